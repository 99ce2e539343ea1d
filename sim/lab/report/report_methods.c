#include "sim/lab/report/report_methods.h"

#include <string.h>

#include "sim/base/result_file.h"

static void name_corpus(const char *path, char name[SIM_CORPUS_NAME_MAX])
{
    size_t end = strlen(path);
    while (end > 1 && path[end - 1] == '/') {
        end--;
    }
    size_t begin = end;
    while (begin > 0 && path[begin - 1] != '/') {
        begin--;
    }
    (void)snprintf(name, SIM_CORPUS_NAME_MAX, "%.*s", (int)(end - begin), path + begin);
}

int sim_contest_of(const struct sim_eval *eval, struct sim_contest *out)
{
    const struct sim_identification *id = &eval->analysis->identification;
    struct sim_contest contest = {
        .n_people = eval->gallery->n_people,
        .n_searches = id->n_searches,
        .n_strangers = id->n_strangers,
        .n_non_mated = eval->analysis->verification.scores.n_non_mated,
    };
    name_corpus(eval->options.corpus, contest.corpus);
    for (size_t i = 0; i < eval->n_methods; i++) {
        if (eval->methods[i].analysis) {
            const int error = sim_verdict_of(eval, i, &contest.verdicts[contest.n_verdicts++]);
            if (error) {
                return error;
            }
        }
    }
    *out = contest;
    return 0;
}

static void print_percent(FILE *out, double value, struct sim_interval interval)
{
    char range[32];
    (void)snprintf(range, sizeof range, "[%.1f, %.1f]", 100.0 * interval.low,
                   100.0 * interval.high);
    fprintf(out, "  %6.2f %-13s", 100.0 * value, range);
}

static void print_p(FILE *out, const struct sim_paired *paired)
{
    fprintf(out, "  %4zu:%-4zu %7.5f", paired->first_better, paired->second_better, paired->p);
}

static void print_verdict(const struct sim_verdict *v, bool is_first, FILE *out)
{
    fprintf(out, "  %-15s", v->method->name);
    print_percent(out, sim_rate_value(v->rank_1), sim_rate_interval(v->rank_1));
    fprintf(out, "  %6.2f", 100.0 * sim_rate_value(v->rank_4));
    if (v->eer >= 0.0) {
        print_percent(out, v->eer, v->eer_interval);
        print_percent(out, v->at.at.fnmr, v->at.fnmr);
    }
    if (!is_first) {
        print_p(out, &v->at_rank_1);
        print_p(out, &v->at_fmr);
    }
    fputc('\n', out);
}

/* The first method's value of one figure, and the best value among the others; lower is better. */
struct standing {
    double own, best;
    struct sim_interval best_interval;
    const char *best_name;
};

static void stand_beside(struct standing *s, const struct sim_verdict *v, double value,
                         struct sim_interval interval, bool is_first)
{
    if (is_first) {
        s->own = value;
    } else if (!s->best_name || value < s->best) {
        *s = (struct standing){s->own, value, interval, v->method->name};
    }
}

static void print_standing(FILE *out, const char *first, const char *figure,
                           const struct standing *s)
{
    const char *how = "worse than the best";
    if (s->own < s->best) {
        how = "better than every other";
    } else if (s->own == s->best) {
        how = "as good as the best other";
    } else if (s->own <= s->best_interval.high) {
        how = "within the interval of the best";
    }
    fprintf(out, "  %s, %s: %s (%s)\n", first, figure, how, s->best_name);
}

static struct sim_interval complement_of(struct sim_interval interval)
{
    return (struct sim_interval){1.0 - interval.high, 1.0 - interval.low};
}

static void print_standings(const struct sim_contest *c, FILE *out)
{
    struct standing rank_1 = {0}, eer = {0}, fnmr = {0};
    for (size_t i = 0; i < c->n_verdicts; i++) {
        const struct sim_verdict *v = &c->verdicts[i];
        stand_beside(&rank_1, v, 1.0 - sim_rate_value(v->rank_1),
                     complement_of(sim_rate_interval(v->rank_1)), i == 0);
        stand_beside(&eer, v, v->eer, v->eer_interval, i == 0);
        stand_beside(&fnmr, v, v->at.at.fnmr, v->at.fnmr, i == 0);
    }
    const char *first = c->verdicts[0].method->name;
    print_standing(out, first, "rank 1", &rank_1);
    if (c->verdicts[0].eer >= 0.0) {
        print_standing(out, first, "EER", &eer);
        print_standing(out, first, "FNMR", &fnmr);
    }
}

void sim_contest_text(const struct sim_contest *c, FILE *out)
{
    if (c->n_verdicts == 0) {
        return;
    }
    const struct sim_verdict *first = &c->verdicts[0];
    fprintf(out,
            "Methods on %s: %zu enrolled, %zu searches (%zu without a comparison), %zu of "
            "strangers,\n%zu non-mated comparisons: the smallest FMR they can support is %.1e\n",
            c->corpus, c->n_people, c->n_searches, first->lost.events, c->n_strangers,
            c->n_non_mated, sim_rate_smallest(c->n_non_mated));
    fprintf(out,
            "  %-15s  rank-1 %% [95 %%]        rank-4  EER %% [95 %%]           "
            "FNMR %% at FMR %.0e     rank 1: people, p    FNMR: people, p\n",
            "", first->fmr);
    for (size_t i = 0; i < c->n_verdicts; i++) {
        print_verdict(&c->verdicts[i], i == 0, out);
    }
    fprintf(
        out,
        "  people: how many have fewer errors with %s, and how many have more; p: paired test\n",
        first->method->name);
    if (c->n_verdicts > 1 && c->n_searches > 0) {
        print_standings(c, out);
    }
}

void sim_contest_left_out(const struct sim_eval *eval, FILE *out)
{
    for (size_t i = 0; i < eval->n_methods; i++) {
        if (!eval->methods[i].analysis) {
            fprintf(out, "  left out: %s\n", eval->methods[i].fault.text);
        }
    }
}

struct contests {
    const struct sim_contest *contests;
    size_t n;
};

static void write_rate(FILE *out, struct sim_rate rate)
{
    struct sim_interval interval = sim_rate_interval(rate);
    fprintf(out, ",%zu,%zu,%.6f,%.6f,%.6f", rate.events, rate.trials, sim_rate_value(rate),
            interval.low, interval.high);
}

static void write_contests(const void *context, FILE *out)
{
    const struct contests *all = context;
    fputs("corpus,method,people,strangers,non_mated,rank_1_events,searches,rank_1,rank_1_low,"
          "rank_1_high,rank_4_events,searches,rank_4,rank_4_low,rank_4_high,eer,eer_low,eer_high,"
          "fmr,supported,fnmr,fnmr_low,fnmr_high,p_rank_1,p_fnmr,seconds,"
          "fnmr_1e-2,fnmr_1e-2_low,fnmr_1e-2_high\n",
          out);
    for (size_t i = 0; i < all->n; i++) {
        const struct sim_contest *c = &all->contests[i];
        for (size_t k = 0; k < c->n_verdicts; k++) {
            const struct sim_verdict *v = &c->verdicts[k];
            fprintf(out, "%s,%s,%zu,%zu,%zu", c->corpus, v->method->name, c->n_people,
                    c->n_strangers, c->n_non_mated);
            write_rate(out, v->rank_1);
            write_rate(out, v->rank_4);
            fprintf(out, ",%.6f,%.6f,%.6f,%g,%d,%.6f,%.6f,%.6f,%.6f,%.6f,%.3f", v->eer,
                    v->eer_interval.low, v->eer_interval.high, v->fmr, v->at.supported,
                    v->at.at.fnmr, v->at.fnmr.low, v->at.fnmr.high, v->at_rank_1.p, v->at_fmr.p,
                    (double)v->wall_ns * 1e-9);
            fprintf(out, ",%.6f,%.6f,%.6f\n", v->at_coarse.at.fnmr, v->at_coarse.fnmr.low,
                    v->at_coarse.fnmr.high);
        }
    }
}

int sim_contest_csv(const struct sim_contest *contests, size_t n, const char *directory,
                    struct iso_fault *fault)
{
    const struct contests all = {contests, n};
    return sim_result_file(directory, "methods.csv", write_contests, &all, fault);
}

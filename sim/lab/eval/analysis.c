#include "sim/lab/eval/analysis.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const double sim_fmr_targets[SIM_FMR_TARGETS] = {1e-1, 1e-2, 1e-3, 1e-4};
const double sim_fpir_targets[SIM_FPIR_TARGETS] = {1e-1, 1e-2, 1e-3};

/* The data that the functions below read and fill in. */
struct analysing {
    const struct sim_corpus *corpus;
    const struct sim_acquisition *acquisition;
    const struct sim_gallery *gallery;
    const struct sim_matches *matches;
    struct sim_analysis *analysis;
};

static const struct sim_sample *sample_of(const struct analysing *w, size_t probe)
{
    return &w->acquisition->samples[w->matches->sample[probe]];
}

static const struct sim_corpus_row *row_of(const struct analysing *w, size_t probe)
{
    return &w->corpus->rows[sample_of(w, probe)->row];
}

/* Sets the person of each probe. People are numbered in the order of their first probe. */
static void identify_probes(const struct analysing *w)
{
    struct sim_analysis *a = w->analysis;
    for (size_t i = 0; i < w->matches->n_probes; i++) {
        const char *subject = row_of(w, i)->subject;
        a->mate[i] = sim_gallery_find(w->gallery, subject);
        a->kind[i] = a->mate[i] == SIM_NOBODY ? SIM_PROBE_STRANGER : SIM_PROBE_MATED;
        if (strcmp(subject, "none") == 0) {
            a->kind[i] = SIM_PROBE_NONE;
        }
        size_t same = 0;
        while (same < i && strcmp(row_of(w, same)->subject, subject) != 0) {
            same++;
        }
        a->person[i] = same < i ? a->person[same] : a->n_subjects++;
    }
}

static void count_samples(const struct analysing *w)
{
    struct sim_analysis *a = w->analysis;
    for (size_t i = 0; i < w->acquisition->n_samples; i++) {
        const struct sim_sample *sample = &w->acquisition->samples[i];
        if (w->corpus->rows[sample->row].role == SIM_ROLE_GALLERY) {
            a->n_gallery_samples++;
            a->gallery_reason[sample->reason]++;
        }
    }
    for (size_t i = 0; i < w->matches->n_probes; i++) {
        a->n_kind[a->kind[i]]++;
        a->probe_reason[a->kind[i]][sample_of(w, i)->reason]++;
    }
    for (size_t p = 0; p < w->gallery->n_people; p++) {
        a->n_people_not_enrolled += w->gallery->n_templates_of[p] == 0;
    }
    for (size_t i = 0; i < w->acquisition->n_captures; i++) {
        a->n_usable_captures += w->acquisition->captures[i].extraction.outcome == ISO_CAPTURE_OK;
    }
}

static bool is_comparable(const struct analysing *w, size_t probe, size_t person)
{
    return sample_of(w, probe)->acquired && w->gallery->n_templates_of[person] > 0;
}

/* Appends a probe's comparisons; returns 1 if its mated one is lost. */
static size_t add_comparisons(const struct analysing *w, size_t probe, struct sim_scores *scores)
{
    const struct sim_analysis *a = w->analysis;
    for (size_t p = 0; p < w->gallery->n_people; p++) {
        if (is_comparable(w, probe, p)) {
            const double value = sim_matches_compared(w->matches, probe, p, a->mate[probe]);
            const struct sim_score score = {value, a->person[probe]};
            if (p == a->mate[probe]) {
                scores->mated[scores->n_mated++] = score;
            } else {
                scores->non_mated[scores->n_non_mated++] = score;
            }
        }
    }
    return a->kind[probe] == SIM_PROBE_MATED && !is_comparable(w, probe, a->mate[probe]);
}

static struct sim_interval wider_interval(struct sim_interval a, struct sim_interval b)
{
    return (struct sim_interval){fmin(a.low, b.low), fmax(a.high, b.high)};
}

/* The interval of a rate of mated comparisons (0..1) from the counts alone. */
static struct sim_interval interval_of_counts(const struct sim_verification *v, double rate)
{
    const size_t n = v->scores.n_mated;
    return sim_rate_interval((struct sim_rate){(size_t)lround(rate * (double)n), n});
}

/* Computes the intervals of the EER and of the FNMRs in two ways. The bootstrap takes account of
 * the dependence of one person's comparisons, but it treats an event that did not occur as
 * impossible. The interval of the counts allows for such events, but it assumes independent
 * comparisons. The result reaches from the lower of both ends to the higher. */
static int verify_intervals(struct sim_verification *v, uint32_t n_subjects)
{
    struct sim_interval eer, fnmr[SIM_FMR_TARGETS];
    const int error = sim_det_bootstrap(&v->scores, n_subjects, sim_fmr_targets, SIM_FMR_TARGETS,
                                        &eer, fnmr);
    if (error == -ENOMEM) {
        return error;
    }
    /* One person cannot be resampled, so the interval is unknown. */
    const struct sim_interval anything = {0.0, 1.0};
    v->eer_interval = error ? anything : wider_interval(eer, interval_of_counts(v, v->eer));
    for (size_t k = 0; k < SIM_FMR_TARGETS; k++) {
        struct sim_operating_point *point = &v->at_fmr[k];
        point->fnmr = error ? anything
                            : wider_interval(fnmr[k], interval_of_counts(v, point->at.fnmr));
    }
    return 0;
}

static int verify_probes(const struct analysing *w)
{
    struct sim_verification *v = &w->analysis->verification;
    for (size_t i = 0; i < w->matches->n_probes; i++) {
        if (w->analysis->kind[i] != SIM_PROBE_NONE) {
            v->n_lost += add_comparisons(w, i, &v->scores);
        }
    }
    sim_scores_sort(&v->scores);
    v->n_det = sim_det_points(&v->scores, NULL, v->det);
    if (v->n_det == 0) {
        return 0;
    }
    v->eer = sim_det_eer(v->det, v->n_det);
    for (size_t k = 0; k < SIM_FMR_TARGETS; k++) {
        struct sim_operating_point *point = &v->at_fmr[k];
        point->at = sim_det_at_fmr(v->det, v->n_det, sim_fmr_targets[k]);
        const size_t failed = (size_t)lround(point->at.fnmr * (double)v->scores.n_mated);
        point->gfnmr = (struct sim_rate){failed + v->n_lost, v->scores.n_mated + v->n_lost};
        point->supported = sim_rate_smallest(v->scores.n_non_mated) <= sim_fmr_targets[k];
    }
    return verify_intervals(v, w->analysis->n_subjects);
}

static struct sim_mated_search search_of(const struct analysing *w, size_t probe)
{
    const size_t mate = w->analysis->mate[probe];
    if (!is_comparable(w, probe, mate)) {
        return (struct sim_mated_search){0, 0.0};
    }
    const double *score = w->matches->score + probe * w->matches->n_people;
    return (struct sim_mated_search){sim_rank(score, w->matches->n_people, mate), score[mate]};
}

static double top_score_of(const struct analysing *w, size_t probe)
{
    double top = -INFINITY;
    for (size_t p = 0; p < w->matches->n_people; p++) {
        top = fmax(top, w->matches->score[probe * w->matches->n_people + p]);
    }
    return top;
}

static void identify_people(const struct analysing *w)
{
    struct sim_identification *id = &w->analysis->identification;
    for (size_t i = 0; i < w->matches->n_probes; i++) {
        if (w->analysis->kind[i] == SIM_PROBE_MATED) {
            id->searches[id->n_searches++] = search_of(w, i);
        } else if (w->analysis->kind[i] == SIM_PROBE_STRANGER) {
            id->top_score[id->n_strangers++] = top_score_of(w, i);
        }
    }
    for (size_t k = 0; k < SIM_FPIR_TARGETS && id->n_searches > 0 && id->n_strangers > 0; k++) {
        id->at_fpir[k] = sim_open_set_at_fpir(id->searches, id->n_searches, id->top_score,
                                              id->n_strangers, sim_fpir_targets[k]);
    }
}

static void count_not_faces(const struct analysing *w)
{
    struct sim_analysis *a = w->analysis;
    for (size_t i = 0; i < w->matches->n_probes && a->verification.n_det > 0; i++) {
        a->none_matched += a->kind[i] == SIM_PROBE_NONE &&
                           top_score_of(w, i) >= a->verification.at_fmr[2].at.threshold;
    }
}

/* Computes the figures of the probes whose row has the condition's value in a column. `scores` and
 * `det` are scratch memory. */
static void condition_figures(const struct analysing *w, size_t column_offset,
                              struct sim_scores *scores, struct sim_det_point *det,
                              struct sim_condition *condition)
{
    scores->n_mated = scores->n_non_mated = 0;
    for (size_t i = 0; i < w->matches->n_probes; i++) {
        const char *value = (const char *)row_of(w, i) + column_offset;
        if (w->analysis->kind[i] == SIM_PROBE_NONE || strcmp(value, condition->value) != 0) {
            continue;
        }
        (void)add_comparisons(w, i, scores);
        if (w->analysis->kind[i] == SIM_PROBE_MATED) {
            const size_t rank = search_of(w, i).rank;
            condition->not_acquired.events += !sample_of(w, i)->acquired;
            condition->not_acquired.trials++;
            condition->rank_1.events += rank == 1;
            condition->rank_1.trials++;
            condition->rank_4.events += rank >= 1 && rank <= 4;
            condition->rank_4.trials++;
        }
    }
    sim_scores_sort(scores);
    const size_t n = sim_det_points(scores, NULL, det);
    condition->eer = sim_det_eer(det, n);
}

/* Adds one condition for each value of a manifest column with enough searches, in the order of
 * first occurrence. */
static void break_down(const struct analysing *w, const char *column, size_t column_offset,
                       struct sim_scores *scores, struct sim_det_point *det)
{
    struct sim_analysis *a = w->analysis;
    const size_t first = a->n_conditions;
    for (size_t i = 0; i < w->matches->n_probes; i++) {
        const char *value = (const char *)row_of(w, i) + column_offset;
        size_t c = first;
        while (c < a->n_conditions && strcmp(a->conditions[c].value, value) != 0) {
            c++;
        }
        if (a->kind[i] == SIM_PROBE_MATED && value[0] != '\0' && c == a->n_conditions) {
            a->conditions[c] = (struct sim_condition){.column = column, .value = value};
            condition_figures(w, column_offset, scores, det, &a->conditions[c]);
            a->n_conditions += a->conditions[c].rank_1.trials >= SIM_CONDITION_MIN;
        }
    }
}

static int break_down_all(const struct analysing *w)
{
    const struct sim_scores *all = &w->analysis->verification.scores;
    struct sim_scores scores = {
        .mated = calloc(all->n_mated + 1, sizeof *scores.mated),
        .non_mated = calloc(all->n_non_mated + 1, sizeof *scores.non_mated),
    };
    struct sim_det_point *det = calloc(all->n_mated + all->n_non_mated + 1, sizeof *det);
    const int error = scores.mated && scores.non_mated && det ? 0 : -ENOMEM;
    if (!error) {
        break_down(w, "pose", offsetof(struct sim_corpus_row, pose), &scores, det);
        break_down(w, "expression", offsetof(struct sim_corpus_row, expression), &scores, det);
    }
    free(scores.mated);
    free(scores.non_mated);
    free(det);
    return error;
}

static void time_searches(const struct analysing *w, int64_t *times_ns)
{
    const struct sim_matches *m = w->matches;
    size_t n_cpu = 0, n_wall = 0;
    for (size_t i = 0; i < m->n_probes; i++) {
        if (sample_of(w, i)->acquired) {
            times_ns[n_cpu++] = m->cpu_ns[i];
        }
    }
    w->analysis->search_cpu = sim_latency_of(times_ns, n_cpu);
    for (size_t i = 0; i < m->n_probes; i++) {
        if (sample_of(w, i)->acquired) {
            times_ns[n_wall++] = m->wall_ns[i];
        }
    }
    w->analysis->search_wall = sim_latency_of(times_ns, n_wall);
}

/* Times of usable captures: of a stage (0 .. ISO_STAGES - 1), or of the whole run by one of the
 * clocks. */
enum { WHOLE_CPU = ISO_STAGES, WHOLE_WALL };

static int64_t time_of(const struct sim_capture *capture, int what)
{
    switch (what) {
    case WHOLE_CPU:
        return capture->cpu_ns;
    case WHOLE_WALL:
        return capture->wall_ns;
    default:
        return capture->extraction.stage_ns[what];
    }
}

static struct sim_latency time_captures(const struct sim_acquisition *acquisition, int what,
                                        int64_t *times_ns)
{
    size_t n = 0;
    for (size_t i = 0; i < acquisition->n_captures; i++) {
        const struct sim_capture *c = &acquisition->captures[i];
        if (c->extraction.outcome == ISO_CAPTURE_OK) {
            times_ns[n++] = time_of(c, what);
        }
    }
    return sim_latency_of(times_ns, n);
}

static int time_all(const struct analysing *w)
{
    struct sim_analysis *a = w->analysis;
    int64_t *times_ns = calloc(w->acquisition->n_captures, sizeof *times_ns);
    if (!times_ns) {
        return -ENOMEM;
    }
    for (int stage = 0; stage < ISO_STAGES; stage++) {
        a->stage[stage] = time_captures(w->acquisition, stage, times_ns);
    }
    a->extract_cpu = time_captures(w->acquisition, WHOLE_CPU, times_ns);
    a->extract_wall = time_captures(w->acquisition, WHOLE_WALL, times_ns);
    time_searches(w, times_ns);
    free(times_ns);
    return 0;
}

static struct sim_analysis *new_analysis(size_t n_probes, size_t n_people)
{
    struct sim_analysis *a = calloc(1, sizeof *a);
    if (!a) {
        return NULL;
    }
    struct sim_verification *v = &a->verification;
    struct sim_identification *id = &a->identification;
    const size_t n_pairs = n_probes * n_people;
    a->kind = calloc(n_probes + 1, sizeof *a->kind);
    a->mate = calloc(n_probes + 1, sizeof *a->mate);
    a->person = calloc(n_probes + 1, sizeof *a->person);
    a->conditions = calloc(2 * n_probes + 1, sizeof *a->conditions);
    v->scores.mated = calloc(n_probes + 1, sizeof *v->scores.mated);
    v->scores.non_mated = calloc(n_pairs + 1, sizeof *v->scores.non_mated);
    v->det = calloc(n_probes + n_pairs + 1, sizeof *v->det);
    id->searches = calloc(n_probes + 1, sizeof *id->searches);
    id->top_score = calloc(n_probes + 1, sizeof *id->top_score);
    if (!a->kind || !a->mate || !a->person || !a->conditions || !v->scores.mated ||
        !v->scores.non_mated || !v->det || !id->searches || !id->top_score) {
        sim_analysis_free(a);
        return NULL;
    }
    return a;
}

int sim_analyse(const struct sim_corpus *corpus, const struct sim_acquisition *acquisition,
                const struct sim_gallery *gallery, const struct sim_matches *matches,
                struct sim_analysis **out)
{
    struct sim_analysis *a = new_analysis(matches->n_probes, matches->n_people);
    if (!a) {
        return -ENOMEM;
    }
    struct analysing w = {corpus, acquisition, gallery, matches, a};
    identify_probes(&w);
    count_samples(&w);
    int error = verify_probes(&w);
    if (!error) {
        identify_people(&w);
        count_not_faces(&w);
        error = break_down_all(&w);
    }
    if (!error) {
        error = time_all(&w);
    }
    if (error) {
        sim_analysis_free(a);
        return error;
    }
    *out = a;
    return 0;
}

void sim_analysis_free(struct sim_analysis *a)
{
    if (a) {
        free(a->kind);
        free(a->mate);
        free(a->person);
        free(a->conditions);
        free(a->verification.scores.mated);
        free(a->verification.scores.non_mated);
        free(a->verification.det);
        free(a->identification.searches);
        free(a->identification.top_score);
        free(a);
    }
}

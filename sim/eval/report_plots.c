#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim/eval/report.h"
#include "sim/picture/plot.h"

static int write_plot(const struct sim_plot *plot, const char *directory, const char *name,
                      struct iso_fault *fault)
{
    char path[4096];
    int length = snprintf(path, sizeof path, "%s/%s", directory, name);
    if (length < 0 || (size_t)length >= sizeof path) {
        return iso_fault_set(fault, -ENAMETOOLONG, "%s: path too long", name);
    }
    return sim_plot_write(plot, path, fault);
}

static int out_of_memory(const char *name, struct iso_fault *fault)
{
    return iso_fault_set(fault, -ENOMEM, "%s: out of memory", name);
}

static int plot_cmc(const struct sim_eval *eval, const char *directory, struct iso_fault *fault)
{
    enum { RANKS_MAX = 20 };
    const struct sim_identification *id = &eval->analysis->identification;
    double rank[RANKS_MAX], rate[RANKS_MAX], worst = 100.0;
    size_t n = eval->gallery->n_people < RANKS_MAX ? eval->gallery->n_people : RANKS_MAX;
    if (id->n_searches == 0 || n < 2) {
        return 0;
    }
    for (size_t r = 0; r < n; r++) {
        rank[r] = (double)(r + 1);
        rate[r] = 100.0 * sim_rate_value(sim_rank_rate(id->searches, id->n_searches, r + 1));
        worst = fmin(worst, rate[r]);
    }
    char subtitle[96];
    (void)snprintf(subtitle, sizeof subtitle, "%zu searches of %zu people", id->n_searches,
                   eval->gallery->n_people);
    const struct sim_series series = {NULL, SIM_SERIES_MARKED, n, rank, rate};
    const struct sim_plot plot = {
        .title = "Cumulative match characteristic",
        .subtitle = subtitle,
        .x = {"rank", SIM_SCALE_LINEAR, 1.0, (double)n},
        .y = {"searches that find the person, %", SIM_SCALE_LINEAR,
              fmax(0.0, 10.0 * floor((worst - 5.0) / 10.0)), 100.0},
        .n_series = 1,
        .series = &series,
    };
    return write_plot(&plot, directory, "cmc.png", fault);
}

static int plot_det(const struct sim_eval *eval, const char *directory, struct iso_fault *fault)
{
    const struct sim_verification *v = &eval->analysis->verification;
    if (v->n_det == 0) {
        return 0;
    }
    double *fmr = calloc(v->n_det, sizeof *fmr), *fnmr = calloc(v->n_det, sizeof *fnmr);
    if (!fmr || !fnmr) {
        free(fmr);
        free(fnmr);
        return out_of_memory("det.png", fault);
    }
    const double lowest = 1e-4, highest = 0.5, ends[] = {lowest, highest};
    size_t n = 0;
    for (size_t i = 0; i < v->n_det; i++) {
        const struct sim_det_point *point = &v->det[i];
        if (point->fmr >= lowest && point->fmr <= highest && point->fnmr <= highest) {
            fmr[n] = point->fmr;
            fnmr[n++] = point->fnmr;
        }
    }
    char subtitle[128];
    (void)snprintf(subtitle, sizeof subtitle, "%zu mated, %zu non-mated comparisons; EER %.2f %%",
                   v->scores.n_mated, v->scores.n_non_mated, 100.0 * v->eer);
    const struct sim_series series[] = {
        {NULL, SIM_SERIES_LINE, n, fmr, fnmr},
        {NULL, SIM_SERIES_DASHED, 2, ends, ends},
    };
    const struct sim_plot plot = {
        .title = "Detection error trade-off",
        .subtitle = subtitle,
        .x = {"false match rate", SIM_SCALE_NORMAL, lowest, highest},
        .y = {"false non-match rate", SIM_SCALE_NORMAL, lowest, highest},
        .n_series = 2,
        .series = series,
    };
    int error = write_plot(&plot, directory, "det.png", fault);
    free(fmr);
    free(fnmr);
    return error;
}

enum { BINS = 80 };

/* The outline of a histogram, two points a bin, as shares; returns the highest. */
static double histogram(const struct sim_score *scores, size_t n, double from, double to, double *x,
                        double *y)
{
    double share[BINS] = {0.0}, highest = 0.0;
    for (size_t i = 0; i < n; i++) {
        double bin = floor((scores[i].score - from) / (to - from) * BINS);
        share[(size_t)fmin(fmax(bin, 0.0), BINS - 1)] += 1.0 / (double)n;
    }
    for (size_t b = 0; b < BINS; b++) {
        x[2 * b] = from + (to - from) * (double)b / BINS;
        x[2 * b + 1] = from + (to - from) * (double)(b + 1) / BINS;
        y[2 * b] = y[2 * b + 1] = 100.0 * share[b];
        highest = fmax(highest, 100.0 * share[b]);
    }
    return highest;
}

/* The lowest finite of rising scores. */
static double lowest_finite(const struct sim_score *scores, size_t n)
{
    size_t i = 0;
    while (i + 1 < n && !isfinite(scores[i].score)) {
        i++;
    }
    return scores[i].score;
}

static int plot_scores(const struct sim_eval *eval, const char *directory, struct iso_fault *fault)
{
    const struct sim_verification *v = &eval->analysis->verification;
    const struct sim_scores *s = &v->scores;
    if (v->n_det == 0) {
        return 0;
    }
    double from = fmin(lowest_finite(s->mated, s->n_mated),
                       lowest_finite(s->non_mated, s->n_non_mated));
    double to = fmax(s->mated[s->n_mated - 1].score, s->non_mated[s->n_non_mated - 1].score);
    if (!isfinite(from) || !isfinite(to) || !(from < to)) {
        return 0; /* nothing to be seen in it */
    }
    double x[2][2 * BINS], y[2][2 * BINS];
    double highest = fmax(histogram(s->mated, s->n_mated, from, to, x[0], y[0]),
                          histogram(s->non_mated, s->n_non_mated, from, to, x[1], y[1]));
    const double threshold = fmin(v->at_fmr[2].at.threshold, to);
    const double threshold_x[] = {threshold, threshold}, threshold_y[] = {0.0, highest};
    const struct sim_series series[] = {
        {"mated", SIM_SERIES_FILLED, 2 * BINS, x[0], y[0]},
        {"non-mated", SIM_SERIES_FILLED, 2 * BINS, x[1], y[1]},
        {NULL, SIM_SERIES_DASHED, 2, threshold_x, threshold_y},
    };
    const struct sim_plot plot = {
        .title = "Scores",
        .subtitle = "dashed: threshold at FMR 0.1 %",
        .x = {eval->cohort ? "score (cohort-normalised)" : "score (negative distance, mm)",
              SIM_SCALE_LINEAR, from, to},
        .y = {"share of comparisons, %", SIM_SCALE_LINEAR, 0.0, 1.05 * highest},
        .n_series = 3,
        .series = series,
    };
    return write_plot(&plot, directory, "scores.png", fault);
}

int sim_report_plots(const struct sim_eval *eval, const char *directory, struct iso_fault *fault)
{
    int error = plot_cmc(eval, directory, fault);
    if (!error) {
        error = plot_det(eval, directory, fault);
    }
    return error ? error : plot_scores(eval, directory, fault);
}

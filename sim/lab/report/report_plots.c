#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "sim/lab/draw/plot.h"
#include "sim/lab/report/report.h"
#include "sim/lab/report/report_calibration.h"

static int write_plot(const struct sim_plot *plot, const char *directory, const char *name,
                      struct iso_fault *fault)
{
    char path[4096];
    const int length = snprintf(path, sizeof path, "%s/%s", directory, name);
    if (length < 0 || (size_t)length >= sizeof path) {
        return iso_fault_set(fault, -ENAMETOOLONG, "%s: path too long", name);
    }
    return sim_plot_write(plot, path, fault);
}

static int out_of_memory(const char *name, struct iso_fault *fault)
{
    return iso_fault_set(fault, -ENOMEM, "%s: out of memory", name);
}

enum { RANKS_MAX = 20, CURVES_MAX = SIM_METHODS };

/* Lists the methods that were not skipped, and returns their number. */
static size_t list_methods(const struct sim_eval *eval,
                           const struct sim_eval_method *methods[CURVES_MAX])
{
    size_t n = 0;
    for (size_t i = 0; i < eval->n_methods; i++) {
        if (eval->methods[i].analysis) {
            methods[n++] = &eval->methods[i];
        }
    }
    return n;
}

/* A curve needs its method's name only if there are several curves. */
static const char *label_of(const struct sim_eval_method *method, size_t n_methods)
{
    return n_methods > 1 ? method->method->name : NULL;
}

static int plot_cmc(const struct sim_eval *eval, const char *directory, struct iso_fault *fault)
{
    const struct sim_eval_method *methods[CURVES_MAX];
    const size_t n_methods = list_methods(eval, methods);
    const size_t n = eval->gallery->n_people < RANKS_MAX ? eval->gallery->n_people : RANKS_MAX;
    const size_t n_searches = eval->analysis->identification.n_searches;
    double rank[RANKS_MAX], rate[CURVES_MAX][RANKS_MAX], worst = 100.0;
    struct sim_series series[CURVES_MAX];
    if (n_searches == 0 || n < 2) {
        return 0;
    }
    for (size_t m = 0; m < n_methods; m++) {
        const struct sim_identification *id = &methods[m]->analysis->identification;
        for (size_t r = 0; r < n; r++) {
            rank[r] = (double)(r + 1);
            rate[m][r] = 100.0 * sim_rate_value(sim_rank_rate(id->searches, n_searches, r + 1));
            worst = fmin(worst, rate[m][r]);
        }
        series[m] = (struct sim_series){label_of(methods[m], n_methods), SIM_SERIES_MARKED, n, rank,
                                        rate[m]};
    }
    char subtitle[96];
    (void)snprintf(subtitle, sizeof subtitle, "%zu searches of %zu people", n_searches,
                   eval->gallery->n_people);
    const struct sim_plot plot = {
        .title = "Cumulative match characteristic",
        .subtitle = subtitle,
        .legend = n_methods > 1 ? SIM_LEGEND_LOWER : SIM_LEGEND_LINE,
        .x = {"rank", SIM_SCALE_LINEAR, 1.0, (double)n},
        .y = {"searches that find the person, %", SIM_SCALE_LINEAR,
              fmax(0.0, 10.0 * floor((worst - 5.0) / 10.0)), 100.0},
        .n_series = n_methods,
        .series = series,
    };
    return write_plot(&plot, directory, "cmc.png", fault);
}

static const double det_lowest = 1e-4, det_highest = 0.5;

/* The part of a DET curve inside the axes. `x` has room for both coordinates of n_det points. */
static struct sim_series det_series(const struct sim_verification *v, const char *label, double *x)
{
    double *y = x + v->n_det;
    size_t n = 0;
    for (size_t i = 0; i < v->n_det; i++) {
        const struct sim_det_point *point = &v->det[i];
        if (point->fmr >= det_lowest && point->fmr <= det_highest && point->fnmr <= det_highest) {
            x[n] = point->fmr;
            y[n++] = point->fnmr;
        }
    }
    return (struct sim_series){label, SIM_SERIES_LINE, n, x, y};
}

static int draw_det(const struct sim_eval *eval, const struct sim_series *series, size_t n_series,
                    const char *directory, struct iso_fault *fault)
{
    const struct sim_verification *v = &eval->analysis->verification;
    char subtitle[128];
    const int length = snprintf(subtitle, sizeof subtitle, "%zu mated, %zu non-mated comparisons",
                                v->scores.n_mated, v->scores.n_non_mated);
    if (n_series == 2) { /* one method and the diagonal */
        (void)snprintf(subtitle + length, sizeof subtitle - (size_t)length, "; EER %.2f %%",
                       100.0 * v->eer);
    }
    const struct sim_plot plot = {
        .title = "Detection error trade-off",
        .subtitle = subtitle,
        .legend = n_series > 2 ? SIM_LEGEND_UPPER : SIM_LEGEND_LINE,
        .x = {"false match rate", SIM_SCALE_NORMAL, det_lowest, det_highest},
        .y = {"false non-match rate", SIM_SCALE_NORMAL, det_lowest, det_highest},
        .n_series = n_series,
        .series = series,
    };
    return write_plot(&plot, directory, "det.png", fault);
}

static int plot_det(const struct sim_eval *eval, const char *directory, struct iso_fault *fault)
{
    const struct sim_eval_method *methods[CURVES_MAX];
    size_t n_methods = list_methods(eval, methods), n_points = 0, n = 0;
    struct sim_series series[CURVES_MAX + 1];
    if (eval->analysis->verification.n_det == 0) {
        return 0;
    }
    for (size_t m = 0; m < n_methods; m++) {
        n_points += methods[m]->analysis->verification.n_det;
    }
    double *x = calloc(2 * n_points, sizeof *x);
    if (!x) {
        return out_of_memory("det.png", fault);
    }
    for (size_t m = 0; m < n_methods; m++) {
        const struct sim_verification *v = &methods[m]->analysis->verification;
        series[m] = det_series(v, label_of(methods[m], n_methods), x + 2 * n);
        n += v->n_det;
    }
    const double ends[] = {det_lowest, det_highest};
    series[n_methods] = (struct sim_series){NULL, SIM_SERIES_DASHED, 2, ends, ends};
    const int error = draw_det(eval, series, n_methods + 1, directory, fault);
    free(x);
    return error;
}

enum { BINS = 80 };

/* The outline of a histogram of shares in percent, two points for each bin. Returns the highest
 * share. */
static double histogram_outline(const struct sim_score *scores, size_t n, double from, double to,
                                double *x, double *y)
{
    double share[BINS] = {0.0}, highest = 0.0;
    for (size_t i = 0; i < n; i++) {
        const double bin = floor((scores[i].score - from) / (to - from) * BINS);
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

/* The lowest finite one of rising scores, or the last one if none is finite. */
static double lowest_finite(const struct sim_score *scores, size_t n)
{
    size_t i = 0;
    while (i + 1 < n && !isfinite(scores[i].score)) {
        i++;
    }
    return scores[i].score;
}

/* The label of the axis of scores, by the kind of the first method's scores. */
static const char *score_label(const struct sim_eval *eval)
{
    static const char *const labels[] = {
        [SIM_SCORE_PAIRWISE] = "score (negative distance)",
        [SIM_SCORE_METRIC] = "score (metric)",
        [SIM_SCORE_COHORT] = "score (cohort-normalised)",
        [SIM_SCORE_DISTANCE] = "score (negative distance, mm)",
    };
    return labels[sim_eval_score_kind(eval)];
}

static int plot_scores(const struct sim_eval *eval, const char *directory, struct iso_fault *fault)
{
    const struct sim_verification *v = &eval->analysis->verification;
    const struct sim_scores *s = &v->scores;
    if (v->n_det == 0) {
        return 0;
    }
    const double from = fmin(lowest_finite(s->mated, s->n_mated),
                             lowest_finite(s->non_mated, s->n_non_mated));
    const double to = fmax(s->mated[s->n_mated - 1].score, s->non_mated[s->n_non_mated - 1].score);
    if (!isfinite(from) || !isfinite(to) || !(from < to)) {
        return 0; /* the picture would be empty */
    }
    double x[2][2 * BINS], y[2][2 * BINS];
    const double highest = fmax(
        histogram_outline(s->mated, s->n_mated, from, to, x[0], y[0]),
        histogram_outline(s->non_mated, s->n_non_mated, from, to, x[1], y[1]));
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
        .x = {score_label(eval), SIM_SCALE_LINEAR, from, to},
        .y = {"share of comparisons, %", SIM_SCALE_LINEAR, 0.0, 1.05 * highest},
        .n_series = 3,
        .series = series,
    };
    return write_plot(&plot, directory, "scores.png", fault);
}

static int plot_growth(const struct sim_eval *eval, const char *directory, struct iso_fault *fault)
{
    const struct sim_growth *growth = &eval->growth;
    double people[SIM_GROWTH_MAX], fpir[SIM_GROWTH_MAX], fnir[SIM_GROWTH_MAX], highest = 1.0;
    if (growth->n < 2) {
        return 0;
    }
    for (size_t i = 0; i < growth->n; i++) {
        people[i] = (double)growth->points[i].n_people;
        fpir[i] = 100.0 * growth->points[i].fpir;
        fnir[i] = 100.0 * growth->points[i].fnir_at_fpir;
        highest = fmax(highest, fmax(fpir[i], fnir[i]));
    }
    const struct sim_series series[] = {
        {"FPIR at one threshold", SIM_SERIES_MARKED, growth->n, people, fpir},
        {"FNIR at FPIR 1 %", SIM_SERIES_MARKED, growth->n, people, fnir},
    };
    const struct sim_plot plot = {
        .title = "Identification by people enrolled",
        .x = {"people enrolled", SIM_SCALE_LOG, people[0], people[growth->n - 1]},
        .y = {"error rate, %", SIM_SCALE_LINEAR, 0.0, 1.05 * highest},
        .n_series = 2,
        .series = series,
    };
    return write_plot(&plot, directory, "growth.png", fault);
}

static int plot_curve(const struct sim_eval *eval, enum sim_factor factor, const char *directory,
                      struct iso_fault *fault)
{
    const struct sim_curve *curve = &eval->curves[factor];
    double x[SIM_CURVE_BINS], y[3][SIM_CURVE_BINS], highest = 1.0;
    for (size_t i = 0; i < curve->n_bins; i++) {
        struct sim_interval interval = sim_rate_interval(curve->bins[i].non_match);
        x[i] = curve->bins[i].mean;
        y[0][i] = 100.0 * sim_rate_value(curve->bins[i].non_match);
        y[1][i] = 100.0 * interval.low;
        y[2][i] = 100.0 * interval.high;
        highest = fmax(highest, y[2][i]);
    }
    const struct sim_series series[] = {
        {NULL, SIM_SERIES_MARKED, curve->n_bins, x, y[0]},
        {NULL, SIM_SERIES_DASHED, curve->n_bins, x, y[1]},
        {NULL, SIM_SERIES_DASHED, curve->n_bins, x, y[2]},
    };
    const struct sim_plot plot = {
        .title = "False non-match rate at FMR 0.1 %",
        .subtitle = "dashed: 95 % intervals",
        .x = {sim_factor_label(factor), SIM_SCALE_LINEAR, x[0], x[curve->n_bins - 1]},
        .y = {"false non-match rate, %", SIM_SCALE_LINEAR, 0.0, 1.05 * highest},
        .n_series = 3,
        .series = series,
    };
    char name[64];
    (void)snprintf(name, sizeof name, "curve-%s.png", sim_factor_name(factor));
    return write_plot(&plot, directory, name, fault);
}

int sim_report_plots(const struct sim_eval *eval, const char *directory, struct iso_fault *fault)
{
    int error = plot_cmc(eval, directory, fault);
    if (!error) {
        error = plot_det(eval, directory, fault);
    }
    if (!error) {
        error = plot_scores(eval, directory, fault);
    }
    if (!error) {
        error = plot_growth(eval, directory, fault);
    }
    if (!error) {
        error = sim_report_promise(&eval->calibration, directory, "promise.png", fault);
    }
    if (!error) {
        error = sim_report_promise(&eval->site.calibration, directory, "site-promise.png", fault);
    }
    for (int f = 0; f < SIM_FACTORS && !error; f++) {
        if (eval->curves[f].n_bins > 1 && eval->analysis->verification.n_det > 0) {
            error = plot_curve(eval, (enum sim_factor)f, directory, fault);
        }
    }
    return error;
}

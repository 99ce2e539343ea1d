#include "sim/lab/report/report_calibration.h"

#include <math.h>

#include "drivers/base/path.h"
#include "sim/lab/draw/plot.h"

enum { LEVEL_FIRST = 1, LEVEL_LAST = 4, LEVELS = LEVEL_LAST - LEVEL_FIRST + 1 };

static const struct sim_promise_point *point_of(const struct sim_calibration *calibration,
                                                int score)
{
    return &calibration->promise[(size_t)score * SIM_PROMISE_STEPS];
}

void sim_report_calibration(const struct sim_calibration *calibration, FILE *out)
{
    if (!calibration->known) {
        return;
    }
    fputs("Promise:  score   FMR promised, measured %  [95 %, over people]\n", out);
    for (int score = LEVEL_FIRST; score <= LEVEL_LAST; score++) {
        const struct sim_promise_point *p = point_of(calibration, score);
        fprintf(out, "  %13.0f %14.2f %9.4f  [%.4f, %.4f]\n", p->score, 100.0 * p->promised,
                100.0 * p->fmr, 100.0 * p->interval.low, 100.0 * p->interval.high);
    }
    fprintf(out, "  Cllr %.4f bits, at least %.4f with another calibration\n", calibration->cllr,
            calibration->cllr_min);
    for (int i = 0; i < SIM_DETECTION_COSTS; i++) {
        const struct sim_detection_cost *cost = &calibration->cost[i];
        fprintf(out, "  DCF at %s, %.0f: %.4f, at least %.4f (at %.2f), weight %.1f\n", cost->level,
                cost->threshold, cost->actual, cost->minimum, cost->best_at, cost->weight);
    }
}

/* ---- summary.json ---- */

static json_t *interval_json(double score, double rate, struct sim_interval interval)
{
    return json_pack("{s:f, s:o, s:f, s:f}", "score", score, "rate", sim_json_number(rate), "low",
                     interval.low, "high", interval.high);
}

static json_t *curve_json(const struct sim_calibration *calibration)
{
    json_t *array = json_array();
    for (int i = 0; i < SIM_PROMISE_POINTS; i++) {
        const struct sim_promise_point *p = &calibration->promise[i];
        json_t *point = interval_json(p->score, p->fmr, p->interval);
        json_object_set_new(point, "promised", json_real(p->promised));
        json_array_append_new(array, point);
    }
    return array;
}

static json_t *costs_json(const struct sim_calibration *calibration)
{
    json_t *array = json_array();
    for (int i = 0; i < SIM_DETECTION_COSTS; i++) {
        const struct sim_detection_cost *c = &calibration->cost[i];
        json_array_append_new(array, json_pack("{s:s, s:f, s:f, s:o, s:o, s:o}", "level", c->level,
                                               "threshold", c->threshold, "weight", c->weight,
                                               "actual", sim_json_number(c->actual), "minimum",
                                               sim_json_number(c->minimum), "best_at",
                                               sim_json_number(c->best_at)));
    }
    return array;
}

json_t *sim_json_calibration(const struct sim_calibration *calibration)
{
    return json_pack("{s:o, s:o, s:o, s:o}", "cllr", sim_json_number(calibration->cllr), "cllr_min",
                     sim_json_number(calibration->cllr_min), "dcf", costs_json(calibration), "fmr",
                     curve_json(calibration));
}

static void add_split(const struct sim_site_split *site, json_t *object)
{
    json_t *fmr = json_array(), *fnmr = json_array();
    for (int i = 0; i < SIM_SITE_SCORES; i++) {
        const struct sim_site_rate *at = &site->at[i];
        json_array_append_new(fmr, interval_json(at->score, at->fmr, at->fmr_interval));
        json_array_append_new(fnmr, interval_json(at->score, at->fnmr, at->fnmr_interval));
    }
    json_object_set_new(object, "splits", json_integer((json_int_t)site->splits));
    json_object_set_new(object, "people", json_integer((json_int_t)site->people));
    json_object_set_new(object, "refused", sim_json_rate(site->refused));
    json_object_set_new(object, "rank_1", sim_json_rate(site->rank_1));
    json_object_set_new(object, "eer", sim_json_number(site->eer));
    json_object_set_new(object, "eer_with_refused", sim_json_number(site->eer_with_refused));
    json_object_set_new(object, "offset", sim_json_number(site->offset));
    json_object_set_new(object, "offset_expected", sim_json_number(site->expected));
    json_object_set_new(object, "growth", sim_json_number(site->growth));
    json_object_set_new(object, "share", sim_json_number(site->share));
    json_object_set_new(object, "fmr", fmr);
    json_object_set_new(object, "fnmr", fnmr);
    json_object_set_new(object, "promise", sim_json_calibration(&site->calibration));
}

json_t *sim_json_site(const struct sim_eval *eval)
{
    static const char *const modes[] = {[SIM_SITE_NONE] = "none",
                                        [SIM_SITE_GALLERY] = "gallery",
                                        [SIM_SITE_SENSOR] = "sensor",
                                        [SIM_SITE_SPLIT] = "split"};
    json_t *object = json_pack("{s:s}", "mode", modes[eval->options.site]);
    if (object &&
        (eval->options.site == SIM_SITE_GALLERY || eval->options.site == SIM_SITE_SENSOR)) {
        json_object_set_new(object, "people", json_integer(eval->adapted.people));
    }
    if (object && eval->options.site == SIM_SITE_SPLIT) {
        add_split(&eval->site, object);
    }
    return object;
}

/* ---- the picture ---- */

/* The lowest rate of both axes; lower rates are drawn there. */
static const double lowest = 1e-5;

/* Points of the picture. */
struct outline {
    double promised[SIM_PROMISE_POINTS], fmr[SIM_PROMISE_POINTS];
    double low[SIM_PROMISE_POINTS], high[SIM_PROMISE_POINTS];
    double level_x[LEVELS], level_y[LEVELS];
};

static void fill_outline(const struct sim_calibration *calibration, struct outline *o)
{
    for (int i = 0; i < SIM_PROMISE_POINTS; i++) {
        const struct sim_promise_point *p = &calibration->promise[i];
        o->promised[i] = p->promised;
        o->fmr[i] = fmax(p->fmr, lowest);
        o->low[i] = fmax(p->interval.low, lowest);
        o->high[i] = fmax(p->interval.high, lowest);
    }
    for (int i = 0; i < LEVELS; i++) {
        const struct sim_promise_point *p = point_of(calibration, LEVEL_FIRST + i);
        o->level_x[i] = p->promised;
        o->level_y[i] = fmax(p->fmr, lowest);
    }
}

static int draw_promise(const struct sim_calibration *calibration, const char *path,
                        struct iso_fault *fault)
{
    struct outline o;
    const double ends[] = {lowest, 1.0};
    char subtitle[160];
    fill_outline(calibration, &o);
    (void)snprintf(subtitle, sizeof subtitle,
                   "dashed: 95 %% interval over people, and the promise kept; Cllr %.3f bits, at "
                   "least %.3f",
                   calibration->cllr, calibration->cllr_min);
    const struct sim_series series[] = {
        {"measured", SIM_SERIES_LINE, SIM_PROMISE_POINTS, o.promised, o.fmr},
        {"at scores 1, 2, 3, 4", SIM_SERIES_MARKED, LEVELS, o.level_x, o.level_y},
        {NULL, SIM_SERIES_DASHED, SIM_PROMISE_POINTS, o.promised, o.low},
        {NULL, SIM_SERIES_DASHED, SIM_PROMISE_POINTS, o.promised, o.high},
        {NULL, SIM_SERIES_DASHED, 2, ends, ends},
    };
    const struct sim_plot plot = {
        .title = "False match rate: promised and measured",
        .subtitle = subtitle,
        .legend = SIM_LEGEND_LOWER,
        .x = {"promised by the score", SIM_SCALE_LOG, lowest, 1.0},
        .y = {"measured", SIM_SCALE_LOG, lowest, 1.0},
        .n_series = sizeof series / sizeof *series,
        .series = series,
    };
    return sim_plot_write(&plot, path, fault);
}

int sim_report_promise(const struct sim_calibration *calibration, const char *directory,
                       const char *name, struct iso_fault *fault)
{
    char path[PATH_MAX];
    if (!calibration->known) {
        return 0;
    }
    const int error = iso_path_join(directory, name, path, fault);
    return error ? error : draw_promise(calibration, path, fault);
}

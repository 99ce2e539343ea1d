#include "sim/lab/landmarks/analysis.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct work {
    const struct sim_corpus *corpus;
    const struct sim_measured_frame *frames;
    size_t n_frames;
    const struct iso_vec3 *offset_mm; /* [ISO_LANDMARKS] */
    struct sim_landmark_analysis *analysis;
    /* Scratch: [n_frames], [n_frames * ISO_LANDMARKS], [n_frames]. */
    struct sim_deviation *deviations;
    double *lengths;
    int64_t *times_ns;
};

/* Bands of the angle between face and camera, in degrees: up to and including the limit. */
static const struct {
    const char *name;
    double above_degrees, limit_degrees;
} bands[] = {
    {"<= 25", -1.0, 25.0},
    {"25..35", 25.0, 35.0},
    {"> 35", 35.0, 180.0},
};

const char *sim_failure_rule_name(enum sim_failure_rule rule)
{
    static const char *const names[SIM_FAILURE_RULES] = {"mean", "mean, less offset",
                                                         "worst, less offset"};
    return (unsigned)rule < SIM_FAILURE_RULES ? names[rule] : NULL;
}

bool sim_frame_fails(const struct sim_measured_frame *frame, enum sim_failure_rule rule)
{
    switch (rule) {
    case SIM_FAILURE_MEAN:
        return frame->error_mean_mm > SIM_FAILURE_MM;
    case SIM_FAILURE_CENTRED_MEAN:
        return frame->centred_mean_mm > SIM_FAILURE_MM;
    default:
        return frame->centred_max_mm > SIM_FAILURE_MM;
    }
}

static bool is_accepted(const struct sim_measured_frame *frame)
{
    return frame->reason == ISO_CAPTURE_OK;
}

static const struct sim_corpus_row *row_of(const struct work *w, const struct sim_measured_frame *f)
{
    return &w->corpus->rows[f->row];
}

static bool is_bona_fide(const struct work *w, const struct sim_measured_frame *f)
{
    return sim_row_kind_of(row_of(w, f)) == SIM_ROW_BONA_FIDE;
}

/* ---- conditions ------------------------------------------------------------------- */

/* Whether a genuine frame belongs to a condition. */
static bool is_of(const struct work *w, const struct sim_measured_frame *f,
                  const struct sim_condition_figures *condition)
{
    if (!condition->column) {
        return true;
    }
    if (strcmp(condition->column, "expression") == 0) {
        return strcmp(row_of(w, f)->expression, condition->value) == 0;
    }
    const double degrees = f->true_angle_rad * 180.0 / M_PI;
    for (size_t b = 0; b < sizeof bands / sizeof *bands; b++) {
        if (strcmp(bands[b].name, condition->value) == 0) {
            return degrees > bands[b].above_degrees && degrees <= bands[b].limit_degrees;
        }
    }
    return false;
}

static void count_event(struct sim_rate *rate, bool event)
{
    rate->trials++;
    rate->events += event;
}

static void count_failures(const struct sim_measured_frame *f, struct sim_condition_figures *c)
{
    for (int r = 0; r < SIM_FAILURE_RULES; r++) {
        struct sim_failures *failures = &c->failures[r];
        const bool fails = sim_frame_fails(f, (enum sim_failure_rule)r);
        count_event(&failures->before, fails);
        if (is_accepted(f)) {
            count_event(&failures->after, fails);
        }
        if (!fails) {
            count_event(&failures->good_refused, !is_accepted(f));
        }
    }
}

static struct sim_spread spread_of_errors(const struct work *w,
                                          const struct sim_condition_figures *condition,
                                          bool centred)
{
    size_t n = 0;
    for (size_t i = 0; i < w->n_frames; i++) {
        const struct sim_measured_frame *f = &w->frames[i];
        if (!is_bona_fide(w, f) || !is_accepted(f) || !is_of(w, f, condition)) {
            continue;
        }
        for (int l = 0; l < ISO_LANDMARKS; l++) {
            if (f->deviation.known[l]) {
                struct iso_vec3 e = f->deviation.error_mm[l];
                w->lengths[n++] = iso_norm(centred ? iso_sub(e, w->offset_mm[l]) : e);
            }
        }
    }
    return sim_spread_of(w->lengths, n);
}

/* Fills in all fields except the definition of the condition. */
static void measure_condition(const struct work *w, struct sim_condition_figures *c)
{
    for (size_t i = 0; i < w->n_frames; i++) {
        const struct sim_measured_frame *f = &w->frames[i];
        if (is_bona_fide(w, f) && is_of(w, f, c)) {
            count_event(&c->refused, !is_accepted(f));
            if (f->n_known > 0) {
                count_failures(f, c);
            }
        }
    }
    c->error_mm = spread_of_errors(w, c, false);
    c->centred_error_mm = spread_of_errors(w, c, true);
}

static bool is_listed(const struct sim_landmark_analysis *a, const char *expression)
{
    for (size_t i = 0; i < a->n_conditions; i++) {
        if (strcmp(a->conditions[i].column, "expression") == 0 &&
            strcmp(a->conditions[i].value, expression) == 0) {
            return true;
        }
    }
    return false;
}

static void list_expressions(const struct work *w)
{
    struct sim_landmark_analysis *a = w->analysis;
    for (size_t r = 0; r < w->corpus->n_rows; r++) {
        const struct sim_corpus_row *row = &w->corpus->rows[r];
        if (sim_row_kind_of(row) == SIM_ROW_BONA_FIDE && *row->expression &&
            !is_listed(a, row->expression)) {
            a->conditions[a->n_conditions++] = (struct sim_condition_figures){
                .column = "expression", .value = row->expression};
        }
    }
}

/* Lists and measures the conditions, and removes those without a frame. Measures all frames
 * together as well. */
static void measure_conditions(const struct work *w)
{
    struct sim_landmark_analysis *a = w->analysis;
    for (size_t b = 0; b < sizeof bands / sizeof *bands; b++) {
        a->conditions[a->n_conditions++] = (struct sim_condition_figures){.column = "angle",
                                                                          .value = bands[b].name};
    }
    list_expressions(w);
    size_t kept = 0;
    for (size_t i = 0; i < a->n_conditions; i++) {
        measure_condition(w, &a->conditions[i]);
        if (a->conditions[i].refused.trials > 0) {
            a->conditions[kept++] = a->conditions[i];
        }
    }
    a->n_conditions = kept;
    measure_condition(w, &a->all);
}

/* ---- landmarks -------------------------------------------------------------------- */

static int measure_landmarks(const struct work *w, bool accepted_only,
                             struct sim_landmark_error out[ISO_LANDMARKS + 1])
{
    size_t n = 0;
    for (size_t i = 0; i < w->n_frames; i++) {
        const struct sim_measured_frame *f = &w->frames[i];
        if (is_bona_fide(w, f) && f->n_known > 0 && (is_accepted(f) || !accepted_only)) {
            w->deviations[n++] = f->deviation;
        }
    }
    return sim_landmark_errors(w->corpus, w->deviations, n, w->offset_mm, out);
}

/* ---- rows ------------------------------------------------------------------------- */

static struct sim_kind_figures *kind_figures(struct sim_landmark_analysis *a,
                                             const struct sim_corpus_row *row)
{
    for (size_t i = 0; i < a->n_kinds; i++) {
        if (strcmp(a->kinds[i].note, row->note) == 0) {
            return &a->kinds[i];
        }
    }
    struct sim_kind_figures *fresh = &a->kinds[a->n_kinds++];
    *fresh = (struct sim_kind_figures){.note = row->note, .kind = sim_row_kind_of(row)};
    return fresh;
}

static void count_rows(const struct work *w)
{
    struct sim_landmark_analysis *a = w->analysis;
    const struct sim_measured_frame *frames = w->frames;
    for (size_t r = 0; r < w->corpus->n_rows; r++) {
        const struct sim_corpus_row *row = &w->corpus->rows[r];
        const bool person = sim_row_kind_of(row) == SIM_ROW_BONA_FIDE;
        struct sim_kind_figures *kind = person ? NULL : kind_figures(a, row);
        struct sim_rate *response = person ? a->bona_fide : kind->response;
        const enum sim_response answer = sim_response_to(frames, row->count);
        for (int k = 0; k < SIM_RESPONSES; k++) {
            count_event(&response[k], k == (int)answer);
        }
        for (size_t i = 0; i < row->count; i++) {
            (person ? a->reason : kind->reason)[frames[i].reason]++;
            a->n_bona_fide += person;
            a->n_true += person && frames[i].n_known > 0;
            if (!person) {
                count_event(&kind->accepted_frames, is_accepted(&frames[i]));
            }
        }
        frames += row->count;
    }
}

/* ---- times ------------------------------------------------------------------------ */

static struct sim_latency latency_of(const struct work *w, int stage)
{
    size_t n = 0;
    for (size_t i = 0; i < w->n_frames; i++) {
        const int64_t time_ns = stage < ISO_STAGES ? w->frames[i].stage_ns[stage]
                                                   : w->frames[i].cpu_ns;
        if (time_ns > 0) {
            w->times_ns[n++] = time_ns;
        }
    }
    return sim_latency_of(w->times_ns, n);
}

int sim_landmark_analyse(const struct sim_corpus *corpus, const struct sim_measurement *measurement,
                         struct sim_landmark_analysis **out)
{
    const size_t n = measurement->n_frames;
    struct sim_landmark_analysis *a = calloc(1, sizeof *a);
    struct work w = {corpus, measurement->frames, n, measurement->offset_mm, a, NULL, NULL, NULL};
    int error = -ENOMEM;
    w.deviations = calloc(n, sizeof *w.deviations);
    w.lengths = calloc(n * ISO_LANDMARKS, sizeof *w.lengths);
    w.times_ns = calloc(n, sizeof *w.times_ns);
    if (a && w.deviations && w.lengths && w.times_ns) {
        a->conditions = calloc(corpus->n_rows + sizeof bands / sizeof *bands,
                               sizeof *a->conditions);
        a->kinds = calloc(corpus->n_rows, sizeof *a->kinds);
        error = a->conditions && a->kinds ? 0 : -ENOMEM;
    }
    if (!error) {
        error = measure_landmarks(&w, true, a->after);
    }
    if (!error) {
        error = measure_landmarks(&w, false, a->before);
    }
    if (!error) {
        measure_conditions(&w);
        count_rows(&w);
        for (int s = 0; s < ISO_STAGES; s++) {
            a->stage[s] = latency_of(&w, s);
        }
        a->whole = latency_of(&w, ISO_STAGES);
        *out = a;
    }
    free(w.deviations);
    free(w.lengths);
    free(w.times_ns);
    if (error) {
        sim_landmark_analysis_free(a);
    }
    return error;
}

void sim_landmark_analysis_free(struct sim_landmark_analysis *analysis)
{
    if (analysis) {
        free(analysis->conditions);
        free(analysis->kinds);
        free(analysis);
    }
}

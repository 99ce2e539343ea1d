#include "sim/train/train_metric.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim/eval/capture.h"
#include "sim/train/metric_learn.h"

enum { HELD_OUT = 5 /* one person in so many calibrates */, REGISTRATIONS = 3 };

/* The templates of all corpora, and whose they are. */
struct training {
    const struct sim_train_metric_options *options;
    size_t n, capacity; /* frames */
    struct iso_template *tmpl;
    size_t *person; /* of each, from 0 over all corpora */
    bool *usable;
    size_t n_people;
    size_t first; /* frame of the corpus that is read */
    uint32_t algorithm;
};

static void take(void *context, size_t number, const struct sim_capture *capture)
{
    struct training *t = context;
    const size_t at = t->first + number;
    t->usable[at] = capture->extraction.outcome == ISO_CAPTURE_OK;
    t->tmpl[at] = capture->extraction.tmpl;
}

static int grow(struct training *t, size_t frames)
{
    const size_t n = t->n + frames;
    struct iso_template *tmpl = realloc(t->tmpl, n * sizeof *tmpl);
    t->tmpl = tmpl ? tmpl : t->tmpl;
    size_t *person = realloc(t->person, n * sizeof *person);
    t->person = person ? person : t->person;
    bool *usable = realloc(t->usable, n * sizeof *usable);
    t->usable = usable ? usable : t->usable;
    t->capacity = n;
    return tmpl && person && usable ? 0 : -ENOMEM;
}

/* Numbers the subjects of a corpus, whose rows need not be in order. */
static void number_people(struct training *t, const struct sim_corpus *corpus)
{
    const size_t first_person = t->n_people;
    size_t frame = t->n;
    for (size_t row = 0; row < corpus->n_rows; row++) {
        size_t person = t->n_people;
        size_t known = t->n;
        for (size_t before = 0; before < row; before++) {
            if (strcmp(corpus->rows[before].subject, corpus->rows[row].subject) == 0) {
                person = t->person[known];
                break;
            }
            known += corpus->rows[before].count;
        }
        t->n_people += person == t->n_people && person >= first_person;
        for (size_t i = 0; i < corpus->rows[row].count; i++) {
            t->person[frame++] = person;
        }
    }
}

/* Everybody in a corpus comes from one population and seed; nobody may be learned from twice. */
static int check_origin(const struct sim_corpus *corpus, const char *directory,
                        struct iso_metric *shape, struct iso_fault *fault)
{
    const char *origin = corpus->rows[0].note;
    for (size_t row = 0; row < corpus->n_rows; row++) {
        if (*origin == '\0' || strcmp(corpus->rows[row].note, origin) != 0) {
            return iso_fault_set(fault, -EINVAL, "%s: row %zu: no origin, or another, in its note",
                                 directory, row + 1);
        }
    }
    for (int i = 0; i < shape->n_origins; i++) {
        if (strcmp(shape->origin[i], origin) == 0) {
            return iso_fault_set(fault, -EINVAL, "%s: the people of %s are there already",
                                 directory, origin);
        }
    }
    (void)snprintf(shape->origin[shape->n_origins++], ISO_METRIC_ORIGIN_MAX, "%.63s", origin);
    return 0;
}

static int read_corpus(struct training *t, const char *directory, struct iso_metric *shape,
                       struct iso_fault *fault)
{
    const struct sim_capture_options options = {
        .model = t->options->model,
        .extract = t->options->extract,
        .threads = t->options->threads,
    };
    struct sim_capture_origin origin;
    struct sim_corpus *corpus = NULL;
    int error = sim_corpus_read(directory, &corpus, fault);
    if (error) {
        return error;
    }
    error = check_origin(corpus, directory, shape, fault);
    const size_t frames = sim_corpus_frames(corpus);
    if (!error && grow(t, frames)) {
        error = iso_fault_set(fault, -ENOMEM, "%s: out of memory", directory);
    }
    if (!error) {
        number_people(t, corpus);
        t->first = t->n;
        error = sim_capture_all(directory, corpus, &options, take, t, &origin, fault);
    }
    if (!error) {
        t->n += frames;
        shape->algorithm = origin.algorithm;
    }
    sim_corpus_free(corpus);
    return error;
}

/* Leaves the usable frames only. */
static void compact(struct training *t)
{
    size_t n = 0;
    for (size_t i = 0; i < t->n; i++) {
        if (t->usable[i]) {
            t->tmpl[n] = t->tmpl[i];
            t->person[n++] = t->person[i];
        }
    }
    t->n = n;
}

/* Adds a template's points to the sums of the curves, and of their number behind those: where they
 * are, or if there are residuals where they are once registered. */
static void add_curves(const struct iso_metric *metric, const struct iso_template *tmpl,
                       const float *residual_mm, double *sum)
{
    const size_t width = (size_t)metric->n_values;
    size_t v = 0;
    for (int r = 0; r < metric->n_radii; r++) {
        for (int l = 0; l < ISO_LANDMARKS; l++) {
            for (int i = 0; (metric->landmarks >> l & 1) && i < metric->n_points; i++) {
                const bool seen = tmpl->weight[r][l][i] >= metric->weight_min;
                const float *p = tmpl->points_mm[r][l][i];
                for (int k = 0; k < 3 && seen; k++) {
                    const float mm = residual_mm ? metric->curve_mm[v + (size_t)k] +
                                                       residual_mm[v + (size_t)k]
                                                 : p[k];
                    sum[v + (size_t)k] += (double)mm;
                    sum[width + v + (size_t)k] += 1.0;
                }
                v += 3;
            }
        }
    }
}

/* The mean curves: those of the face frame first, then of what is registered to them. */
static int learn_curves(const struct training *t, struct iso_metric *metric)
{
    const size_t width = (size_t)metric->n_values;
    float *residual_mm = calloc(width, sizeof *residual_mm);
    double *sum = calloc(2 * width, sizeof *sum);
    int error = residual_mm && sum ? 0 : -ENOMEM;
    for (int pass = 0; pass <= REGISTRATIONS && !error; pass++) {
        memset(sum, 0, 2 * width * sizeof *sum);
        for (size_t s = 0; s < t->n; s++) {
            if (pass > 0 && iso_metric_residuals(metric, &t->tmpl[s], residual_mm)) {
                continue;
            }
            add_curves(metric, &t->tmpl[s], pass > 0 ? residual_mm : NULL, sum);
        }
        for (size_t v = 0; v < width; v++) {
            metric->curve_mm[v] = (float)(sum[v] / fmax(sum[width + v], 1.0));
        }
    }
    free(residual_mm);
    free(sum);
    return error;
}

/* Residuals of the people that are learned from, renumbered without those held out. */
static int learn_axes(const struct training *t, struct iso_metric *metric,
                      struct sim_train_metric_report *report)
{
    const size_t width = (size_t)metric->n_values;
    float *residual_mm = calloc(t->n * width + 1, sizeof *residual_mm);
    size_t *person = calloc(t->n + 1, sizeof *person);
    size_t *number = calloc(t->n_people + 1, sizeof *number); /* 0: nothing of them yet */
    int error = residual_mm && person && number ? 0 : -ENOMEM;
    struct sim_metric_samples samples = {0};
    for (size_t s = 0; !error && s < t->n; s++) {
        const size_t who = t->person[s];
        if (who % HELD_OUT == 0 ||
            iso_metric_residuals(metric, &t->tmpl[s], &residual_mm[samples.n * width])) {
            continue;
        }
        if (number[who] == 0) {
            number[who] = ++samples.n_people;
        }
        person[samples.n++] = number[who] - 1;
    }
    if (!error) {
        samples.residual_mm = residual_mm;
        samples.person = person;
        error = sim_metric_learn(&samples, metric, &report->explained);
        report->n_people = samples.n_people;
        report->n_templates = samples.n;
    }
    free(residual_mm);
    free(person);
    free(number);
    return error;
}

/* Scores of the people held out: everybody's first template against the later ones of all. */
struct held_out {
    size_t n_mated, n_other;
    double *mated, *other;
};

static int compare_held_out(const struct training *t, const struct iso_metric *metric,
                            struct held_out *out)
{
    size_t n = 0;
    struct iso_metric_vector *vector = calloc(t->n + 1, sizeof *vector);
    size_t *person = calloc(t->n + 1, sizeof *person);
    int error = vector && person ? 0 : -ENOMEM;
    for (size_t s = 0; !error && s < t->n; s++) {
        if (t->person[s] % HELD_OUT == 0 &&
            iso_metric_project(metric, &t->tmpl[s], &vector[n]) == 0) {
            person[n++] = t->person[s];
        }
    }
    out->mated = calloc(n + 1, sizeof *out->mated);
    out->other = calloc(n * (n / 2) + 1, sizeof *out->other);
    error = out->mated && out->other ? error : -ENOMEM;
    for (size_t g = 0; !error && g < n; g++) {
        if (g > 0 && person[g - 1] == person[g]) {
            continue; /* not the first of its person */
        }
        for (size_t p = 1; p < n; p++) {
            if (person[p - 1] != person[p]) {
                continue; /* the first of its own */
            }
            const double score = iso_metric_score(metric, &vector[g], &vector[p]);
            if (person[g] == person[p]) {
                out->mated[out->n_mated++] = score;
            } else if (out->n_other < n * (n / 2)) {
                out->other[out->n_other++] = score;
            }
        }
    }
    free(vector);
    free(person);
    return error;
}

static double share_at_least(const double *score, size_t n, double threshold)
{
    size_t above = 0;
    for (size_t i = 0; i < n; i++) {
        above += score[i] >= threshold;
    }
    return (double)above / fmax((double)n, 1.0);
}

static void describe(const struct held_out *held, const struct iso_metric *metric,
                     struct sim_train_metric_report *report)
{
    report->n_mated = held->n_mated;
    report->n_others = held->n_other;
    const double gain = (double)metric->gain, bias = (double)metric->bias;
    for (int i = 0; i < 3; i++) {
        const double raw = (2.0 + i - bias) / gain;
        report->fmr_at[i] = share_at_least(held->other, held->n_other, raw);
        report->false_non_match_at[i] = 1.0 - share_at_least(held->mated, held->n_mated, raw);
    }
}

static int calibrate(const struct training *t, struct iso_metric *metric,
                     struct sim_train_metric_report *report)
{
    struct held_out held = {0};
    float gain = 0.0f, bias = 0.0f;
    metric->gain = 1.0f;
    metric->bias = 0.0f;
    int error = compare_held_out(t, metric, &held);
    if (!error) {
        error = sim_metric_calibrate(held.other, held.n_other, &gain, &bias);
    }
    if (!error) {
        metric->gain = gain;
        metric->bias = bias;
        describe(&held, metric, report);
    }
    free(held.mated);
    free(held.other);
    return error;
}

struct sim_train_metric_options sim_train_metric_options_default(void)
{
    return (struct sim_train_metric_options){
        .extract = iso_extract_options_default(),
        .landmarks = 1U << ISO_LM_NASION | 1U << ISO_LM_NOSE_TIP | 1U << ISO_LM_ALA_R |
                     1U << ISO_LM_ALA_L | 1U << ISO_LM_EYE_IN_R | 1U << ISO_LM_EYE_IN_L |
                     1U << ISO_LM_EYE_OUT_R | 1U << ISO_LM_EYE_OUT_L,
        .n_dimensions = 150,
        .threads = 1,
    };
}

static int learn(struct training *t, const struct iso_metric *shape, struct iso_metric **out,
                 struct sim_train_metric_report *report, struct iso_fault *fault)
{
    struct iso_metric *metric = NULL;
    report->n_frames = t->n;
    compact(t);
    int error = iso_metric_new(shape, &metric);
    error = error ? error : learn_curves(t, metric);
    error = error ? error : learn_axes(t, metric, report);
    error = error ? error : calibrate(t, metric, report);
    if (error) {
        iso_metric_free(metric);
        return iso_fault_set(fault, error, "learning the metric: %s",
                             error == -ENODATA ? "too few people" : strerror(-error));
    }
    *out = metric;
    return 0;
}

int sim_train_metric(const struct sim_train_metric_options *options, struct iso_metric **out,
                     struct sim_train_metric_report *report, struct iso_fault *fault)
{
    struct training t = {.options = options};
    struct sim_train_metric_report found = {0};
    struct iso_metric shape = {
        .landmarks = options->landmarks,
        .n_radii = options->extract.n_radii,
        .n_points = options->extract.n_points,
        .n_dimensions = options->n_dimensions,
        .weight_min = 0.3f,
        .gain = 1.0f,
    };
    int error = options->n_corpora >= 1 && options->n_corpora <= SIM_METRIC_CORPORA_MAX
                    ? 0
                    : iso_fault_set(fault, -EINVAL, "1..%d corpora are needed",
                                    SIM_METRIC_CORPORA_MAX);
    for (int i = 0; i < options->n_corpora && !error; i++) {
        error = read_corpus(&t, options->corpora[i], &shape, fault);
    }
    if (!error) {
        error = learn(&t, &shape, out, &found, fault);
    }
    if (!error) {
        *report = found;
    }
    free(t.tmpl);
    free(t.person);
    free(t.usable);
    return error;
}

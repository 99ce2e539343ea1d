#include "sim/train/metric/train_metric.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/match/rerank.h"
#include "sim/base/progress.h"
#include "sim/lab/match/capture.h"
#include "sim/lab/match/parallel.h"
#include "sim/train/metric/metric_learn.h"
#include "sim/train/metric/rerank_learn.h"

enum {
    HELD_OUT = 5, /* one person in so many calibrates */
    REGISTRATIONS = 3,
    OTHERS_FITTED = 60000, /* comparisons of strangers whose upper faces are fitted, at most */
};

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
        if (!sim_corpus_row_is_of(&corpus->rows[row], origin)) {
            return iso_fault_set(fault, -EINVAL, "%s: row %zu: no origin, or another, in its note",
                                 directory, row + 1);
        }
    }
    for (int i = 0; i < shape->n_origins; i++) {
        if (sim_corpus_row_is_of(&corpus->rows[0], shape->origin[i])) {
            return iso_fault_set(fault, -EINVAL, "%s: the people of %s are there already",
                                 directory, shape->origin[i]);
        }
    }
    (void)snprintf(shape->origin[shape->n_origins++], ISO_METRIC_ORIGIN_MAX, "%.*s",
                   (int)sim_corpus_origin_length(origin), origin);
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
    const size_t width = (size_t)metric->n_curve_values;
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
    const size_t width = (size_t)metric->n_curve_values;
    float *residual_mm = calloc((size_t)metric->n_values, sizeof *residual_mm);
    double *sum = calloc(2 * width, sizeof *sum);
    int error = residual_mm && sum ? 0 : -ENOMEM;
    const bool shown = sim_progress_begin("averaging the curves", (REGISTRATIONS + 1) * t->n);
    for (int pass = 0; pass <= REGISTRATIONS && !error; pass++) {
        memset(sum, 0, 2 * width * sizeof *sum);
        for (size_t s = 0; s < t->n; s++) {
            sim_progress_step(1);
            if (pass > 0 && iso_metric_residuals(metric, &t->tmpl[s], residual_mm)) {
                continue;
            }
            add_curves(metric, &t->tmpl[s], pass > 0 ? residual_mm : NULL, sum);
        }
        for (size_t v = 0; v < width; v++) {
            metric->curve_mm[v] = (float)(sum[v] / fmax(sum[width + v], 1.0));
        }
    }
    sim_progress_end(shown);
    free(residual_mm);
    free(sum);
    return error;
}

/* Every second node of the upper face, as the fields of a chessboard (between them the smoothed
 * surface has little to add), that nearly all templates have. */
static void choose_nodes(const struct training *t, struct iso_metric *shape)
{
    enum { MISSING_PERMILLE = 5 };
    for (int i = 0; i < ISO_UPPER_NODES; i++) {
        const int row = iso_upper_row(i), column = iso_upper_column(i);
        size_t missing = 0;
        for (size_t s = 0; s < t->n; s++) {
            missing += t->tmpl[s].upper.kind[row][column] == ISO_UPPER_NONE;
        }
        if ((row + column) % 2 == 0 && 1000 * missing <= MISSING_PERMILLE * t->n) {
            shape->node[shape->n_nodes++] = (uint16_t)i;
        }
    }
}

/* The mean heights of the upper face, of those who have them. */
static void learn_heights(const struct training *t, struct iso_metric *metric)
{
    for (int i = 0; i < metric->n_nodes; i++) {
        const int row = iso_upper_row(metric->node[i]);
        const int column = iso_upper_column(metric->node[i]);
        double sum_mm = 0.0;
        size_t n = 0;
        for (size_t s = 0; s < t->n; s++) {
            sum_mm += (double)t->tmpl[s].upper.z_mm[row][column]; /* 0 where there is none */
            n += t->tmpl[s].upper.kind[row][column] != ISO_UPPER_NONE;
        }
        metric->upper_mm[i] = (float)(sum_mm / fmax((double)n, 1.0));
    }
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
    const bool shown = sim_progress_begin("registering the templates", t->n);
    for (size_t s = 0; !error && s < t->n; s++) {
        const size_t who = t->person[s];
        sim_progress_step(1);
        if (who % HELD_OUT == 0 ||
            iso_metric_residuals(metric, &t->tmpl[s], &residual_mm[samples.n * width])) {
            continue;
        }
        if (number[who] == 0) {
            number[who] = ++samples.n_people;
        }
        person[samples.n++] = number[who] - 1;
    }
    sim_progress_end(shown);
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

/* A comparison of two templates of people held out. */
struct pair {
    const struct iso_template *enrolled, *probe;
    double score; /* the metric's */
    double fit;   /* -ln(rms / 1 mm) of the upper faces' misfit; NaN: not known */
};

struct pairs {
    size_t n, capacity;
    struct pair *list;
};

/* Comparisons of the people held out: everybody's first template against the later ones of all. */
struct held_out {
    struct pairs mated, other;
};

static void free_held_out(struct held_out *held)
{
    free(held->mated.list);
    free(held->other.list);
}

static int new_pairs(struct pairs *pairs, size_t capacity)
{
    pairs->capacity = capacity;
    pairs->list = calloc(capacity + 1, sizeof *pairs->list);
    return pairs->list ? 0 : -ENOMEM;
}

static void add_pair(struct pairs *pairs, struct pair pair)
{
    if (pairs->n < pairs->capacity) {
        pairs->list[pairs->n++] = pair;
    }
}

/* A template of somebody held out, as the metric sees it. */
struct seen {
    struct iso_metric_vector vector;
    const struct iso_template *tmpl;
    size_t person;
};

static void compare_seen(const struct iso_metric *metric, const struct seen *seen, size_t n,
                         struct held_out *out)
{
    for (size_t g = 0; g < n; g++) {
        if (g > 0 && seen[g - 1].person == seen[g].person) {
            continue; /* not the first of its person */
        }
        for (size_t p = 1; p < n; p++) {
            if (seen[p - 1].person != seen[p].person) {
                continue; /* the first of its own */
            }
            const bool mated = seen[g].person == seen[p].person;
            add_pair(mated ? &out->mated : &out->other,
                     (struct pair){
                         .enrolled = seen[g].tmpl,
                         .probe = seen[p].tmpl,
                         .score = iso_metric_score(metric, &seen[g].vector, &seen[p].vector),
                         .fit = NAN,
                     });
        }
    }
}

static int compare_held_out(const struct training *t, const struct iso_metric *metric,
                            struct held_out *out)
{
    size_t n = 0;
    struct seen *seen = calloc(t->n + 1, sizeof *seen);
    if (!seen) {
        return -ENOMEM;
    }
    for (size_t s = 0; s < t->n; s++) {
        if (t->person[s] % HELD_OUT == 0 &&
            iso_metric_project(metric, &t->tmpl[s], &seen[n].vector) == 0) {
            seen[n].tmpl = &t->tmpl[s];
            seen[n++].person = t->person[s];
        }
    }
    int error = new_pairs(&out->mated, n);
    error = error ? error : new_pairs(&out->other, n * (n / 2));
    if (!error) {
        compare_seen(metric, seen, n, out);
    }
    explicit_bzero(seen, (t->n + 1) * sizeof *seen);
    free(seen);
    return error;
}

static int calibrate(struct held_out *held, struct iso_metric *metric)
{
    const struct pairs *other = &held->other;
    double *ratio = calloc(other->n + 1, sizeof *ratio);
    float gain = 0.0f, bias = 0.0f;
    int error = ratio ? 0 : -ENOMEM;
    for (size_t i = 0; !error && i < other->n; i++) {
        ratio[i] = other->list[i].score;
    }
    error = error ? error : sim_metric_calibrate(ratio, other->n, &gain, &bias);
    free(ratio);
    if (error) {
        return error;
    }
    metric->gain = gain;
    metric->bias = bias;
    struct pairs *const both[] = {&held->mated, &held->other};
    for (int k = 0; k < 2; k++) {
        for (size_t i = 0; i < both[k]->n; i++) {
            both[k]->list[i].score = (double)gain * both[k]->list[i].score + (double)bias;
        }
    }
    return 0;
}

/* Pairs whose upper faces are fitted, and the working memory of each thread. */
struct fitting {
    struct pair *list;
    struct iso_rerank_workspace *work;
};

static int fit_upper_faces(void *context, int worker, size_t number)
{
    const struct fitting *fitting = context;
    struct pair *pair = &fitting->list[number];
    const struct iso_upper_face *enrolled = &pair->enrolled->upper;
    double rms_mm;
    if (iso_rerank_misfit(&fitting->work[worker], &pair->probe->upper, &enrolled, 1, &rms_mm) ==
        0) {
        pair->fit = -log(rms_mm);
    }
    return 0;
}

/* Of people who are the same, and of those who are not. */
static int fit_pairs(int threads, const struct pairs *mated, const struct pairs *other)
{
    struct iso_rerank_workspace *work = calloc((size_t)threads, sizeof *work);
    if (!work) {
        return -ENOMEM;
    }
    struct fitting own = {mated->list, work}, others = {other->list, work};
    int error = sim_parallel(threads, "fitting faces of one person", mated->n, fit_upper_faces,
                             &own);
    if (!error) {
        error = sim_parallel(threads, "fitting faces of two people", other->n, fit_upper_faces,
                             &others);
    }
    free(work);
    return error;
}

/* Leaves one comparison in so many: a misfit takes a thousand times longer than a score. */
static void thin(struct pairs *pairs, size_t one_in)
{
    size_t n = 0;
    for (size_t i = 0; i < pairs->n; i += one_in) {
        pairs->list[n++] = pairs->list[i];
    }
    pairs->n = n;
}

static int learn_rerank(const struct training *t, struct held_out *held, struct iso_metric *metric)
{
    struct pairs *other = &held->other;
    thin(other, other->n / OTHERS_FITTED + 1);
    int error = fit_pairs(t->options->threads, &held->mated, other);
    double *score = calloc(other->n + 1, sizeof *score), *fit = calloc(other->n + 1, sizeof *fit);
    error = score && fit ? error : -ENOMEM;
    for (size_t i = 0; !error && i < other->n; i++) {
        score[i] = other->list[i].score;
        fit[i] = other->list[i].fit;
    }
    const struct sim_rerank_pairs strangers = {other->n, score, fit};
    error = error ? error : sim_rerank_learn(&strangers, &metric->rerank);
    free(score);
    free(fit);
    return error;
}

/* People held out are drawn at large, and so alike by chance only; relatives come to one door. All
 * scores are lowered by this, so that they promise even of the one stranger in ten who is most
 * alike what they would promise of all: log10 of one in ten. */
static const float caution = 1.0f;

static void be_cautious(struct iso_metric *metric)
{
    metric->bias -= caution;
    metric->rerank.bias += caution * (metric->rerank.metric - 1.0f); /* its metric's score, too */
}

/* The share of comparisons that score so high, fused or not. */
static double share_at_least(const struct pairs *pairs, const struct iso_rerank_weights *weights,
                             double threshold)
{
    size_t above = 0;
    for (size_t i = 0; i < pairs->n; i++) {
        const struct pair *p = &pairs->list[i];
        const bool fused = weights && !isnan(p->fit);
        above += (fused ? iso_rerank_fuse(weights, p->score, exp(-p->fit)) : p->score) >= threshold;
    }
    return (double)above / fmax((double)pairs->n, 1.0);
}

static void describe(const struct held_out *held, const struct iso_rerank_weights *weights,
                     struct sim_train_scores *out)
{
    out->n_mated = held->mated.n;
    out->n_others = held->other.n;
    for (int i = 0; i < 3; i++) {
        const double score = 2.0 + i + (double)caution; /* what will be 2 + i */
        out->fmr_at[i] = share_at_least(&held->other, weights, score);
        out->false_non_match_at[i] = 1.0 - share_at_least(&held->mated, weights, score);
    }
}

/* What scores mean: from the people held out. */
static int learn_scores(const struct training *t, struct iso_metric *metric,
                        struct sim_train_metric_report *report)
{
    struct held_out held = {{0}, {0}};
    metric->gain = 1.0f;
    metric->bias = 0.0f;
    int error = compare_held_out(t, metric, &held);
    error = error ? error : calibrate(&held, metric);
    if (!error) {
        describe(&held, NULL, &report->metric);
        error = learn_rerank(t, &held, metric);
    }
    if (!error) {
        describe(&held, &metric->rerank, &report->fused);
        be_cautious(metric);
    }
    free_held_out(&held);
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

static int learn(struct training *t, struct iso_metric *shape, struct iso_metric **out,
                 struct sim_train_metric_report *report, struct iso_fault *fault)
{
    struct iso_metric *metric = NULL;
    report->n_frames = t->n;
    compact(t);
    choose_nodes(t, shape);
    int error = iso_metric_new(shape, &metric);
    error = error ? error : learn_curves(t, metric);
    if (!error) {
        learn_heights(t, metric);
    }
    error = error ? error : learn_axes(t, metric, report);
    error = error ? error : learn_scores(t, metric, report);
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

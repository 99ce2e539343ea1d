#include "sim/lab/eval/eval.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim/lab/eval/eval_files.h"
#include "sim/lab/match/extract_options.h"
#include "sim/lab/match/landmark_choice.h"
#include "sim/lab/match/method_match.h"
#include "sim/world/face/person.h"

static bool wants_faces(const struct sim_eval *eval)
{
    for (size_t i = 0; i < eval->n_methods; i++) {
        if (sim_method_pairwise(eval->methods[i].method)) {
            return true;
        }
    }
    return false;
}

static int acquire_samples(struct sim_eval *eval, struct iso_fault *fault)
{
    struct sim_capture_options options = {
        .model = eval->model,
        .extract = eval->options.extract,
        .threads = eval->options.threads,
    };
    const char *directory = eval->options.corpus;
    const bool faces = wants_faces(eval);
    int error = faces ? sim_scans_new(eval->corpus, &eval->faces) : 0;
    if (error) {
        return iso_fault_set(fault, error, "%s: out of memory", directory);
    }
    options.inspect = faces ? sim_scans_inspect : NULL;
    options.inspect_context = eval->faces;
    error = sim_acquire(directory, eval->corpus, &options, eval->options.fuse, &eval->acquisition,
                        fault);
    if (!error) {
        error = sim_eval_check_cohort(eval, fault);
    }
    if (!error) {
        error = sim_eval_check_metric(eval, fault);
    }
    return error || !faces
               ? error
               : sim_scans_fuse(directory, eval->corpus, eval->acquisition, eval->faces, fault);
}

/* Provides the knowledge of a pairwise method: NULL for a method that does not learn. -EINVAL if
 * the corpus lacks infrared images or the training set is missing; errors of the method. */
static int teach_method(struct sim_eval *eval, const struct sim_method *method,
                        const void **knowledge, struct iso_fault *fault)
{
    *knowledge = NULL;
    if (method->infrared && !sim_scans_infrared(eval->faces)) {
        return iso_fault_set(fault, -EINVAL, "%s: %s has frames without an infrared image",
                             method->name, eval->options.corpus);
    }
    if (!method->train) {
        return 0;
    }
    if (!eval->options.training) {
        return iso_fault_set(fault, -EINVAL, "%s: has to learn from a training corpus",
                             method->name);
    }
    bool marks[SIM_MARKS];
    sim_scans_marks(eval->faces, marks);
    return sim_training_set_teach(eval->options.training, method, marks, knowledge, fault);
}

/* Sets the fault for an error of comparing templates, and returns the error. */
static int out_of_range(int error, struct iso_fault *fault)
{
    if (!error) {
        return 0;
    }
    return iso_fault_set(fault, error, "comparing templates: %s",
                         error == -EINVAL ? "an option is out of range" : strerror(-error));
}

static int search_gallery(struct sim_eval *eval, struct sim_eval_method *m, struct iso_fault *fault)
{
    const struct sim_eval_options *o = &eval->options;
    if (!sim_method_pairwise(m->method)) {
        const bool adapted = eval->adapted.metric != NULL;
        struct sim_scoring scoring = {
            .metric = adapted ? eval->adapted.metric : eval->metric,
            .cohort = eval->cohort,
            .match = o->match,
            .rerank = m->method == &sim_method_hfpc,
            .site = adapted ? &eval->adapted : NULL,
            .shipped = eval->metric,
        };
        if (m->method == &sim_method_hfpc_upper) {
            scoring.metric = NULL;
            memcpy(scoring.match.left_out, sim_landmarks_below, sizeof sim_landmarks_below);
        }
        int error = sim_match(eval->corpus, eval->acquisition, eval->gallery, &scoring, o->threads,
                              &m->matches);
        if (!error && scoring.site && scoring.metric) {
            error = sim_site_judge_strangers(eval->corpus, eval->acquisition, eval->gallery,
                                             eval->metric, &scoring, o->threads, m->matches);
        }
        return out_of_range(error, fault);
    }
    const void *knowledge;
    int error = teach_method(eval, m->method, &knowledge, fault);
    if (error) {
        return error;
    }
    error = sim_method_match(m->method, knowledge, eval->corpus, eval->acquisition, eval->gallery,
                             eval->faces, o->threads, &m->matches);
    return error ? iso_fault_set(fault, error, "%s: %s", m->method->name, strerror(-error)) : 0;
}

/* Refuses scores that are no numbers, with the row of scores.csv that would have the first one. */
static int check_scores(const struct sim_eval *eval, const struct sim_matches *matches,
                        struct iso_fault *fault)
{
    size_t probe, person;
    if (!sim_matches_find_nan(matches, &probe, &person)) {
        return 0;
    }
    const struct sim_sample *sample = &eval->acquisition->samples[matches->sample[probe]];
    return iso_fault_set(fault, -EDOM, "%s frame %zu, compared with %s: the score is no number",
                         eval->corpus->rows[sample->row].recording,
                         eval->acquisition->captures[sample->first_capture].frame,
                         eval->gallery->names[person]);
}

static int compare_by(struct sim_eval *eval, struct sim_eval_method *m, struct iso_fault *fault)
{
    const int64_t begin_ns = sim_wall_ns(NULL);
    int error = search_gallery(eval, m, &m->fault);
    if (error == -EINVAL && eval->options.lenient && sim_method_pairwise(m->method)) {
        return 0; /* skipped */
    }
    if (!error) {
        error = check_scores(eval, m->matches, &m->fault);
    }
    if (!error) {
        error = out_of_range(
            sim_analyse(eval->corpus, eval->acquisition, eval->gallery, m->matches, &m->analysis),
            &m->fault);
    }
    m->wall_ns = sim_wall_ns(NULL) - begin_ns;
    return error ? iso_fault_set(fault, error, "%s", m->fault.text) : 0;
}

/* The appliance's own methods run last. Only they may mark a sample as not acquired afterwards,
 * and the other methods must be measured on every acquired sample. */
static int compare_methods(struct sim_eval *eval, struct iso_fault *fault)
{
    int error = sim_gallery_new(eval->corpus, eval->acquisition, eval->options.gallery_limit,
                                &eval->gallery);
    if (!error && eval->options.site == SIM_SITE_SENSOR) {
        eval->gallery->teaching = sim_site_searching_sensor(eval->corpus, eval->acquisition);
    }
    if (!error && eval->metric &&
        (eval->options.site == SIM_SITE_GALLERY || eval->options.site == SIM_SITE_SENSOR)) {
        error = sim_site_adapt(eval->gallery, eval->metric, &eval->adapted);
    }
    error = out_of_range(error, fault);
    for (int own = 0; own < 2; own++) {
        for (size_t i = 0; !error && i < eval->n_methods; i++) {
            struct sim_eval_method *m = &eval->methods[i];
            if (sim_method_pairwise(m->method) == (own == 0)) {
                error = compare_by(eval, m, fault);
            }
        }
    }
    for (size_t i = 0; !error && i < eval->n_methods && !eval->matches; i++) {
        eval->matches = eval->methods[i].matches;
        eval->analysis = eval->methods[i].analysis;
    }
    return error || eval->matches
               ? error
               : iso_fault_set(fault, -EINVAL, "%s", eval->methods[0].fault.text);
}

/* The mean length of a deviation without the constant offsets; NaN if no landmark is known. */
static double mean_error(const struct sim_deviation *deviation,
                         const struct iso_vec3 offset_mm[ISO_LANDMARKS])
{
    double sum = 0.0;
    int n = 0;
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        if (deviation->known[l]) {
            sum += iso_norm(iso_sub(deviation->error_mm[l], offset_mm[l]));
            n++;
        }
    }
    return n > 0 ? sum / n : NAN;
}

/* Computes the errors of the landmarks. eval->landmarks receives the figures over all usable
 * captures. error_mm [n_captures] receives the mean error of each capture, or NaN if a capture has
 * no known landmark. */
static int measure_landmarks(struct sim_eval *eval, double *error_mm, struct iso_fault *fault)
{
    const struct sim_acquisition *a = eval->acquisition;
    struct sim_truth *truth = NULL;
    int error = sim_truth_read(eval->options.corpus, eval->corpus, &truth, fault);
    if (error) {
        return error;
    }
    struct sim_deviation *deviations = calloc(a->n_captures, sizeof *deviations);
    struct iso_vec3 offset_mm[ISO_LANDMARKS];
    size_t n = 0;
    for (size_t i = 0; deviations && i < a->n_captures; i++) {
        const struct sim_capture *c = &a->captures[i];
        if (c->extraction.outcome == ISO_CAPTURE_OK) {
            deviations[n++] = sim_deviation_of(&c->extraction, &truth[i], c->row);
        }
    }
    error = deviations ? sim_landmark_offsets(deviations, n, offset_mm) : -ENOMEM;
    if (!error) {
        error = sim_landmark_errors(eval->corpus, deviations, n, offset_mm, eval->landmarks);
    }
    for (size_t i = 0, k = 0; !error && i < a->n_captures; i++) {
        const bool usable = a->captures[i].extraction.outcome == ISO_CAPTURE_OK;
        error_mm[i] = usable ? mean_error(&deviations[k], offset_mm) : NAN;
        k += usable;
    }
    free(deviations);
    free(truth);
    return error ? iso_fault_set(fault, error, "landmarks: %s", strerror(-error)) : 0;
}

static int draw_curves(struct sim_eval *eval, const double *error_mm)
{
    double(*factor)[SIM_FACTORS] = calloc(eval->matches->n_probes + 1, sizeof *factor);
    if (!factor) {
        return -ENOMEM;
    }
    sim_factors_measure(eval->corpus, eval->acquisition, eval->matches, error_mm, factor);
    const int error = sim_curves_of(
        eval->analysis, eval->matches, (const double(*)[SIM_FACTORS])factor,
        eval->analysis->verification.at_fmr[2].at.threshold, eval->curves);
    free(factor);
    return error;
}

/* Computes the results that depend on the first method. */
static int look_closer(struct sim_eval *eval, struct iso_fault *fault)
{
    double *error_mm = calloc(eval->acquisition->n_captures + 1, sizeof *error_mm);
    if (!error_mm) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", eval->options.corpus);
    }
    int error = measure_landmarks(eval, error_mm, fault);
    if (!error) {
        error = draw_curves(eval, error_mm);
        if (!error) {
            error = sim_growth_of(eval->gallery, eval->matches, eval->analysis, sim_fpir_targets[1],
                                  &eval->growth);
        }
        if (error) {
            (void)iso_fault_set(fault, error, "%s: out of memory", eval->options.corpus);
        }
    }
    free(error_mm);
    return error;
}

/* Whether the scores keep what they promise. Only those of a metric promise error rates. */
static int judge_promises(struct sim_eval *eval, struct iso_fault *fault)
{
    const struct sim_scores *scores = &eval->analysis->verification.scores;
    if (sim_eval_score_kind(eval) != SIM_SCORE_METRIC) {
        return 0;
    }
    const int error = sim_calibration_of(scores, eval->analysis->n_subjects,
                                         (double)scores->n_non_mated, &eval->calibration);
    return error ? iso_fault_set(fault, error, "%s: %s", eval->options.corpus, strerror(-error))
                 : 0;
}

static int split_people(struct sim_eval *eval, struct iso_fault *fault)
{
    const struct sim_scoring scoring = {.metric = eval->metric,
                                        .cohort = eval->cohort,
                                        .match = eval->options.match,
                                        .rerank = true};
    if (!eval->metric || eval->options.site != SIM_SITE_SPLIT) {
        return 0;
    }
    const int error = sim_site_split(eval->corpus, eval->acquisition, eval->gallery, &scoring,
                                     eval->options.threads, &eval->site);
    return error ? iso_fault_set(fault, error, "%s: --site split: %s", eval->options.corpus,
                                 error == -EINVAL ? "needs four enrolled people" : strerror(-error))
                 : 0;
}

static void choose_methods(struct sim_eval *eval)
{
    const struct sim_eval_options *o = &eval->options;
    eval->n_methods = o->n_methods > 0 ? o->n_methods : 1;
    eval->methods[0].method = &sim_method_hfpc;
    for (size_t i = 0; i < o->n_methods; i++) {
        eval->methods[i].method = o->methods[i];
    }
}

enum sim_score_kind sim_eval_score_kind(const struct sim_eval *eval)
{
    if (sim_method_pairwise(sim_eval_first(eval))) {
        return SIM_SCORE_PAIRWISE;
    }
    if (eval->metric && sim_eval_first(eval) != &sim_method_hfpc_upper) {
        return SIM_SCORE_METRIC;
    }
    return eval->cohort ? SIM_SCORE_COHORT : SIM_SCORE_DISTANCE;
}

int sim_eval_run(const struct sim_eval_options *options, struct sim_eval **out,
                 struct iso_fault *fault)
{
    int error = sim_threads_check(options->threads, options->extract.heat, fault);
    if (error) {
        return error;
    }
    struct sim_eval *eval = calloc(1, sizeof *eval);
    if (!eval) {
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    eval->options = *options;
    choose_methods(eval);
    const int64_t begin_ns = sim_wall_ns(NULL);
    error = sim_eval_load(eval, fault);
    if (!error && options->training) {
        error = sim_training_set_check(options->training, options->corpus, eval->corpus,
                                       &eval->trained_apart, fault);
    }
    if (!error) {
        error = acquire_samples(eval, fault);
    }
    if (!error) {
        error = compare_methods(eval, fault);
    }
    if (!error) {
        error = look_closer(eval, fault);
    }
    if (!error) {
        error = judge_promises(eval, fault);
    }
    if (!error) {
        error = split_people(eval, fault);
    }
    if (error) {
        sim_eval_free(eval);
        return error;
    }
    eval->wall_ns = sim_wall_ns(NULL) - begin_ns;
    *out = eval;
    return 0;
}

void sim_eval_free(struct sim_eval *eval)
{
    if (eval) {
        for (size_t i = 0; i < eval->n_methods; i++) {
            sim_analysis_free(eval->methods[i].analysis);
            sim_matches_free(eval->methods[i].matches);
        }
        sim_scans_free(eval->faces);
        sim_gallery_free(eval->gallery);
        sim_acquisition_free(eval->acquisition);
        iso_site_metric_free(&eval->adapted);
        iso_metric_free(eval->metric);
        iso_cohort_free(eval->cohort);
        iso_head_model_free(eval->model);
        sim_corpus_free(eval->corpus);
        free(eval);
    }
}

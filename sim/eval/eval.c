#include "sim/eval/eval.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "sim/data_file.h"
#include "sim/eval/extract_options.h"

static int load(struct sim_eval *eval, struct iso_fault *fault)
{
    int error = sim_head_model_load(eval->options.model, &eval->model, fault);
    if (!error && eval->options.cohort) {
        error = sim_cohort_load(eval->options.cohort, &eval->cohort, fault);
    }
    if (!error) {
        error = sim_corpus_read(eval->options.corpus, &eval->corpus, fault);
    }
    return error;
}

static int acquire(struct sim_eval *eval, struct iso_fault *fault)
{
    const struct sim_capture_options options = {
        .model = eval->model,
        .extract = eval->options.extract,
        .threads = eval->options.threads,
    };
    int error = sim_acquire(eval->options.corpus, eval->corpus, &options, eval->options.fuse,
                            &eval->acquisition, fault);
    if (!error && eval->cohort &&
        iso_cohort_algorithm(eval->cohort) != eval->acquisition->origin.algorithm) {
        return iso_fault_set(fault, -EBADMSG, "%s: made by algorithm %08x, templates are of %08x",
                             eval->options.cohort, (unsigned)iso_cohort_algorithm(eval->cohort),
                             (unsigned)eval->acquisition->origin.algorithm);
    }
    return error;
}

static int compare(struct sim_eval *eval, struct iso_fault *fault)
{
    const struct sim_eval_options *o = &eval->options;
    int error = sim_gallery_new(eval->corpus, eval->acquisition, o->gallery_limit, &eval->gallery);
    if (!error) {
        error = sim_match(eval->corpus, eval->acquisition, eval->gallery, eval->cohort, &o->match,
                          o->threads, &eval->matches);
    }
    if (!error) {
        error = sim_analyse(eval->corpus, eval->acquisition, eval->gallery, eval->matches,
                            &eval->analysis);
    }
    return error ? iso_fault_set(fault, error, "comparing templates: %s",
                                 error == -EINVAL ? "an option is out of range" : strerror(-error))
                 : 0;
}

static int measure_landmarks(struct sim_eval *eval, struct iso_fault *fault)
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
    free(deviations);
    free(truth);
    return error ? iso_fault_set(fault, error, "landmarks: %s", strerror(-error)) : 0;
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
    int64_t begin_ns = sim_wall_ns(NULL);
    error = load(eval, fault);
    if (!error) {
        error = acquire(eval, fault);
    }
    if (!error) {
        error = compare(eval, fault);
    }
    if (!error) {
        error = measure_landmarks(eval, fault);
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
        sim_analysis_free(eval->analysis);
        sim_matches_free(eval->matches);
        sim_gallery_free(eval->gallery);
        sim_acquisition_free(eval->acquisition);
        iso_cohort_free(eval->cohort);
        iso_head_model_free(eval->model);
        sim_corpus_free(eval->corpus);
        free(eval);
    }
}

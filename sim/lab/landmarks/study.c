#include "sim/lab/landmarks/study.h"

#include <errno.h>
#include <stdlib.h>

#include "drivers/model/model_file.h"
#include "sim/lab/match/extract_options.h"

static int measure(struct sim_study *study, struct iso_fault *fault)
{
    const struct sim_study_options *o = &study->options;
    const struct sim_capture_options options = {
        .model = study->model,
        .extract = o->extract,
        .threads = o->threads,
    };
    int error = sim_measure(o->corpus, study->corpus, &options, &study->measurement, fault);
    if (error) {
        return error;
    }
    error = sim_landmark_analyse(study->corpus, study->measurement, &study->analysis);
    return error ? iso_fault_set(fault, error, "%s: out of memory", o->corpus) : 0;
}

int sim_study_run(const struct sim_study_options *options, struct sim_study **out,
                  struct iso_fault *fault)
{
    int error = sim_threads_check(options->threads, options->extract.heat, fault);
    if (error) {
        return error;
    }
    struct sim_study *study = calloc(1, sizeof *study);
    if (!study) {
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    study->options = *options;
    const int64_t begin_ns = sim_wall_ns(NULL);
    error = iso_head_model_load(options->model, &study->model, fault);
    if (!error) {
        error = sim_corpus_read(options->corpus, &study->corpus, fault);
    }
    if (!error) {
        error = measure(study, fault);
    }
    if (error) {
        sim_study_free(study);
        return error;
    }
    study->wall_ns = sim_wall_ns(NULL) - begin_ns;
    *out = study;
    return 0;
}

void sim_study_free(struct sim_study *study)
{
    if (study) {
        sim_landmark_analysis_free(study->analysis);
        sim_measurement_free(study->measurement);
        iso_head_model_free(study->model);
        sim_corpus_free(study->corpus);
        free(study);
    }
}

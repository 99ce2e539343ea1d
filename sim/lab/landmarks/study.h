/* The benchmark of landmarks, gates and presentation attacks on one corpus. */
#ifndef SIM_LAB_LANDMARKS_STUDY_H
#define SIM_LAB_LANDMARKS_STUDY_H

#include <stdio.h>

#include "sim/lab/landmarks/analysis.h"

struct sim_study_options {
    const char *corpus; /* directory */
    const char *model;  /* file */
    int threads;        /* 1 with ISO_HEAT_SPECTRAL, whose solver is not reentrant */
    struct iso_extract_options extract; /* the study sets its clock and sensor */
};

struct sim_study {
    struct sim_study_options options;
    struct sim_corpus *corpus;
    struct iso_head_model *model;
    struct sim_measurement *measurement;
    struct sim_landmark_analysis *analysis;
    int64_t wall_ns; /* duration of the whole study */
};

/* Measures and analyses a corpus. The strings in the options must outlive the result. -EINVAL for
 * options out of range, or the errors of reading the corpus and the model and of sim_measure; each
 * with a fault. */
int sim_study_run(const struct sim_study_options *options, struct sim_study **out,
                  struct iso_fault *fault) __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void sim_study_free(struct sim_study *study);

/* Prints tables for people. */
void sim_study_text(const struct sim_study *study, FILE *out);

/* Writes landmarks.csv, the landmarks of every fitted frame, and frames.csv, one line for each
 * frame. Errors of sim_result_file. */
int sim_study_csv(const struct sim_study *study, const char *directory, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Writes summary.json. Errors of iso_path_join and sim_json_file. */
int sim_study_json(const struct sim_study *study, const char *directory, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif

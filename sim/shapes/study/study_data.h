/* The data of a study, and its two parts. Internal to sim/shapes/study. */
#ifndef SIM_SHAPES_STUDY_STUDY_DATA_H
#define SIM_SHAPES_STUDY_STUDY_DATA_H

#include <stdbool.h>

#include "sim/shapes/study/choice.h"
#include "sim/shapes/study/retrieve.h"
#include "sim/shapes/study/study.h"

enum {
    SIM_STUDY_RESULTS_MAX = SIM_CHOICE_METHODS_MAX * SIM_CHOICE_CLASSIFIERS_MAX,
};

/* The result of one method and classifier. */
struct sim_study_result {
    const struct iso_shape_method *method;
    const struct iso_classifier_ops *classifier;
    bool ranked;
    struct iso_retrieval retrieval;
    struct iso_confusion_rates rates;
};

struct sim_study {
    const struct sim_shapes_study_options *options;
    struct sim_shape_manifest *manifest;
    struct sim_bank_options items_how, queries_how;
    struct sim_choice choice;
    struct sim_bank *items;
    struct sim_bank *queries; /* NULL: the items */
    int32_t *query_row;       /* [n] of the manifest: the queries, or NULL */
    int n_results;
    struct sim_study_result result[SIM_STUDY_RESULTS_MAX];
};

/* Refuses times of heat that a method of the study cannot have. -EINVAL with a fault. */
int sim_study_check_times(const struct sim_study *study, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Writes parameters.json. No classifier stands for each method's own. -ENOMEM, -EIO, with a fault.
 */
int sim_study_save_parameters(const struct sim_study *study, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Measures the study's method number m with each classifier that fits it, or with its own one. Adds
 * the results, prints a line for each and writes the files of its directory. Errors of the
 * features and of the classifier, each with a fault. */
int sim_study_run_method(struct sim_study *study, int m, FILE *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Writes the files of the whole study. Errors of writing, with a fault. */
int sim_study_save(const struct sim_study *study, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif

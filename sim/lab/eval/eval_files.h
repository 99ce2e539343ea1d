/* The files of an evaluation: corpus, head model, metric and cohort, and whether they fit together.
 */
#ifndef SIM_LAB_EVAL_EVAL_FILES_H
#define SIM_LAB_EVAL_EVAL_FILES_H

#include "sim/lab/eval/eval.h"

/* Reads the files that the options name. The errors of iso_head_model_load, iso_cohort_load,
 * iso_metric_load and sim_corpus_read; the caller frees what was read. */
int sim_eval_load(struct sim_eval *eval, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Whether the metric and the cohort, if there are any, were made for the acquired templates and not
 * from people of the corpus: 0, or -EBADMSG. */
int sim_eval_check_metric(const struct sim_eval *eval, struct iso_fault *fault)
    __attribute__((warn_unused_result));
int sim_eval_check_cohort(const struct sim_eval *eval, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif

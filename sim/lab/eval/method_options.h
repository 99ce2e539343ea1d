/* The choice of methods on the command line. */
#ifndef SIM_LAB_EVAL_METHOD_OPTIONS_H
#define SIM_LAB_EVAL_METHOD_OPTIONS_H

#include <stdio.h>

#include "sim/base/options.h"
#include "sim/lab/eval/eval.h"

struct sim_method_choice {
    size_t n; /* 0: no method was given */
    const struct sim_method *methods[SIM_METHODS];
    bool all; /* methods that cannot work on a corpus are left out */
};

sim_option_parser sim_option_methods; /* struct sim_method_choice: "all", or names and commas */

/* A line a method: its name and its source. */
void sim_method_choice_help(FILE *out);

/* Puts the methods into the options, and what they learn from: *training, from `directory` (NULL:
 * none), is made if one of them learns, and to be freed after the last evaluation. Needs the model,
 * the extractor's options and the number of threads in the options. Errors of reading the model and
 * of sim_training_set_new. */
int sim_method_choice_apply(const struct sim_method_choice *choice, const char *directory,
                            struct sim_eval_options *options, struct sim_training_set **training,
                            struct iso_fault *fault) __attribute__((warn_unused_result));

#endif

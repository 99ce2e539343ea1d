/* The choice of methods on the command line. */
#ifndef SIM_LAB_EVAL_METHOD_OPTIONS_H
#define SIM_LAB_EVAL_METHOD_OPTIONS_H

#include <stdio.h>

#include "sim/base/options.h"
#include "sim/lab/eval/eval.h"

struct sim_method_choice {
    size_t n; /* 0: no method was given */
    const struct sim_method *methods[SIM_METHODS];
    bool all; /* skip methods that cannot work on a corpus */
};

/* Parses "all", or names separated by commas, into a struct sim_method_choice. */
sim_option_parser sim_option_methods;

/* Prints one line for each method: its name and its source. */
void sim_method_choice_help(FILE *out);

/* Puts the methods into the options, with their training set. If one of the methods learns,
 * *training is read from `directory` (NULL: none); otherwise it stays unchanged. Free it after the
 * last evaluation. The model, the extractor's options and the number of threads must be set in
 * the options. Errors of sim_threads_check, of reading the model and of sim_training_set_new. */
int sim_method_choice_apply(const struct sim_method_choice *choice, const char *directory,
                            struct sim_eval_options *options, struct sim_training_set **training,
                            struct iso_fault *fault) __attribute__((warn_unused_result));

#endif

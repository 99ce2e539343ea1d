/* Reports on several methods and one or more corpora: a table for people and a file for programs.
 */
#ifndef SIM_LAB_REPORT_REPORT_METHODS_H
#define SIM_LAB_REPORT_REPORT_METHODS_H

#include <stdio.h>

#include "sim/lab/eval/verdict.h"

/* The results of one corpus; they are copied out of the evaluation. */
struct sim_contest {
    char corpus[SIM_CORPUS_NAME_MAX]; /* the last part of its path */
    size_t n_verdicts;
    struct sim_verdict verdicts[SIM_METHODS];
    size_t n_people, n_searches, n_strangers, n_non_mated;
};

/* Takes the verdicts of all methods that were not skipped. -ENOMEM. */
int sim_contest_of(const struct sim_eval *eval, struct sim_contest *out)
    __attribute__((warn_unused_result));

/* Prints the table of one corpus, one method in each line, and how the first method compares with
 * the best of the others. */
void sim_contest_text(const struct sim_contest *contest, FILE *out);

/* Prints a line with the reason for each method that was skipped. */
void sim_contest_left_out(const struct sim_eval *eval, FILE *out);

/* methods.csv: one line for each method and corpus. */
int sim_contest_csv(const struct sim_contest *contests, size_t n, const char *directory,
                    struct iso_fault *fault) __attribute__((warn_unused_result));

#endif

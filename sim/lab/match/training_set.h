/* A corpus that methods learn from, and the knowledge that they learned. */
#ifndef SIM_LAB_MATCH_TRAINING_SET_H
#define SIM_LAB_MATCH_TRAINING_SET_H

#include "sim/lab/match/scans.h"
#include "sim/lab/methods/method.h"

struct sim_training_set;

/* Reads a corpus: takes every usable frame of the rows that show a person, labelled with its
 * subject. The options must be those of the corpora to compare; their inspector is replaced.
 * Errors of sim_corpus_read, sim_acquire and sim_scans_fuse; -ENOMEM; each with a fault. */
int sim_training_set_new(const char *directory, const struct sim_capture_options *options,
                         struct sim_training_set **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void sim_training_set_free(struct sim_training_set *set);

/* The number of faces in the set, and the number of their people. */
size_t sim_training_set_faces(const struct sim_training_set *set);
uint32_t sim_training_set_people(const struct sim_training_set *set);

/* Checks that training and test share no person. The first word of a row's note names the origin
 * of people in rendered corpora (sim_corpus_row_is_of). -EINVAL with a fault if a row of either
 * corpus has the same origin as a row of the other, or if the two directories are the same. *known
 * is true if both corpora have a note in every row with a person, so that a return of 0 is a
 * proof. */
int sim_training_set_check(const struct sim_training_set *set, const char *directory,
                           const struct sim_corpus *corpus, bool *known, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Gives the knowledge that a method learns from the set. The set keeps it and frees it; a method
 * that uses marks learns again if `marks` have changed, and its old knowledge is then freed.
 * *knowledge is NULL for a method that does not learn. Errors of the method. */
int sim_training_set_teach(struct sim_training_set *set, const struct sim_method *method,
                           const bool marks[SIM_MARKS], const void **knowledge,
                           struct iso_fault *fault) __attribute__((warn_unused_result));

#endif

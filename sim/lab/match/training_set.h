/* A corpus that methods learn from, and what they learned. */
#ifndef SIM_LAB_MATCH_TRAINING_SET_H
#define SIM_LAB_MATCH_TRAINING_SET_H

#include "sim/lab/match/scans.h"
#include "sim/lab/methods/method.h"

struct sim_training_set;

/* Every usable frame of the rows that show somebody, labelled with its subject. The options are
 * those of the corpora that will be compared. Errors of sim_corpus_read, sim_acquire and
 * sim_scans_fuse. */
int sim_training_set_new(const char *directory, const struct sim_capture_options *options,
                         struct sim_training_set **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));
void sim_training_set_free(struct sim_training_set *set);

size_t sim_training_set_faces(const struct sim_training_set *set);
uint32_t sim_training_set_people(const struct sim_training_set *set);

/* Nobody may be learned from and tested with. Rendered corpora say who is in them by the note
 * of a row (sim_corpus_row_is_of): -EINVAL with a fault if two rows are of the same people, or if
 * the two directories are the same. *known says whether both corpora have such notes in every row
 * with a person, so that 0 proves anything. */
int sim_training_set_check(const struct sim_training_set *set, const char *directory,
                           const struct sim_corpus *corpus, bool *known, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* What a method learns from the set: its own, kept until the set is freed or `marks` change (a
 * method that works on marks then learns again). NULL for a method that does not learn. Errors of
 * the method. */
int sim_training_set_teach(struct sim_training_set *set, const struct sim_method *method,
                           const bool marks[SIM_MARKS], const void **knowledge,
                           struct iso_fault *fault) __attribute__((warn_unused_result));

#endif

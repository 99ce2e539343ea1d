/* Decides which visits are certain enough to learn from. Pure.
 *
 * A learned template is added to the enrolled ones and never replaces one; it is marked
 * (iso_template.learned). Two limits prevent drift. The visit has to be more certain than any
 * threshold requires. And the template has to reach the same score with the enrolled templates
 * alone: a learned template never justifies the next one. */
#ifndef ISO_FIRMWARE_RECOGNISE_LEARNING_H
#define ISO_FIRMWARE_RECOGNISE_LEARNING_H

#include "core/match/search.h"
#include "firmware/visit/decision.h"

struct iso_learning_options {
    int templates; /* of one person, at most; 0: learning is off */
    double score;  /* lowest score of a frame, and with the enrolled templates */
};

/* Whether the visit that this verdict ended is one to learn from: it was allowed, it had no frame
 * with a cue of an attack, and every usable frame counted for the person with that score. */
bool iso_learning_is_sure(const struct iso_learning_options *options,
                          const struct iso_decision *decision, const struct iso_verdict *verdict);

/* Lists the enrolled templates among n templates of a person, at most n, as entries that refer to
 * them. Returns their number. */
int iso_learning_enrolled(int64_t person, const struct iso_template *templates, int n,
                          struct iso_search_entry *out);

#endif

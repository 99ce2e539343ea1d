/* Which visits are sure enough to learn from. Pure.
 *
 * A learned template stands beside the enrolled ones, never in the place of one, and is marked
 * (iso_template.learned). Two bounds keep it from drifting: the visit has to be surer than any
 * threshold asks for, and the template as like those that were enrolled, without the learned ones:
 * nothing that was learned vouches for what is learned next. */
#ifndef ISO_FIRMWARE_RECOGNISE_LEARNING_H
#define ISO_FIRMWARE_RECOGNISE_LEARNING_H

#include "core/match/search.h"
#include "firmware/visit/decision.h"

struct iso_learning_options {
    int templates; /* of one person, at most; 0: nothing is learned */
    double score;  /* of every frame of the visit, and with the enrolled templates */
};

/* Whether the visit that this verdict ended is one to learn from: allowed, no frame with a cue of
 * an attack, and every usable frame counted for the person with that score. */
bool iso_learning_is_sure(const struct iso_learning_options *options,
                          const struct iso_decision *decision, const struct iso_verdict *verdict);

/* The enrolled ones among n templates of a person, at most n, as entries that refer to them;
 * returns how many they are. */
int iso_learning_enrolled(int64_t person, const struct iso_template *templates, int n,
                          struct iso_search_entry *out);

#endif

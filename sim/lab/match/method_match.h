/* Searches by a pairwise method; match.h does the same for the appliance's own methods. */
#ifndef SIM_LAB_MATCH_METHOD_MATCH_H
#define SIM_LAB_MATCH_METHOD_MATCH_H

#include "sim/lab/match/match.h"
#include "sim/lab/match/scans.h"
#include "sim/lab/methods/method.h"

/* Describes every acquired sample and compares every probe with every enrolled person. The distance
 * of a person is that of the nearest of the person's descriptions. A face that cannot be described
 * has infinite distance to everyone. The `distance_mm` of the result is in the method's own unit;
 * the score is its negative. Subjects are not used here. -ENOMEM or the errors of the method. */
int sim_method_match(const struct sim_method *method, const void *knowledge,
                     const struct sim_corpus *corpus, const struct sim_acquisition *acquisition,
                     const struct sim_gallery *gallery, const struct sim_scans *faces, int threads,
                     struct sim_matches **out) __attribute__((warn_unused_result));

#endif

/* How unlike the part of a shape is to a whole shape, by features of local heat (local_heat.h).
 *
 * Each point of the query looks for the point of the other shape whose heat is most like its own;
 * the mean over the query's points is the distance (as in Boiman, Shechtman and Irani 2008, where
 * each feature votes by its nearest neighbour, and as a Hausdorff distance of one direction,
 * Huttenlocher, Klanderman and Rucklidge 1993, with the mean in the place of the maximum). Points
 * that are missing from the query therefore cost nothing. A difference d counts as d / (1 + d /
 * 0.2), the bounded function of Geman and Reynolds 1992: on a swollen limb or at a wrong vertex a
 * few points are like nothing on the other shape, and without a bound they decide.
 * Times at which heat may have reached the query's boundary count little: the weight of a time t at
 * the distance d from it is 1 - exp(-d^2 / 4t). The area that the query had as a whole is unknown,
 * so several are tried, and the least distance counts. */
#ifndef ISO_CORE_SHAPE_PARTIAL_PARTIAL_DISTANCE_H
#define ISO_CORE_SHAPE_PARTIAL_PARTIAL_DISTANCE_H

#include "isotherm/shape_method.h"

/* A query made ready. One thread at a time may use it. */
struct iso_partial_query;

/* The feature is one of local heat (iso_is_local_heat); it is copied. -ENOMEM. */
int iso_partial_query_new(const float *feature, struct iso_partial_query **out)
    __attribute__((warn_unused_result));

/* Frees it. NULL is accepted. */
void iso_partial_query_free(struct iso_partial_query *query);

/* The distance of the query from another shape, given by its feature, 0 to 0.2: the mean of the
 * bounded differences of the logarithm of heat (root mean square over times), for the whole area
 * that fits best. If `area_ratio` is not NULL, it receives that area divided by the area of
 * the query. */
double iso_partial_distance(struct iso_partial_query *query, const float *other,
                            double *area_ratio);

#endif

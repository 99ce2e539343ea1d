/* The gallery as a 1:N search by the learned metric sees it: one row of numbers a person.
 *
 * With x the probe's vector and y the person's, v and w their variances within a person, b the
 * variance between people, and for each dimension
 *
 *   shrink = b / (b + w),  same = v + b w / (b + w),  any = v + b
 *
 * the score (iso_metric_score) multiplies out to
 *
 *   gain / 2 * (  sum x (2 shrink / same) y           a dot product of two vectors
 *               - sum (shrink^2 / same) y^2           and one of squares
 *               + sum x^2 (1 / any - 1 / same)        of the probe and w alone
 *               + sum log(any / same)  ) + bias       of v and w alone,
 *
 * and w takes few values: it is a step of iso_metric_variance. A scan that looks at every person is
 * exact, since the registration of a template needs no partner: it is to the mean curves. There is
 * nothing that a shortlist could lose but what rounding does; principal components with an
 * expansion of the best pose, as unlearned templates need, would only approximate it. The scan
 * works in single precision: for the 150 numbers and the scores of the shipped metric it is off by
 * less than 1e-4, the width of a line of which 1 is a tenfold false match rate. The people that it
 * finds are then scored anew by iso_metric_score, so that scores are the same to the bit as by any
 * other way.
 *
 * One thread at a time may use an index, also for a search, which works in memory of the index. The
 * content is biometric: it is wiped when it is moved, removed or freed. A search wipes its working
 * memory at its end. */
#ifndef ISOTHERM_INDEX_H
#define ISOTHERM_INDEX_H

#include "isotherm/metric.h"

enum {
    ISO_INDEX_TEMPLATES_MAX = 16, /* of one person */
    ISO_INDEX_HITS_MAX = 64,      /* of one search */
};

struct iso_search_hit {
    int64_t person;
    double distance_mm; /* of the closest template; NaN by metric */
    double score;       /* higher is more alike */
};

struct iso_index;

/* An empty index without room. The metric outlives it. -ENOMEM. */
int iso_index_new(const struct iso_metric *metric, struct iso_index **out)
    __attribute__((warn_unused_result));
void iso_index_free(struct iso_index *index);

/* Room for so many people in all, at 4 bytes a dimension (rounded up to 8 dimensions) and 24 more
 * each: no function but this allocates. Grows by doubling, never shrinks. -ENOMEM, then nothing has
 * changed. */
int iso_index_reserve(struct iso_index *index, size_t n_people) __attribute__((warn_unused_result));

/* How many people are in it. */
size_t iso_index_size(const struct iso_index *index);

/* Makes this the person's vector, that of 1..ISO_INDEX_TEMPLATES_MAX templates; a new person comes
 * in. Quickest in the order of rising numbers. -EINVAL for another number of templates or a step
 * that there is not, -ENOSPC if there is no room for a new person. */
int iso_index_put(struct iso_index *index, int64_t person, const struct iso_metric_vector *vector)
    __attribute__((warn_unused_result));

/* Takes another template of the person in, who is made if need be; errors of iso_index_put. */
int iso_index_add(struct iso_index *index, int64_t person, const struct iso_metric_vector *one)
    __attribute__((warn_unused_result));

/* The person's vector as it was put, to the bit. -ENOENT: nobody has this number. */
int iso_index_find(const struct iso_index *index, int64_t person, struct iso_metric_vector *out)
    __attribute__((warn_unused_result));

/* Forgets somebody. -ENOENT. */
int iso_index_remove(struct iso_index *index, int64_t person) __attribute__((warn_unused_result));

/* The best people for a probe (the vector of one template) by falling score, equal ones by rising
 * number: at most `capacity` are written, and *n_hits says how many. Their distances are NaN.
 * -EINVAL for a vector of another number of templates, or a capacity outside
 * 0..ISO_INDEX_HITS_MAX. */
int iso_index_search(const struct iso_index *index, const struct iso_metric_vector *probe,
                     struct iso_search_hit *hits, int capacity, int *n_hits)
    __attribute__((warn_unused_result));

#endif

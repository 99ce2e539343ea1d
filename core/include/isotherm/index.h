/** @file
 * An index of people for 1:N search by the learned metric: one row of numbers a person.
 *
 * With x the probe's vector and y the person's, v and w their variances within a person, b the
 * variance between people, and for each dimension
 *
 *     shrink = b / (b + w),  same = v + b w / (b + w),  any = v + b
 *
 * the score (iso_metric_score()) multiplies out to
 *
 *     gain / 2 * (  sum x (2 shrink / same) y           a dot product of two vectors
 *                 - sum (shrink^2 / same) y^2           and one of squares
 *                 + sum x^2 (1 / any - 1 / same)        of the probe and w alone
 *                 + sum log(any / same)  ) + bias       of v and w alone,
 *
 * and w takes few values: it is a step of iso_metric_variance(). The search is exact, because a
 * template is registered to the mean curves and not to the templates that it is compared with. From
 * 512 people on it first compares codes, one byte for each of the first 60 numbers, which give a
 * bound that the score cannot exceed, and scores only those people who may be among the best. (A
 * processor without AVX2 or NEON scores everybody.) It works in single precision; with the shipped
 * metric its scores are off by less than 1e-4. The people that it finds are then scored anew by
 * iso_metric_score(), so that their scores are the same to the bit as those of iso_metric_score().
 *
 * One thread at a time may use an index, also for a search, which works in memory of the index. The
 * content is biometric: the index wipes it when it is moved, removed or freed. */
#ifndef ISOTHERM_INDEX_H
#define ISOTHERM_INDEX_H

#include "isotherm/metric.h"

enum {
    ISO_INDEX_TEMPLATES_MAX = 16, /**< Most templates of one person. */
    ISO_INDEX_HITS_MAX = 64,      /**< Most hits of one search. */
};

/** A person whom a search has found. */
struct iso_search_hit {
    int64_t person;     /**< The caller's number of the person. */
    double distance_mm; /**< Distance of the closest template, mm; NaN of a search by metric. */
    double score;       /**< Higher is more alike. */
};

/** An index of people. */
struct iso_index;

/** Makes an empty index, without room for people.
 *
 * @param metric  The metric; it is referenced, not copied, and has to outlive the index.
 * @param out     Receives the index; free it with iso_index_free().
 * @return 0; -ENOMEM. */
int iso_index_new(const struct iso_metric *metric, struct iso_index **out)
    __attribute__((warn_unused_result));

/** Wipes and frees an index.
 *
 * @param index  The index, or NULL. */
void iso_index_free(struct iso_index *index);

/** Makes room for people. After iso_index_new() no other function of the index allocates memory.
 * Room grows by doubling and never shrinks. A person takes 4 bytes for each dimension (their number
 * rounded up to a multiple of 8), and some 88 more.
 *
 * @param index     The index.
 * @param n_people  How many people there shall be room for in all.
 * @return 0; -ENOMEM, and nothing has changed. */
int iso_index_reserve(struct iso_index *index, size_t n_people) __attribute__((warn_unused_result));

/** How many people are in an index.
 *
 * @param index  The index.
 * @return The number of people. */
size_t iso_index_size(const struct iso_index *index);

/** Sets the vector of a person, who is added if unknown. Quickest in the order of rising numbers.
 *
 * @param index   The index.
 * @param person  The caller's number of the person.
 * @param vector  The vector of 1..ISO_INDEX_TEMPLATES_MAX templates; it is copied.
 * @return 0; -EINVAL for another number of templates or a step out of range; -ENOSPC if there is no
 *         room for another person. Nothing has changed then. */
int iso_index_put(struct iso_index *index, int64_t person, const struct iso_metric_vector *vector)
    __attribute__((warn_unused_result));

/** Adds a template to those of a person, who is added if unknown.
 *
 * @param index   The index.
 * @param person  The caller's number of the person.
 * @param one     The vector of one template; it is copied.
 * @return As iso_index_put(), where the templates of the person are counted together. */
int iso_index_add(struct iso_index *index, int64_t person, const struct iso_metric_vector *one)
    __attribute__((warn_unused_result));

/** The vector of a person.
 *
 * @param index   The index.
 * @param person  The caller's number of the person.
 * @param out     Receives the vector as it was put, to the bit.
 * @return 0; -ENOENT if nobody has this number. */
int iso_index_find(const struct iso_index *index, int64_t person, struct iso_metric_vector *out)
    __attribute__((warn_unused_result));

/** Removes a person, whose vector is wiped.
 *
 * @param index   The index.
 * @param person  The caller's number of the person.
 * @return 0; -ENOENT if nobody has this number. */
int iso_index_remove(struct iso_index *index, int64_t person) __attribute__((warn_unused_result));

/** Finds the people who look most like a probe, by falling score; equal scores by rising number.
 * The search wipes its working memory.
 *
 * @param index     The index.
 * @param probe     The vector of one template.
 * @param hits      [capacity]: receives the people; their distances are NaN.
 * @param capacity  How many people are wanted at most, 0..ISO_INDEX_HITS_MAX.
 * @param n_hits    Receives how many were found.
 * @return 0; -EINVAL for a vector of several templates or none, or a capacity out of range. */
int iso_index_search(const struct iso_index *index, const struct iso_metric_vector *probe,
                     struct iso_search_hit *hits, int capacity, int *n_hits)
    __attribute__((warn_unused_result));

#endif

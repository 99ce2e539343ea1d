/* A vocabulary: typical rows of values, the words. Other rows are assigned to the words nearest to
 * them.
 *
 * k-means (Lloyd 1982) started by k-means++ (Arthur and Vassilvitskii 2007). A bag counts how much
 * of a surface belongs to each word. Each vertex is shared between words by its distance from them,
 * as in Bronstein et al., "Shape Google", ACM TOG 30, 2011, section 4. */
#ifndef ISO_CORE_SHAPE_DESCRIBE_VOCABULARY_H
#define ISO_CORE_SHAPE_DESCRIBE_VOCABULARY_H

#include <stdint.h>

enum { ISO_WORDS_MAX = 256 };

struct iso_vocabulary {
    int32_t n_words, n_values;
    float *word;   /* [n_words][n_values] */
    double spread; /* mean squared distance of a row from its word */
};

/* Learns from n rows of n_values. With fewer rows than words, some words are the same. -EINVAL for
 * sizes < 1 or more than ISO_WORDS_MAX words, -ENOMEM. */
int iso_vocabulary_init(const float *row, int32_t n, int32_t n_values, int32_t n_words,
                        uint64_t seed, struct iso_vocabulary *out)
    __attribute__((warn_unused_result));

/* Releases what it holds. */
void iso_vocabulary_done(struct iso_vocabulary *vocabulary);

/* Adds n weighted rows to a bag of n_words. */
void iso_vocabulary_count(const struct iso_vocabulary *vocabulary, const float *row,
                          const float *weight, int32_t n, float *bag);

#endif

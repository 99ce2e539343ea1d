/* Principal components of feature vectors whose length is larger than their number (Turk and
 * Pentland 1991): from the matrix of their products. */
#ifndef ISO_CORE_SHAPE_DESCRIBE_PRINCIPAL_H
#define ISO_CORE_SHAPE_DESCRIBE_PRINCIPAL_H

#include <stdint.h>

struct iso_principal {
    int32_t size, n_components;
    float *mean;      /* [size] */
    float *component; /* [n_components][size], of unit length, by falling variance */
};

/* n vectors of `size` values. Components without variance are left out: n_components may come out
 * less than wanted (0 if all vectors are the same). -EINVAL for n, size or wanted < 1, -EDOM if the
 * vectors are not finite, -ENOMEM. */
int iso_principal_init(const float *const *vector, int32_t n, int32_t size, int32_t wanted,
                       struct iso_principal *out) __attribute__((warn_unused_result));

/* Releases what it holds. */
void iso_principal_done(struct iso_principal *principal);

/* Coefficients of a vector: n_components values. */
void iso_principal_project(const struct iso_principal *principal, const float *vector,
                           float *coefficient);

#endif

/* Linear subspaces learned from samples: principal components, and the directions that separate
 * people. A sample is a row of n_in floats. */
#ifndef SIM_LAB_METHODS_SUBSPACE_H
#define SIM_LAB_METHODS_SUBSPACE_H

#include <stddef.h>
#include <stdint.h>

#include "core/base/fault.h"

/* coordinate[k] = sum_i basis[k][i] (sample[i] - mean[i]) */
struct sim_subspace {
    size_t n_in, n_out;
    float *mean;  /* [n_in] */
    float *basis; /* [n_out][n_in] */
};

/* Frees it and what it holds. NULL is accepted. */
void sim_subspace_free(struct sim_subspace *subspace);

/* Computes the principal components of n >= 2 samples, whitened: every coordinate has variance 1
 * over the samples. Keeps the smallest number of components that hold `energy` (0..1] of the
 * variance, at most `n_most`. It uses the Gram matrix of the samples (Sirovich and Kirby 1987; Turk
 * and Pentland 1991) and LAPACK. -EINVAL for too few samples or identical samples, -ENOMEM, -EDOM
 * if LAPACK does not converge. */
int sim_subspace_principal(const float *samples, size_t n, size_t n_in, double energy,
                           size_t n_most, struct sim_subspace **out)
    __attribute__((warn_unused_result));

/* Linear discriminant analysis after principal components (Belhumeur, Hespanha and Kriegman
 * 1997). Finds at most n_people - 1 directions in which the means of people differ most, in units
 * of the spread within people. That spread is regularised by the share `shrinkage` (0..1) of its
 * mean (Friedman 1989), because each person has few samples. person[i] < n_people. -EINVAL for
 * fewer than two people or no person with two samples, -ENOMEM, -EDOM if the spread within
 * people is singular. */
int sim_subspace_discriminant(const float *samples, const uint32_t *person, size_t n, size_t n_in,
                              uint32_t n_people, double energy, double shrinkage,
                              struct sim_subspace **out) __attribute__((warn_unused_result));

/* Computes the coordinates of a sample, [n_out]. */
void sim_subspace_project(const struct sim_subspace *subspace, const float *sample,
                          float *coordinate);

/* 1 - cosine of the angle between two rows: 0 for the same direction, 1 for orthogonal rows, 2
 * for opposite ones. The distance of a row of zeros to any row is 1. */
double sim_cosine_distance(const float *a, const float *b, size_t n);

#endif

/* Removes the scale from a course of heat that is sampled at t = alpha^tau.
 *
 * A shape scaled by beta has h'(tau) = beta^-2 h(tau - 2 log_alpha beta): h shifted and multiplied.
 * There are two ways to remove both:
 *
 *  - SI-HK (Abdelrahman 2013, 4.3-4.6): amplitudes of the Fourier transform of h itself, divided by
 *    their sum. It needs no logarithm and no derivative, so that noise is not amplified.
 *  - SI-HKS (Bronstein and Kokkinos, CVPR 2010): amplitudes of the Fourier transform of the
 *    derivative of log h.
 *
 * A shift keeps the amplitudes of a finite window only if the course could be continued
 * periodically. SI-HKS therefore needs a window from where h is level to where it is level again,
 * and SI-HK one whose ends are near 0. Otherwise both hold approximately: a signature three times
 * as large, over the same 14 octaves of absolute time, changes by 10 % (SI-HK) and 5 % (SI-HKS,
 * with its own window); 1 % of noise adds 0.2 % and 60 % to that
 * (tests/core/shape/test_shape_heat.c). If times are given in units of the shape's area, scaling
 * the shape causes no shift.
 *
 * (4.4 has beta^2 h(tau + s), because its beta scales the operator; the amplitudes are the same.)
 */
#ifndef ISO_CORE_SHAPE_DESCRIBE_SCALE_INVARIANT_H
#define ISO_CORE_SHAPE_DESCRIBE_SCALE_INVARIANT_H

#include <stdint.h>

/* Discrete Fourier transforms of real courses of n samples, by a matrix of cosines and sines. */
struct iso_fourier;

/* Makes the matrix for courses of n samples, of whose amplitudes the first n_kept are wanted. Any
 * number of threads may use it at once. -EINVAL (n < 4, n_kept outside 1..n / 2), -ENOMEM. */
int iso_fourier_new(int n, int n_kept, struct iso_fourier **out)
    __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void iso_fourier_free(struct iso_fourier *fourier);

/* Amplitudes of SI-HK for n_courses courses of n samples: out is [n_courses][n_kept]. They are
 * divided by the sum over all frequencies 0..n / 2. A course of zeros has zeros. -ENOMEM. */
int iso_si_hk(const struct iso_fourier *fourier, const double *course, int32_t n_courses,
              float *out) __attribute__((warn_unused_result));

/* Amplitudes of SI-HKS: out is [n_courses][n_kept]. Samples that are not above 0 count as the
 * smallest one of their course that is. The courses have one sample more than `fourier` was made
 * for, because the differences of a course are one fewer than its samples. -ENOMEM. */
int iso_si_hks(const struct iso_fourier *fourier, const double *course, int32_t n_courses,
               float *out) __attribute__((warn_unused_result));

#endif

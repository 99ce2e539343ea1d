/* The information in a score, if it is read as a likelihood ratio.
 *
 * A score of s promises that at most the share p = 10^-s of non-mated comparisons reaches it
 * (isotherm/metric.h). This is not yet a likelihood ratio: who reads the score as one, L = 10^s,
 * believes too much. If the promise is kept exactly, p is evenly distributed over 0..1 in non-mated
 * comparisons, and the mean of 1/p is infinite, where the mean of every right likelihood ratio is 1
 * (Turing's rule: Good, "Probability and the Weighing of Evidence", 1950).
 *
 * For s > 0 the likelihood ratio is therefore that of the promise. Its denominator is the density
 * that the promise gives to p in non-mated comparisons, which is 1. Its numerator is the density of
 * p in mated comparisons, which is not known. A family of densities stands for it: k p^(k-1) with k
 * in 0..1. The smaller k is, the more of the mated comparisons have a small p. The numerator is the
 * mean over all k with equal weights (Sellke, Bayarri and Berger 2001 for
 * the family; Vovk and Wang, "E-values", 2021, section 2, for the mean over k):
 *
 *     L(s) = (1 - p + p ln p) / (p ln(p)^2).
 *
 * A score of 2 is then a likelihood ratio of 4.5, a score of 3 one of 21, a score of 4 one of 118.
 * The promise says nothing about scores below 0. There the likelihood ratio continues from
 * L(0) = 1/2 with a factor of ten for each unit of the score, which is an affine function of the
 * logarithm of a likelihood ratio.
 *
 * The functions need scores that are sorted (sim_scores_sort), and at least one of each kind. */
#ifndef SIM_LAB_MEASURE_LIKELIHOOD_H
#define SIM_LAB_MEASURE_LIKELIHOOD_H

#include "sim/lab/measure/det.h"

/* The natural logarithm of L(score). It rises with the score and is continuous. */
double sim_log_likelihood_ratio(double score);

/* The cost of the logarithms of likelihood ratios, in bits, over all ratios of prior probabilities
 * and costs (Bruemmer and du Preez, "Application-independent evaluation of speaker detection",
 * 2006, C_llr): the mean over mated comparisons of log2(1 + 1/L) and that over non-mated
 * comparisons of log2(1 + L), halved. 0 is perfect; 1 is the cost of a score that says nothing;
 * more than 1 does harm. NaN without scores of one of the kinds. */
double sim_cllr(const struct sim_scores *scores);

/* The least cost that a rising function of the score could have on these comparisons (C_llr^min of
 * the same authors). The pool-adjacent-violators algorithm finds that function. Equal scores get
 * equal likelihood ratios. The difference to sim_cllr() is the loss by calibration. *out is NaN
 * without scores of one of the kinds. -ENOMEM. */
int sim_cllr_min(const struct sim_scores *scores, double *out) __attribute__((warn_unused_result));

#endif

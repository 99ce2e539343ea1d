/* Site statistics: what the people enrolled at one door show of its sensor, and the metric that is
 * adapted to them.
 *
 * The metric (isotherm/metric.h) is learned from rendered people. Real people before one sensor
 * differ from them in two ways. All of them share an offset from the rendered mean, which says
 * nothing about who somebody is, and their templates vary more from capture to capture. Both depend
 * on the sensor, so they can only be learned at the site.
 *
 * The adapted metric takes the offset o as one more direction in which a person varies, and half of
 * the covariance within a person from the site (Garcia-Romero and McCree, "Supervised domain
 * adaptation for i-vector based speaker recognition", 2014):
 *
 *     W' = (1 - a) I + a W_site + o o',    B' = B,
 *
 * and then chooses the coordinates in which W' is the identity and B' is diagonal. So the adapted
 * metric has the form of the shipped one, costs the same, and keeps its scale. `a` rises to one
 * half with the number of captures; o shrinks to 0 for few people.
 *
 * An attacker may enrol crafted templates in order to change the scores of other people. The
 * statistics limit what one person can change. The offset o is the median over the people plus the
 * mean of their deviations from it, each of which is limited (site.c). The variance along a
 * direction of W_site is a mean that leaves out the people who vary most (site_spread.c). A score
 * is the lowest one of several, each of which leaves out some people (iso_site_score).
 *
 * The statistics are computed in two passes over the same people: iso_site_add() for each of them,
 * iso_site_find_directions(), then iso_site_review() for each of them. The result is the same to
 * the bit in every order of the people.
 *
 * Biometric data of the site: the caller keeps it as safe as templates. One thread uses an object.
 */
#ifndef ISO_CORE_MATCH_SITE_H
#define ISO_CORE_MATCH_SITE_H

#include <stdint.h>

#include "core/match/metric_vector.h"
#include "isotherm/metric.h"

enum {
    ISO_SITE_CAPTURES = 64, /* most captures of one person that are used */
    ISO_SITE_OWN_MAX = 64, /* with more people, each has so small a share in the offset that a score
                              does not leave it out */
};

struct iso_site;

/* The people so far, in numbers. */
struct iso_site_summary {
    int people;      /* people who were added */
    int taught;      /* people of these with at least two captures */
    double offset;   /* length of o, in standard deviations of a rendered person; 0 for nobody */
    double expected; /* about the length that o would have if the people were rendered ones */
    double growth;   /* variance within a person as a multiple of the rendered one; 0: not known */
    double share;    /* a, 0..0.5 */
};

/* Makes statistics of nobody for vectors of this metric, which is not kept. -ENOMEM. */
int iso_site_new(const struct iso_metric *metric, struct iso_site **out)
    __attribute__((warn_unused_result));

/* Wipes and frees the statistics. NULL is accepted. */
void iso_site_free(struct iso_site *site);

/* First pass: adds a person with n captures, each the vector of one template by the metric of
 * iso_site_new(). `number` is the caller's number of the person; no two people have the same.
 * Only the first ISO_SITE_CAPTURES captures are used. Returns -EINVAL if n is less than 1, if the
 * mean of the captures is not finite, or if iso_site_find_directions() was called before; -ENOMEM.
 * After an error the statistics are as they were. */
int iso_site_add(struct iso_site *site, int64_t number, const struct iso_metric_vector *captures,
                 int n) __attribute__((warn_unused_result));

/* Ends the first pass: computes the offset, and the directions in which the people vary. Returns
 * -EINVAL if the first pass has ended before, -EDOM if the decomposition fails, -ENOMEM. Takes
 * about 10 ms. */
int iso_site_find_directions(struct iso_site *site) __attribute__((warn_unused_result));

/* Second pass: measures how much a person varies along each direction. The caller passes every
 * person of the first pass once, with the same captures. Returns -EINVAL if n is less than 1, if
 * iso_site_find_directions() was not called, if the mean of the captures is not finite, or if there
 * are more people, or more people with several captures, than in the first pass; -ENOMEM. */
int iso_site_review(struct iso_site *site, const struct iso_metric_vector *captures, int n)
    __attribute__((warn_unused_result));

/* Describes the statistics after both passes. */
struct iso_site_summary iso_site_summary(const struct iso_site *site);

/* A metric that is adapted to a site. The structure owns the memory of its members. */
struct iso_site_metric {
    struct iso_metric *metric;
    int n;       /* numbers of a vector */
    int people;  /* of the site */
    float *turn; /* [n][n]: number k of an adapted vector is the sum of number d times turn[d][k] */
    float *offset;                  /* [n]: o in the adapted coordinates */
    struct iso_metric_steps *steps; /* of the adapted metric (metric_vector.h) */
    int n_own;                      /* people whose share in o is known: all, except those whom
                                       iso_site_metric_forget() removed; none in large sites */
    int64_t *number;                /* [n_own]: their numbers, rising */
    float *own; /* [n_own][n]: a person's mean, as it counts in o, in the adapted coordinates */
};

/* Makes the adapted metric after both passes; the caller frees it with iso_site_metric_free().
 * `metric` is the one of iso_site_new(). Without people the result is the shipped metric, up to
 * rounding. -EINVAL for a metric of another shape, or if not everybody was reviewed; -EDOM if the
 * decomposition fails, -ENOMEM; then *out is all zero. About 10 ms. */
int iso_site_adapt(const struct iso_site *site, const struct iso_metric *metric,
                   struct iso_site_metric *out) __attribute__((warn_unused_result));

/* Wipes and frees an adapted metric, which may be all zero. */
void iso_site_metric_free(struct iso_site_metric *adapted);

/* Wipes and removes a person's share in the offset from the list of shares. The offset itself, to
 * which this person has contributed, changes only when the metric is adapted anew. Nothing happens
 * if the list has no share of this person. */
void iso_site_metric_forget(struct iso_site_metric *adapted, int64_t number);

/* Converts the vector of a template by the shipped metric to its vector by the adapted metric. Up
 * to rounding, iso_metric_project() computes the same vector from the template, but takes longer.
 */
void iso_site_turn(const struct iso_site_metric *adapted, const struct iso_metric_vector *one,
                   struct iso_metric_vector *out);

/* Computes the score of a probe and a person of the site. It differs from iso_metric_score() in two
 * ways:
 *
 * - The offset is computed without the face of this person. If there are n people, each of them
 *   contributes about 1/n to the offset. If this person's face were part of the offset, the score
 *   would ignore that part of the face.
 * - The people are divided into four groups. The score is computed four times, and each time one
 *   group is left out of the offset. The lowest of the four scores is the result. This limits an
 *   attacker who enrols crafted templates in order to change the offset: the attacker's templates
 *   are left out of one of the four scores.
 *
 * `number` is the one of iso_site_add(); it may be that of nobody. `person` and `probe` are vectors
 * by the adapted metric. If `adapted` has no own shares, this is iso_metric_score(). Returns
 * -INFINITY for a person without templates, or if the numbers are not finite. Takes some ten
 * microseconds. */
double iso_site_score(const struct iso_site_metric *adapted, int64_t number,
                      const struct iso_metric_vector *person,
                      const struct iso_metric_vector *probe);

#endif

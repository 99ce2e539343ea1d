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
 * Somebody who enrols crafted templates should not move the scores of others. So the statistics
 * count what people have in common, and not what one of them shows alone (site.c, site_spread.c,
 * iso_site_score): o is a median over people, with the mean of small deviations from it; and a
 * direction of W_site counts as far as several people vary along it.
 *
 * The statistics are computed in two passes over the same people: iso_site_add() for each of them,
 * iso_site_find_directions(), then iso_site_review() for each of them. The order of people does not
 * matter, to the bit.
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
    ISO_SITE_OWN_MAX = 64,  /* in sites of more people, the share of one in the offset is so small
                               that it is not left out of a score */
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
 * Captures beyond ISO_SITE_CAPTURES are not used. -EINVAL without a capture, for a number that is
 * not finite, or after iso_site_find_directions(); -ENOMEM. After an error nothing has changed. */
int iso_site_add(struct iso_site *site, int64_t number, const struct iso_metric_vector *captures,
                 int n) __attribute__((warn_unused_result));

/* Ends the first pass: computes the offset, and the directions in which the people vary.  -EDOM if
 * the decomposition fails, -ENOMEM. About 10 ms. */
int iso_site_find_directions(struct iso_site *site) __attribute__((warn_unused_result));

/* Second pass: measures how much a person varies along each direction. Everybody who was added is
 * reviewed once, with the same captures. -EINVAL before iso_site_find_directions(), or if all were
 * reviewed; -ENOMEM. */
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
    int n_own;                      /* people with an own share: all who are left, or none */
    int64_t *number;                /* [n_own]: rising */
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

/* Removes and wipes a person's own share. The offset still contains it, among the others', until
 * the metric is adapted anew. Nothing happens for a person without one. */
void iso_site_metric_forget(struct iso_site_metric *adapted, int64_t number);

/* Converts the vector of a template by the shipped metric to its vector by the adapted metric. Up
 * to rounding, iso_metric_project() computes the same vector from the template, but takes longer.
 */
void iso_site_turn(const struct iso_site_metric *adapted, const struct iso_metric_vector *one,
                   struct iso_metric_vector *out);

/* Computes the score of a probe and a person of the site. It differs from iso_metric_score() in two
 * ways. It leaves out the person's own share of the offset: each of n people adds an n-th of the
 * own face to the offset, and without this correction that part would count as common to everybody.
 * And it is the least score without one more of four groups of people, so that somebody who enrols
 * crafted templates to turn the offset towards the difference of two people gains little.
 *
 * `number` is the one of iso_site_add(); it may be that of nobody. `person` and `probe` are vectors
 * by the adapted metric. If `adapted` has no own shares, this is iso_metric_score(). Returns
 * -INFINITY for a person without templates, or if the numbers are not finite. Takes some ten
 * microseconds. */
double iso_site_score(const struct iso_site_metric *adapted, int64_t number,
                      const struct iso_metric_vector *person,
                      const struct iso_metric_vector *probe);

#endif

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
 * The weight of one person is limited, and so is what one capture adds, so that one person cannot
 * move the metric beyond a bound (site.c). The sums are whole numbers: people may be added and
 * removed in any order with the same result to the bit, and a removed person leaves nothing.
 * Biometric data of the site: the caller keeps it as safe as templates. One thread uses an object.
 */
#ifndef ISO_CORE_MATCH_SITE_H
#define ISO_CORE_MATCH_SITE_H

#include "core/match/metric_vector.h"
#include "isotherm/metric.h"

/* Most captures of one person that are used. */
enum { ISO_SITE_CAPTURES = 64 };

/* The squared length of a person's mean, by the variances between people and one capture, is
 * limited to this number a dimension, where 1 is expected of a rendered person. The longest of 362
 * real captures has 3.8. */
#define ISO_SITE_LENGTH_LIMIT 6.0

struct iso_site;

/* The people so far, in numbers. */
struct iso_site_summary {
    int people;      /* people who were added */
    int taught;      /* people of these with at least two captures */
    double offset;   /* length of o, in standard deviations of a rendered person; 0 for nobody */
    double expected; /* the length that o would have if the people were rendered ones */
    double growth;   /* variance within a person as a multiple of the rendered one; 0: not known */
    double share;    /* a, 0..0.5 */
};

/* Makes statistics of nobody for vectors of this metric, which is not kept. -ENOMEM. */
int iso_site_new(const struct iso_metric *metric, struct iso_site **out)
    __attribute__((warn_unused_result));

/* Wipes and frees the statistics. NULL is accepted. */
void iso_site_free(struct iso_site *site);

/* Adds a person with n captures, each the vector of one template by the metric of iso_site_new().
 * Captures beyond ISO_SITE_CAPTURES are not used. -EINVAL without a capture or for a number that is
 * not finite. */
int iso_site_add(struct iso_site *site, const struct iso_metric_vector *captures, int n)
    __attribute__((warn_unused_result));

/* Removes a person who was added with the same captures. The errors of iso_site_add, and -EINVAL if
 * nobody is left to remove. */
int iso_site_remove(struct iso_site *site, const struct iso_metric_vector *captures, int n)
    __attribute__((warn_unused_result));

/* Describes the statistics. */
struct iso_site_summary iso_site_summary(const struct iso_site *site);

/* A metric that is adapted to a site. The structure owns the memory of its members. */
struct iso_site_metric {
    struct iso_metric *metric;
    int n;       /* numbers of a vector */
    int people;  /* of the site */
    float *turn; /* [n][n]: number k of an adapted vector is the sum of number d times turn[d][k] */
    float *offset;                  /* [n]: o in the adapted coordinates */
    struct iso_metric_steps *steps; /* of the adapted metric (metric_vector.h) */
};

/* Makes the adapted metric; the caller frees it with iso_site_metric_free(). `metric` is the one of
 * iso_site_new(). Without people the result is the shipped metric, up to rounding. -EINVAL for a
 * metric of another shape, -EDOM if the decomposition fails, -ENOMEM; then *out is all zero. About
 * 10 ms. */
int iso_site_adapt(const struct iso_site *site, const struct iso_metric *metric,
                   struct iso_site_metric *out) __attribute__((warn_unused_result));

/* Wipes and frees an adapted metric, which may be all zero. */
void iso_site_metric_free(struct iso_site_metric *adapted);

/* Converts the vector of a template by the shipped metric to its vector by the adapted metric. Up
 * to rounding, iso_metric_project() computes the same vector from the template, but takes longer.
 */
void iso_site_turn(const struct iso_site_metric *adapted, const struct iso_metric_vector *one,
                   struct iso_metric_vector *out);

/* Computes the score of a probe and a person of the site. It differs from iso_metric_score(): it
 * leaves out the person's own share of the offset. Each of n people adds an n-th of the own face to
 * the offset, and without this correction that part would count as common to everybody.
 *
 * `person` and `probe` are vectors by the adapted metric. `person` contains all vectors with which
 * the person was added to the site. Returns -INFINITY for a person without templates. Takes about
 * ten microseconds. */
double iso_site_score(const struct iso_site_metric *adapted, const struct iso_metric_vector *person,
                      const struct iso_metric_vector *probe);

#endif

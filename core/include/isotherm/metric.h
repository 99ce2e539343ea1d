/* The learned metric: how likely it is that templates are of one person.
 *
 *   template -> curves of some landmarks, registered to the mean curves, and heights of the upper
 *   face -> residuals -> linear projection -> a vector of some 150 numbers and how noisy it is, of
 *   normal length -> log likelihood ratio in closed form
 *
 * The projection is learned (isotherm-sim train metric) so that within a person the vector's
 * numbers are independent with variance 1, and between people independent with variances `between`:
 * the two-covariance model of probabilistic linear discriminant analysis (Ioffe 2006; Prince and
 * Elder 2007; Bruemmer and de Villiers 2010). What moves with expression, pose or noise then counts
 * little and what tells people apart much.
 *
 * How noisy a template is depends on the sensor and grows with the square of the distance; a vector
 * says so itself, since people hardly differ in many of its numbers: the variance within a person
 * is the one with which the vector is likeliest (some 0.2 of the average template's near a fine
 * sensor, 2 to 3 of them at a metre). A noisy template moves scores less, and what several know of
 * a person is weighed. Vectors are what a search compares; templates are what is kept, so that a
 * better metric needs no new enrolment.
 *
 * A score is the log likelihood ratio, scaled so that a score of s or more is as rare as 10^-s
 * among the tenth of all strangers who are most alike, and ten times rarer among all: calibrated on
 * people that the projection was not learned from, before several sensors (what it comes to on
 * others: sim/results/scores.md). One threshold is then one false match rate. The few candidates
 * that a search leaves are looked at again: rerank.h. */
#ifndef ISOTHERM_METRIC_H
#define ISOTHERM_METRIC_H

#include "isotherm/template.h"

enum {
    ISO_METRIC_DIMENSIONS_MAX = 160,
    ISO_METRIC_ORIGINS_MAX = 16,
    ISO_METRIC_ORIGIN_MAX = 64,
    ISO_METRIC_VALUES_MAX = ISO_TEMPLATE_RADII_MAX * ISO_LANDMARKS * ISO_TEMPLATE_POINTS_MAX * 3 +
                            ISO_UPPER_NODES,
    /* The weight of a vector is known to half an octave: of one template, of those of a person. */
    ISO_METRIC_STEP_MIN = -10,
    ISO_METRIC_STEP_ONE_MAX = 10,
    ISO_METRIC_STEP_MAX = 18,
    ISO_METRIC_STEPS = ISO_METRIC_STEP_MAX - ISO_METRIC_STEP_MIN + 1,
    ISO_METRIC_BYTES_MAX = 2 * 1024 * 1024,
};

/* How a fused score (rerank.h) comes from the metric's and the misfit of the upper faces. */
struct iso_rerank_weights {
    float metric; /* times the metric's score, >= 0 */
    float upper;  /* times the misfit's -ln(rms / 1 mm), >= 0 */
    float bias;
};

struct iso_metric {
    uint32_t algorithm; /* of the templates that it compares */
    uint32_t landmarks; /* bit l: the curves of landmark l are used */
    int n_radii, n_points, n_dimensions;
    float weight_min;                 /* points that weigh less count as the mean curve's */
    float gain, bias;                 /* score = gain * natural log likelihood ratio + bias */
    struct iso_rerank_weights rerank; /* all zero: scores are not fused */
    int n_origins;                    /* corpora it was learned from ... */
    char origin[ISO_METRIC_ORIGINS_MAX][ISO_METRIC_ORIGIN_MAX]; /* ... "POPULATION-SEED" */
    int n_nodes;                    /* of the upper face (upper_face.h) that are used ... */
    uint16_t node[ISO_UPPER_NODES]; /* ... row * ISO_UPPER_COLUMNS + column, rising */
    int n_curve_values;             /* 3 * points of all curves that are used */
    int n_values;                   /* and n_nodes */
    float *curve_mm;                /* [n_curve_values] mean curves: radius, landmark, point, xyz */
    float *upper_mm;                /* [n_nodes] mean heights, right behind them */
    float *between;                 /* [n_dimensions] variances, falling; within a person 1 */
    float *centre;                  /* [n_dimensions] subtracted after the projection */
    float *axis;                    /* [n_values][n_dimensions] the projection */
};

/* A template as the metric sees it; or several of one person together. Biometric. */
struct iso_metric_vector {
    int n;        /* templates in it; 0: none yet */
    float weight; /* in average templates: 1 / the variance of the mean within a person */
    int step;     /* the weight as scores see it, 2^(step / 2) */
    float scale;  /* makes the mean as long as is expected of it */
    float mean[ISO_METRIC_DIMENSIONS_MAX];
};

/* Arrays of zeros for these sizes (landmarks, n_radii, n_points, n_nodes and node, n_dimensions of
 * `shape`; the rest of it is copied too). -EINVAL for sizes out of range, -ENOMEM. */
int iso_metric_new(const struct iso_metric *shape, struct iso_metric **out)
    __attribute__((warn_unused_result));
void iso_metric_free(struct iso_metric *metric);

/* File, little endian: char magic[8] = "ISOMETR3"; uint32 bytes of the file; uint32 crc32 of all
 * that follows it; uint32 algorithm, landmarks; uint16 n_radii, n_points, n_dimensions, n_origins,
 * n_nodes; float weight_min, gain, bias; float rerank.metric, upper, bias; the origins, 64 bytes
 * each; uint16 node; float curve_mm, upper_mm, between, centre; then for each dimension a float,
 * its step, and n_values int16: axis = step * number. -EBADMSG with *fault (if not NULL) a static
 * text if damaged; -ENOMEM. */
int iso_metric_parse(const void *bytes, size_t size, struct iso_metric **out, const char **fault)
    __attribute__((warn_unused_result));

/* The file's bytes in a buffer that the caller frees with free(). -EINVAL if numbers are not
 * finite or the file would be larger than ISO_METRIC_BYTES_MAX; -ENOMEM. */
int iso_metric_serialise(const struct iso_metric *metric, void **bytes, size_t *size)
    __attribute__((warn_unused_result));

/* What is left of the curves once they are registered to the mean curves, mm: the closest rigid
 * motion by weight, then differences; 0 where a point is missing. Behind them the upper face's
 * heights less the mean ones, in the face frame, filled-in ones too; 0 where there is none. -EINVAL
 * for a template of another algorithm or shape; -ENODATA if fewer than 30 % of the points are
 * there. */
int iso_metric_residuals(const struct iso_metric *metric, const struct iso_template *tmpl,
                         float *residual_mm) __attribute__((warn_unused_result));

/* The variance within a person of a vector's mean, in shares of an average template's: 1 / weight,
 * to half an octave. */
double iso_metric_variance(int step);

/* The vector of one template; errors of iso_metric_residuals. */
int iso_metric_project(const struct iso_metric *metric, const struct iso_template *tmpl,
                       struct iso_metric_vector *out) __attribute__((warn_unused_result));

/* Takes others of the same person in, each by its weight. */
void iso_metric_vector_add(const struct iso_metric *metric, const struct iso_metric_vector *one,
                           struct iso_metric_vector *all);

/* Whether the probe is of the person that was enrolled with all these templates: the predictive
 * density given them against that of people at large. -INFINITY for a person without any. */
double iso_metric_score(const struct iso_metric *metric, const struct iso_metric_vector *person,
                        const struct iso_metric_vector *probe);

#endif

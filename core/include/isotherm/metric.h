/** @file
 * The learned metric: how likely two templates are of one person.
 *
 * A template's curves are registered to mean curves by the closest rigid motion. The remaining
 * differences, and those of the upper face, are projected to a vector of at most
 * ISO_METRIC_DIMENSIONS_MAX numbers. The projection makes the numbers independent within a person,
 * with variance 1, and between people, with the variances `between`: the two-covariance model of
 * probabilistic linear discriminant analysis (Ioffe 2006; Prince and Elder 2007; Bruemmer and de
 * Villiers 2010). Differences by expression, pose or noise then count little, and differences
 * between people count much.
 *
 * The noise of a template depends on the sensor and grows with the square of the distance. It is
 * estimated from the vector, because people hardly differ in many of its numbers: the variance
 * within a person is the one for which the vector is most likely. A noisy template moves scores
 * less. A search compares vectors. Templates are what is stored, so that a better metric needs no
 * new enrolment.
 *
 * A score is the log likelihood ratio, scaled so that a score of s or more is as rare as 10^-s
 * among the tenth of all strangers who are most alike, and ten times rarer among all strangers. It
 * is calibrated on rendered people that the projection was not learned from, before several
 * sensors. */
#ifndef ISOTHERM_METRIC_H
#define ISOTHERM_METRIC_H

#include "isotherm/fault.h"
#include "isotherm/template.h"

enum {
    ISO_METRIC_DIMENSIONS_MAX = 160, /**< Most numbers of a vector. */
    ISO_METRIC_ORIGINS_MAX = 16,     /**< Most corpora that a metric names. */
    ISO_METRIC_ORIGIN_MAX = 64,      /**< Bytes of the name of a corpus, with its end. */
    /** Most values that are left of a template before the projection. */
    ISO_METRIC_VALUES_MAX = ISO_TEMPLATE_RADII_MAX * ISO_LANDMARKS * ISO_TEMPLATE_POINTS_MAX * 3 +
                            ISO_UPPER_NODES,
    ISO_METRIC_STEP_MIN = -10,    /**< Least step of a weight; a step is half an octave. */
    ISO_METRIC_STEP_ONE_MAX = 10, /**< Largest step of the weight of one template. */
    ISO_METRIC_STEP_MAX = 18,     /**< Largest step of the weight of a person's templates. */
    ISO_METRIC_STEPS = ISO_METRIC_STEP_MAX - ISO_METRIC_STEP_MIN + 1, /**< How many steps. */
    ISO_METRIC_BYTES_MAX = 2 * 1024 * 1024, /**< Largest file of a metric, bytes. */
};

/** How the appliance fuses the metric's score with the misfit of the upper faces. */
struct iso_rerank_weights {
    float metric; /**< Factor of the metric's score, at least 0. */
    float upper;  /**< Factor of -ln(rms / 1 mm) of the misfit, at least 0. */
    float bias;   /**< Added to the sum. */
};

/** A metric. iso_metric_new() and iso_metric_parse() make one, which owns its arrays. */
struct iso_metric {
    uint32_t algorithm; /**< Algorithm of the templates that it compares. */
    uint32_t landmarks; /**< Bit l: the curves of landmark l are used. */
    int n_radii;        /**< Isotherms of a landmark. */
    int n_points;       /**< Points of an isotherm. */
    int n_dimensions;   /**< Numbers of a vector. */
    float weight_min;   /**< A point that weighs less is missing; its residual is 0. */
    float gain;         /**< score = gain * natural log likelihood ratio + bias. */
    float bias;         /**< See gain. */
    struct iso_rerank_weights rerank; /**< All zero: scores are not fused. */
    int n_origins;                    /**< Corpora that it was learned from. */
    char origin[ISO_METRIC_ORIGINS_MAX][ISO_METRIC_ORIGIN_MAX]; /**< "POPULATION-SEED" of each. */
    int n_nodes;                    /**< Nodes of the upper face that are used. */
    uint16_t node[ISO_UPPER_NODES]; /**< [n_nodes]: row * ISO_UPPER_COLUMNS + column, rising. */
    int n_curve_values;             /**< 3 * points of all curves that are used. */
    int n_values;                   /**< n_curve_values + n_nodes. */
    float *curve_mm; /**< [n_curve_values]: mean curves by radius, landmark, point, xyz, mm. */
    float *upper_mm; /**< [n_nodes]: mean heights, right behind the curves, mm. */
    float *between;  /**< [n_dimensions]: variances between people, falling. */
    float *centre;   /**< [n_dimensions]: subtracted after the projection. */
    float *axis;     /**< [n_values][n_dimensions]: the projection. */
};

/** A template as the metric sees it, or several templates of one person together. A plain value.
 * Biometric. */
struct iso_metric_vector {
    int n;        /**< Templates in it; 0: none yet. */
    float weight; /**< In average templates: 1 / the variance of the mean within a person. */
    int step;     /**< The weight as scores see it: 2^(step / 2). */
    float scale;  /**< Factor that gives the mean its expected length. */
    float mean[ISO_METRIC_DIMENSIONS_MAX]; /**< [n_dimensions]: the mean of the templates. */
};

/** Makes a metric with arrays of zeros.
 *
 * @param shape  The sizes: landmarks, n_radii, n_points, n_nodes and node, n_dimensions, n_origins.
 *               The other members are copied as well, except the arrays.
 * @param out    Receives the metric; free it with iso_metric_free().
 * @return 0; -EINVAL for sizes out of range; -ENOMEM. */
int iso_metric_new(const struct iso_metric *shape, struct iso_metric **out)
    __attribute__((warn_unused_result));

/** Frees a metric.
 *
 * @param metric  The metric, or NULL. */
void iso_metric_free(struct iso_metric *metric);

/** Reads the bytes of a metric's file.
 *
 * Little endian: char magic[8] = "ISOMETR3"; uint32 bytes of the file; uint32 crc32 of all that
 * follows it; uint32 algorithm, landmarks; uint16 n_radii, n_points, n_dimensions, n_origins,
 * n_nodes; float weight_min, gain, bias; float rerank.metric, upper, bias; the origins, 64 bytes
 * each; uint16 node; float curve_mm, upper_mm, between, centre; then for each dimension a float,
 * its step, and n_values int16: axis = step * number.
 *
 * @param bytes  The file; it may be freed afterwards.
 * @param size   Its size, bytes.
 * @param out    Receives the metric; free it with iso_metric_free().
 * @param fault  If not NULL: on failure, receives a text that says what is wrong.
 * @return 0; -EBADMSG if the file is damaged; -ENOMEM. */
int iso_metric_parse(const void *bytes, size_t size, struct iso_metric **out,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

/** Writes the bytes of a metric's file.
 *
 * @param metric  The metric.
 * @param bytes   Receives a buffer that the caller frees with free().
 * @param size    Receives its size, bytes.
 * @return 0; -EINVAL if a size or a number is out of range, or if the file would be larger than
 *         ISO_METRIC_BYTES_MAX; -ENOMEM. */
int iso_metric_serialise(const struct iso_metric *metric, void **bytes, size_t *size)
    __attribute__((warn_unused_result));

/** The differences between a template and the mean: those of its curves after their registration to
 * the mean curves, and those of the heights of its upper face.
 *
 * @param metric       The metric.
 * @param tmpl         The template.
 * @param residual_mm  [n_values]: receives the differences, mm; 0 for a point that is missing and
 *                     for a node without a surface. Filled-in nodes count like measured ones.
 * @return 0; -EINVAL for a template of another algorithm or shape; -ENODATA if fewer than 30 % of
 *         the points, or fewer than 3 points, have at least the weight weight_min. */
int iso_metric_residuals(const struct iso_metric *metric, const struct iso_template *tmpl,
                         float *residual_mm) __attribute__((warn_unused_result));

/** The variance within a person of a vector's mean, as a multiple of an average template's.
 *
 * @param step  The step of the vector.
 * @return 1 / weight, to half an octave. */
double iso_metric_variance(int step);

/** The vector of one template.
 *
 * @param metric  The metric.
 * @param tmpl    The template.
 * @param out     Receives the vector.
 * @return As iso_metric_residuals(). */
int iso_metric_project(const struct iso_metric *metric, const struct iso_template *tmpl,
                       struct iso_metric_vector *out) __attribute__((warn_unused_result));

/** Adds templates to those of the same person, each by its weight.
 *
 * @param metric  The metric.
 * @param one     The vector of the templates that are added.
 * @param all     The vector of the person, which is changed; with n of 0 it has no template yet. */
void iso_metric_vector_add(const struct iso_metric *metric, const struct iso_metric_vector *one,
                           struct iso_metric_vector *all);

/** Whether a probe is of a person: the density of the probe given the person's templates, compared
 * with its density among people at large.
 *
 * @param metric  The metric.
 * @param person  The vector of all templates of the person.
 * @param probe   The vector of the probe.
 * @return The score; -INFINITY for a person without templates. */
double iso_metric_score(const struct iso_metric *metric, const struct iso_metric_vector *person,
                        const struct iso_metric_vector *probe);

#endif

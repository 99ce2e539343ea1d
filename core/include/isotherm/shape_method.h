/** @file
 * Descriptors of non-rigid shapes by name: the table that an evaluation runs through.
 *
 * A shape becomes a feature vector in two steps, since some methods learn from a corpus (without
 * labels) what a vector means:
 *
 *     shape --describe--> description --code--> feature          (coder: learnt from descriptions)
 *
 * All features of one coder have one layout. Its parts are what the classifier RCR codes apart
 * (classifier.h); other classifiers see one vector. */
#ifndef ISOTHERM_SHAPE_METHOD_H
#define ISOTHERM_SHAPE_METHOD_H

#include <stdbool.h>

#include "isotherm/shape.h"

enum {
    ISO_SHAPE_PARTS_MAX = 8,           /**< Most parts of a description or feature. */
    ISO_SHAPE_BAGS_MAX = ISO_CHANNELS, /**< Most bags of a description. */
};

/** The description of a shape. It owns its arrays. Its sizes, except n_points, belong to the method
 * and are the same for all shapes. */
struct iso_shape_description {
    int32_t n_bags;   /**< Of methods with bags: bags (colour channels); else 0. */
    int32_t n_points; /**< Of methods with bags: vertices of the shape. */
    int32_t n_values; /**< Of methods with bags: values of a vertex. */
    float *local;     /**< [n_bags][n_points][n_values]. */
    float *weight;    /**< [n_points]: share of the area, sum 1. */
    int32_t n_parts;  /**< Parts of the description of the shape as a whole. */
    int32_t part_size[ISO_SHAPE_PARTS_MAX]; /**< [n_parts]: values of each part. */
    float *whole;                           /**< [sum of part_size]: parts one after another. */
};

/** How a description becomes a feature. */
enum iso_shape_coding {
    ISO_CODING_PLAIN,   /**< The parts as they are. */
    ISO_CODING_REDUCED, /**< The first part by its principal components, others as they are. */
    ISO_CODING_BAGS,    /**< Words of a vocabulary for each bag, then the parts. */
};

/** A norm of differences. */
enum iso_norm {
    ISO_NORM_L1, /**< Sum of magnitudes. */
    ISO_NORM_L2, /**< Euclidean length. */
    /** For features of local heat only: for each point of the first shape the least difference to a
     * point of the second, bounded by 0.2, on average. Parts may be missing from the first shape,
     * not from the second. */
    ISO_NORM_PARTIAL,
};

enum {
    ISO_DESCRIBE_TIMES_MIN = 40,   /**< Fewest times of heat of a description. */
    ISO_DESCRIBE_TIMES_MAX = 1000, /**< Most times of heat of a description. */
};

/** The times at which a description looks at heat, evenly spaced on a logarithmic scale. */
struct iso_describe_times {
    int32_t n;    /**< How many; 0: as many as the method has. */
    double first; /**< The first one, in areas of the shape; 0: that of the method. */
    double last;  /**< The last one, above the first; 0: that of the method. */
};

/** A method of describing shapes. */
struct iso_shape_method {
    const char *name;             /**< As on a command line: "cp-hk". */
    const char *title;            /**< As in a table: "CP-HK". */
    const char *source;           /**< Author, year, section. */
    bool colour;                  /**< It needs a shape with colours. */
    enum iso_shape_coding coding; /**< How its descriptions become features. */
    int32_t size;       /**< Default: principal components, or words of each vocabulary; or 0. */
    enum iso_norm norm; /**< The norm by which nearest neighbours are best looked for. */
    const char *classifier; /**< What the dissertation classifies it by: a name of classifier.h. */
    /** Leading parts that a description keeps of what `describe` makes; 0: all. Methods with the
     * same `describe` share its result. */
    int32_t kept_parts;
    /** The method's own times; all 0 if it has none that can be chosen. The heat mean signature of
     * td and srcp-td-one always has the time 1 / 64. */
    struct iso_describe_times times;
    /** Describes a shape; call iso_shape_describe() instead. */
    int (*describe)(const struct iso_shape *shape, const struct iso_describe_times *times,
                    struct iso_shape_description *out);
};

/** All methods; the table ends with NULL:
 *
 *     shape-dna     15 normalised eigenvalues
 *     td            temperature distribution: histogram of the heat mean signature
 *     cp-td         heat from critical points: histograms at 100 times, normalised eigenvalues
 *     srcp-td       the same, reduced to 64 principal components
 *     srcp-td-one   the same from one point, the minimum of the heat mean signature
 *     cp-hk         scale-invariant heat from critical points: 6 histograms, how many points there
 *                   are, normalised eigenvalues
 *     cp-hk-plain   cp-hk without the eigenvalues
 *     shape-google  bag of features over SI-HKS
 *     local-heat    heat at short times at 400 points, for shapes of which a part is missing
 *     w-hks1        bags of features over scale-invariant weighted signatures of three channels
 *     w-hks2        the same and a histogram of colours
 *     si-hk-colour  bag of features over scale-invariant signatures and a histogram of colours (A2
 *                   of SHREC'13, with which chapter 5 compares its methods)
 */
extern const struct iso_shape_method *const iso_shape_methods[];

/** Finds a method by its name.
 *
 * @param name  The name, such as "cp-hk".
 * @return The method, a constant; NULL if there is none of that name. */
const struct iso_shape_method *iso_shape_method_find(const char *name);

/** Describes a shape. Any number of threads may call this at once.
 *
 * @param method  The method.
 * @param shape   The shape.
 * @param out     Receives the description; free it with iso_shape_description_free().
 * @return 0; -ENODATA if the method needs colours and there are none; -ENOMEM. */
int iso_shape_describe(const struct iso_shape_method *method, const struct iso_shape *shape,
                       struct iso_shape_description **out) __attribute__((warn_unused_result));

/** The times that a method uses if some are chosen.
 *
 * @param method  The method.
 * @param chosen  What is chosen; each 0 is replaced by the method's own value. NULL: nothing.
 * @param times   Receives the times; all 0 for a method without times that can be chosen.
 * @return 0; -EINVAL if the number is outside ISO_DESCRIBE_TIMES_MIN..ISO_DESCRIBE_TIMES_MAX, if a
 *         time is not above 0 or not finite, or if the last one is not above the first one. */
int iso_shape_method_times(const struct iso_shape_method *method,
                           const struct iso_describe_times *chosen,
                           struct iso_describe_times *times) __attribute__((warn_unused_result));

/** Describes a shape, as iso_shape_describe(), by heat at other times. Descriptions of different
 * times cannot be compared, even where their sizes are the same.
 *
 * @param method  The method.
 * @param shape   The shape.
 * @param chosen  As for iso_shape_method_times().
 * @param out     Receives the description; free it with iso_shape_description_free().
 * @return As iso_shape_describe(); -EINVAL from iso_shape_method_times(). */
int iso_shape_describe_at(const struct iso_shape_method *method, const struct iso_shape *shape,
                          const struct iso_describe_times *chosen,
                          struct iso_shape_description **out) __attribute__((warn_unused_result));

/** Frees a description.
 *
 * @param description  The description, or NULL. */
void iso_shape_description_free(struct iso_shape_description *description);

/** How a feature vector is laid out. */
struct iso_feature_layout {
    int32_t size;                           /**< Values of a feature. */
    int32_t n_parts;                        /**< Parts of a feature. */
    int32_t part_size[ISO_SHAPE_PARTS_MAX]; /**< [n_parts]: they follow each other; sum: size. */
    enum iso_norm norm; /**< The norm of the method, by which the classifier nn compares. */
};

/** Turns the descriptions of one method into features. */
struct iso_shape_coder;

/** Learns from the descriptions of a corpus by one method.
 *
 * @param method    The method.
 * @param training  [n]: descriptions of that method; what is needed of them is copied.
 * @param n         How many descriptions, at least 1.
 * @param size      Principal components, or words of a vocabulary; 0: the method's default. It is
 *                  cut to n for ISO_CODING_REDUCED.
 * @param seed      Starts the vocabularies.
 * @param out       Receives the coder; free it with iso_shape_coder_free().
 * @return 0; -EINVAL for descriptions of different sizes or n < 1; -EDOM if principal components
 *         cannot be found; -ENOMEM. */
int iso_shape_coder_new(const struct iso_shape_method *method,
                        const struct iso_shape_description *const *training, int32_t n,
                        int32_t size, uint64_t seed, struct iso_shape_coder **out)
    __attribute__((warn_unused_result));

/** Frees a coder.
 *
 * @param coder  The coder, or NULL. */
void iso_shape_coder_free(struct iso_shape_coder *coder);

/** The layout of a coder's features.
 *
 * @param coder  The coder.
 * @return The layout; it belongs to the coder. */
const struct iso_feature_layout *iso_shape_coder_layout(const struct iso_shape_coder *coder);

/** The feature of one description. Any number of threads may call this at once.
 *
 * @param coder        The coder.
 * @param description  A description of the coder's method.
 * @param feature      [size of the layout]: receives the feature.
 * @return 0; -EINVAL for a description of other sizes than those learnt from; -ENOMEM. */
int iso_shape_code(const struct iso_shape_coder *coder,
                   const struct iso_shape_description *description, float *feature)
    __attribute__((warn_unused_result));

#endif

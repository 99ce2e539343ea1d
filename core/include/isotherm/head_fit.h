/** @file
 * The fit of the head model to a frame, as far as a user sees it: its options, and which parts of
 * the face are covered.
 *
 * The fit estimates pose, identity and expression together: robust Gauss-Newton on point-to-plane
 * residuals, with the coefficients held by their prior N(0, 1) (Blanz and Vetter 1999; Amberg,
 * Knothe and Vetter 2008). */
#ifndef ISOTHERM_HEAD_FIT_H
#define ISOTHERM_HEAD_FIT_H

enum {
    ISO_SHAPE_FIT_JAWS_MAX = 3, /**< Largest number of starts of a fit. */
};

/** Options of the fit. Start from those of iso_extract_options_default(). */
struct iso_shape_fit_options {
    int rigid_iterations;          /**< Iterations of pose alone, 1..64. */
    int iterations;                /**< Iterations with identity and expression, 1..64. */
    int jaws;                      /**< Starts: 1 mouth shut, 2 also half open, 3 also wide open. */
    int vertices;                  /**< Vertices that are compared at most; 0: all of the face. */
    double cutoff_first_mm;        /**< Tukey's cut-off in the first iteration with modes, mm. */
    double cutoff_last_mm;         /**< Tukey's cut-off in the last iteration, mm. */
    double soft_weight;            /**< Weight of vertices that are not ISO_HEAD_RIGID, 0..1. */
    double identity_stiffness_mm2; /**< Weight of identity's prior beside a vertex's squared
                                        residual, mm^2. */
    double expression_stiffness_mm2; /**< The same for the expression, mm^2. */
};

/** A part of the face. */
enum iso_face_part {
    ISO_PART_BROW,  /**< The brow. */
    ISO_PART_EYES,  /**< Both eyes. */
    ISO_PART_NOSE,  /**< The nose. */
    ISO_PART_MOUTH, /**< The mouth. */
    ISO_PART_LEFT,  /**< The subject's left side, without nose and mouth. */
    ISO_PART_RIGHT, /**< The subject's right side, without nose and mouth. */
    ISO_FACE_PARTS  /**< How many there are. */
};

/** The name of a part of the face, such as "brow".
 *
 * @param part  The part.
 * @return A constant; NULL outside the range. */
const char *iso_face_part_name(enum iso_face_part part);

/** Which parts of a fitted face are covered: by a hand, hair, a scarf, or a hole in the frame. */
struct iso_occlusion {
    /** For each part the share of its vertices, 0..1, that the camera should see and does not:
     * something lies more than 10 mm before them, or nothing was measured. 0 for a part that is
     * turned away. */
    double covered[ISO_FACE_PARTS];
    /** How well the rest of the face fits, mm^2: the mean of min(r^2, 36) over the residuals r of
     * what is measured and bare. */
    double rest_mm2;
};

#endif

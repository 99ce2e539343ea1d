/** @file
 * From a depth frame to a template: every step of the library in the order the data flows.
 *
 *     frame -> face region -> clean -> head model fitted -> face patch (resampled in the face
 *     frame, holes filled on the residual) -> mesh -> heat of 12 landmarks -> isotherms -> template
 *
 * The method is that of M. Abdelrahman, "Geometric Modeling of Non-rigid 3D Shapes", dissertation,
 * University of Louisville, 2013, chapter 6.
 *
 * One extractor is one workspace: it is created once and used for frame after frame by one thread
 * at a time. It allocates no memory of its own after it is created (except with ISO_HEAT_SPECTRAL,
 * which is for comparison). */
#ifndef ISOTHERM_EXTRACT_H
#define ISOTHERM_EXTRACT_H

#include <stdbool.h>
#include <stdint.h>

#include "isotherm/capture.h"
#include "isotherm/frame.h"
#include "isotherm/head_fit.h"
#include "isotherm/head_model.h"
#include "isotherm/mesh.h"
#include "isotherm/template.h"

/** How the heat equation is solved. */
enum iso_heat_method {
    ISO_HEAT_GRID = 0, /**< Chebyshev expansion on the patch's grid; if that is too stiff, as
                            ISO_HEAT_DIRECT. */
    ISO_HEAT_DIRECT,   /**< On a mesh: factorisation and shift-invert Lanczos. */
    ISO_HEAT_SPECTRAL, /**< On a mesh: 100 eigenpairs, as in the dissertation. */
};

/** The name of a way to solve the heat equation: "grid", "direct" or "spectral".
 *
 * @param method  The method.
 * @return A constant; NULL outside the range. */
const char *iso_heat_method_name(enum iso_heat_method method);

/** A step of the extraction, for its time. */
enum iso_stage {
    ISO_STAGE_REGION,   /**< Where the face is in the frame. */
    ISO_STAGE_CLEAN,    /**< Outliers and small pieces are removed. */
    ISO_STAGE_FIT,      /**< The head model is fitted. */
    ISO_STAGE_PATCH,    /**< The surface is resampled in the face frame. */
    ISO_STAGE_MESH,     /**< The patch becomes a surface of triangles. */
    ISO_STAGE_HEAT,     /**< The heat of each landmark is computed. */
    ISO_STAGE_ISOTHERM, /**< The isotherms are traced and sampled. */
    ISO_STAGES          /**< How many there are. */
};

/** The name of a step, such as "region" or "clean".
 *
 * @param stage  The step.
 * @return A constant; NULL outside the range. */
const char *iso_stage_name(enum iso_stage stage);

/** Options of an extractor. Start from iso_extract_options_default(): templates of other options
 * than the default ones do not fit the trained metric. Where a description ends with a colon and a
 * value, this is the default. */
struct iso_extract_options {
    double t_mm2;                             /**< Time of the heat (heat_kernel.h), mm^2: 100. */
    int n_radii;                              /**< Radii that count, 1..ISO_TEMPLATE_RADII_MAX. */
    double radius_mm[ISO_TEMPLATE_RADII_MAX]; /**< Radii of the isotherms: 12, 20, 28, 36 mm. */
    int n_points;                             /**< Points of an isotherm: 16. */
    double crop_radius_mm;            /**< Radius of the face patch about the nose tip: 100 mm. */
    double spacing_mm;                /**< Distance of the face patch's grid points: 2 mm. */
    double smoothing_mm;              /**< Sigma of the filter of the residual: 3 mm. */
    double outlier_mm;                /**< Larger residuals are filled in: 20 mm. */
    struct iso_shape_fit_options fit; /**< The fit of the head model. */
    double distance_min_mm;    /**< Least distance of the nose tip from the sensor: 300 mm. */
    double distance_max_mm;    /**< Largest distance of the nose tip: 1500 mm. */
    double yaw_max_rad;        /**< Beyond it: "turn-left" and so on: 40 degrees. */
    double pitch_max_rad;      /**< Beyond it: "look-up" and so on: 40 degrees. */
    bool track;                /**< Start from the face of the previous frame, and search the
                                    whole frame only if it is lost: false. */
    enum iso_heat_method heat; /**< How the heat equation is solved: ISO_HEAT_GRID. */
    char sensor[ISO_TEMPLATE_SENSOR_MAX]; /**< Kind of sensor, written into templates: "". */
    int64_t (*now_ns)(void *context);     /**< Monotonic clock, nanoseconds, for the times of the
                                               stages; NULL: no times are taken. */
    void *now_context;                    /**< Passed to now_ns. */
};

/** The options that the appliance uses and the trained metric belongs to.
 *
 * @return The options. */
struct iso_extract_options iso_extract_options_default(void);

/** What an extraction gives. A plain value; it is large (some 36 kB). Biometric: wipe the template
 * with iso_template_wipe() when it is not needed any more. */
struct iso_extraction {
    enum iso_capture outcome; /**< What became of the frame; a template only with ISO_CAPTURE_OK. */
    enum iso_capture cue;     /**< The cue of a presentation attack (iso_capture_is_attack) that the
                                   attitude of a living head may have given as well: then `outcome` is
                                   the way to turn. Otherwise ISO_CAPTURE_NO_FACE. */
    struct iso_rigid camera_from_face; /**< Pose of the face; rough from the region on, good once
                                            `fitted`. */
    double yaw_rad;     /**< Turn of the head, radians; above 0: to the subject's left. */
    double pitch_rad;   /**< Nod of the head, radians; above 0: up. */
    double roll_rad;    /**< Tilt of the head, radians; above 0: to the subject's left shoulder. */
    double distance_mm; /**< Distance of the nose tip from the sensor along the axis, mm. */
    double residual_mm; /**< Root mean square of the fit's residuals, each limited to 6 mm. */
    bool fitted;        /**< Whether the head model was fitted. The members below, down to
                             expression_norm, have a meaning only then, whatever the outcome. */
    bool tracked;       /**< The face was found where the frame before had it. */
    struct iso_vec3 landmark_mm[ISO_LANDMARKS];  /**< The landmarks on the fitted head with its
                                                      expression, camera frame, mm. */
    struct iso_vec3 ibug_mm[ISO_LANDMARKS_IBUG]; /**< The same of the 68 points. */
    double sigma_mm[ISO_LANDMARKS]; /**< Standard deviation of each landmark's position, mm. */
    struct iso_occlusion occlusion; /**< What of the face is covered. */
    double fit_coverage;    /**< Share of the visible fitted face that was measured, 0..1. */
    double identity_norm;   /**< How unlike the mean head it is, in standard deviations. */
    double expression_norm; /**< How strong the expression is, in standard deviations. */
    double coverage;        /**< Measured share of the face patch, 0..1. */
    /** Where the heat was released, camera frame, mm: the points of the face patch at which the
     * landmarks of the head without its expression lie. Only with ISO_CAPTURE_OK and only from
     * iso_extractor_run(). */
    struct iso_vec3 source_mm[ISO_LANDMARKS];
    struct iso_template tmpl;     /**< The template; valid where source_mm is. */
    int64_t stage_ns[ISO_STAGES]; /**< Time of each step, ns; 0 without a clock. */
};

/** An extractor: the workspace of all steps. */
struct iso_extractor;

/** Makes an extractor.
 *
 * @param model    The head model; it is referenced, not copied, and has to outlive the extractor.
 * @param options  The options; they are copied.
 * @param out      Receives the extractor; free it with iso_extractor_free().
 * @return 0; -EINVAL for options out of range; -ENOMEM. */
int iso_extractor_new(const struct iso_head_model *model, const struct iso_extract_options *options,
                      struct iso_extractor **out) __attribute__((warn_unused_result));

/** Frees an extractor.
 *
 * @param extractor  The extractor, or NULL. */
void iso_extractor_free(struct iso_extractor *extractor);

/** Identifies everything that shapes a template: head model, radii, time and so on. Templates of
 * different algorithms cannot be compared.
 *
 * @param extractor  The extractor.
 * @return The number that its templates carry. */
uint32_t iso_extractor_algorithm(const struct iso_extractor *extractor);

/** Makes a template of a frame, or says why there is none.
 *
 * @param extractor  The extractor.
 * @param frame      The frame; it is not changed.
 * @param out        Receives the result, whatever its outcome.
 * @return 0 with *out written; -EINVAL for a frame that iso_frame_check() refuses or whose planes
 *         exceed 1920 x 1200; -EDOM, -ENOMEM from the solver of the heat equation. */
int iso_extractor_run(struct iso_extractor *extractor, const struct iso_frame *frame,
                      struct iso_extraction *out) __attribute__((warn_unused_result));

/** Finds the landmarks of a frame and decides whether it is usable, without a template: the steps
 * ISO_STAGE_REGION to ISO_STAGE_PATCH.
 *
 * @param extractor  The extractor.
 * @param frame      The frame; it is not changed.
 * @param out        Receives the result, without source_mm and template.
 * @return As iso_extractor_run(). */
int iso_extractor_locate(struct iso_extractor *extractor, const struct iso_frame *frame,
                         struct iso_extraction *out) __attribute__((warn_unused_result));

/** Ends the tracking of a face: the next frame is searched as a whole.
 *
 * (With `track` a face is followed through at most ten frames that are at most 250 ms apart and
 * come from one camera. Then the whole frame is searched again, and the nearest face is taken. The
 * result of a frame depends on the frame before only in that the fit starts from the pose found
 * there.)
 *
 * @param extractor  The extractor. */
void iso_extractor_forget(struct iso_extractor *extractor);

/** The surface that the last run with the outcome ISO_CAPTURE_OK worked on, for pictures.
 *
 * @param extractor  The extractor.
 * @return The mesh; it belongs to the extractor and is valid until the next run. */
const struct iso_mesh *iso_extractor_mesh(const struct iso_extractor *extractor);

/** The heat of one landmark on that surface.
 *
 * @param extractor  The extractor.
 * @param landmark   The landmark that the heat comes from.
 * @return [n_vertices of the mesh], 1/mm^2; it belongs to the extractor and is valid until the next
 *         run. */
const double *iso_extractor_heat(const struct iso_extractor *extractor, enum iso_landmark landmark);

#endif

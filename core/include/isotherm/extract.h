/* From a depth frame to a template: every step of core in the order the data flows.
 *
 *   frame -> face region -> clean -> head model fitted -> face patch (resampled in the face
 *   frame, holes filled on the residual) -> mesh -> heat of 12 landmarks -> isotherms -> template
 *
 * One extractor is one workspace: created once, used for frame after frame by one thread, no
 * allocation of its own after it is created (but by ISO_HEAT_SPECTRAL, which is for comparison). */
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

enum iso_heat_method {
    ISO_HEAT_GRID = 0, /* Chebyshev expansion on the patch's grid; too stiff: as DIRECT */
    ISO_HEAT_DIRECT,   /* on a mesh: factorisation and shift-invert Lanczos */
    ISO_HEAT_SPECTRAL, /* on a mesh: 100 eigenpairs, as in the dissertation */
};

/* "grid", "direct", "spectral"; NULL outside the range. */
const char *iso_heat_method_name(enum iso_heat_method method);

enum iso_stage {
    ISO_STAGE_REGION,
    ISO_STAGE_CLEAN,
    ISO_STAGE_FIT,
    ISO_STAGE_PATCH,
    ISO_STAGE_MESH,
    ISO_STAGE_HEAT,
    ISO_STAGE_ISOTHERM,
    ISO_STAGES
};

/* "region", "clean", ...; NULL outside the range. */
const char *iso_stage_name(enum iso_stage stage);

struct iso_tasks; /* the threads of the appliance; not public */

struct iso_extract_options {
    double t_mm2;                             /* time of the heat (heat_kernel.h): 100 */
    int n_radii;                              /* 1..ISO_TEMPLATE_RADII_MAX */
    double radius_mm[ISO_TEMPLATE_RADII_MAX]; /* of the isotherms: 12, 20, 28, 36 */
    int n_points;                             /* of an isotherm: 16 */
    double crop_radius_mm;                    /* of the face patch about the nose tip: 100 */
    double spacing_mm;                        /* of the face patch: 2 */
    double smoothing_mm;                      /* sigma of the residual's filter: 3 */
    double outlier_mm;                        /* residuals beyond are filled in: 20 */
    struct iso_shape_fit_options fit;         /* of the head model (shape_fit.h) */
    double distance_min_mm, distance_max_mm;  /* of the nose tip from the sensor: 300, 1500 */
    double yaw_max_rad, pitch_max_rad;        /* beyond: turn-left and so on: 40 degrees */
    bool track;                               /* look for the face where it was just before: no */
    enum iso_heat_method heat;
    char sensor[ISO_TEMPLATE_SENSOR_MAX]; /* written into templates */
    int64_t (*now_ns)(void *context);     /* monotonic clock for stage times; NULL: no times */
    void *now_context;
};

struct iso_extract_options iso_extract_options_default(void);

struct iso_extraction {
    enum iso_capture outcome; /* only ISO_CAPTURE_OK has a template */

    /* Rough from the region on, good once `fitted`. */
    struct iso_rigid camera_from_face;
    double yaw_rad, pitch_rad, roll_rad; /* yaw > 0: turned to the subject's left; pitch > 0: up */
    double distance_mm;                  /* nose tip from the sensor along the axis */
    double residual_mm;                  /* robust fit of the head model */

    /* Only if the head model was fitted, whatever the gates say of it: camera frame, on the fitted
     * head, as the face is, its expression on. */
    bool fitted;
    bool tracked; /* it was where the frame before had it, and was not looked for elsewhere */
    struct iso_vec3 landmark_mm[ISO_LANDMARKS];
    struct iso_vec3 ibug_mm[ISO_LANDMARKS_IBUG];
    double sigma_mm[ISO_LANDMARKS]; /* standard deviation of where the landmark is */
    struct iso_occlusion occlusion; /* what of the face is covered */
    double fit_coverage;            /* share of the visible fitted face that was measured, 0..1 */
    double identity_norm;           /* how unlike the mean head it is, in standard deviations */
    double expression_norm;         /* how strong the expression is, likewise */

    double coverage; /* measured share of the face patch, 0..1 */
    /* Only with ISO_CAPTURE_OK and only from iso_extractor_run: where the heat was released, camera
     * frame: points of the measured surface, where the landmarks would be at rest. */
    struct iso_vec3 source_mm[ISO_LANDMARKS];
    struct iso_template tmpl;
    int64_t stage_ns[ISO_STAGES];
};

struct iso_extractor;

/* The model is referenced, not copied: it must outlive the extractor. -EINVAL for options out of
 * range, -ENOMEM. */
int iso_extractor_new(const struct iso_head_model *model, const struct iso_extract_options *options,
                      struct iso_extractor **out) __attribute__((warn_unused_result));
void iso_extractor_free(struct iso_extractor *extractor);

/* Identifies everything that shapes a template: templates of different values are not compared. */
uint32_t iso_extractor_algorithm(const struct iso_extractor *extractor);

/* Returns 0 with *out written, whatever its outcome; -EINVAL for a frame that iso_frame_check
 * refuses or whose planes exceed 1920 x 1200; -EDOM, -ENOMEM from the heat solver. */
int iso_extractor_run(struct iso_extractor *extractor, const struct iso_frame *frame,
                      struct iso_extraction *out) __attribute__((warn_unused_result));

/* The same as far as the landmarks and the gates: ISO_STAGE_REGION to ISO_STAGE_PATCH, without a
 * template. */
int iso_extractor_locate(struct iso_extractor *extractor, const struct iso_frame *frame,
                         struct iso_extraction *out) __attribute__((warn_unused_result));

/* Looks for the face anew in the next frame, even with `track`. (A face is followed through frames
 * that are at most 250 ms apart and come from one camera, ten at a time; then it is looked for
 * again, and the nearest is taken. What a frame gives depends on the one before only by where the
 * fit starts.) */
void iso_extractor_forget(struct iso_extractor *extractor);

/* What the last run with outcome OK worked on, for pictures; valid until the next run. */
const struct iso_mesh *iso_extractor_mesh(const struct iso_extractor *extractor);
/* Heat at the mesh's vertices from one landmark, 1/mm^2. */
const double *iso_extractor_heat(const struct iso_extractor *extractor, enum iso_landmark landmark);

#endif

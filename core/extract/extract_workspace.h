/* The memory of an extractor: the workspaces of all steps. Internal to core/extract. */
#ifndef ISO_CORE_EXTRACT_EXTRACT_WORKSPACE_H
#define ISO_CORE_EXTRACT_EXTRACT_WORKSPACE_H

#include "core/find/nose_candidate.h"
#include "core/find/pose_search.h"
#include "core/frame/shrink.h"
#include "core/heat/grid/heat_grid.h"
#include "core/isotherm/face_isotherms.h"
#include "core/landmark/occlusion.h"
#include "core/landmark/pose_fit.h"
#include "core/presentation/presentation.h"
#include "core/surface/clean.h"
#include "core/surface/face_patch.h"
#include "isotherm/eigenpairs.h"
#include "isotherm/extract.h"
#include "isotherm/heat_kernel.h"
#include "isotherm/triangulate.h"

enum {
    ISO_EXTRACT_WIDTH_MAX = 1920,
    ISO_EXTRACT_HEIGHT_MAX = 1200,
    ISO_EXTRACT_COARSE_PX_MAX = 640 * 480,
    /* The widest patch with its margin, if a pixel is half as wide as the clean pitch. If pixels
     * are smaller, the frame is shrunk. */
    ISO_EXTRACT_CLEAN_PX_MAX = 682 * 682,
    ISO_EXTRACT_SEARCH_VERTICES = 220,
    ISO_EXTRACT_SEARCH_FIT_VERTICES = 320,
    ISO_EXTRACT_EIGENPAIRS = 100,
};

/* Pitches at which the steps work, millimetres a pixel: the search (for a face at 600 mm), and the
 * cleaned cut-out. */
#define ISO_EXTRACT_COARSE_PITCH_MM 4.0
#define ISO_EXTRACT_COARSE_AT_MM    600.0
#define ISO_EXTRACT_CLEAN_PITCH_MM  1.0

/* Where the face of the previous frame was. */
struct iso_extract_track {
    int frames_left; /* how many more frames the face may be followed; 0: there is none */
    struct iso_rigid camera_from_face;
    int64_t t_ns;
    struct iso_camera camera;
};

struct iso_extractor {
    const struct iso_head_model *model;
    struct iso_extract_options options;
    uint32_t algorithm;
    struct iso_extraction extraction; /* of the present frame */

    /* find */
    struct iso_frame coarse;
    struct iso_candidate_finder *finder;
    struct iso_pose_vertices *search_vertices;
    struct iso_shape_fitter *search_fitter;
    struct iso_presentation *presentation;

    /* the cleaned frame, the head model fitted to it */
    struct iso_cleaner *cleaner;
    struct iso_shape_fitter *fitter;
    struct iso_shape_fit head;
    uint8_t *parts; /* [model->n_vertices] bits of enum iso_face_part */
    struct iso_extract_track track;

    /* patch in the face frame, as planes or as a mesh */
    struct iso_face_patch *patch;
    bool on_grid; /* the last run worked on the planes */
    struct iso_grid *grid;
    struct iso_grid_point grid_sources[ISO_LANDMARKS];
    struct iso_triangulator *patch_triangulator;
    struct iso_mesh *mesh;
    int32_t (*adjacent)[3];
    struct iso_surface_point sources[ISO_LANDMARKS];
    struct iso_vec3 source_mm[ISO_LANDMARKS]; /* the sources in the face frame */

    /* heat and isotherms */
    struct iso_symmetric *stiffness, *mass;
    struct iso_heat_direct *direct;
    double *heat; /* [ISO_LANDMARKS][mesh->n_vertices] */
    struct iso_tracer *tracer;
    struct iso_heat_grid *heat_grid;
    struct iso_grid_tracer *grid_tracer;
};

/* extract_judge.c: judges a frame without a face. The outcome is a picture that is held up,
 * ISO_CAPTURE_NOBODY, or `otherwise`. */
enum iso_capture iso__extract_judge_scene(struct iso_extractor *x,
                                          const struct iso_candidate_options *range,
                                          enum iso_capture otherwise);

/* Judges the pose of a face: ISO_CAPTURE_OK, or what would help. */
enum iso_capture iso__extract_judge_pose(const struct iso_extractor *x,
                                         const struct iso_frame *frame,
                                         const struct iso_pose_fit *fit,
                                         const struct iso_extraction *out);
/* Judges the fit in x->head, whose pose is in `out`: ISO_CAPTURE_OK for a face that is not covered
 * and shows no presentation attack. A head that is refused and turned or bowed far is told to turn:
 * what the gates measure is uncertain then. Sets out->cue. */
enum iso_capture iso__extract_judge_fit(const struct iso_extractor *x,
                                        const struct iso_frame *frame,
                                        const struct iso_frame *cleaned,
                                        struct iso_extraction *out);

/* extract_isotherms.c: makes a surface of the patch with the sources on it, and the upper face of
 * the template. -ENODATA or -ENOENT if there is no surface, or none at a source. */
int iso__extract_surface(struct iso_extractor *x, struct iso_extraction *out);

/* Computes the heat of the sources. Errors of the solver. */
int iso__extract_heat(struct iso_extractor *x);

/* Traces the isotherms and fills in the rest of the template. */
int iso__extract_isotherms(struct iso_extractor *x, struct iso_template *tmpl);

/* extract_upper_face.c: the upper face of the patch, sampled at the nodes of a template. */
void iso__extract_upper_face(const struct iso_face_patch *patch, struct iso_upper_face *out);

#endif

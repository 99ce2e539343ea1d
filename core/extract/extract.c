#include "isotherm/extract.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "core/extract/extract_inside.h"
#include "core/extract/extract_workspace.h"

/* The largest cost of a face in the coarse frame: a mean square of residuals, each limited to 6 mm,
 * with the penalties of pose_search.c. */
static const double search_cost_max_mm2 = 14.0;
static const double search_coverage_min = 0.5;

/* The least share of the face patch that must be measured. */
static const double patch_coverage_min = 0.45;

/* Triangles of the measured surface that span more depth than this join different surfaces. */
static const double patch_jump_mm = 10.0;

/* People are also found a little outside the range in which they are recognised, so that they can
 * be told to come closer or to step back. */
static const double too_near_share = 0.6, too_far_share = 1.4;

/* The whole frame is searched again after a face was followed for this many frames, or after a gap
 * of this length between two frames. */
enum { TRACK_FRAMES = 10 };
static const int64_t track_age_max_ns = 250000000;

/* The part of the frame that is cleaned reaches further from the nose than the patch, by this. */
static const double clean_margin_mm = 20.0;

const char *iso_stage_name(enum iso_stage stage)
{
    static const char *const names[ISO_STAGES] = {
        "region", "clean", "fit", "patch", "mesh", "heat", "isotherm",
    };
    return (unsigned)stage < ISO_STAGES ? names[stage] : NULL;
}

static int64_t now_ns(const struct iso_extractor *x)
{
    return x->options.now_ns ? x->options.now_ns(x->options.now_context) : 0;
}

/* By how much a frame is shrunk for the search: to the coarse pitch, and further if the view of the
 * camera is so wide that the coarse frame would still be too large. */
static int coarse_factor(const struct iso_frame *frame)
{
    const double pixel_mm = iso_camera_pixel_mm(&frame->camera, ISO_EXTRACT_COARSE_AT_MM);
    const double pitch = fmin(rint(ISO_EXTRACT_COARSE_PITCH_MM / pixel_mm), ISO_SHRINK_MAX);
    const double side_px = fmin(frame->width_px, frame->height_px);
    int factor = (int)fmax(fmin(pitch, side_px), 1.0);
    while ((frame->width_px / factor) * (frame->height_px / factor) > ISO_EXTRACT_COARSE_PX_MAX) {
        factor++;
    }
    return factor;
}

/* Describes the attitude and the distance of a pose. The angles follow from the directions of the
 * face's +z and +y axes in the camera frame. */
static void describe_pose(const struct iso_pose_fit *fit, struct iso_extraction *out)
{
    const struct iso_mat3 *r = &fit->camera_from_face.rotation;
    out->camera_from_face = fit->camera_from_face;
    out->yaw_rad = atan2(r->m[0][2], -r->m[2][2]);
    out->pitch_rad = asin(fmin(fmax(-r->m[1][2], -1.0), 1.0));
    out->roll_rad = atan2(r->m[0][1], -r->m[1][1]);
    out->distance_mm = fit->camera_from_face.translation_mm.z;
    out->residual_mm = sqrt(fit->cost_mm2);
}

/* Finds the face roughly in the frame shrunk to the coarse pitch. */
static int find_face(struct iso_extractor *x, const struct iso_frame *frame,
                     struct iso_pose_fit *fit, struct iso_extraction *out)
{
    const bool pinhole = frame->camera.projection == ISO_PINHOLE;
    const struct iso_window all = {0, 0, frame->width_px, frame->height_px};
    int error = iso_frame_shrink(frame, all, coarse_factor(frame), ISO_EXTRACT_COARSE_PX_MAX,
                                 &x->coarse);
    if (error) {
        return error;
    }
    /* The depths of an orthographic image are not counted from the camera. */
    const struct iso_candidate_options range = {
        .near_mm = pinhole ? too_near_share * x->options.distance_min_mm : 0.0,
        .far_mm = pinhole ? too_far_share * x->options.distance_max_mm : INFINITY,
    };
    struct iso_nose_candidate candidates[ISO_CANDIDATES_MAX];
    int n_candidates, n_parts;
    error = iso_candidates_find(x->finder, &x->coarse, &range, candidates, &n_candidates, &n_parts);
    if (error) {
        return error;
    }
    const struct iso_pose_search search = {
        .vertices = x->search_vertices,
        .fitter = x->search_fitter,
        .frame = &x->coarse,
        .cost_max_mm2 = search_cost_max_mm2,
        .coverage_min = search_coverage_min,
    };
    bool several;
    if (iso_pose_search(&search, candidates, n_candidates, fit, &several)) {
        out->outcome = iso__extract_judge_scene(
            x, &range, n_candidates > 0 ? ISO_CAPTURE_NOT_A_FACE : ISO_CAPTURE_NO_FACE);
        return 0;
    }
    if (several) {
        out->outcome = ISO_CAPTURE_SEVERAL_FACES;
        return 0;
    }
    out->outcome = ISO_CAPTURE_OK;
    describe_pose(fit, out);
    return 0;
}

/* Copies the result of the fit to the extraction. Points become those of the camera frame. */
static void describe_fit(const struct iso_extractor *x, struct iso_extraction *out)
{
    const struct iso_shape_fit *head = &x->head;
    const struct iso_shape_residuals residuals = iso_shape_fitter_residuals(x->fitter);
    const struct iso_rigid *pose = &head->pose.camera_from_face;
    out->fitted = true;
    out->occlusion = iso_occlusion_measure(&residuals, x->parts);
    out->fit_coverage = head->pose.coverage;
    out->identity_norm = head->identity_norm;
    out->expression_norm = head->expression_norm;
    for (int i = 0; i < ISO_LANDMARKS_IBUG; i++) {
        out->ibug_mm[i] = iso_rigid_apply(pose, head->ibug_mm[i]);
    }
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        out->landmark_mm[l] = out->ibug_mm[iso_landmark_ibug[l]];
        out->sigma_mm[l] = head->sigma_mm[l];
    }
}

/* Fits the head model to the cleaned frame. */
static int fit_head(struct iso_extractor *x, const struct iso_frame *frame,
                    const struct iso_frame *cleaned, struct iso_pose_fit *fit,
                    struct iso_extraction *out)
{
    struct iso_rigid start = fit->camera_from_face;
    const int error = iso_shape_fit(x->fitter, cleaned, &start, &x->head);
    if (error) {
        return error;
    }
    *fit = x->head.pose;
    describe_fit(x, out);
    describe_pose(fit, out);
    out->outcome = iso__extract_judge_fit(x, frame, cleaned, out);
    return 0;
}

/* Resamples the surface in the face frame and fills its holes. */
static void make_patch(struct iso_extractor *x, const struct iso_frame *cleaned,
                       struct iso_extraction *out)
{
    out->coverage = iso_face_patch_resample(x->patch, cleaned, patch_jump_mm,
                                            &out->camera_from_face);
    if (out->coverage < patch_coverage_min) {
        out->outcome = ISO_CAPTURE_TOO_FEW_POINTS;
    }
}

static bool same_camera(const struct iso_camera *a, const struct iso_camera *b)
{
    return a->projection == b->projection && a->width_px == b->width_px &&
           a->height_px == b->height_px && a->fx_px == b->fx_px && a->fy_px == b->fy_px &&
           a->pitch_mm == b->pitch_mm && a->cx_px == b->cx_px && a->cy_px == b->cy_px &&
           a->k1 == b->k1 && a->k2 == b->k2 && a->k3 == b->k3 && a->p1 == b->p1 && a->p2 == b->p2;
}

/* Whether the fit may start from the face that the previous frame showed. Three conditions must be
 * true: tracking is switched on; the previous frame comes from the same camera and is not too old;
 * and fewer than TRACK_FRAMES frames were fitted since the last search of a whole frame. */
static bool is_tracked(const struct iso_extractor *x, const struct iso_frame *frame)
{
    const struct iso_extract_track *t = &x->track;
    int64_t age_ns = frame->t_ns - t->t_ns;
    return x->options.track && t->frames_left > 0 && age_ns > 0 && age_ns <= track_age_max_ns &&
           same_camera(&t->camera, &frame->camera);
}

/* Remembers the pose of a usable face for the next frame. A face is followed for TRACK_FRAMES
 * frames only, because somebody nearer may have come. */
static void keep_track(struct iso_extractor *x, const struct iso_frame *frame, bool tracked,
                       const struct iso_extraction *out)
{
    struct iso_extract_track *t = &x->track;
    const int frames_left = tracked ? t->frames_left - 1 : TRACK_FRAMES;
    *t = (struct iso_extract_track){
        .frames_left = out->outcome == ISO_CAPTURE_OK ? frames_left : 0,
        .camera_from_face = out->camera_from_face,
        .t_ns = frame->t_ns,
        .camera = frame->camera,
    };
}

void iso_extractor_forget(struct iso_extractor *extractor)
{
    extractor->track.frames_left = 0;
}

/* A frame on its way through the steps. */
struct progress {
    struct iso_extractor *x;
    const struct iso_frame *frame;
    struct iso_extraction *out;
    int64_t before_ns; /* when the previous step ended */
    int error;
};

/* Ends a step. Its time is the time since the end of the previous step. Returns false if the step
 * failed, or if the frame is unusable (the outcome then says why). */
static bool end_stage(struct progress *progress, enum iso_stage stage, int error)
{
    const int64_t after_ns = now_ns(progress->x);
    progress->out->stage_ns[stage] = after_ns - progress->before_ns;
    progress->before_ns = after_ns;
    if (error == -ENODATA || error == -ENOENT) {
        /* The cleaning left nothing, the head cannot be fitted, there is no triangle, or there is
         * no triangle at a landmark. */
        progress->out->outcome = ISO_CAPTURE_TOO_FEW_POINTS;
        return false;
    }
    progress->error = error;
    return !error && progress->out->outcome == ISO_CAPTURE_OK;
}

/* Whether the face stands where it can be used; if not, the outcome says what would help. */
static bool stands_well(const struct progress *progress, const struct iso_pose_fit *fit)
{
    struct iso_extraction *out = progress->out;
    out->outcome = iso__extract_judge_pose(progress->x, progress->frame, fit, out);
    return out->outcome == ISO_CAPTURE_OK;
}

/* The steps from a frame to a template, or to the face patch if that is the last step asked for. A
 * face that is tracked is not searched. */
static int run_stages(struct iso_extractor *x, const struct iso_frame *frame, enum iso_stage last,
                      bool tracked, struct iso_extraction *out)
{
    struct progress p = {.x = x, .frame = frame, .out = out, .before_ns = now_ns(x)};
    struct iso_pose_fit fit = {.camera_from_face = x->track.camera_from_face, .in_image = 1.0};
    const struct iso_vec3 *nose_mm = &fit.camera_from_face.translation_mm;
    const double radius_mm = x->options.crop_radius_mm + clean_margin_mm;
    const struct iso_frame *cleaned = NULL;

    if (tracked) {
        out->outcome = ISO_CAPTURE_OK;
    }
    bool usable = tracked || (end_stage(&p, ISO_STAGE_REGION, find_face(x, frame, &fit, out)) &&
                              stands_well(&p, &fit));
    usable = usable && end_stage(&p, ISO_STAGE_CLEAN,
                                 iso_clean(x->cleaner, frame, *nose_mm, radius_mm,
                                           ISO_EXTRACT_CLEAN_PITCH_MM, &cleaned));
    usable = usable && end_stage(&p, ISO_STAGE_FIT, fit_head(x, frame, cleaned, &fit, out));
    usable = usable && stands_well(&p, &fit);
    if (usable) {
        make_patch(x, cleaned, out);
        usable = end_stage(&p, ISO_STAGE_PATCH, 0);
    }
    usable = usable && last > ISO_STAGE_PATCH;
    usable = usable && end_stage(&p, ISO_STAGE_MESH, iso__extract_surface(x, out));
    usable = usable && end_stage(&p, ISO_STAGE_HEAT, iso__extract_heat(x));
    if (usable) {
        (void)end_stage(&p, ISO_STAGE_ISOTHERM, iso__extract_isotherms(x, &out->tmpl));
    }
    return p.error;
}

static int run_anew(struct iso_extractor *x, const struct iso_frame *frame, enum iso_stage last,
                    bool tracked)
{
    memset(&x->extraction, 0, sizeof x->extraction);
    x->extraction.outcome = ISO_CAPTURE_NO_FACE;
    return run_stages(x, frame, last, tracked, &x->extraction);
}

static int check_and_run(struct iso_extractor *extractor, const struct iso_frame *frame,
                         enum iso_stage last, struct iso_extraction *out)
{
    int error = iso_frame_check(frame, NULL);
    if (error) {
        return error;
    }
    if (frame->width_px > ISO_EXTRACT_WIDTH_MAX || frame->height_px > ISO_EXTRACT_HEIGHT_MAX) {
        return -EINVAL;
    }
    struct iso_extraction *extraction = &extractor->extraction;
    bool tracked = is_tracked(extractor, frame);
    error = run_anew(extractor, frame, last, tracked);
    if (!error && tracked && extraction->outcome != ISO_CAPTURE_OK) { /* lost: look for it */
        tracked = false;
        error = run_anew(extractor, frame, last, tracked);
    }
    if (!error) {
        keep_track(extractor, frame, tracked, extraction);
        extraction->tracked = tracked;
        *out = *extraction;
    }
    explicit_bzero(extraction, sizeof *extraction);
    return error;
}

int iso_extractor_run(struct iso_extractor *extractor, const struct iso_frame *frame,
                      struct iso_extraction *out)
{
    return check_and_run(extractor, frame, ISO_STAGE_ISOTHERM, out);
}

int iso_extractor_locate(struct iso_extractor *extractor, const struct iso_frame *frame,
                         struct iso_extraction *out)
{
    return check_and_run(extractor, frame, ISO_STAGE_PATCH, out);
}

struct iso_shape_residuals iso_extractor_fit(const struct iso_extractor *extractor)
{
    return iso_shape_fitter_residuals(extractor->fitter);
}

uint32_t iso_extractor_algorithm(const struct iso_extractor *extractor)
{
    return extractor->algorithm;
}

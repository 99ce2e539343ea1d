/* The gates: whether what was found can be used, and if not, what would help or what it is. */
#include <math.h>

#include "core/extract/extract_workspace.h"

/* A fit that is worse than this, rms-like with residuals limited to 6 mm, is to no face. */
static const double fit_cost_max_mm2 = 10.0;

/* A head that fits badly and is far from any head: millimetres of residual plus so much for every
 * standard deviation of the identity (root mean square of 60 coefficients). Rendered faces reach
 * 2.7, real ones (Kinect v2) 4.43, 2 of 378 beyond the limit; 1 of 275 frames of what is no face is
 * within it. With 40 modes the same bounds refused 12 of the real ones: the last modes say little
 * and make the mean square smaller. */
static const double unlikeness_per_sigma_mm = 1.5, unlikeness_max_mm = 4.35;

static const double fit_coverage_min = 0.5;
static const double in_image_min = 0.9;

/* Shares of a part that may be covered. Noses cast shadows and eyes are lost by some sensors. */
static const double covered_max[ISO_FACE_PARTS] = {
    [ISO_PART_BROW] = 0.8,  [ISO_PART_EYES] = 0.7, [ISO_PART_NOSE] = 0.5,
    [ISO_PART_MOUTH] = 0.6, [ISO_PART_LEFT] = 0.6, [ISO_PART_RIGHT] = 0.6,
};

/* So much of a wall's or a table's surface lies on one plane. The backs of people and what else is
 * as large reach 0.6. */
static const double wall_flat_share = 0.8;

/* Whether the nearest thing within the range of use is none that a visitor could be: there is none,
 * or it is larger than a person can hold and flat. */
static bool is_background(const struct iso_presentation_cues *cues,
                          const struct iso_presentation_options *bounds)
{
    return !cues->has_sheet || (cues->sheet.area_mm2 > bounds->held_area_max_mm2 &&
                                cues->sheet.flat.inlier_share >= wall_flat_share);
}

enum iso_capture iso__extract_judge_scene(struct iso_extractor *x,
                                          const struct iso_candidate_options *range,
                                          enum iso_capture otherwise)
{
    const struct iso_presentation_options bounds = iso_presentation_options_default();
    struct iso_presentation_cues cues;
    iso_presentation_measure_scene(x->presentation, &x->coarse, range->near_mm,
                                   x->options.distance_max_mm, &cues);
    enum iso_capture outcome = iso_presentation_judge(&cues, &bounds);
    if (outcome != ISO_CAPTURE_OK) {
        return outcome;
    }
    /* The depths of an orthographic image count from anywhere: nothing of it is known to be far. */
    const bool distant = isfinite(range->far_mm);
    return distant && is_background(&cues, &bounds) ? ISO_CAPTURE_NOBODY : otherwise;
}

/* The way a face that is cut by the image border should go, as the subject sees it, whose left is
 * the image's right. */
static enum iso_capture way_to_the_middle(const struct iso_frame *frame, struct iso_vec3 nose_mm)
{
    double u = 0.0, v = 0.0;
    (void)iso_camera_project(&frame->camera, nose_mm, &u, &v);
    double right = (u - frame->crop_x_px) / frame->width_px - 0.5;
    double down = (v - frame->crop_y_px) / frame->height_px - 0.5;
    if (fabs(right) > fabs(down)) {
        return right > 0.0 ? ISO_CAPTURE_MOVE_RIGHT : ISO_CAPTURE_MOVE_LEFT;
    }
    return down > 0.0 ? ISO_CAPTURE_MOVE_UP : ISO_CAPTURE_MOVE_DOWN;
}

/* Whether a face stands where it can be used, and if not, what would help. */
enum iso_capture iso__extract_judge_pose(const struct iso_extractor *x,
                                         const struct iso_frame *frame,
                                         const struct iso_pose_fit *fit,
                                         const struct iso_extraction *out)
{
    bool pinhole = frame->camera.projection == ISO_PINHOLE;
    if (pinhole && out->distance_mm > x->options.distance_max_mm) {
        return ISO_CAPTURE_TOO_FAR;
    }
    if (pinhole && out->distance_mm < x->options.distance_min_mm) {
        return ISO_CAPTURE_TOO_CLOSE;
    }
    if (fit->in_image < in_image_min) {
        return way_to_the_middle(frame, fit->camera_from_face.translation_mm);
    }
    if (fabs(out->yaw_rad) > x->options.yaw_max_rad) {
        return out->yaw_rad > 0.0 ? ISO_CAPTURE_TURN_RIGHT : ISO_CAPTURE_TURN_LEFT;
    }
    if (fabs(out->pitch_rad) > x->options.pitch_max_rad) {
        return out->pitch_rad > 0.0 ? ISO_CAPTURE_LOOK_DOWN : ISO_CAPTURE_LOOK_UP;
    }
    return ISO_CAPTURE_OK;
}

/* The part of which most is covered, if it is too much. */
static enum iso_capture judge_cover(const struct iso_occlusion *occlusion)
{
    static const enum iso_capture words[ISO_FACE_PARTS] = {
        [ISO_PART_BROW] = ISO_CAPTURE_COVERED_BROW, [ISO_PART_EYES] = ISO_CAPTURE_COVERED_EYES,
        [ISO_PART_NOSE] = ISO_CAPTURE_COVERED_NOSE, [ISO_PART_MOUTH] = ISO_CAPTURE_COVERED_MOUTH,
        [ISO_PART_LEFT] = ISO_CAPTURE_COVERED_LEFT, [ISO_PART_RIGHT] = ISO_CAPTURE_COVERED_RIGHT,
    };
    enum iso_capture outcome = ISO_CAPTURE_OK;
    double worst = 0.0;
    for (int part = 0; part < ISO_FACE_PARTS; part++) {
        double over = occlusion->covered[part] - covered_max[part];
        if (over > worst) {
            worst = over;
            outcome = words[part];
        }
    }
    return outcome;
}

/* Whether the fitted face is one that is alive, as far as a single frame says. */
static enum iso_capture judge_presentation(const struct iso_extractor *x,
                                           const struct iso_frame *frame,
                                           const struct iso_frame *cleaned)
{
    const struct iso_presentation_options bounds = iso_presentation_options_default();
    const struct iso_shape_residuals head = iso_shape_fitter_residuals(x->fitter);
    struct iso_presentation_cues cues;
    iso_presentation_measure_face(x->presentation, frame, cleaned, &x->head, &head, &cues);
    return iso_presentation_judge(&cues, &bounds);
}

static bool is_like_a_face(double cost_mm2, double identity_norm)
{
    return cost_mm2 <= fit_cost_max_mm2 &&
           sqrt(cost_mm2) + unlikeness_per_sigma_mm * identity_norm <= unlikeness_max_mm;
}

enum iso_capture iso__extract_judge_fit(const struct iso_extractor *x,
                                        const struct iso_frame *frame,
                                        const struct iso_frame *cleaned,
                                        const struct iso_extraction *out)
{
    const double norm = x->head.identity_norm;
    enum iso_capture cover = judge_cover(&out->occlusion);
    /* What covers a face does not fit a head, but the rest of the face does. */
    if (cover != ISO_CAPTURE_OK && is_like_a_face(out->occlusion.rest_mm2, norm)) {
        return cover;
    }
    if (!is_like_a_face(x->head.pose.cost_mm2, norm)) {
        return ISO_CAPTURE_NOT_A_FACE;
    }
    return x->head.pose.coverage < fit_coverage_min ? ISO_CAPTURE_TOO_FEW_POINTS
                                                    : judge_presentation(x, frame, cleaned);
}

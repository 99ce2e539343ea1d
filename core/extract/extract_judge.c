/* The checks of a face: whether it can be used. If it cannot, the outcome tells the person what
 * would help, or names the presentation attack. */
#include <math.h>

#include "core/extract/extract_workspace.h"

/* The largest cost of a fit to a face: a mean square of residuals, each limited to 6 mm. */
static const double fit_cost_max_mm2 = 10.0;

/* The limit of how unlike a head a fit may be: the root of the cost in mm, plus 1.5 mm for every
 * standard deviation of the identity (root mean square of 60 coefficients). Rendered faces
 * reach 2.7. Real ones (Kinect v2) reach 4.43; 2 of 378 are beyond the limit. Of 275 frames that
 * show no face, 1 is within it. With 40 modes the same bounds refused 12 of the real faces: the
 * last modes carry little information and make the mean square smaller. */
static const double unlikeness_per_sigma_mm = 1.5, unlikeness_max_mm = 4.35;

static const double fit_coverage_min = 0.5;
static const double in_image_min = 0.9;

/* The share of each part that may be covered. Noses cast shadows, and some sensors do not measure
 * eyes. */
static const double covered_max[ISO_FACE_PARTS] = {
    [ISO_PART_BROW] = 0.8,  [ISO_PART_EYES] = 0.7, [ISO_PART_NOSE] = 0.5,
    [ISO_PART_MOUTH] = 0.6, [ISO_PART_LEFT] = 0.6, [ISO_PART_RIGHT] = 0.6,
};

/* The checks may accept a head that is turned or bowed further than this, 25 degrees. If they
 * refuse it, the person is told to turn the head. */
static const double frontal_max_rad = 25.0 * M_PI / 180.0;

/* Walls and tables have at least this share of their surface on one plane. Backs of people, and
 * other things of that size, reach 0.6. */
static const double wall_flat_share = 0.8;

/* Whether the nearest thing within the range of use cannot be a visitor: there is none, or it is
 * flat and larger than a person can hold. */
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
                                   x->options.distance_max_mm, &bounds, &cues);
    const enum iso_capture outcome = iso_presentation_judge(&cues, &bounds);
    if (outcome != ISO_CAPTURE_OK) {
        return outcome;
    }
    /* The depths of an orthographic image have no fixed origin, so that nothing in it is known to
     * be far. */
    const bool distant = isfinite(range->far_mm);
    return distant && is_background(&cues, &bounds) ? ISO_CAPTURE_NOBODY : otherwise;
}

/* The direction in which a person should move whose face is cut by the border of the image. The
 * left of the person is the right of the image. */
static enum iso_capture way_to_the_middle(const struct iso_frame *frame, struct iso_vec3 nose_mm)
{
    double u = 0.0, v = 0.0;
    (void)iso_camera_project(&frame->camera, nose_mm, &u, &v);
    const double right = (u - frame->crop_x_px) / frame->width_px - 0.5;
    const double down = (v - frame->crop_y_px) / frame->height_px - 0.5;
    if (fabs(right) > fabs(down)) {
        return right > 0.0 ? ISO_CAPTURE_MOVE_RIGHT : ISO_CAPTURE_MOVE_LEFT;
    }
    return down > 0.0 ? ISO_CAPTURE_MOVE_UP : ISO_CAPTURE_MOVE_DOWN;
}

/* The way in which a head should turn whose attitude is beyond a limit, ISO_CAPTURE_OK within both.
 * The angle that exceeds its limit by more decides. */
static enum iso_capture way_to_the_front(const struct iso_extraction *out, double yaw_max_rad,
                                         double pitch_max_rad)
{
    const double yaw_over = fabs(out->yaw_rad) - yaw_max_rad;
    const double pitch_over = fabs(out->pitch_rad) - pitch_max_rad;
    if (yaw_over > 0.0 && yaw_over >= pitch_over) {
        return out->yaw_rad > 0.0 ? ISO_CAPTURE_TURN_RIGHT : ISO_CAPTURE_TURN_LEFT;
    }
    if (pitch_over > 0.0) {
        return out->pitch_rad > 0.0 ? ISO_CAPTURE_LOOK_DOWN : ISO_CAPTURE_LOOK_UP;
    }
    return ISO_CAPTURE_OK;
}

enum iso_capture iso__extract_judge_pose(const struct iso_extractor *x,
                                         const struct iso_frame *frame,
                                         const struct iso_pose_fit *fit,
                                         const struct iso_extraction *out)
{
    const bool pinhole = frame->camera.projection == ISO_PINHOLE;
    if (pinhole && out->distance_mm > x->options.distance_max_mm) {
        return ISO_CAPTURE_TOO_FAR;
    }
    if (pinhole && out->distance_mm < x->options.distance_min_mm) {
        return ISO_CAPTURE_TOO_CLOSE;
    }
    if (fit->in_image < in_image_min) {
        return way_to_the_middle(frame, fit->camera_from_face.translation_mm);
    }
    return way_to_the_front(out, x->options.yaw_max_rad, x->options.pitch_max_rad);
}

/* The outcome for the part that exceeds its limit by most; ISO_CAPTURE_OK if no part does. */
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
        const double over = occlusion->covered[part] - covered_max[part];
        if (over > worst) {
            worst = over;
            outcome = words[part];
        }
    }
    return outcome;
}

/* Whether the fitted face is alive, as far as a single frame shows that. */
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

/* Judges the fit without regard to the attitude. */
static enum iso_capture judge_head(const struct iso_extractor *x, const struct iso_frame *frame,
                                   const struct iso_frame *cleaned,
                                   const struct iso_extraction *out)
{
    const double norm = x->head.identity_norm;
    const enum iso_capture cover = judge_cover(&out->occlusion);
    /* An object in front of a face does not fit a head, but the rest of the face does. */
    if (cover != ISO_CAPTURE_OK && is_like_a_face(out->occlusion.rest_mm2, norm)) {
        return cover;
    }
    if (!is_like_a_face(x->head.pose.cost_mm2, norm)) {
        return ISO_CAPTURE_NOT_A_FACE;
    }
    return x->head.pose.coverage < fit_coverage_min ? ISO_CAPTURE_TOO_FEW_POINTS
                                                    : judge_presentation(x, frame, cleaned);
}

/* Whether the attitude alone may have led to this outcome: the far cheek of a turned head is not
 * measured, nor are the eyes of one that is bowed. What does not fit a head is not told to turn,
 * because chairs fit turned heads best. */
static bool may_be_attitude(enum iso_capture outcome)
{
    const bool covered = outcome >= ISO_CAPTURE_COVERED_BROW &&
                         outcome <= ISO_CAPTURE_COVERED_RIGHT;
    return covered || outcome == ISO_CAPTURE_WRONG_SIZE || outcome == ISO_CAPTURE_EYES_CUT;
}

enum iso_capture iso__extract_judge_fit(const struct iso_extractor *x,
                                        const struct iso_frame *frame,
                                        const struct iso_frame *cleaned, struct iso_extraction *out)
{
    const enum iso_capture outcome = judge_head(x, frame, cleaned, out);
    if (!may_be_attitude(outcome)) {
        return outcome;
    }
    const enum iso_capture way = way_to_the_front(out,
                                                  fmin(frontal_max_rad, x->options.yaw_max_rad),
                                                  fmin(frontal_max_rad, x->options.pitch_max_rad));
    if (way == ISO_CAPTURE_OK) {
        return outcome;
    }
    out->cue = iso_capture_is_attack(outcome) ? outcome : ISO_CAPTURE_NO_FACE;
    return way;
}

#include "core/presentation/presentation.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

struct iso_presentation {
    const struct iso_head_model *model;
    struct iso_sizer *sizer;
    struct iso_sheet_finder *finder;
};

/* The share of the scale that comes from the fit; the rest comes from the measured size. */
static const double fit_weight = 1.0 / 3.0;
/* The largest root mean square of the 60 identity coefficients that is usual for people. */
static const double people_norm = 0.41;
/* A head that is fitted to a bent sheet has unusual coefficients. For every unit by which their
 * root mean square exceeds people_norm, the bound sheet_share is lower by this. (None of 376 real
 * faces has more than 0.70 on a bent sheet. A rolled photograph with 0.77, which would have passed,
 * exceeds people_norm by 0.57.) */
static const double bent_share_per_oddness = 0.15;
/* The shares of the places about an eye and within it that must be measured before the eye is
 * judged. */
static const double around_min = 0.3, measured_min = 0.5;

struct iso_presentation_options iso_presentation_options_default(void)
{
    return (struct iso_presentation_options){
        .sheet_share = 0.83,
        .too_small = 0.152,
        .too_large = 0.128,
        .no_size_cost_mm2 = 7.0,
        .eye_behind_mm = 3.0,
        .eye_hole_share = 0.9,
        .held_flat_share = 0.55,
        .held_bent_share = 0.8,
        .held_area_max_mm2 = 130000.0,
        .screen_hole_share = 0.08,
    };
}

double iso_presentation_oversize(const struct iso_presentation_cues *cues)
{
    return fit_weight * log(cues->fitted_scale) + (1.0 - fit_weight) * log(cues->size.scale);
}

static bool is_bent(const struct iso_presentation_cues *cues,
                    const struct iso_presentation_options *o)
{
    const double oddness = fmax(cues->identity_norm - people_norm, 0.0);
    return cues->relief.bent.inlier_share >= o->sheet_share - bent_share_per_oddness * oddness;
}

static bool cut_out(const struct iso_eye *eye, const struct iso_presentation_options *o)
{
    const bool behind = eye->hole_share <= 1.0 - measured_min && eye->depth_mm >= o->eye_behind_mm;
    return eye->around_share >= around_min && (behind || eye->hole_share >= o->eye_hole_share);
}

static enum iso_capture judge_sheet(const struct iso_sheet *sheet,
                                    const struct iso_presentation_options *o)
{
    if (sheet->area_mm2 > o->held_area_max_mm2) {
        return ISO_CAPTURE_OK;
    }
    const bool flat = sheet->flat.inlier_share >= o->held_flat_share;
    if (flat && sheet->hole_share >= o->screen_hole_share) {
        return ISO_CAPTURE_SCREEN;
    }
    if (flat) {
        return ISO_CAPTURE_FLAT;
    }
    return sheet->bent.inlier_share >= o->held_bent_share ? ISO_CAPTURE_BENT : ISO_CAPTURE_OK;
}

enum iso_capture iso_presentation_judge(const struct iso_presentation_cues *cues,
                                        const struct iso_presentation_options *options)
{
    if (cues->has_relief && cues->relief.flat.inlier_share >= options->sheet_share) {
        return ISO_CAPTURE_FLAT;
    }
    if (cues->has_relief && is_bent(cues, options)) {
        return ISO_CAPTURE_BENT;
    }
    if (cues->has_size) {
        const double over = iso_presentation_oversize(cues);
        if (over > options->too_large || over < -options->too_small ||
            cues->size.cost_mm2 > options->no_size_cost_mm2) {
            return ISO_CAPTURE_WRONG_SIZE;
        }
    }
    if (cues->has_eyes && cut_out(&cues->eyes[ISO_EYE_R], options) &&
        cut_out(&cues->eyes[ISO_EYE_L], options)) {
        return ISO_CAPTURE_EYES_CUT;
    }
    const bool face = cues->has_relief || cues->has_size || cues->has_eyes;
    return cues->has_sheet && !face ? judge_sheet(&cues->sheet, options) : ISO_CAPTURE_OK;
}

int iso_presentation_new(const struct iso_head_model *model, size_t capacity_px,
                         struct iso_presentation **out)
{
    struct iso_presentation *p = calloc(1, sizeof *p);
    if (!p) {
        return -ENOMEM;
    }
    p->model = model;
    int error = iso_sizer_new(model, &p->sizer);
    if (!error) {
        error = iso_sheet_finder_new(capacity_px, &p->finder);
    }
    if (error) {
        iso_presentation_free(p);
        return error;
    }
    *out = p;
    return 0;
}

void iso_presentation_free(struct iso_presentation *presentation)
{
    if (presentation) {
        iso_sizer_free(presentation->sizer);
        iso_sheet_finder_free(presentation->finder);
        free(presentation);
    }
}

void iso_presentation_measure_face(const struct iso_presentation *presentation,
                                   const struct iso_frame *frame, const struct iso_frame *cleaned,
                                   const struct iso_shape_fit *fit,
                                   const struct iso_shape_residuals *head,
                                   struct iso_presentation_cues *out)
{
    const struct iso_rigid *pose = &fit->pose.camera_from_face;
    struct iso_presentation_cues cues = {.identity_norm = fit->identity_norm};
    cues.fitted_scale = iso_size_of_fit(presentation->model, head->vertex_mm);
    cues.has_relief = iso_relief_measure(cleaned, pose, &cues.relief) == 0;
    cues.has_size = iso_size_measure(presentation->sizer, cleaned, pose, &cues.size) == 0;
    iso_eyes_measure(frame, fit, cues.eyes);
    cues.has_eyes = true;
    *out = cues;
}

void iso_presentation_measure_scene(struct iso_presentation *presentation,
                                    const struct iso_frame *coarse, double near_mm, double far_mm,
                                    const struct iso_presentation_options *options,
                                    struct iso_presentation_cues *out)
{
    struct iso_presentation_cues cues = {0};
    cues.has_sheet = iso_sheet_find(presentation->finder, coarse, near_mm, far_mm,
                                    options->held_area_max_mm2, &cues.sheet) == 0;
    *out = cues;
}

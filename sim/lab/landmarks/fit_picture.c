#include "sim/lab/landmarks/fit_picture.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/extract/extract_inside.h"
#include "core/landmark/meeting.h"
#include "sim/lab/landmarks/measure.h"
#include "sim/lab/picture/fit.h"

static double degrees(double rad)
{
    return rad * 180.0 / M_PI;
}

/* Puts the fitted head into the view, in the camera frame. The caller frees the arrays, even after
 * a failure. */
static int place_head(const struct sim_fit_subject *s, struct iso_vec3 **vertices_mm,
                      bool **measured, struct sim_fit_view *view)
{
    const struct iso_shape_residuals fit = iso_extractor_fit(s->extractor);
    *vertices_mm = calloc(fit.n, sizeof **vertices_mm);
    *measured = calloc(fit.n, sizeof **measured);
    if (!*vertices_mm || !*measured) {
        return -ENOMEM;
    }
    for (uint32_t v = 0; v < fit.n; v++) {
        (*vertices_mm)[v] = iso_rigid_apply(&s->extraction->camera_from_face, fit.vertex_mm[v]);
        (*measured)[v] = fit.meeting[v] == ISO_MEETING_MEASURED;
    }
    view->n_vertices = fit.n;
    view->n_triangles = s->model->n_triangles;
    view->vertices_mm = *vertices_mm;
    view->triangles = (const uint32_t(*)[3])s->model->triangles;
    view->residual_mm = fit.residual_mm;
    view->measured = *measured;
    view->found_mm = s->extraction->landmark_mm;
    return 0;
}

static void describe_fit(const struct iso_extraction *x, char *text, size_t size)
{
    const char *outcome = iso_capture_name(x->outcome);
    if (!x->fitted) {
        (void)snprintf(text, size, "outcome %s, no head was fitted", outcome);
        return;
    }
    (void)snprintf(text, size,
                   "outcome %s    residual %.2f mm    coverage %.2f (fit %.2f)    yaw %+.1f\u00b0  "
                   "pitch %+.1f\u00b0  roll %+.1f\u00b0    %.0f mm away",
                   outcome, x->residual_mm, x->coverage, x->fit_coverage, degrees(x->yaw_rad),
                   degrees(x->pitch_rad), degrees(x->roll_rad), x->distance_mm);
}

static void describe_errors(const struct sim_fit_subject *s, char *text, size_t size)
{
    static const struct iso_vec3 no_offset_mm[ISO_LANDMARKS];
    struct sim_measured_frame f = {.n_known = 0};
    if (s->extraction->fitted && s->truth) {
        f.deviation = sim_deviation_of(s->extraction, s->truth, 0);
        for (int l = 0; l < ISO_LANDMARKS; l++) {
            f.n_known += f.deviation.known[l];
        }
    }
    if (f.n_known == 0) {
        (void)snprintf(text, size, "error not known");
        return;
    }
    sim_measure_frame_errors(no_offset_mm, &f);
    (void)snprintf(text, size, "error of %zu landmarks: mean %.2f mm, worst %.2f mm", f.n_known,
                   f.error_mean_mm, f.error_max_mm);
}

int sim_fit_picture(const struct sim_fit_subject *subject, const char *path,
                    struct iso_fault *fault)
{
    char fit[256], errors[128];
    struct iso_vec3 *vertices_mm = NULL;
    bool *measured = NULL;
    struct sim_fit_view view = {.frame = subject->frame, .caption = {subject->title, fit, errors}};
    int error = subject->extraction->fitted ? place_head(subject, &vertices_mm, &measured, &view)
                                            : 0;
    for (int l = 0; subject->truth && l < ISO_LANDMARKS; l++) {
        if (subject->truth->known[l]) {
            view.true_mm = subject->truth->point_mm;
            view.true_known = subject->truth->known;
        }
    }
    describe_fit(subject->extraction, fit, sizeof fit);
    describe_errors(subject, errors, sizeof errors);
    if (error) {
        (void)iso_fault_set(fault, error, "%s: out of memory", path);
    } else {
        error = sim_picture_fit(&view, path, fault);
    }
    free(vertices_mm);
    free(measured);
    return error;
}

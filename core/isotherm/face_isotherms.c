#include "core/isotherm/face_isotherms.h"

#include <errno.h>
#include <string.h>

/* The isotherm of one landmark at one radius. Returns 0 with n = 0 where there is none. */
static int trace_one(struct iso_tracer *tracer, const struct iso_heated_face *face, int landmark,
                     double radius_mm, int n_points, struct iso_isotherm *out)
{
    const double *heat = &face->heat[(size_t)landmark * (size_t)face->mesh->n_vertices];
    out->n = 0;
    double level;
    if (iso_isotherm_level(face->mesh, heat, radius_mm, &level)) {
        return 0;
    }
    int curves = iso_tracer_run(tracer, face->mesh, face->adjacent, heat, level);
    if (curves < 0) {
        return curves;
    }
    int enclosing = iso_tracer_enclosing(tracer, face->landmark_mm[landmark]);
    if (enclosing >= 0 && iso_isotherm_sample_polar(iso_tracer_curve(tracer, enclosing),
                                                    face->landmark_mm[landmark], n_points, out)) {
        out->n = 0;
    }
    return 0;
}

int iso_face_isotherms(struct iso_tracer *tracer, const struct iso_heated_face *face,
                       struct iso_template *tmpl)
{
    memset(tmpl->points_mm, 0, sizeof tmpl->points_mm);
    memset(tmpl->weight, 0, sizeof tmpl->weight);
    double total = 0.0;
    for (int r = 0; r < tmpl->n_radii; r++) {
        for (int l = 0; l < ISO_LANDMARKS; l++) {
            struct iso_isotherm curve;
            int error = trace_one(tracer, face, l, (double)tmpl->radius_mm[r], tmpl->n_points,
                                  &curve);
            if (error) {
                return error;
            }
            for (int i = 0; i < curve.n; i++) {
                struct iso_vec3 p = curve.points_mm[i];
                double measured = iso_face_patch_measured(face->patch, p.x, p.y);
                float *point = tmpl->points_mm[r][l][i];
                point[0] = (float)p.x;
                point[1] = (float)p.y;
                point[2] = (float)p.z;
                tmpl->weight[r][l][i] = curve.weight[i] * (float)measured;
                total += (double)tmpl->weight[r][l][i];
            }
        }
    }
    tmpl->quality = (float)(total / (tmpl->n_radii * ISO_LANDMARKS * tmpl->n_points));
    return 0;
}

#include "core/isotherm/face_isotherms.h"

#include <errno.h>
#include <string.h>

#include "core/isotherm/rays.h"

/* Samples the curve that encloses a landmark. Sets n = 0 if there is none. */
static void sample(const struct iso_tracer *curves, struct iso_vec3 landmark_mm,
                   const struct iso__rays *rays, struct iso_isotherm *out)
{
    const int enclosing = iso_tracer_enclosing(curves, landmark_mm);
    if (enclosing < 0 ||
        iso__isotherm_sample_rays(iso_tracer_curve(curves, enclosing), landmark_mm, rays, out)) {
        out->n = 0;
    }
}

/* Finds the isotherm of one landmark at one radius on a mesh. Returns 0 with n = 0 if there is
 * none; -ENOSPC if the tracer is too small; -ENOMEM. */
static int trace_on_mesh(struct iso_tracer *tracer, const struct iso_heated_face *face,
                         int landmark, double radius_mm, const struct iso__rays *rays,
                         struct iso_isotherm *out)
{
    const double *heat = &face->heat[(size_t)landmark * (size_t)face->mesh->n_vertices];
    out->n = 0;
    double level;
    const int error = iso_isotherm_level(face->mesh, heat, radius_mm, &level);
    if (error) {
        return error == -ERANGE ? 0 : error;
    }
    const int curves = iso_tracer_run(tracer, face->mesh, face->adjacent, heat, level);
    if (curves < 0) {
        return curves;
    }
    sample(tracer, face->landmark_mm[landmark], rays, out);
    return 0;
}

/* Writes a curve to the template. Returns the sum of its weights. */
static double keep(const struct iso_isotherm *curve, const struct iso_face_patch *patch, int radius,
                   int landmark, struct iso_template *tmpl)
{
    double total = 0.0;
    for (int i = 0; i < curve->n; i++) {
        const struct iso_vec3 p = curve->points_mm[i];
        const double measured = patch ? iso_face_patch_measured(patch, p.x, p.y) : 1.0;
        float *point = tmpl->points_mm[radius][landmark][i];
        point[0] = (float)p.x;
        point[1] = (float)p.y;
        point[2] = (float)p.z;
        tmpl->weight[radius][landmark][i] = curve->weight[i] * (float)measured;
        total += (double)tmpl->weight[radius][landmark][i];
    }
    return total;
}

static void begin(struct iso_template *tmpl)
{
    memset(tmpl->points_mm, 0, sizeof tmpl->points_mm);
    memset(tmpl->weight, 0, sizeof tmpl->weight);
}

static void end(struct iso_template *tmpl, double total)
{
    tmpl->quality = (float)(total / (tmpl->n_radii * ISO_LANDMARKS * tmpl->n_points));
}

int iso_face_isotherms(struct iso_tracer *tracer, const struct iso_heated_face *face,
                       struct iso_template *tmpl)
{
    struct iso__rays rays;
    begin(tmpl);
    iso__rays_set(&rays, tmpl->n_points);
    double total = 0.0;
    for (int r = 0; r < tmpl->n_radii; r++) {
        for (int l = 0; l < ISO_LANDMARKS; l++) {
            struct iso_isotherm curve;
            const int error = trace_on_mesh(tracer, face, l, (double)tmpl->radius_mm[r], &rays,
                                            &curve);
            if (error) {
                return error;
            }
            total += keep(&curve, face->patch, r, l, tmpl);
        }
    }
    end(tmpl, total);
    return 0;
}

/* The isotherms of one landmark. The sums of their weights go to weight[radius][landmark]. */
static void trace_on_grid(struct iso_grid_tracer *tracer, const struct iso_heated_grid *face,
                          int landmark, const struct iso__rays *rays, struct iso_template *tmpl,
                          double weight[][ISO_LANDMARKS])
{
    iso_grid_tracer_begin(tracer, face->grid, &face->heat[landmark]);
    for (int r = tmpl->n_radii - 1; r >= 0; r--) { /* usually from the largest down */
        struct iso_isotherm curve;
        double level;
        curve.n = 0;
        if (iso_grid_tracer_run(tracer, (double)tmpl->radius_mm[r], &level) > 0) {
            sample(iso_grid_tracer_curves(tracer), face->landmark_mm[landmark], rays, &curve);
        }
        weight[r][landmark] = keep(&curve, face->patch, r, landmark, tmpl);
    }
}

void iso_face_isotherms_on_grid(struct iso_grid_tracer *tracer, const struct iso_heated_grid *face,
                                struct iso_template *tmpl)
{
    double weight[ISO_TEMPLATE_RADII_MAX][ISO_LANDMARKS], total = 0.0;
    struct iso__rays rays;
    begin(tmpl);
    iso__rays_set(&rays, tmpl->n_points);
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        trace_on_grid(tracer, face, l, &rays, tmpl, weight);
    }
    for (int r = 0; r < tmpl->n_radii; r++) { /* in the order of iso_face_isotherms */
        for (int l = 0; l < ISO_LANDMARKS; l++) {
            total += weight[r][l];
        }
    }
    end(tmpl, total);
}

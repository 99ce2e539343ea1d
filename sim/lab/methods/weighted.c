/* Heat front propagation contours on a weighted manifold: chapter 5 applied to faces.
 *
 * Heat flows on the face as if skin that scatters more infrared light were denser (Abdelrahman
 * 2013, 5.11 to 5.13; the weight is that of sim/lab/methods/reflectance.h). So isotherms bend
 * around brows, lips and lids as well as along the relief. All other steps are the appliance's
 * comparison by distance: mesh, sources, t, radii (the enclosed areas are areas of the surface, not
 * of the density), sampling by polar angle, trimmed distance.
 *
 * `hfpc-weighted-1` is the control: the same computation on the same mesh with density 1
 * everywhere. The two differ only by the weight. The control and `hfpc` without a metric differ
 * only by the implementation. */
#include <errno.h>
#include <stdlib.h>

#include "core/isotherm/face_isotherms.h"
#include "core/match/distance.h"
#include "isotherm/heat_kernel.h"
#include "sim/lab/methods/method.h"
#include "sim/lab/methods/scan_mesh.h"

/* Intermediate data between a face and its template. */
struct work {
    struct sim_scan_mesh *face;
    double *density; /* [n_vertices] */
    double *heat;    /* [ISO_LANDMARKS][n_vertices] */
    struct iso_symmetric *stiffness, *mass;
    struct iso_heat_direct *solver;
    struct iso_tracer *tracer;
};

static void work_done(struct work *w)
{
    sim_scan_mesh_free(w->face);
    free(w->density);
    free(w->heat);
    iso_symmetric_free(w->stiffness);
    iso_symmetric_free(w->mass);
    iso_heat_direct_free(w->solver);
    iso_tracer_free(w->tracer);
}

static int make_room(struct work *w)
{
    const int32_t n = w->face->mesh->n_vertices, nnz = n + 3 * w->face->mesh->n_triangles;
    const struct iso_heat_direct_options direct = {.n_capacity = n, .nnz_capacity = nnz};
    int error = iso_symmetric_new(n, nnz, &w->stiffness);
    if (!error) {
        error = iso_symmetric_new(n, nnz, &w->mass);
    }
    if (!error) {
        error = iso_heat_direct_new(&direct, &w->solver);
    }
    if (!error) {
        error = iso_tracer_new(w->face->mesh->n_triangles, &w->tracer);
    }
    w->density = calloc((size_t)n, sizeof *w->density);
    w->heat = calloc((size_t)ISO_LANDMARKS * (size_t)n, sizeof *w->heat);
    return error || (w->density && w->heat) ? error : -ENOMEM;
}

/* `reflectance` is on the face's grid, or NULL for density 1. */
static int release_heat(const float *reflectance, double t_mm2, struct work *w)
{
    const struct iso_mesh *mesh = w->face->mesh;
    for (int32_t i = 0; i < mesh->n_vertices; i++) {
        w->density[i] = reflectance ? (double)reflectance[w->face->pixel[i]] : 1.0;
    }
    const int error = iso_stiffness_mass_weighted(mesh, ISO_MASS_CONSISTENT, w->density,
                                                  w->stiffness, w->mass);
    if (error) {
        return error;
    }
    return iso_heat_direct(w->solver, mesh, w->stiffness, w->mass, w->face->sources, ISO_LANDMARKS,
                           &t_mm2, 1, w->heat);
}

/* Multiplies the weight of each point by the measured share of the surface there, so that filled
 * surface does not count. */
static void weigh(const struct sim_scan *face, struct iso_template *tmpl)
{
    for (int i = 0; i < tmpl->n_radii * ISO_LANDMARKS * tmpl->n_points; i++) {
        const int k = i % tmpl->n_points, l = i / tmpl->n_points % ISO_LANDMARKS;
        const int r = i / tmpl->n_points / ISO_LANDMARKS;
        const float *p = tmpl->points_mm[r][l][k];
        double z, share = 0.0;
        (void)sim_scan_height(face, (double)p[0], (double)p[1], &z, &share);
        tmpl->weight[r][l][k] *= (float)share;
    }
}

static int trace(const struct iso_extract_options *options, const struct sim_scan *face,
                 const struct work *w, struct iso_template *tmpl)
{
    struct iso_heated_face heated = {
        .mesh = w->face->mesh,
        .adjacent = (const int32_t(*)[3])w->face->adjacent,
        .heat = w->heat,
    };
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        heated.landmark_mm[l] = iso_mesh_point_at(w->face->mesh, w->face->sources[l]);
    }
    tmpl->n_radii = (uint16_t)options->n_radii;
    tmpl->n_points = (uint16_t)options->n_points;
    tmpl->n_frames = 1;
    for (int r = 0; r < options->n_radii; r++) {
        tmpl->radius_mm[r] = (float)options->radius_mm[r];
    }
    const int error = iso_face_isotherms(w->tracer, &heated, tmpl);
    if (!error) {
        weigh(face, tmpl);
    }
    return error;
}

static void discard(void *description)
{
    if (description) {
        iso_template_wipe(description);
        free(description);
    }
}

static int describe(const struct sim_scan *face, const float *reflectance, void **description)
{
    const struct iso_extract_options options = iso_extract_options_default();
    struct work w = {0};
    struct iso_template *tmpl = calloc(1, sizeof *tmpl);
    int error = tmpl ? sim_scan_mesh_new(face, 1, &w.face) : -ENOMEM;
    if (!error) {
        error = make_room(&w);
    }
    if (!error) {
        error = release_heat(reflectance, options.t_mm2, &w);
    }
    if (!error) {
        error = trace(&options, face, &w, tmpl);
    }
    work_done(&w);
    if (error) {
        discard(tmpl);
        return error;
    }
    *description = tmpl;
    return 0;
}

static int describe_weighted(const void *knowledge, const struct sim_scan *face, void **description)
{
    (void)knowledge;
    return face->reflectance ? describe(face, face->reflectance, description) : -ENODATA;
}

static int describe_evenly(const void *knowledge, const struct sim_scan *face, void **description)
{
    (void)knowledge;
    return describe(face, NULL, description);
}

static int distance(const void *knowledge, const void *probe, const void *gallery, double *out)
{
    (void)knowledge;
    const struct iso_match_options options = iso_match_options_default();
    struct iso_icp_workspace *work = malloc(sizeof *work);
    const int error = work ? iso_match_distance(work, probe, gallery, &options, out) : -ENOMEM;
    free(work);
    return error;
}

const struct sim_method sim_method_hfpc_weighted = {
    .name = "hfpc-weighted",
    .source = "Abdelrahman 2013, chapters 6 and 5: the appliance's contours by distance, on a "
              "surface whose density is the skin's infrared reflectance",
    .infrared = true,
    .describe = describe_weighted,
    .discard = discard,
    .distance = distance,
};

const struct sim_method sim_method_hfpc_weighted_1 = {
    .name = "hfpc-weighted-1",
    .source = "control of hfpc-weighted: the same on the same mesh, with density 1",
    .describe = describe_evenly,
    .discard = discard,
    .distance = distance,
};

/* Heat front propagation contours as printed (Abdelrahman 2013, sections 6.2.2 and 6.2.3).
 *
 * The heat kernel comes from the first 100 eigenpairs (6.1). Each of the 12 landmarks has one
 * contour of equal heat value; the value is the same for every face (the value in the plane at
 * 18 mm). Fixed points are equally spaced along the contour by arc length. Rigid ICP (appendix
 * F) registers one set of points to the other. The distance is the L2 norm of the differences of
 * corresponding points, here their root mean square, so that contours that leave the face do not
 * count as similar. Mesh, landmarks and t are the appliance's, so that the comparison is only
 * about how contours are made and matched. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/registration/icp.h"
#include "isotherm/eigenpairs.h"
#include "isotherm/heat_kernel.h"
#include "isotherm/isotherm_curve.h"
#include "sim/lab/methods/method.h"
#include "sim/lab/methods/scan_mesh.h"

enum { EIGENPAIRS = 100, POINTS = 32, ALL_POINTS = ISO_LANDMARKS * POINTS, ICP_ITERATIONS = 20 };
static const double t_mm2 = 100.0, radius_mm = 18.0;

struct contours {
    float point_mm[ALL_POINTS][3]; /* POINTS of each landmark */
    float weight[ALL_POINTS];      /* 1, or 0 for a contour that runs off the face */
};

/* Intermediate data between a face and its contours. */
struct work {
    struct sim_scan_mesh *face;
    struct iso_symmetric *stiffness, *mass;
    struct iso_tracer *tracer;
    double *heat; /* [ISO_LANDMARKS][face->mesh->n_vertices] */
};

static void work_done(struct work *w)
{
    sim_scan_mesh_free(w->face);
    iso_symmetric_free(w->stiffness);
    iso_symmetric_free(w->mass);
    iso_tracer_free(w->tracer);
    free(w->heat);
}

static int release_heat(struct work *w)
{
    const struct iso_mesh *mesh = w->face->mesh;
    const int32_t n = mesh->n_vertices, nnz = n + 3 * mesh->n_triangles;
    struct iso_eigenpairs *pairs = NULL;
    int error = iso_symmetric_new(n, nnz, &w->stiffness);
    if (!error) {
        error = iso_symmetric_new(n, nnz, &w->mass);
    }
    if (!error) {
        error = iso_stiffness_mass(mesh, ISO_MASS_CONSISTENT, w->stiffness, w->mass);
    }
    w->heat = calloc((size_t)ISO_LANDMARKS * (size_t)n, sizeof *w->heat);
    if (error || !w->heat) {
        if (error) {
            return error;
        }
        return -ENOMEM;
    }
    error = iso_eigenpairs_new(w->stiffness, w->mass, EIGENPAIRS, 1e-10, &pairs);
    if (!error) {
        iso_heat_spectral(pairs, mesh, w->face->sources, ISO_LANDMARKS, &t_mm2, 1, w->heat);
    }
    iso_eigenpairs_free(pairs);
    return error;
}

/* The heat value in the plane at the radius (isotherm/heat_kernel.h). */
static double contour_level(void)
{
    const double pi = 3.14159265358979323846;
    return exp(-radius_mm * radius_mm / (4.0 * t_mm2)) / (4.0 * pi * t_mm2);
}

static int trace_contours(struct work *w, struct contours *contours)
{
    const struct iso_mesh *mesh = w->face->mesh;
    int error = iso_tracer_new(mesh->n_triangles, &w->tracer);
    for (int l = 0; l < ISO_LANDMARKS && !error; l++) {
        const double *heat = &w->heat[(size_t)l * (size_t)mesh->n_vertices];
        struct iso_vec3 at = iso_mesh_point_at(mesh, w->face->sources[l]);
        const int n = iso_tracer_run(w->tracer, mesh, (const int32_t(*)[3])w->face->adjacent, heat,
                                     contour_level());
        const int index = n < 0 ? n : iso_tracer_enclosing(w->tracer, at);
        struct iso_isotherm sampled;
        if (n < 0) {
            error = n;
        } else if (index >= 0 && iso_tracer_curve(w->tracer, index).closed &&
                   iso_isotherm_sample_arc(iso_tracer_curve(w->tracer, index), at, POINTS,
                                           &sampled) == 0) {
            for (int i = 0; i < POINTS; i++) {
                float *p = contours->point_mm[l * POINTS + i];
                p[0] = (float)sampled.points_mm[i].x;
                p[1] = (float)sampled.points_mm[i].y;
                p[2] = (float)sampled.points_mm[i].z;
                contours->weight[l * POINTS + i] = 1.0f;
            }
        }
    }
    return error;
}

static void discard(void *description)
{
    if (description) {
        explicit_bzero(description, sizeof(struct contours));
        free(description);
    }
}

static int describe(const void *knowledge, const struct sim_scan *face, void **description)
{
    (void)knowledge;
    struct work w = {0};
    struct contours *contours = calloc(1, sizeof *contours);
    int error = contours ? sim_scan_mesh_new(face, 1, &w.face) : -ENOMEM;
    if (!error) {
        error = release_heat(&w);
    }
    if (!error) {
        error = trace_contours(&w, contours);
    }
    work_done(&w);
    if (error) {
        discard(contours);
        return error;
    }
    *description = contours;
    return 0;
}

/* Root mean square of the differences of corresponding points. */
static double l2_norm(const struct contours *probe, const struct contours *gallery,
                      const struct iso_affine *gallery_from_probe)
{
    double sum = 0.0;
    size_t n = 0;
    for (int i = 0; i < ALL_POINTS; i++) {
        if (probe->weight[i] > 0.0f && gallery->weight[i] > 0.0f) {
            const float *p = probe->point_mm[i], *g = gallery->point_mm[i];
            struct iso_vec3 source = {(double)p[0], (double)p[1], (double)p[2]};
            struct iso_vec3 target = {(double)g[0], (double)g[1], (double)g[2]};
            struct iso_vec3 d = iso_sub(iso_affine_apply(gallery_from_probe, source), target);
            sum += iso_dot(d, d);
            n++;
        }
    }
    return sqrt(sum / (double)n);
}

static int distance(const void *knowledge, const void *probe, const void *gallery, double *out)
{
    (void)knowledge;
    const struct contours *p = probe, *g = gallery;
    const struct iso_icp_points source = {ISO_LANDMARKS, POINTS, p->point_mm, p->weight};
    const struct iso_icp_points target = {ISO_LANDMARKS, POINTS, g->point_mm, g->weight};
    const struct iso_icp_options options = {
        .transform = ISO_ICP_RIGID,
        .pairing = ISO_ICP_NEAREST,
        .trim = 1.0,
        .iterations_max = ICP_ITERATIONS,
        .tolerance_mm = 1e-4,
    };
    struct iso_icp_result result;
    struct iso_icp_workspace *work = malloc(sizeof *work);
    const int error = work ? iso_icp(work, &source, &target, &options, &result) : -ENOMEM;
    free(work);
    if (!error) {
        *out = l2_norm(p, g, &result.target_from_source);
    }
    return error;
}

const struct sim_method sim_method_hfpc_literal = {
    .name = "hfpc-literal",
    .source = "Abdelrahman 2013, chapter 6 as printed: 100 eigenpairs, one contour of equal heat a "
              "landmark, arc length, rigid ICP, L2",
    .describe = describe,
    .discard = discard,
    .distance = distance,
};

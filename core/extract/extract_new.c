#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/bytes.h"
#include "core/base/crc32.h"
#include "core/extract/extract_workspace.h"

/* Raise this number with every change of the code that moves the points of a template. */
enum { ALGORITHM_REVISION = 3 };

struct iso_extract_options iso_extract_options_default(void)
{
    return (struct iso_extract_options){
        .t_mm2 = 100.0,
        .n_radii = 4,
        .radius_mm = {12.0, 20.0, 28.0, 36.0},
        .n_points = 16,
        .crop_radius_mm = 100.0,
        .spacing_mm = 2.0,
        .smoothing_mm = 3.0,
        .outlier_mm = 20.0,
        .fit = {.rigid_iterations = 4,
                .iterations = 10,
                .jaws = 3,
                .cutoff_first_mm = 12.0,
                .cutoff_last_mm = 6.0,
                .soft_weight = 1.0,
                .identity_stiffness_mm2 = 10.0,
                .expression_stiffness_mm2 = 3.0},
        .distance_min_mm = 300.0,
        .distance_max_mm = 1500.0,
        .yaw_max_rad = 40.0 * M_PI / 180.0,
        .pitch_max_rad = 40.0 * M_PI / 180.0,
        .heat = ISO_HEAT_GRID,
    };
}

static bool in_range(double value, double low, double high)
{
    return value >= low && value <= high; /* false for NaN */
}

static bool options_sane(const struct iso_extract_options *o)
{
    bool sane = in_range(o->t_mm2, 1.0, 10000.0) &&
                in_range(o->n_points, 4, ISO_TEMPLATE_POINTS_MAX) &&
                in_range(o->n_radii, 1, ISO_TEMPLATE_RADII_MAX) &&
                in_range(o->distance_min_mm, 50.0, 10000.0) &&
                in_range(o->distance_max_mm, o->distance_min_mm, 10000.0) &&
                (o->heat == ISO_HEAT_GRID || o->heat == ISO_HEAT_DIRECT ||
                 o->heat == ISO_HEAT_SPECTRAL) &&
                in_range(o->yaw_max_rad, 0.0, M_PI_2) && in_range(o->pitch_max_rad, 0.0, M_PI_2) &&
                memchr(o->sensor, '\0', sizeof o->sensor) != NULL;
    for (int r = 0; sane && r < o->n_radii; r++) {
        sane = in_range(o->radius_mm[r], 3.0, o->crop_radius_mm);
    }
    return sane;
}

/* A hash of everything that moves the points of a template. Options that only decide whether there
 * is a template do not count. */
static uint32_t algorithm_of(const struct iso_head_model *model,
                             const struct iso_extract_options *o)
{
    uint8_t bytes[26 * 4 + ISO_TEMPLATE_RADII_MAX * 4], *p = bytes;
    p = iso_put_u32(p, ALGORITHM_REVISION);
    p = iso_put_u32(p, model->crc32);
    p = iso_put_u32(p, (uint32_t)o->n_radii);
    p = iso_put_u32(p, (uint32_t)o->n_points);
    p = iso_put_u32(p, (uint32_t)o->fit.rigid_iterations);
    p = iso_put_u32(p, (uint32_t)o->fit.iterations);
    p = iso_put_u32(p, (uint32_t)o->fit.jaws);
    p = iso_put_u32(p, (uint32_t)o->fit.vertices);
    p = iso_put_u32(p, (uint32_t)o->heat);
    const double values[] = {o->t_mm2,
                             o->crop_radius_mm,
                             o->spacing_mm,
                             o->smoothing_mm,
                             o->outlier_mm,
                             o->fit.cutoff_first_mm,
                             o->fit.cutoff_last_mm,
                             o->fit.soft_weight,
                             o->fit.identity_stiffness_mm2,
                             o->fit.expression_stiffness_mm2};
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
        p = iso_put_f32(p, (float)values[i]);
    }
    for (int r = 0; r < o->n_radii; r++) {
        p = iso_put_f32(p, (float)o->radius_mm[r]);
    }
    return iso_crc32(0, bytes, (size_t)(p - bytes));
}

static int new_find(struct iso_extractor *x)
{
    x->coarse.depth_mm = calloc(ISO_EXTRACT_COARSE_PX_MAX, sizeof *x->coarse.depth_mm);
    if (!x->coarse.depth_mm) {
        return -ENOMEM;
    }
    int error = iso_candidate_finder_new(ISO_EXTRACT_COARSE_PX_MAX, &x->finder);
    if (!error) {
        error = iso_pose_vertices_new(x->model, ISO_EXTRACT_SEARCH_VERTICES, 1.0,
                                      &x->search_vertices);
    }
    struct iso_shape_fit_options rough = x->options.fit;
    rough.rigid_iterations = 1;
    rough.iterations = 4;
    rough.jaws = 1;
    rough.vertices = ISO_EXTRACT_SEARCH_FIT_VERTICES;
    if (!error) {
        error = iso_shape_fitter_new(x->model, &rough, &x->search_fitter);
    }
    if (!error) {
        error = iso_shape_fitter_new(x->model, &x->options.fit, &x->fitter);
    }
    x->parts = calloc(x->model->n_vertices, sizeof *x->parts);
    if (!error && !x->parts) {
        error = -ENOMEM;
    }
    if (!error) {
        iso_face_parts_of(x->model, x->parts);
        error = iso_presentation_new(x->model, ISO_EXTRACT_COARSE_PX_MAX, &x->presentation);
    }
    return error;
}

static int new_patch(struct iso_extractor *x, int32_t *n_px)
{
    const struct iso_face_patch_options options = {
        .radius_mm = x->options.crop_radius_mm,
        .spacing_mm = x->options.spacing_mm,
        .smoothing_mm = x->options.smoothing_mm,
        .outlier_mm = x->options.outlier_mm,
    };
    int error = iso_face_patch_new(x->model, &options, &x->patch);
    if (error) {
        return error;
    }
    const struct iso_frame *grid = iso_face_patch_frame(x->patch);
    *n_px = grid->width_px * grid->height_px;
    /* The patch is whole and smooth by construction, so that no edge is cut. */
    const struct iso_triangulate_options whole = {.jump_mm = ISO_FACE_PATCH_ORIGIN_MM};
    error = iso_triangulator_new((size_t)*n_px, &whole, &x->patch_triangulator);
    if (!error) {
        error = iso_mesh_new(*n_px, 2 * *n_px, &x->mesh);
    }
    if (!error) {
        x->adjacent = calloc(2 * (size_t)*n_px, sizeof *x->adjacent);
        error = x->adjacent ? 0 : -ENOMEM;
    }
    if (!error) {
        error = iso_grid_new(grid->width_px, grid->height_px, &x->grid);
    }
    return error;
}

static int new_heat(struct iso_extractor *x, int32_t n_px)
{
    const int32_t nnz = n_px + 3 * 2 * n_px;
    int error = iso_symmetric_new(n_px, nnz, &x->stiffness);
    if (!error) {
        error = iso_symmetric_new(n_px, nnz, &x->mass);
    }
    const struct iso_heat_direct_options direct = {.n_capacity = n_px, .nnz_capacity = nnz};
    if (!error) {
        error = iso_heat_direct_new(&direct, &x->direct);
    }
    if (!error) {
        error = iso_tracer_new(2 * n_px, &x->tracer);
    }
    if (!error) {
        x->heat = calloc(ISO_LANDMARKS * (size_t)n_px, sizeof *x->heat);
        error = x->heat ? 0 : -ENOMEM;
    }
    if (!error) {
        error = iso_heat_grid_new(x->grid, ISO_LANDMARKS, &x->heat_grid);
    }
    if (!error) {
        error = iso_grid_tracer_new(x->grid, &x->grid_tracer);
    }
    return error;
}

int iso_extractor_new(const struct iso_head_model *model, const struct iso_extract_options *options,
                      struct iso_extractor **out)
{
    if (!options_sane(options)) {
        return -EINVAL;
    }
    struct iso_extractor *x = calloc(1, sizeof *x);
    if (!x) {
        return -ENOMEM;
    }
    x->model = model;
    x->options = *options;
    x->algorithm = algorithm_of(model, options);
    int32_t n_px = 0;
    int error = new_find(x);
    if (!error) {
        error = iso_cleaner_new(ISO_EXTRACT_CLEAN_PX_MAX, &x->cleaner);
    }
    if (!error) {
        error = new_patch(x, &n_px);
    }
    if (!error) {
        error = new_heat(x, n_px);
    }
    if (error) {
        iso_extractor_free(x);
        return error;
    }
    *out = x;
    return 0;
}

/* Wipes the face from the buffers of the extractor itself. The cleaner, the patch, the fitters, the
 * grid and its heat solver wipe theirs when they are freed. */
static void wipe_face(struct iso_extractor *x)
{
    if (x->coarse.depth_mm) {
        explicit_bzero(x->coarse.depth_mm, ISO_EXTRACT_COARSE_PX_MAX * sizeof *x->coarse.depth_mm);
    }
    if (x->mesh) {
        explicit_bzero(x->mesh->vertices_mm,
                       (size_t)x->mesh->vertex_capacity * sizeof *x->mesh->vertices_mm);
    }
    if (x->heat) {
        explicit_bzero(x->heat, ISO_LANDMARKS * (size_t)x->mesh->vertex_capacity * sizeof *x->heat);
    }
    explicit_bzero(&x->head, sizeof x->head);
    explicit_bzero(x->source_mm, sizeof x->source_mm);
}

void iso_extractor_free(struct iso_extractor *extractor)
{
    if (!extractor) {
        return;
    }
    struct iso_extractor *x = extractor;
    wipe_face(x);
    free(x->coarse.depth_mm);
    free(x->parts);
    iso_candidate_finder_free(x->finder);
    iso_pose_vertices_free(x->search_vertices);
    iso_shape_fitter_free(x->search_fitter);
    iso_shape_fitter_free(x->fitter);
    iso_presentation_free(x->presentation);
    iso_cleaner_free(x->cleaner);
    iso_face_patch_free(x->patch);
    iso_triangulator_free(x->patch_triangulator);
    iso_mesh_free(x->mesh);
    free(x->adjacent);
    iso_symmetric_free(x->stiffness);
    iso_symmetric_free(x->mass);
    iso_heat_direct_free(x->direct);
    iso_tracer_free(x->tracer);
    free(x->heat);
    iso_grid_free(x->grid);
    iso_heat_grid_free(x->heat_grid);
    iso_grid_tracer_free(x->grid_tracer);
    free(x);
}

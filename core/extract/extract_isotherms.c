/* The second half of the extractor: from the face patch to the points of a template. */
#include <errno.h>
#include <string.h>

#include "core/extract/extract_inside.h"
#include "core/extract/extract_workspace.h"

const char *iso_heat_method_name(enum iso_heat_method method)
{
    static const char *const names[] = {"grid", "direct", "spectral"};
    return (unsigned)method < sizeof names / sizeof *names ? names[method] : NULL;
}

/* The position in the patch of a landmark of the head without its expression. */
static void place_of(const struct iso_extractor *x, int landmark, double *column, double *row)
{
    const struct iso_vec3 at = x->head.neutral_mm[landmark];
    iso_face_patch_pixel(x->patch, at.x, at.y, column, row);
}

/* Makes the grid of the patch and places the landmarks on it. No mesh is made, and the mesh of the
 * previous frame is emptied. */
static int make_grid(struct iso_extractor *x)
{
    x->mesh->n_vertices = x->mesh->n_triangles = 0;
    int error = iso_grid_build(x->grid, iso_face_patch_frame(x->patch), ISO_FACE_PATCH_ORIGIN_MM);
    for (int l = 0; l < ISO_LANDMARKS && !error; l++) {
        double column, row;
        place_of(x, l, &column, &row);
        error = iso_grid_locate(x->grid, column, row, &x->grid_sources[l]);
        if (!error) {
            x->source_mm[l] = iso_grid_point_at(x->grid, &x->grid_sources[l]);
        }
    }
    return error;
}

/* Makes a mesh of the patch, in the face frame. */
static int make_mesh(const struct iso_extractor *x)
{
    const int error = iso_triangulate(x->patch_triangulator, iso_face_patch_frame(x->patch),
                                      x->mesh);
    for (int32_t i = 0; !error && i < x->mesh->n_vertices; i++) {
        x->mesh->vertices_mm[i] = iso_face_from_patch(x->mesh->vertices_mm[i]);
    }
    return error;
}

/* Makes the mesh of the patch, finds the neighbours of its triangles and places the landmarks on
 * it. */
static int make_mesh_with_sources(struct iso_extractor *x)
{
    int error = make_mesh(x);
    if (error) {
        return error;
    }
    iso_triangulate_adjacency(x->patch_triangulator, x->adjacent);
    for (int l = 0; l < ISO_LANDMARKS && !error; l++) {
        double column, row;
        place_of(x, l, &column, &row);
        error = iso_triangulate_locate(x->patch_triangulator, column, row, &x->sources[l]);
        if (!error) {
            x->source_mm[l] = iso_mesh_point_at(x->mesh, x->sources[l]);
        }
    }
    return error;
}

int iso__extract_surface(struct iso_extractor *x, struct iso_extraction *out)
{
    x->on_grid = x->options.heat == ISO_HEAT_GRID;
    memset(&out->tmpl, 0, sizeof out->tmpl);
    iso__extract_upper_face(x->patch, &out->tmpl.upper);
    const int error = x->on_grid ? make_grid(x) : make_mesh_with_sources(x);
    for (int l = 0; l < ISO_LANDMARKS && !error; l++) {
        out->source_mm[l] = iso_rigid_apply(&out->camera_from_face, x->source_mm[l]);
    }
    return error;
}

static int release_directly(struct iso_extractor *x, enum iso_mass mass)
{
    int error = iso_stiffness_mass(x->mesh, mass, x->stiffness, x->mass);
    if (!error) {
        error = iso_heat_direct(x->direct, x->mesh, x->stiffness, x->mass, x->sources,
                                ISO_LANDMARKS, &x->options.t_mm2, 1, x->heat);
    }
    return error;
}

static int release_spectrally(struct iso_extractor *x)
{
    struct iso_eigenpairs *pairs;
    int error = iso_stiffness_mass(x->mesh, ISO_MASS_CONSISTENT, x->stiffness, x->mass);
    if (!error) {
        error = iso_eigenpairs_new(x->stiffness, x->mass, ISO_EXTRACT_EIGENPAIRS, 1e-10, &pairs);
    }
    if (!error) {
        iso_heat_spectral(pairs, x->mesh, x->sources, ISO_LANDMARKS, &x->options.t_mm2, 1, x->heat);
        iso_eigenpairs_free(pairs);
    }
    return error;
}

static int release_on_grid(struct iso_extractor *x)
{
    double radius_mm = 0.0;
    for (int r = 0; r < x->options.n_radii; r++) {
        radius_mm = fmax(radius_mm, x->options.radius_mm[r]);
    }
    const struct iso_heat_grid_request request = {
        .sources = x->grid_sources,
        .n_sources = ISO_LANDMARKS,
        .t_mm2 = x->options.t_mm2,
        .radius_mm = radius_mm,
    };
    int error = iso_heat_grid(x->heat_grid, x->grid, &request);
    if (error == -ERANGE) { /* too stiff: the general solver with the same mass */
        x->on_grid = false;
        error = make_mesh_with_sources(x);
        if (!error) {
            error = release_directly(x, ISO_MASS_LUMPED);
        }
    }
    return error;
}

int iso__extract_heat(struct iso_extractor *x)
{
    switch (x->options.heat) {
    case ISO_HEAT_GRID:
        return release_on_grid(x);
    case ISO_HEAT_DIRECT:
        return release_directly(x, ISO_MASS_CONSISTENT);
    case ISO_HEAT_SPECTRAL:
        return release_spectrally(x);
    }
    return -EINVAL;
}

static int trace_on_mesh(struct iso_extractor *x, struct iso_template *tmpl)
{
    struct iso_heated_face face = {
        .mesh = x->mesh,
        .adjacent = (const int32_t(*)[3])x->adjacent,
        .patch = x->patch,
        .heat = x->heat,
    };
    memcpy(face.landmark_mm, x->source_mm, sizeof face.landmark_mm);
    return iso_face_isotherms(x->tracer, &face, tmpl);
}

static void trace_on_grid(struct iso_extractor *x, struct iso_template *tmpl)
{
    struct iso_heated_grid face = {.grid = x->grid, .patch = x->patch};
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        face.heat[l] = iso_heat_grid_column(x->heat_grid, l);
    }
    memcpy(face.landmark_mm, x->source_mm, sizeof face.landmark_mm);
    iso_face_isotherms_on_grid(x->grid_tracer, &face, tmpl);
}

int iso__extract_isotherms(struct iso_extractor *x, struct iso_template *tmpl)
{
    tmpl->algorithm = x->algorithm;
    memcpy(tmpl->sensor, x->options.sensor, sizeof tmpl->sensor);
    tmpl->n_radii = (uint16_t)x->options.n_radii;
    tmpl->n_points = (uint16_t)x->options.n_points;
    tmpl->n_frames = 1;
    for (int r = 0; r < x->options.n_radii; r++) {
        tmpl->radius_mm[r] = (float)x->options.radius_mm[r];
    }
    if (x->on_grid) {
        trace_on_grid(x, tmpl);
        return 0;
    }
    return trace_on_mesh(x, tmpl);
}

const struct iso_mesh *iso_extractor_mesh(const struct iso_extractor *x)
{
    if (x->on_grid && x->mesh->n_triangles == 0 && make_mesh(x)) {
        x->mesh->n_vertices = x->mesh->n_triangles = 0; /* no patch was made yet */
    }
    return x->mesh;
}

const struct iso_face_patch *iso_extractor_patch(const struct iso_extractor *x)
{
    return x->patch;
}

const double *iso_extractor_heat(const struct iso_extractor *x, enum iso_landmark landmark)
{
    double *heat = &x->heat[(size_t)landmark * (size_t)iso_extractor_mesh(x)->n_vertices];
    if (x->on_grid) { /* the mesh's vertices are the grid's, row by row */
        const float *column = iso_heat_grid_column(x->heat_grid, (int)landmark).value;
        int32_t n = 0;
        for (int row = 0; row < x->grid->height; row++) {
            for (int i = row * x->grid->stride; i < row * x->grid->stride + x->grid->width; i++) {
                if (x->grid->share_mm2[i] > 0.0f) {
                    heat[n++] = (double)column[i];
                }
            }
        }
    }
    return heat;
}

#include "sim/lab/methods/scan_mesh.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/surface/face_patch.h"
#include "isotherm/triangulate.h"

/* Data that only the construction needs. */
struct making {
    const struct sim_scan *face;
    int step, first, side; /* of the part of the grid that becomes the mesh */
    struct iso_frame *frame;
    struct iso_triangulator *triangulator;
};

static size_t pixel_of(const struct making *m, int column, int row)
{
    return (size_t)(m->first + row * m->step) * (size_t)m->face->side +
           (size_t)(m->first + column * m->step);
}

static int make_frame(struct making *m)
{
    const struct iso_camera camera = {
        .projection = ISO_ORTHOGRAPHIC,
        .width_px = m->side,
        .height_px = m->side,
        .pitch_mm = m->face->spacing_mm * m->step,
        .cx_px = (m->side - 1) / 2.0,
        .cy_px = (m->side - 1) / 2.0,
    };
    const int error = iso_frame_new(&camera, m->side, m->side, false, &m->frame);
    for (int row = 0; !error && row < m->side; row++) {
        for (int column = 0; column < m->side; column++) {
            const float z = m->face->z_mm[pixel_of(m, column, row)];
            if (!isnan(z)) {
                m->frame->depth_mm[row * m->side + column] = (float)ISO_FACE_PATCH_ORIGIN_MM - z;
            }
        }
    }
    return error;
}

/* Moves the vertices into the face frame and sets the pixel of each. */
static void place(const struct making *m, struct sim_scan_mesh *out)
{
    for (int32_t i = 0; i < out->mesh->n_vertices; i++) {
        struct iso_vec3 *p = &out->mesh->vertices_mm[i];
        const double pitch_mm = m->face->spacing_mm * m->step, middle = (m->side - 1) / 2.0;
        const int column = (int)lround(middle + p->x / pitch_mm);
        const int row = (int)lround(middle + p->y / pitch_mm);
        out->pixel[i] = (int32_t)pixel_of(m, column, row);
        *p = iso_face_from_patch(*p);
    }
}

static int locate(const struct making *m, struct sim_scan_mesh *out)
{
    int error = 0;
    for (int l = 0; l < ISO_LANDMARKS && !error; l++) {
        struct iso_vec3 at = m->face->source_mm[l];
        error = iso_triangulate_locate(m->triangulator, sim_scan_column(m->face, at.x),
                                       sim_scan_row(m->face, at.y), &out->sources[l]);
    }
    return error;
}

static int make(struct making *m, struct sim_scan_mesh *out)
{
    const struct iso_triangulate_options options = {.jump_mm = ISO_FACE_PATCH_ORIGIN_MM};
    const int32_t pixels = m->side * m->side, triangles = 2 * pixels;
    int error = make_frame(m);
    if (!error) {
        error = iso_triangulator_new((size_t)pixels, &options, &m->triangulator);
    }
    if (!error) {
        error = iso_mesh_new(pixels, triangles, &out->mesh);
    }
    if (!error) {
        error = iso_triangulate(m->triangulator, m->frame, out->mesh);
    }
    out->adjacent = calloc((size_t)triangles, sizeof *out->adjacent);
    out->pixel = calloc((size_t)pixels, sizeof *out->pixel);
    if (error || !out->adjacent || !out->pixel) {
        if (error) {
            return error;
        }
        return -ENOMEM;
    }
    place(m, out);
    iso_triangulate_adjacency(m->triangulator, out->adjacent);
    return m->step == 1 ? locate(m, out) : 0;
}

int sim_scan_mesh_new(const struct sim_scan *face, int step, struct sim_scan_mesh **out)
{
    if (step < 1 || step > 8) {
        return -EINVAL;
    }
    const int half = (face->side - 1) / 2 / step;
    struct making m = {.face = face, .step = step, .side = 2 * half + 1};
    m.first = (face->side - 1) / 2 - half * step;
    struct sim_scan_mesh *mesh = calloc(1, sizeof *mesh);
    const int error = mesh ? make(&m, mesh) : -ENOMEM;
    if (m.frame) { /* biometric data */
        explicit_bzero(m.frame->depth_mm, (size_t)m.side * (size_t)m.side * sizeof(float));
    }
    iso_frame_free(m.frame);
    iso_triangulator_free(m.triangulator);
    if (error) {
        sim_scan_mesh_free(mesh);
        return error == -ENOENT ? -ENODATA : error;
    }
    *out = mesh;
    return 0;
}

void sim_scan_mesh_free(struct sim_scan_mesh *mesh)
{
    if (!mesh) {
        return;
    }
    if (mesh->mesh) {
        explicit_bzero(mesh->mesh->vertices_mm,
                       (size_t)mesh->mesh->n_vertices * sizeof *mesh->mesh->vertices_mm);
    }
    iso_mesh_free(mesh->mesh);
    free(mesh->adjacent);
    free(mesh->pixel);
    free(mesh);
}

#include "sim/train/head/head_surface.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "sim/train/head/opening.h"

/* The crop, in the face frame. The ears are behind this depth. */
static const double radius_mm = 114.0, behind_mm = 104.0;

/* Room for the vertices and triangles that close the openings. */
enum { EXTRA_VERTICES = 256, EXTRA_TRIANGLES = 1024, NOWHERE = UINT32_MAX };

void sim_head_surface_free(struct sim_head_surface *surface)
{
    if (surface) {
        free(surface->vertices);
        free(surface->mean_mm);
        free(surface->triangles);
        free(surface);
    }
}

static struct sim_head_surface *surface_alloc(size_t n_vertices, size_t n_triangles)
{
    struct sim_head_surface *s = calloc(1, sizeof *s);
    if (s) {
        s->vertices = calloc(n_vertices, sizeof *s->vertices);
        s->mean_mm = calloc(n_vertices, sizeof *s->mean_mm);
        s->triangles = calloc(n_triangles, sizeof *s->triangles);
    }
    if (s && s->vertices && s->mean_mm && s->triangles) {
        return s;
    }
    sim_head_surface_free(s);
    return NULL;
}

/* Takes the outer skin of face, head and neck. */
static int add_skin(struct sim_surface_builder *builder, const struct sim_ict *ict)
{
    int error = 0;
    for (uint32_t i = 0; !error && i < SIM_ICT_MOUTH_SOCKET; i++) {
        error = sim_surface_add_vertex(builder, ict, (struct sim_head_vertex){.source = {i, i}});
    }
    for (uint32_t t = 0; !error && t < ict->n_triangles; t++) {
        const uint32_t *v = ict->triangles[t];
        if (v[0] < SIM_ICT_MOUTH_SOCKET && v[1] < SIM_ICT_MOUTH_SOCKET &&
            v[2] < SIM_ICT_MOUTH_SOCKET) {
            error = sim_surface_add_triangle(builder, v[0], v[1], v[2]);
        }
    }
    return error;
}

static bool in_crop(struct iso_vec3 p)
{
    return hypot(p.x, p.y) <= radius_mm && p.z >= -behind_mm;
}

/* Removes the triangles with a corner outside the crop. */
static void crop_surface(struct sim_head_surface *s)
{
    uint32_t n = 0;
    for (uint32_t t = 0; t < s->n_triangles; t++) {
        const uint32_t *v = s->triangles[t];
        if (in_crop(s->mean_mm[v[0]]) && in_crop(s->mean_mm[v[1]]) && in_crop(s->mean_mm[v[2]])) {
            memmove(s->triangles[n++], v, sizeof s->triangles[0]);
        }
    }
    s->n_triangles = n;
}

/* Removes the spikes along the crop's edge: triangles with a corner that no other triangle uses. */
static int trim_surface(struct sim_head_surface *s)
{
    uint32_t *uses = calloc(s->n_vertices, sizeof *uses), n = 0;
    if (!uses) {
        return -ENOMEM;
    }
    for (uint32_t i = 0; i < 3 * s->n_triangles; i++) {
        uses[s->triangles[i / 3][i % 3]]++;
    }
    for (uint32_t t = 0; t < s->n_triangles; t++) {
        const uint32_t *v = s->triangles[t];
        if (uses[v[0]] > 1 && uses[v[1]] > 1 && uses[v[2]] > 1) {
            memmove(s->triangles[n++], v, sizeof s->triangles[0]);
        }
    }
    s->n_triangles = n;
    free(uses);
    return 0;
}

int sim_head_surface_compact(struct sim_head_surface *s)
{
    uint32_t *new_of = malloc(s->n_vertices * sizeof *new_of), n = 0;
    if (!new_of) {
        return -ENOMEM;
    }
    memset(new_of, 0xff, s->n_vertices * sizeof *new_of); /* NOWHERE */
    for (uint32_t t = 0; t < s->n_triangles; t++) {
        for (int k = 0; k < 3; k++) {
            new_of[s->triangles[t][k]] = 0;
        }
    }
    int error = 0;
    for (int i = 0; i < ISO_LANDMARKS_IBUG; i++) {
        error = new_of[s->landmarks[i]] == NOWHERE ? -EINVAL : error;
    }
    for (uint32_t i = 0; !error && i < s->n_vertices; i++) {
        if (new_of[i] != NOWHERE) {
            s->vertices[n] = s->vertices[i];
            s->mean_mm[n] = s->mean_mm[i];
            new_of[i] = n++;
        }
    }
    if (!error) {
        for (uint32_t i = 0; i < 3 * s->n_triangles; i++) {
            uint32_t *corner = &s->triangles[i / 3][i % 3];
            *corner = new_of[*corner];
        }
        for (int i = 0; i < ISO_LANDMARKS_IBUG; i++) {
            s->landmarks[i] = new_of[s->landmarks[i]];
        }
        s->n_vertices = n;
    }
    free(new_of);
    return error;
}

/* Vertices of the skin are numbered as in the head model. */
static int place_landmarks(const struct sim_ict *ict, struct sim_head_surface *s)
{
    for (int i = 0; i < ISO_LANDMARKS_IBUG; i++) {
        if (ict->landmarks[i] >= SIM_ICT_MOUTH_SOCKET) {
            return -EINVAL;
        }
        s->landmarks[i] = ict->landmarks[i];
    }
    return 0;
}

/* Keeps the visible part of the face, with its landmarks. */
static int cut_face(const struct sim_ict *ict, struct sim_head_surface *s, struct iso_fault *fault)
{
    crop_surface(s);
    int error = trim_surface(s);
    if (!error) {
        error = place_landmarks(ict, s);
    }
    if (!error) {
        error = sim_head_surface_compact(s);
    }
    if (error) {
        (void)iso_fault_set(fault, error, "head model: a landmark is not on the face");
    }
    return error;
}

int sim_head_surface_new(const struct sim_ict *ict, struct sim_head_surface **out,
                         struct iso_fault *fault)
{
    struct sim_surface_builder builder = {
        .vertex_capacity = SIM_ICT_MOUTH_SOCKET + EXTRA_VERTICES,
        .triangle_capacity = ict->n_triangles + EXTRA_TRIANGLES,
    };
    builder.surface = surface_alloc(builder.vertex_capacity, builder.triangle_capacity);
    if (!builder.surface) {
        return iso_fault_set(fault, -ENOMEM, "head model: out of memory");
    }
    int error = add_skin(&builder, ict);
    if (!error) {
        error = sim_close_openings(&builder, ict);
    }
    if (error) {
        (void)iso_fault_set(fault, error, "head model: eyes and mouth cannot be closed");
    } else {
        error = cut_face(ict, builder.surface, fault);
    }
    if (!error) {
        *out = builder.surface;
        builder.surface = NULL;
    }
    sim_head_surface_free(builder.surface);
    return error == -ENOSPC ? -EINVAL : error;
}

void sim_head_surface_displacement(const struct sim_head_surface *surface, const float *field_mm,
                                   float (*out_mm)[3])
{
    for (uint32_t i = 0; i < surface->n_vertices; i++) {
        const float *a = field_mm + 3 * (size_t)surface->vertices[i].source[0];
        const float *b = field_mm + 3 * (size_t)surface->vertices[i].source[1];
        for (int k = 0; k < 3; k++) {
            out_mm[i][k] = 0.5f * (a[k] + b[k]);
        }
    }
}

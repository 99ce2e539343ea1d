#include "sim/train/head/head_exposure.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "core/surface/raster.h"

/* The image of the head, 260 mm wide and high, and the distance of the head from its plane. */
enum { SIDE_PX = 521 };
static const double pitch_mm = 0.5, origin_mm = 500.0;

static const double hidden_mm = 1.0;      /* a surface nearer by more than this hides a vertex */
static const double facing_cosine = 0.35; /* a vertex at a flatter angle does not face the camera */

struct exposure {
    const struct sim_head_surface *surface;
    struct iso_raster raster;
    struct iso_vec3 *seen_mm; /* [n_vertices], camera frame of the current direction */
    struct iso_vec3 *normal;  /* [n_vertices], face frame */
    int *faced, *shown;       /* [n_vertices] numbers of directions */
};

static void free_exposure(struct exposure *e)
{
    free(e->raster.depth_mm);
    free(e->seen_mm);
    free(e->normal);
    free(e->faced);
    free(e->shown);
}

static int prepare(const struct sim_head_surface *s, struct exposure *e)
{
    *e = (struct exposure){
        .surface = s,
        .raster = {.camera = {.projection = ISO_ORTHOGRAPHIC,
                              .width_px = SIDE_PX,
                              .height_px = SIDE_PX,
                              .pitch_mm = pitch_mm,
                              .cx_px = SIDE_PX / 2,
                              .cy_px = SIDE_PX / 2},
                   .width_px = SIDE_PX,
                   .height_px = SIDE_PX},
    };
    e->raster.depth_mm = calloc((size_t)SIDE_PX * SIDE_PX, sizeof *e->raster.depth_mm);
    e->seen_mm = calloc(s->n_vertices, sizeof *e->seen_mm);
    e->normal = calloc(s->n_vertices, sizeof *e->normal);
    e->faced = calloc(s->n_vertices, sizeof *e->faced);
    e->shown = calloc(s->n_vertices, sizeof *e->shown);
    if (!e->raster.depth_mm || !e->seen_mm || !e->normal || !e->faced || !e->shown) {
        return -ENOMEM;
    }
    for (uint32_t t = 0; t < s->n_triangles; t++) {
        const uint32_t *v = s->triangles[t];
        struct iso_vec3 a = s->mean_mm[v[0]];
        struct iso_vec3 area = iso_cross(iso_sub(s->mean_mm[v[1]], a),
                                         iso_sub(s->mean_mm[v[2]], a));
        for (int k = 0; k < 3; k++) {
            e->normal[v[k]] = iso_add(e->normal[v[k]], area);
        }
    }
    return 0;
}

/* Renders the head, turned by yaw and pitch. Counts the direction for each vertex that faces the
 * camera, and for each of these that is visible. */
static void look(struct exposure *e, double yaw_rad, double pitch_rad)
{
    const struct sim_head_surface *s = e->surface;
    struct iso_mat3 facing = {{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};
    struct iso_mat3 yaw = iso_mat3_rotation(iso_vec3(0, yaw_rad, 0));
    struct iso_mat3 pitch = iso_mat3_rotation(iso_vec3(pitch_rad, 0, 0));
    struct iso_mat3 turned = iso_mat3_mul(&yaw, &pitch);
    struct iso_mat3 rotation = iso_mat3_mul(&facing, &turned);
    for (uint32_t i = 0; i < s->n_vertices; i++) {
        e->seen_mm[i] = iso_mat3_apply(&rotation, s->mean_mm[i]);
        e->seen_mm[i].z += origin_mm;
    }
    iso_raster_clear(&e->raster);
    iso_raster_triangles(&e->raster, e->seen_mm, (const uint32_t(*)[3])s->triangles,
                         (int32_t)s->n_triangles, 0, 1.0, 0);
    for (uint32_t i = 0; i < s->n_vertices; i++) {
        struct iso_vec3 normal = iso_unit(iso_mat3_apply(&rotation, e->normal[i]));
        double u, v;
        if (-normal.z < facing_cosine ||
            !iso_camera_project(&e->raster.camera, e->seen_mm[i], &u, &v)) {
            continue;
        }
        const int column = (int)lrint(u), row = (int)lrint(v);
        if (column < 0 || row < 0 || column >= SIDE_PX || row >= SIDE_PX) {
            continue;
        }
        const double front_mm = (double)e->raster.depth_mm[row * SIDE_PX + column];
        e->faced[i]++;
        e->shown[i] += !(front_mm > 0.0) || e->seen_mm[i].z - front_mm <= hidden_mm;
    }
}

int sim_head_exposure(const struct sim_head_surface *surface, double *exposure)
{
    static const double yaws_deg[] = {-50, -25, 0, 25, 50}, pitches_deg[] = {-40, -20, 0, 20, 40};
    enum { YAWS = sizeof yaws_deg / sizeof *yaws_deg };
    enum { PITCHES = sizeof pitches_deg / sizeof *pitches_deg };
    struct exposure e;
    const int error = prepare(surface, &e);
    for (int y = 0; !error && y < YAWS; y++) {
        for (int p = 0; p < PITCHES; p++) {
            look(&e, yaws_deg[y] * M_PI / 180.0, pitches_deg[p] * M_PI / 180.0);
        }
    }
    for (uint32_t i = 0; !error && i < surface->n_vertices; i++) {
        exposure[i] = e.faced[i] > 0 ? (double)e.shown[i] / e.faced[i] : 0.0;
    }
    free_exposure(&e);
    return error;
}

#include "core/shape/describe/view_area.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/lapack.h"

enum { SIZE_PX = 512 };

/* The mesh is drawn with a radius of 1 and in parallel projection, so that it does not matter how
 * far away its centre is, as long as all depths are above 0. */
static const double distance = 2.0;

/* The radius in halves of the picture's width, so that no triangle is cut off. */
static const double filled = 0.96;

/* The area and the centre of all triangles, and the second moments of the surface about the
 * centre: of a triangle with corners v about any point it is area / 12 (sum v v' + s s'), where s
 * is the sum of v. */
static void add_moments(const struct iso_mesh *mesh, int32_t t, double area, struct iso_vec3 centre,
                        double moment[3][3])
{
    double v[4][3] = {{0.0}};
    for (int k = 0; k < 3; k++) {
        const struct iso_vec3 p = iso_sub(mesh->vertices_mm[mesh->triangles[t][k]], centre);
        const double x[3] = {p.x, p.y, p.z};
        for (int i = 0; i < 3; i++) {
            v[k][i] = x[i];
            v[3][i] += x[i];
        }
    }
    for (int k = 0; k < 4; k++) {
        for (int i = 0; i < 9; i++) {
            moment[i / 3][i % 3] += area / 12.0 * v[k][i / 3] * v[k][i % 3];
        }
    }
}

static void measure_area(struct iso_view_area *view)
{
    const struct iso_mesh *mesh = view->mesh;
    struct iso_vec3 sum = {0.0, 0.0, 0.0};
    view->total_area = 0.0;
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        const int32_t *c = mesh->triangles[t];
        const double area = iso_mesh_triangle_area(mesh, t);
        view->area[t] = area;
        view->total_area += area;
        for (int k = 0; k < 3; k++) {
            sum = iso_madd(sum, area / 3.0, mesh->vertices_mm[c[k]]);
        }
    }
    view->centre = iso_scale(1.0 / view->total_area, sum);
}

static int find_axes(struct iso_view_area *view)
{
    double moment[3][3] = {{0.0}}, value[3];
    view->radius = 0.0;
    for (int32_t t = 0; t < view->mesh->n_triangles; t++) {
        add_moments(view->mesh, t, view->area[t], view->centre, moment);
        for (int k = 0; k < 3; k++) {
            const struct iso_vec3 corner = view->mesh->vertices_mm[view->mesh->triangles[t][k]];
            view->radius = fmax(view->radius, iso_norm(iso_sub(corner, view->centre)));
        }
    }
    const int error = iso_lapack_error(
        LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'V', 'U', 3, &moment[0][0], 3, value));
    if (!error) { /* eigenvalues rise */
        view->axis[0] = iso_vec3(moment[0][2], moment[1][2], moment[2][2]);
        view->axis[1] = iso_vec3(moment[0][1], moment[1][1], moment[2][1]);
        view->axis[2] = iso_cross(view->axis[0], view->axis[1]);
    }
    return error;
}

static void set_camera(struct iso_view_area *view)
{
    const double middle = 0.5 * (SIZE_PX - 1);
    view->raster.camera = (struct iso_camera){.projection = ISO_ORTHOGRAPHIC,
                                              .width_px = SIZE_PX,
                                              .height_px = SIZE_PX,
                                              .pitch_mm = 2.0 / (filled * SIZE_PX),
                                              .cx_px = middle,
                                              .cy_px = middle};
    view->raster.width_px = view->raster.height_px = SIZE_PX;
}

int iso_view_area_init(struct iso_view_area *view, const struct iso_mesh *mesh)
{
    const size_t n = (size_t)mesh->n_triangles + 1, pixels = (size_t)SIZE_PX * SIZE_PX;
    struct iso_view_area made = {.mesh = mesh};
    made.area = malloc(n * sizeof *made.area);
    made.seen = malloc(n * sizeof *made.seen);
    made.turned = malloc(((size_t)mesh->n_vertices + 1) * sizeof *made.turned);
    made.raster.depth_mm = malloc(pixels * sizeof *made.raster.depth_mm);
    made.raster.triangle = malloc(pixels * sizeof *made.raster.triangle);
    int error = made.area && made.seen && made.turned && made.raster.depth_mm &&
                        made.raster.triangle
                    ? 0
                    : -ENOMEM;
    if (!error) {
        measure_area(&made);
        error = made.total_area > 0.0 ? find_axes(&made) : -EINVAL;
    }
    if (error) {
        iso_view_area_done(&made);
        return error;
    }
    set_camera(&made);
    *view = made;
    return 0;
}

void iso_view_area_done(struct iso_view_area *view)
{
    free(view->area);
    free(view->seen);
    free(view->turned);
    free(view->raster.depth_mm);
    free(view->raster.triangle);
    *view = (struct iso_view_area){0};
}

/* The camera's axes: z away from the viewer, x and y from the mesh's own axes, so that a mesh that
 * is turned gives the same picture. */
static void camera_axes(const struct iso_view_area *view, struct iso_vec3 direction,
                        struct iso_vec3 axis[3])
{
    int least = 0;
    for (int k = 1; k < 3; k++) {
        if (fabs(iso_dot(direction, view->axis[k])) <
            fabs(iso_dot(direction, view->axis[least])) - 1e-6) {
            least = k;
        }
    }
    axis[2] = iso_scale(-1.0, direction);
    axis[0] = iso_unit(iso_cross(view->axis[least], axis[2]));
    axis[1] = iso_cross(axis[2], axis[0]);
}

static void draw(struct iso_view_area *view, struct iso_vec3 direction)
{
    const struct iso_mesh *mesh = view->mesh;
    struct iso_vec3 axis[3];
    camera_axes(view, direction, axis);
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        const struct iso_vec3 p = iso_scale(1.0 / view->radius,
                                            iso_sub(mesh->vertices_mm[v], view->centre));
        view->turned[v] = iso_vec3(iso_dot(p, axis[0]), iso_dot(p, axis[1]),
                                   iso_dot(p, axis[2]) + distance);
    }
    iso_raster_clear(&view->raster);
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        const int32_t *c = mesh->triangles[t];
        const struct iso_vec3 corners[3] = {view->turned[c[0]], view->turned[c[1]],
                                            view->turned[c[2]]};
        iso_raster_triangle(&view->raster, corners, t, 0.0, 0);
    }
}

void iso_view_area_score(struct iso_view_area *view, struct iso_vec3 direction,
                         struct iso_shape_view *out)
{
    const int32_t n = view->mesh->n_triangles;
    int32_t pixels = 0;
    draw(view, direction);
    memset(view->seen, 0, (size_t)n * sizeof *view->seen);
    for (int32_t i = 0; i < SIZE_PX * SIZE_PX; i++) {
        const int32_t t = view->raster.triangle[i];
        if (t >= 0) {
            view->seen[t]++;
            pixels++;
        }
    }
    /* A flat mesh that is seen edge-on covers no pixel: this is the worst view by either score. */
    *out = (struct iso_shape_view){.direction = direction,
                                   .divergence = pixels > 0 ? 0.0 : INFINITY};
    for (int32_t t = 0; t < n; t++) {
        if (view->seen[t] > 0 && view->area[t] > 0.0) {
            const double share = (double)view->seen[t] / pixels;
            out->entropy -= share * log2(share);
            out->divergence += share * log2(share * view->total_area / view->area[t]);
        }
    }
}

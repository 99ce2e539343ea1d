#include "core/surface/grid.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/lanes.h"
#include "core/surface/face_patch.h"

enum { SIDE_MAX = 2048 };

size_t iso_grid_plane_size(const struct iso_grid *grid)
{
    const size_t n = (size_t)(grid->height + 2) * (size_t)grid->stride + 2 * ISO_LANES;
    return (n + 15) / 16 * 16;
}

size_t iso_grid_plane_origin(const struct iso_grid *grid)
{
    return (size_t)grid->stride + ISO_LANES;
}

/* The planes have a larger alignment than the memory from calloc. The pointer from calloc is stored
 * in front of them, so that it can be freed. */
enum { ALIGNMENT = 64 };

float *iso_grid_planes_new(const struct iso_grid *grid, int n_planes)
{
    const size_t bytes = iso_grid_plane_size(grid) * (size_t)n_planes * sizeof(float);
    char *memory = calloc(1, bytes + ALIGNMENT + sizeof memory);
    if (!memory) {
        return NULL;
    }
    uintptr_t first = (uintptr_t)memory + sizeof memory;
    char *planes = memory + sizeof memory + (ALIGNMENT - first % ALIGNMENT) % ALIGNMENT;
    memcpy(planes - sizeof memory, &memory, sizeof memory);
    return (float *)(void *)planes;
}

void iso_grid_planes_free(float *planes, size_t plane_size, int n_planes)
{
    if (planes) { /* the planes may hold a face, which is biometric data */
        char *memory;
        memcpy(&memory, (char *)planes - sizeof memory, sizeof memory);
        explicit_bzero(planes, plane_size * (size_t)n_planes * sizeof *planes);
        free(memory);
    }
}

enum { PLANES = 6 };

int iso_grid_new(int width_px, int height_px, struct iso_grid **out)
{
    if (width_px < 2 || height_px < 2 || width_px > SIDE_MAX || height_px > SIDE_MAX) {
        return -EINVAL;
    }
    struct iso_grid *g = calloc(1, sizeof *g);
    if (!g) {
        return -ENOMEM;
    }
    g->width = width_px;
    g->height = height_px;
    /* A whole number of groups of lanes plus one more group, so that the last group of a row ends
     * before the next row begins. */
    g->stride = (width_px + ISO_LANES - 1) / ISO_LANES * ISO_LANES + ISO_LANES;
    float *planes = iso_grid_planes_new(g, PLANES);
    uint8_t *cells = calloc(iso_grid_plane_size(g), 1);
    g->memory = planes;
    g->cell = cells ? cells + iso_grid_plane_origin(g) : NULL;
    if (!planes || !cells) {
        iso_grid_free(g);
        return -ENOMEM;
    }
    float **const pointers[PLANES] = {&g->z_mm,        &g->share_mm2,   &g->cell_mm2[0],
                                      &g->cell_mm2[1], &g->cell_mm2[2], &g->cell_mm2[3]};
    for (size_t i = 0; i < PLANES; i++) {
        *pointers[i] = planes + i * iso_grid_plane_size(g) + iso_grid_plane_origin(g);
    }
    *out = g;
    return 0;
}

void iso_grid_free(struct iso_grid *grid)
{
    if (grid) {
        iso_grid_planes_free(grid->memory, iso_grid_plane_size(grid), PLANES);
        free(grid->cell ? grid->cell - iso_grid_plane_origin(grid) : NULL);
        free(grid);
    }
}

/* Area of the triangle of a cell that leaves out corner k: its legs, one pitch long seen from the
 * front, meet at corner 3 - k. */
static float area_of(const float z[4], int k, float pitch_mm)
{
    const int middle = 3 - k;
    float along = z[middle ^ 1] - z[middle], down = z[middle ^ 2] - z[middle];
    return 0.5f * pitch_mm * sqrtf(pitch_mm * pitch_mm + along * along + down * down);
}

/* Adds the triangle of a cell that leaves out corner k. */
static void add_triangle(struct iso_grid *grid, int32_t at, const float depth[4], int k)
{
    const float area = area_of(depth, k, (float)grid->pitch_mm);
    grid->cell_mm2[k][at] = area;
    for (int c = 0; c < 3; c++) {
        grid->share_mm2[iso_grid_corner(grid, at, iso_cell_corners[k][c])] += area / 3.0f;
    }
}

/* Fills in one cell that has at least three corners. Returns how many triangles it has. */
static int build_cell(struct iso_grid *grid, int32_t at, const float depth[4], double jump_mm)
{
    float falling = depth[0] - depth[3], rising = depth[1] - depth[2];
    const bool rises = (double)rising * (double)rising < (double)falling * (double)falling;
    const uint8_t set = iso_cell_set(depth, rises, jump_mm);
    grid->cell[at] = set;
    int n = 0;
    for (int k = 0; k < 4; k++) {
        if (set >> k & 1) {
            add_triangle(grid, at, depth, k);
            n++;
        }
    }
    return n;
}

int iso_grid_build(struct iso_grid *grid, const struct iso_frame *frame, double jump_mm)
{
    if (frame->camera.projection != ISO_ORTHOGRAPHIC || frame->width_px != grid->width ||
        frame->height_px != grid->height) {
        return -EINVAL;
    }
    grid->pitch_mm = frame->camera.pitch_mm;
    grid->cx_px = frame->camera.cx_px - frame->crop_x_px;
    grid->cy_px = frame->camera.cy_px - frame->crop_y_px;
    size_t origin = iso_grid_plane_origin(grid), size = iso_grid_plane_size(grid);
    memset(grid->cell - origin, 0, size);
    memset(grid->share_mm2 - origin, 0, size * sizeof *grid->share_mm2);
    int32_t triangles = 0;
    for (int row = 0; row < grid->height; row++) {
        const float *depth = &frame->depth_mm[(size_t)row * (size_t)grid->width];
        int32_t at = row * grid->stride;
        for (int column = 0; column < grid->width; column++, at++) {
            grid->z_mm[at] = (float)ISO_FACE_PATCH_ORIGIN_MM - depth[column];
            for (int k = 0; k < 4; k++) {
                grid->cell_mm2[k][at] = 0.0f;
            }
            if (row + 1 == grid->height || column + 1 == grid->width) {
                continue;
            }
            const float corners[4] = {depth[column], depth[column + 1], depth[column + grid->width],
                                      depth[column + grid->width + 1]};
            if ((corners[0] > 0) + (corners[1] > 0) + (corners[2] > 0) + (corners[3] > 0) >= 3) {
                triangles += build_cell(grid, at, corners, jump_mm);
            }
        }
    }
    return triangles > 0 ? 0 : -ENODATA;
}

/* Weights of the place (s, t) of a cell, both 0..1, in the triangle that leaves out corner k, in
 * the order of its corners; false if it lies outside. */
static bool weigh_corners(int k, double s, double t, double weight[3])
{
    const int middle = 3 - k;
    double along = middle & 1 ? 1.0 - s : s, down = middle >> 1 ? 1.0 - t : t;
    for (int c = 0; c < 3; c++) {
        const int corner = iso_cell_corners[k][c];
        weight[c] = corner == (middle ^ 1) ? along : down;
        if (corner == middle) {
            weight[c] = 1.0 - along - down;
        }
        if (weight[c] < -1e-12) {
            return false;
        }
        weight[c] = fmax(weight[c], 0.0);
    }
    return true;
}

int iso_grid_locate(const struct iso_grid *grid, double column, double row,
                    struct iso_grid_point *point)
{
    if (!(column >= 0.0 && row >= 0.0 && column <= grid->width - 1 && row <= grid->height - 1)) {
        return -ENOENT;
    }
    int u = (int)fmin(column, grid->width - 2.0), v = (int)fmin(row, grid->height - 2.0);
    const int32_t at = v * grid->stride + u;
    const struct iso_cell_list list = iso_cell_list(grid->cell[at]);
    for (int h = 0; h < list.count; h++) {
        struct iso_grid_point found;
        if (weigh_corners(list.left_out[h], column - u, row - v, found.weight)) {
            for (int c = 0; c < 3; c++) {
                const int corner = iso_cell_corners[list.left_out[h]][c];
                found.corner[c] = iso_grid_corner(grid, at, corner);
            }
            *point = found;
            return 0;
        }
    }
    return -ENOENT;
}

struct iso_vec3 iso_grid_vertex(const struct iso_grid *grid, int32_t index)
{
    int row = index / grid->stride, column = index % grid->stride;
    return iso_vec3((column - grid->cx_px) * grid->pitch_mm, (grid->cy_px - row) * grid->pitch_mm,
                    (double)grid->z_mm[index]);
}

struct iso_vec3 iso_grid_point_at(const struct iso_grid *grid, const struct iso_grid_point *point)
{
    struct iso_vec3 at = iso_vec3(0, 0, 0);
    for (int c = 0; c < 3; c++) {
        at = iso_madd(at, point->weight[c], iso_grid_vertex(grid, point->corner[c]));
    }
    return at;
}

#include "sim/world/prop/screen.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "sim/base/noise3.h"

enum { ROWS = 71, COLUMNS = 71, CELLS = (ROWS - 1) * (COLUMNS - 1) };

static const double keyboard_depth_mm = 220.0, keyboard_lean_rad = 0.35;

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The value below which the given share of all values lies. NAN if there is no memory. */
static double quantile(const double values[CELLS], double share)
{
    static const int last = CELLS - 1;
    double *sorted = malloc(CELLS * sizeof *sorted);
    double found = NAN;
    if (sorted) {
        memcpy(sorted, values, CELLS * sizeof *sorted);
        qsort(sorted, CELLS, sizeof *sorted, compare_doubles);
        const int at = (int)lrint(share * CELLS);
        if (at <= 0) {
            found = sorted[0] - 1.0;
        } else {
            found = at > last ? sorted[last] + 1.0 : sorted[at];
        }
        free(sorted);
    }
    return found;
}

/* Makes the whole glass. Triangles 2 i and 2 i + 1 are cell i. */
static int whole_glass(const struct sim_screen *screen, struct sim_solid **out)
{
    const int error = sim_solid_sheet(ROWS, COLUMNS, SIM_GLASS, out);
    for (int i = 0; error == 0 && i < ROWS * COLUMNS; i++) {
        const double x = screen->width_mm * ((double)(i % COLUMNS) / (COLUMNS - 1) - 0.5);
        const double y = screen->height_mm * ((double)(i / COLUMNS) / (ROWS - 1) - 0.5);
        const double depth = 0.5 +
                             0.5 * sim_noise3(screen->key + 1, iso_vec3(x / 60.0, y / 60.0, 0.5));
        (*out)->vertices_mm[i] = iso_vec3(x, y, screen->behind_mm * depth);
    }
    return error;
}

/* Copies either the measured cells or the others into a new solid. If there are none, returns 0
 * with *out NULL. */
static int part_of_glass(const struct sim_solid *glass, const double value[CELLS], double level,
                         bool measured, struct sim_solid **out)
{
    uint32_t n = 0;
    for (int i = 0; i < CELLS; i++) {
        n += (value[i] >= level) == measured ? 2 : 0;
    }
    *out = NULL;
    if (n == 0) {
        return 0;
    }
    const int error = sim_solid_new(glass->n_vertices, n, measured ? SIM_GLASS : SIM_MIRROR, out);
    if (error != 0) {
        return error;
    }
    memcpy((*out)->vertices_mm, glass->vertices_mm, glass->n_vertices * sizeof *glass->vertices_mm);
    n = 0;
    for (size_t i = 0; i < CELLS; i++) {
        if ((value[i] >= level) == measured) {
            memcpy((*out)->triangles + n, glass->triangles + 2 * i, 2 * sizeof *glass->triangles);
            n += 2;
        }
    }
    return 0;
}

static void split_glass(struct sim_group *group, const struct sim_screen *screen,
                        const struct sim_solid *glass, double value[CELLS])
{
    for (int i = 0; i < CELLS; i++) {
        struct iso_vec3 p = glass->vertices_mm[i / (COLUMNS - 1) * COLUMNS + i % (COLUMNS - 1)];
        const double patches = sim_noise3(
            screen->key, iso_vec3(p.x / screen->patch_mm, p.y / screen->patch_mm, 0.5));
        const double grains = sim_noise3(screen->key + 2, iso_vec3(p.x / 5.0, p.y / 5.0, 0.5));
        value[i] = patches + 0.3 * grains;
    }
    const double level = quantile(value, screen->lost);
    for (int measured = 0; measured < 2; measured++) {
        struct sim_solid *part = NULL;
        const int made = isnan(level) ? -ENOMEM
                                      : part_of_glass(glass, value, level, measured, &part);
        if (made != 0 || part) {
            sim_group_add(group, made, part);
        }
    }
}

static void add_glass(struct sim_group *group, const struct sim_screen *screen)
{
    struct sim_solid *glass = NULL;
    double *value = malloc(CELLS * sizeof *value);
    const int made = value ? whole_glass(screen, &glass) : -ENOMEM;
    if (made == 0) {
        split_glass(group, screen, glass, value);
        sim_solid_free(glass);
    } else {
        sim_group_add(group, made, NULL);
    }
    free(value);
}

/* Four bars around the glass, as thick as the device. */
static void add_rim(struct sim_group *group, const struct sim_screen *screen)
{
    const double rim = screen->rim_mm, middle_z = 0.5 * screen->thickness_mm - 0.5;
    struct iso_vec3 lying = {screen->width_mm + 2.0 * rim, rim, screen->thickness_mm};
    struct iso_vec3 standing = {rim, screen->height_mm, screen->thickness_mm};
    for (int side = -1; side <= 1; side += 2) {
        const double y = side * 0.5 * (screen->height_mm + rim),
                     x = side * 0.5 * (screen->width_mm + rim);
        sim_group_add_box(group, lying, iso_vec3(0.0, y, middle_z), SIM_PLASTIC);
        sim_group_add_box(group, standing, iso_vec3(x, 0.0, middle_z), SIM_PLASTIC);
    }
}

/* The lower half turns about the hinge, towards the viewer. */
static void add_keyboard(struct sim_group *group, const struct sim_screen *screen)
{
    struct iso_rigid before = group->placed,
                     half = {iso_mat3_rotation(iso_vec3(keyboard_lean_rad, 0.0, 0.0)),
                             {0.0, 0.5 * screen->height_mm + screen->rim_mm,
                              0.5 * screen->thickness_mm}};
    struct iso_vec3 size = {screen->width_mm + 2.0 * screen->rim_mm, 12.0, keyboard_depth_mm};
    group->placed = iso_rigid_mul(&before, &half);
    sim_group_add_box(group, size, iso_vec3(0.0, 6.0, -0.5 * keyboard_depth_mm), SIM_PLASTIC);
    group->placed = before;
}

void sim_screen_add(struct sim_group *group, const struct sim_screen *screen)
{
    add_glass(group, screen);
    add_rim(group, screen);
    if (screen->keyboard) {
        add_keyboard(group, screen);
    }
}

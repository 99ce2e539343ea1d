#include "sim/lab/methods/geodesic.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

/* The steps of one quadrant: coprime and within 3. Rotation gives the other quadrants. */
static const int quadrant[8][2] = {{1, 0}, {3, 1}, {2, 1}, {3, 2}, {1, 1}, {2, 3}, {1, 2}, {1, 3}};

enum { NEIGHBOURS = 32 };

struct entry {
    double distance_mm;
    int pixel;
};

struct sim_geodesic {
    int side;
    double spacing_mm;
    double *distance_mm; /* [side * side] */
    bool *final;         /* likewise */
    struct entry *heap;  /* may contain a pixel several times, with falling distances */
    size_t n_heap;
    int step[NEIGHBOURS][2];
    double flat_mm2[NEIGHBOURS]; /* squared length of the step in the grid's plane */
};

int sim_geodesic_new(const struct sim_scan *face, struct sim_geodesic **out)
{
    struct sim_geodesic *g = calloc(1, sizeof *g);
    if (!g) {
        return -ENOMEM;
    }
    const size_t pixels = sim_scan_pixels(face);
    g->side = face->side;
    g->spacing_mm = face->spacing_mm;
    g->distance_mm = calloc(pixels, sizeof *g->distance_mm);
    g->final = calloc(pixels, sizeof *g->final);
    g->heap = calloc(pixels * NEIGHBOURS + 4, sizeof *g->heap);
    if (!g->distance_mm || !g->final || !g->heap) {
        sim_geodesic_free(g);
        return -ENOMEM;
    }
    for (int q = 0; q < 4; q++) {
        for (int k = 0; k < 8; k++) {
            const int x = quadrant[k][0], y = quadrant[k][1];
            int *step = g->step[8 * q + k];
            const int turned[4][2] = {{x, y}, {-y, x}, {-x, -y}, {y, -x}};
            step[0] = turned[q][0];
            step[1] = turned[q][1];
            g->flat_mm2[8 * q + k] = g->spacing_mm * g->spacing_mm * (x * x + y * y);
        }
    }
    *out = g;
    return 0;
}

void sim_geodesic_free(struct sim_geodesic *g)
{
    if (g) {
        free(g->distance_mm);
        free(g->final);
        free(g->heap);
        free(g);
    }
}

static void push(struct sim_geodesic *g, double distance_mm, int pixel)
{
    size_t i = g->n_heap++;
    while (i > 0 && g->heap[(i - 1) / 2].distance_mm > distance_mm) {
        g->heap[i] = g->heap[(i - 1) / 2];
        i = (i - 1) / 2;
    }
    g->heap[i] = (struct entry){distance_mm, pixel};
}

static struct entry pop(struct sim_geodesic *g)
{
    struct entry top = g->heap[0], last = g->heap[--g->n_heap];
    size_t i = 0;
    for (size_t child = 1; child < g->n_heap; child = 2 * i + 1) {
        child += child + 1 < g->n_heap &&
                 g->heap[child + 1].distance_mm < g->heap[child].distance_mm;
        if (g->heap[child].distance_mm >= last.distance_mm) {
            break;
        }
        g->heap[i] = g->heap[child];
        i = child;
    }
    g->heap[i] = last;
    return top;
}

/* Gives a pixel a path of this length, if it is shorter than the known path. */
static void offer(struct sim_geodesic *g, int pixel, double distance_mm)
{
    if (distance_mm < g->distance_mm[pixel]) {
        g->distance_mm[pixel] = distance_mm;
        push(g, distance_mm, pixel);
    }
}

static void spread(struct sim_geodesic *g, const struct sim_scan *face, struct entry at)
{
    const int u = at.pixel % g->side, v = at.pixel / g->side;
    const double z = (double)face->z_mm[at.pixel];
    for (int k = 0; k < NEIGHBOURS; k++) {
        const int column = u + g->step[k][0], row = v + g->step[k][1];
        if (column < 0 || row < 0 || column >= g->side || row >= g->side) {
            continue;
        }
        const int pixel = row * g->side + column;
        const double rise = (double)face->z_mm[pixel] - z;
        if (g->final[pixel] || isnan(rise)) {
            continue;
        }
        offer(g, pixel, at.distance_mm + sqrt(g->flat_mm2[k] + rise * rise));
    }
}

/* Finds the four grid points around a place, and the length of the straight path to each. Returns
 * 4, or 0 if the place has no surface. */
static int corners(const struct sim_scan *face, struct iso_vec3 place, int pixel[4],
                   double distance_mm[4])
{
    double z;
    if (!sim_scan_height(face, place.x, place.y, &z, NULL)) {
        return 0;
    }
    const int u = (int)floor(sim_scan_column(face, place.x));
    const int v = (int)floor(sim_scan_row(face, place.y));
    place.z = z;
    for (int k = 0; k < 4; k++) {
        const int column = u + (k & 1), row = v + (k >> 1);
        pixel[k] = row * face->side + column;
        distance_mm[k] = iso_norm(iso_sub(sim_scan_point(face, column, row), place));
    }
    return 4;
}

static void flood(struct sim_geodesic *g, const struct sim_scan *face)
{
    while (g->n_heap > 0) {
        struct entry at = pop(g);
        if (!g->final[at.pixel]) {
            g->final[at.pixel] = true;
            spread(g, face, at);
        }
    }
}

int sim_geodesic_from(struct sim_geodesic *g, const struct sim_scan *face, struct iso_vec3 from,
                      const struct iso_vec3 *to, int n, double *distance_mm)
{
    int pixel[4];
    double near_mm[4];
    if (corners(face, from, pixel, near_mm) == 0) {
        return -ENODATA;
    }
    for (size_t i = 0; i < sim_scan_pixels(face); i++) {
        g->distance_mm[i] = INFINITY;
        g->final[i] = false;
    }
    g->n_heap = 0;
    for (int k = 0; k < 4; k++) {
        offer(g, pixel[k], near_mm[k]);
    }
    flood(g, face);
    for (int i = 0; i < n; i++) {
        double shortest = INFINITY;
        const int count = corners(face, to[i], pixel, near_mm);
        for (int k = 0; k < count; k++) {
            shortest = fmin(shortest, g->distance_mm[pixel[k]] + near_mm[k]);
        }
        if (!isfinite(shortest)) {
            return -ENODATA;
        }
        distance_mm[i] = shortest;
    }
    return 0;
}

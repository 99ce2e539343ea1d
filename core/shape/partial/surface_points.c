#include "core/shape/partial/surface_points.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

struct entry {
    double distance;
    int32_t vertex;
};

/* A wave that runs along the edges: what is still to be visited is a heap, nearest first. */
struct wave {
    const struct iso_shape *shape;
    double *distance; /* [n_vertices] from the nearest source so far */
    int32_t *source;  /* [n_vertices]: the number of that source */
    struct entry *heap;
    size_t n, room;
};

static int push(struct wave *w, double distance, int32_t vertex)
{
    if (w->n == w->room) {
        const size_t room = 2 * w->room + 256;
        struct entry *heap = realloc(w->heap, room * sizeof *heap);
        if (!heap) {
            return -ENOMEM;
        }
        w->heap = heap;
        w->room = room;
    }
    size_t at = w->n++;
    for (; at > 0 && w->heap[(at - 1) / 2].distance > distance; at = (at - 1) / 2) {
        w->heap[at] = w->heap[(at - 1) / 2];
    }
    w->heap[at] = (struct entry){distance, vertex};
    return 0;
}

static struct entry pop(struct wave *w)
{
    const struct entry top = w->heap[0], last = w->heap[--w->n];
    size_t at = 0;
    for (size_t child = 1; child < w->n; child = 2 * at + 1) {
        child += child + 1 < w->n && w->heap[child + 1].distance < w->heap[child].distance;
        if (w->heap[child].distance >= last.distance) {
            break;
        }
        w->heap[at] = w->heap[child];
        at = child;
    }
    w->heap[at] = last;
    return top;
}

/* Makes a vertex a source. */
static int start(struct wave *w, int32_t vertex, int32_t number)
{
    w->distance[vertex] = 0.0;
    w->source[vertex] = number;
    return push(w, 0.0, vertex);
}

/* Runs until no vertex comes nearer to a source. */
static int run(struct wave *w)
{
    const struct iso_shape *shape = w->shape;
    int error = 0;
    while (w->n > 0 && !error) {
        const struct entry e = pop(w);
        if (e.distance > w->distance[e.vertex]) {
            continue; /* it was reached by a shorter way meanwhile */
        }
        const struct iso_vec3 here = shape->mesh->vertices_mm[e.vertex];
        for (int32_t k = shape->neighbour_start[e.vertex];
             k < shape->neighbour_start[e.vertex + 1] && !error; k++) {
            const int32_t next = shape->neighbour[k];
            const double there = e.distance +
                                 iso_norm(iso_sub(shape->mesh->vertices_mm[next], here));
            if (there < w->distance[next]) {
                w->distance[next] = there;
                w->source[next] = w->source[e.vertex];
                error = push(w, there, next);
            }
        }
    }
    return error;
}

static int wave_init(struct wave *w, const struct iso_shape *shape)
{
    const size_t n = (size_t)shape->mesh->n_vertices;
    *w = (struct wave){.shape = shape};
    w->distance = malloc(n * sizeof *w->distance);
    w->source = calloc(n, sizeof *w->source);
    if (!w->distance || !w->source) {
        return -ENOMEM;
    }
    for (size_t v = 0; v < n; v++) {
        w->distance[v] = INFINITY;
    }
    return 0;
}

static void wave_done(struct wave *w)
{
    free(w->distance);
    free(w->source);
    free(w->heap);
}

static int32_t farthest(const struct wave *w)
{
    int32_t best = 0;
    for (int32_t v = 1; v < w->shape->mesh->n_vertices; v++) {
        best = w->distance[v] > w->distance[best] ? v : best;
    }
    return best;
}

int iso_surface_points(const struct iso_shape *shape, int32_t first, int32_t n, int32_t *vertex,
                       double *weight)
{
    const int32_t n_vertices = shape->mesh->n_vertices;
    struct wave wave;
    int32_t count = 0;
    int error = wave_init(&wave, shape);
    for (int32_t next = first; !error && count < n && count < n_vertices; count++) {
        vertex[count] = next;
        error = start(&wave, next, count);
        if (!error) {
            error = run(&wave);
        }
        next = farthest(&wave);
    }
    for (int32_t p = 0; p < n; p++) {
        vertex[p] = p < count ? vertex[p] : first;
        weight[p] = 0.0;
    }
    for (int32_t v = 0; v < n_vertices && !error; v++) {
        weight[wave.source[v]] += shape->area[v] / shape->total_area;
    }
    wave_done(&wave);
    return error;
}

int iso_boundary_distance(const struct iso_shape *shape, double *distance)
{
    struct wave wave;
    int error = wave_init(&wave, shape);
    for (int32_t v = 0; v < shape->mesh->n_vertices && !error; v++) {
        error = shape->near_boundary[v] ? start(&wave, v, 0) : 0;
    }
    if (!error) {
        error = run(&wave);
    }
    for (int32_t v = 0; v < shape->mesh->n_vertices && !error; v++) {
        distance[v] = wave.distance[v];
    }
    wave_done(&wave);
    return error;
}

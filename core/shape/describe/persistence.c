#include "core/shape/describe/persistence.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "core/shape/describe/largest_part.h"

/* A vertex by its place in the order of falling values. */
struct level {
    double value;
    int32_t vertex;
};

struct islands {
    const struct iso_shape *shape;
    int32_t n;
    struct level *level; /* [n], by falling values */
    int32_t *place;      /* [n]: the place of each vertex in `level` */
    int32_t *parent;     /* [n]: a forest of places; the root of an island is its peak */
    int32_t *number;     /* [n]: the number of the segment whose peak has this place */
};

static int by_falling_value(const void *a, const void *b)
{
    const struct level *x = a, *y = b;
    if (x->value != y->value) {
        return x->value > y->value ? -1 : 1;
    }
    return (x->vertex > y->vertex) - (x->vertex < y->vertex);
}

static int by_falling_persistence(const void *a, const void *b)
{
    const struct iso_peak *x = a, *y = b;
    if (x->persistence != y->persistence) {
        return x->persistence > y->persistence ? -1 : 1;
    }
    return (x->vertex > y->vertex) - (x->vertex < y->vertex);
}

/* The highest neighbour that is above a place; `place` itself if none is. */
static int32_t way_up(const struct islands *islands, int32_t place)
{
    const struct iso_shape *shape = islands->shape;
    const int32_t v = islands->level[place].vertex;
    int32_t best = place;
    for (int32_t at = shape->neighbour_start[v]; at < shape->neighbour_start[v + 1]; at++) {
        const int32_t other = islands->place[shape->neighbour[at]];
        best = other < best ? other : best;
    }
    return best;
}

/* Lets the level sink to the lowest vertex. Where two islands meet, the island of the lower peak
 * joins the other one if its peak is less than `least` above the pass. peak, which may be NULL,
 * receives the persistence of each peak whose island has joined another one; *n counts them. */
static void sink(struct islands *islands, double least, struct iso_peak *peak, int32_t *n)
{
    const struct iso_shape *shape = islands->shape;
    for (int32_t place = 0; place < islands->n; place++) {
        const int32_t v = islands->level[place].vertex;
        islands->parent[place] = place;
        int32_t own = iso_part_root(islands->parent, way_up(islands, place));
        islands->parent[place] = own;
        for (int32_t at = shape->neighbour_start[v]; at < shape->neighbour_start[v + 1]; at++) {
            const int32_t other = islands->place[shape->neighbour[at]];
            if (other > place) {
                continue; /* below the level still */
            }
            const int32_t root = iso_part_root(islands->parent, other);
            const int32_t lower = root > own ? root : own, higher = root > own ? own : root;
            const double height = islands->level[lower].value - islands->level[place].value;
            if (lower != higher && height < least) {
                islands->parent[lower] = higher;
                own = higher;
                if (peak) {
                    peak[(*n)++] = (struct iso_peak){islands->level[lower].vertex, height};
                }
            }
        }
    }
}

/* Finds all peaks and their persistence. */
static void find_peaks(struct islands *islands, struct iso_segments *segments)
{
    sink(islands, INFINITY, segments->peak, &segments->n_peaks);
    const double lowest = islands->level[islands->n - 1].value;
    const struct level *top = &islands->level[0];
    segments->peak[segments->n_peaks++] = (struct iso_peak){top->vertex, top->value - lowest};
    qsort(segments->peak, (size_t)segments->n_peaks, sizeof *segments->peak,
          by_falling_persistence);
}

/* Numbers the islands that are left in the order of the peaks. */
static void number_segments(struct islands *islands, struct iso_segments *segments)
{
    for (int32_t p = 0; p < segments->n_peaks; p++) {
        const int32_t place = islands->place[segments->peak[p].vertex];
        if (iso_part_root(islands->parent, place) == place) {
            islands->number[place] = segments->n_segments++;
        }
    }
    for (int32_t v = 0; v < islands->n; v++) {
        segments->segment[v] = islands->number[iso_part_root(islands->parent, islands->place[v])];
    }
}

static int allocate(const struct iso_shape *shape, struct islands *islands,
                    struct iso_segments *segments)
{
    const size_t n = (size_t)shape->mesh->n_vertices;
    *islands = (struct islands){.shape = shape, .n = shape->mesh->n_vertices};
    *segments = (struct iso_segments){0};
    islands->level = malloc(n * sizeof *islands->level);
    islands->place = malloc(n * sizeof *islands->place);
    islands->parent = malloc(n * sizeof *islands->parent);
    islands->number = malloc(n * sizeof *islands->number);
    segments->peak = malloc(n * sizeof *segments->peak);
    segments->segment = malloc(n * sizeof *segments->segment);
    const bool room = islands->level && islands->place && islands->parent && islands->number;
    return room && segments->peak && segments->segment ? 0 : -ENOMEM;
}

static void sort_vertices(struct islands *islands, const double *f)
{
    for (int32_t v = 0; v < islands->n; v++) {
        islands->level[v] = (struct level){f[v], v};
    }
    qsort(islands->level, (size_t)islands->n, sizeof *islands->level, by_falling_value);
    for (int32_t place = 0; place < islands->n; place++) {
        islands->place[islands->level[place].vertex] = place;
    }
}

int iso_shape_segments(const struct iso_shape *shape, const double *f, double least,
                       struct iso_segments *out)
{
    struct islands islands;
    struct iso_segments segments;
    bool valid = least >= 0.0;
    for (int32_t v = 0; v < shape->mesh->n_vertices; v++) {
        valid = valid && isfinite(f[v]);
    }
    if (!valid) {
        return -EINVAL;
    }
    const int error = allocate(shape, &islands, &segments);
    if (!error) {
        sort_vertices(&islands, f);
        find_peaks(&islands, &segments);
        int32_t none = 0;
        sink(&islands, least, NULL, &none);
        number_segments(&islands, &segments);
        *out = segments;
    } else {
        iso_segments_done(&segments);
    }
    free(islands.level);
    free(islands.place);
    free(islands.parent);
    free(islands.number);
    return error;
}

void iso_segments_done(struct iso_segments *segments)
{
    free(segments->peak);
    free(segments->segment);
    *segments = (struct iso_segments){0};
}

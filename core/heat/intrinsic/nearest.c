#include "core/heat/intrinsic/nearest.h"

#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static double coordinate(const struct iso_nearest *tree, int32_t place, int axis)
{
    const struct iso_vec3 *p = &tree->point[tree->order[place]];
    return axis == 0 ? p->x : axis == 1 ? p->y : p->z;
}

/* Points that share a coordinate are in the order of their numbers, so that the tree does not
 * depend on the order in which they came. */
static bool is_before(const struct iso_nearest *tree, int32_t a, int32_t b, int axis)
{
    const double p = coordinate(tree, a, axis), q = coordinate(tree, b, axis);
    return p != q ? p < q : tree->order[a] < tree->order[b];
}

static void swap(struct iso_nearest *tree, int32_t a, int32_t b)
{
    const int32_t kept = tree->order[a];
    tree->order[a] = tree->order[b];
    tree->order[b] = kept;
}

/* Moves the first of first..end - 1 to its place of the order, smaller ones before it. Returns the
 * place. */
static int32_t divide(struct iso_nearest *tree, int32_t first, int32_t end, int axis)
{
    swap(tree, first, first + (end - first) / 2);
    int32_t place = first;
    for (int32_t i = first + 1; i < end; i++) {
        if (is_before(tree, i, first, axis)) {
            swap(tree, ++place, i);
        }
    }
    swap(tree, first, place);
    return place;
}

/* Puts the median of a stretch into its middle (Hoare's selection). */
static void select_middle(struct iso_nearest *tree, int32_t first, int32_t end, int axis)
{
    const int32_t middle = first + (end - first) / 2;
    while (end - first > 1) {
        const int32_t place = divide(tree, first, end, axis);
        if (place == middle) {
            return;
        }
        if (place < middle) {
            first = place + 1;
        } else {
            end = place;
        }
    }
}

static uint8_t longest_axis(const struct iso_nearest *tree, int32_t first, int32_t end)
{
    uint8_t best = 0;
    double most = -1.0;
    for (uint8_t axis = 0; axis < 3; axis++) {
        double low = coordinate(tree, first, axis), high = low;
        for (int32_t i = first + 1; i < end; i++) {
            low = fmin(low, coordinate(tree, i, axis));
            high = fmax(high, coordinate(tree, i, axis));
        }
        if (high - low > most) {
            most = high - low;
            best = axis;
        }
    }
    return best;
}

static void build(struct iso_nearest *tree, int32_t first, int32_t end)
{
    while (end - first > 1) {
        const int32_t middle = first + (end - first) / 2;
        const uint8_t axis = longest_axis(tree, first, end);
        select_middle(tree, first, end, axis);
        tree->axis[middle] = axis;
        build(tree, first, middle);
        first = middle + 1;
    }
}

int iso_nearest_init(struct iso_nearest *tree, const struct iso_vec3 *point, const int32_t *number,
                     int32_t n)
{
    struct iso_nearest made = {.point = point, .n = n};
    made.order = malloc(((size_t)n + 1) * sizeof *made.order);
    made.axis = calloc((size_t)n + 1, sizeof *made.axis);
    if (!made.order || !made.axis) {
        iso_nearest_done(&made);
        return -ENOMEM;
    }
    memcpy(made.order, number, (size_t)n * sizeof *number);
    build(&made, 0, n);
    *tree = made;
    return 0;
}

void iso_nearest_done(struct iso_nearest *tree)
{
    free(tree->order);
    free(tree->axis);
    *tree = (struct iso_nearest){0};
}

/* What is looked for, and what was found so far. */
struct query {
    const struct iso_nearest *tree;
    struct iso_vec3 at;
    int32_t self;
    int k, n;
    struct iso_neighbour *found; /* [k], by rising distance */
};

static bool is_nearer(const struct iso_neighbour *a, const struct iso_neighbour *b)
{
    return a->square != b->square ? a->square < b->square : a->point < b->point;
}

static void offer(struct query *query, int32_t point)
{
    const struct iso_vec3 d = iso_sub(query->tree->point[point], query->at);
    const struct iso_neighbour one = {iso_dot(d, d), point};
    if (point == query->self ||
        (query->n == query->k && !is_nearer(&one, &query->found[query->k - 1]))) {
        return;
    }
    int at = query->n < query->k ? query->n++ : query->k - 1;
    for (; at > 0 && is_nearer(&one, &query->found[at - 1]); at--) {
        query->found[at] = query->found[at - 1];
    }
    query->found[at] = one;
}

/* The depth is the logarithm of the number of points, because every stretch is halved. */
static void search(struct query *query, int32_t first, int32_t end)
{
    if (first >= end) {
        return;
    }
    const int32_t middle = first + (end - first) / 2;
    offer(query, query->tree->order[middle]);
    if (end - first == 1) {
        return;
    }
    const int axis = query->tree->axis[middle];
    const double at = axis == 0 ? query->at.x : axis == 1 ? query->at.y : query->at.z;
    const double off = at - coordinate(query->tree, middle, axis);
    const bool below = off < 0.0;
    search(query, below ? first : middle + 1, below ? middle : end);
    if (query->n < query->k || off * off <= query->found[query->k - 1].square) {
        search(query, below ? middle + 1 : first, below ? end : middle);
    }
}

int iso_nearest_find(const struct iso_nearest *tree, int32_t point, int k,
                     struct iso_neighbour *out)
{
    struct query query = {
        .tree = tree, .at = tree->point[point], .self = point, .k = k, .found = out};
    search(&query, 0, tree->n);
    return query.n;
}

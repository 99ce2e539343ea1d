#include "isotherm/isotherm_curve.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/wipe.h"
#include "core/isotherm/tracer_store.h"

/* What is being traced. */
struct scene {
    const struct iso_mesh *mesh;
    const int32_t (*adjacent)[3];
    const double *heat;
    double level;
};

int iso_tracer_new(int32_t triangle_capacity, struct iso_tracer **out)
{
    if (triangle_capacity < 1) {
        return -EINVAL;
    }
    struct iso_tracer *t = calloc(1, sizeof *t);
    if (!t) {
        return -ENOMEM;
    }
    const size_t n = (size_t)triangle_capacity;
    t->triangle_capacity = triangle_capacity;
    t->points = calloc(2 * n, sizeof *t->points);
    t->start = calloc(n + 1, sizeof *t->start);
    t->closed = calloc(n, sizeof *t->closed);
    t->passed = calloc(n, sizeof *t->passed);
    t->cut = calloc(n, sizeof *t->cut);
    if (!t->points || !t->start || !t->closed || !t->passed || !t->cut) {
        iso_tracer_free(t);
        return -ENOMEM;
    }
    *out = t;
    return 0;
}

void iso_tracer_free(struct iso_tracer *tracer)
{
    if (tracer) {
        iso_wipe_free(tracer->points);
        free(tracer->start);
        free(tracer->closed);
        free(tracer->passed);
        free(tracer->cut);
        free(tracer);
    }
}

/* The edge, by its opposite corner, at which a triangle turns from hot to cold (or from cold to
 * hot); -1 if the level does not cut it. */
static int turning_edge(const struct scene *scene, int32_t triangle, bool from_hot)
{
    const int32_t *v = scene->mesh->triangles[triangle];
    for (int k = 0; k < 3; k++) {
        const bool first = scene->heat[v[(k + 1) % 3]] >= scene->level;
        bool second = scene->heat[v[(k + 2) % 3]] >= scene->level;
        if (first == from_hot && second != from_hot) {
            return k;
        }
    }
    return -1;
}

/* Where the level cuts an edge, by linear interpolation. */
static struct iso_vec3 cut(const struct scene *scene, int32_t triangle, int edge)
{
    const int32_t *v = scene->mesh->triangles[triangle];
    int32_t a = v[(edge + 1) % 3], b = v[(edge + 2) % 3];
    const double s = (scene->level - scene->heat[a]) / (scene->heat[b] - scene->heat[a]);
    const struct iso_vec3 from = scene->mesh->vertices_mm[a];
    return iso_madd(from, s, iso_sub(scene->mesh->vertices_mm[b], from));
}

/* Follows the level from a triangle until it returns or leaves the mesh. (Or until it meets another
 * curve, which is possible if not all triangles have the same orientation.) */
static void walk(struct iso_tracer *t, const struct scene *scene, int32_t first)
{
    int32_t n = t->start[t->n_curves], triangle = first;
    bool open = false;
    while (!t->passed[triangle]) {
        t->passed[triangle] = 1;
        t->points[n++] = cut(scene, triangle, turning_edge(scene, triangle, true));
        const int leaves = turning_edge(scene, triangle, false);
        const int32_t next = scene->adjacent[triangle][leaves];
        if (next < 0) {
            t->points[n++] = cut(scene, triangle, leaves);
            open = true;
            break;
        }
        triangle = next;
    }
    t->closed[t->n_curves] = !open && triangle == first;
    t->start[++t->n_curves] = n;
}

/* Lists the triangles that the level cuts, and marks them as not passed. Returns their number. */
static int32_t list_cut_triangles(struct iso_tracer *t, const struct scene *scene)
{
    const double *heat = scene->heat, level = scene->level;
    int32_t n = 0;

    for (int32_t i = 0; i < scene->mesh->n_triangles; i++) {
        const int32_t *v = scene->mesh->triangles[i];
        const int hot = (heat[v[0]] >= level) + (heat[v[1]] >= level) + (heat[v[2]] >= level);
        t->cut[n] = i;
        t->passed[i] = 0;
        n += hot == 1 || hot == 2;
    }
    return n;
}

int iso_tracer_run(struct iso_tracer *tracer, const struct iso_mesh *mesh,
                   const int32_t (*adjacent)[3], const double *heat, double level)
{
    if (mesh->n_triangles > tracer->triangle_capacity) {
        return -ENOSPC;
    }
    const struct scene scene = {mesh, adjacent, heat, level};
    const int32_t n = list_cut_triangles(tracer, &scene);
    tracer->n_curves = 0;
    tracer->start[0] = 0;
    /* Open curves come first, from where they enter the mesh. Then only loops are left. */
    for (int32_t i = 0; i < n; i++) {
        const int32_t t = tracer->cut[i];
        if (!tracer->passed[t] && adjacent[t][turning_edge(&scene, t, true)] < 0) {
            walk(tracer, &scene, t);
        }
    }
    for (int32_t i = 0; i < n; i++) {
        if (!tracer->passed[tracer->cut[i]]) {
            walk(tracer, &scene, tracer->cut[i]);
        }
    }
    return tracer->n_curves;
}

struct iso_curve iso_tracer_curve(const struct iso_tracer *tracer, int index)
{
    const int32_t from = tracer->start[index];
    return (struct iso_curve){tracer->start[index + 1] - from, tracer->closed[index],
                              &tracer->points[from]};
}

/* The winding number of a curve about `centre`, seen from the front: the number of its upward
 * crossings of the ray along +x minus the number of its downward crossings. A chord closes an open
 * curve. *area receives twice the area that the curve encloses. */
static int turns_about(struct iso_curve curve, struct iso_vec3 centre, double *area)
{
    double sum = 0.0;
    int turns = 0;
    struct iso_vec3 a = iso_sub(curve.points_mm[curve.n - 1], centre);
    for (int32_t k = 0; k < curve.n; k++) {
        const struct iso_vec3 b = iso_sub(curve.points_mm[k], centre);
        const double cross = a.x * b.y - a.y * b.x;
        if ((a.y >= 0.0) != (b.y >= 0.0)) {
            turns += b.y >= 0.0 && cross > 0.0;
            turns -= b.y < 0.0 && cross < 0.0;
        }
        sum += cross;
        a = b;
    }
    *area = fabs(sum);
    return turns;
}

int iso_tracer_enclosing(const struct iso_tracer *tracer, struct iso_vec3 landmark_mm)
{
    int best = -ENOENT;
    double best_area = 0.0;
    for (int i = 0; i < tracer->n_curves; i++) {
        double area;
        if (turns_about(iso_tracer_curve(tracer, i), landmark_mm, &area) && area > best_area) {
            best_area = area;
            best = i;
        }
    }
    return best;
}

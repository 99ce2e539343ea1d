/* The best views of a mesh (isotherm/signature.h). */
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "core/shape/describe/view_area.h"

/* Directions that are looked at first: the vertices of an icosahedron whose faces are cut into
 * SPLIT^2 triangles. They are the same after a reflection in a coordinate plane, so that the signs
 * of the mesh's axes do not matter. */
enum { SPLIT = 4, DIRECTIONS = 10 * SPLIT * SPLIT + 2, ROUND = 6 };

static const double first_step = 0.12, last_step = 0.01; /* radians */

/* A score must be better by this to count, so that rounding does not decide. */
static const double least_gain = 1e-9;

/* ---- the directions ---- */

static void add_direction(struct iso_vec3 *direction, int *n, struct iso_vec3 at)
{
    const struct iso_vec3 unit = iso_unit(at);
    for (int i = 0; i < *n; i++) {
        if (iso_norm(iso_sub(direction[i], unit)) < 1e-6) {
            return;
        }
    }
    direction[(*n)++] = unit;
}

/* Adds the vertices of the triangles into which a face is cut. */
static void cut_face(struct iso_vec3 *direction, int *n, const struct iso_vec3 corner[3])
{
    for (int i = 0; i <= SPLIT; i++) {
        for (int j = 0; i + j <= SPLIT; j++) {
            const struct iso_vec3 edge = iso_madd(iso_scale(i, corner[0]), j, corner[1]);
            add_direction(direction, n, iso_madd(edge, SPLIT - i - j, corner[2]));
        }
    }
}

/* The vertices of the icosahedron are (0, +-1, +-golden) and their rotations. Three of them are a
 * face if they are at the least distance, 2, from each other. */
static void find_directions(struct iso_vec3 direction[DIRECTIONS])
{
    enum { CORNERS = 12 };
    const double golden = 0.5 * (1.0 + sqrt(5.0));
    struct iso_vec3 v[CORNERS];
    int n = 0;
    for (int i = 0; i < 4; i++) {
        const double one = i & 1 ? -1.0 : 1.0, long_one = i & 2 ? -golden : golden;
        v[3 * i] = iso_vec3(0.0, one, long_one);
        v[3 * i + 1] = iso_vec3(one, long_one, 0.0);
        v[3 * i + 2] = iso_vec3(long_one, 0.0, one);
    }
    for (int i = 0; i < CORNERS * CORNERS * CORNERS; i++) {
        const int a = i % CORNERS, b = i / CORNERS % CORNERS, c = i / (CORNERS * CORNERS);
        const struct iso_vec3 face[3] = {v[a], v[b], v[c]};
        const double longest = fmax(
            iso_norm(iso_sub(v[a], v[b])),
            fmax(iso_norm(iso_sub(v[b], v[c])), iso_norm(iso_sub(v[c], v[a]))));
        if (a < b && b < c && longest < 2.1) {
            cut_face(direction, &n, face);
        }
    }
}

/* ---- the search ---- */

struct search {
    struct iso_view_area view;
    enum iso_view_score score;
    double nearest; /* the cosine of the least angle between two views */
    const struct iso_shape_view *chosen;
    int n_chosen;
};

static double gain(const struct search *search, const struct iso_shape_view *a,
                   const struct iso_shape_view *b)
{
    return search->score == ISO_VIEW_ENTROPY ? a->entropy - b->entropy
                                             : b->divergence - a->divergence;
}

static bool is_apart(const struct search *search, struct iso_vec3 direction)
{
    for (int i = 0; i < search->n_chosen; i++) {
        if (iso_dot(search->chosen[i].direction, direction) > search->nearest) {
            return false;
        }
    }
    return true;
}

/* Looks around a view in smaller and smaller circles, and goes where the score is better. */
static void climb(struct search *search, struct iso_shape_view *best)
{
    double step = first_step;
    while (step >= last_step) {
        const struct iso_vec3 at = best->direction, *axis = search->view.axis;
        const struct iso_vec3 side = fabs(iso_dot(at, axis[2])) < 0.9 ? axis[2] : axis[0];
        const struct iso_vec3 e1 = iso_unit(iso_cross(side, at)), e2 = iso_cross(at, e1);
        bool moved = false;
        for (int i = 0; i < ROUND; i++) {
            const double turn = 2.0 * M_PI * i / ROUND;
            const struct iso_vec3 off = iso_add(iso_scale(cos(turn), e1), iso_scale(sin(turn), e2));
            const struct iso_vec3 to = iso_unit(iso_madd(at, step, off));
            struct iso_shape_view seen;
            if (is_apart(search, to)) {
                iso_view_area_score(&search->view, to, &seen);
                if (gain(search, &seen, best) > least_gain) {
                    *best = seen;
                    moved = true;
                }
            }
        }
        step *= moved ? 1.0 : 0.5;
    }
}

/* The best of the first directions that is far enough from the views chosen so far. */
static const struct iso_shape_view *best_of(const struct search *search,
                                            const struct iso_shape_view seen[DIRECTIONS])
{
    const struct iso_shape_view *best = NULL;
    for (int i = 0; i < DIRECTIONS; i++) {
        if (is_apart(search, seen[i].direction) &&
            (!best || gain(search, &seen[i], best) > least_gain)) {
            best = &seen[i];
        }
    }
    return best;
}

static int choose(struct search *search, struct iso_shape_view seen[DIRECTIONS], int n,
                  struct iso_shape_view *out)
{
    struct iso_vec3 direction[DIRECTIONS];
    const struct iso_vec3 *axis = search->view.axis;
    find_directions(direction);
    for (int i = 0; i < DIRECTIONS; i++) {
        const struct iso_vec3 d = direction[i];
        const struct iso_vec3 to = iso_madd(iso_madd(iso_scale(d.x, axis[0]), d.y, axis[1]), d.z,
                                            axis[2]);
        iso_view_area_score(&search->view, iso_unit(to), &seen[i]);
    }
    search->chosen = out;
    while (search->n_chosen < n) {
        const struct iso_shape_view *best = best_of(search, seen);
        if (!best) {
            break;
        }
        out[search->n_chosen] = *best;
        climb(search, &out[search->n_chosen]);
        search->n_chosen++;
    }
    return search->n_chosen;
}

int iso_shape_views(const struct iso_mesh *mesh, enum iso_view_score score, double apart_rad, int n,
                    struct iso_shape_view *out, int *n_found)
{
    if (n < 1 || !(apart_rad > 0.0 && apart_rad < M_PI) || mesh->n_triangles < 1 ||
        iso_mesh_check(mesh, NULL)) {
        return -EINVAL;
    }
    struct search search = {.score = score, .nearest = cos(apart_rad)};
    struct iso_shape_view *seen = malloc(DIRECTIONS * sizeof *seen);
    int error = seen ? iso_view_area_init(&search.view, mesh) : -ENOMEM;
    if (!error) {
        *n_found = choose(&search, seen, n, out);
        iso_view_area_done(&search.view);
    }
    free(seen);
    return error;
}

int iso_shape_view_of(const struct iso_mesh *mesh, struct iso_vec3 direction,
                      struct iso_shape_view *out)
{
    struct iso_view_area view;
    const double length = iso_norm(direction);
    if (!(length > 0.0) || !isfinite(length) || mesh->n_triangles < 1 ||
        iso_mesh_check(mesh, NULL)) {
        return -EINVAL;
    }
    const int error = iso_view_area_init(&view, mesh);
    if (!error) {
        iso_view_area_score(&view, iso_scale(1.0 / length, direction), out);
        iso_view_area_done(&view);
    }
    return error;
}

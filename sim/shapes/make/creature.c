#include "sim/shapes/make/creature.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "sim/shapes/make/flesh.h"
#include "sim/shapes/make/polygonise.h"
#include "sim/shapes/make/thin.h"

enum {
    VERTICES_MIN = 200,
    /* Marching tetrahedra make about this many times the wanted number of vertices, so that
     * thinning has a choice. */
    FINER = 4,
    RELAX_STEPS = 8,
};

/* ---- the field on a grid --------------------------------------------------------- */

/* A grid around the skeleton with room for all its flesh and an empty border. */
static struct sim_field_grid grid_about(const struct sim_skeleton *skeleton, double pitch_mm)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int b = 0; b < skeleton->n_bones; b++) {
        const struct sim_bone *bone = &skeleton->bone[b];
        const double r = sim_flesh_reach * fmax(bone->radius_from_mm, bone->radius_to_mm) +
                         pitch_mm;
        const double p[3] = {bone->from_mm.x, bone->from_mm.y, bone->from_mm.z};
        const double q[3] = {bone->to_mm.x, bone->to_mm.y, bone->to_mm.z};
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], fmin(p[k], q[k]) - r);
            high[k] = fmax(high[k], fmax(p[k], q[k]) + r);
        }
    }
    return (struct sim_field_grid){
        .nx = (int)((high[0] - low[0]) / pitch_mm) + 2,
        .ny = (int)((high[1] - low[1]) / pitch_mm) + 2,
        .nz = (int)((high[2] - low[2]) / pitch_mm) + 2,
        .origin_mm = iso_vec3(low[0], low[1], low[2]),
        .pitch_mm = pitch_mm,
    };
}

/* The nodes of one axis within a bone's reach. */
static void reach_along(double from, double to, double r, double origin, double pitch, int n,
                        int *first, int *last)
{
    const int a = (int)floor((fmin(from, to) - r - origin) / pitch);
    const int b = (int)ceil((fmax(from, to) + r - origin) / pitch);
    *first = a > 0 ? a : 0;
    *last = b < n - 1 ? b : n - 1;
}

static void add_bone(const struct sim_bone *bone, struct sim_field_grid *grid)
{
    const double r = sim_flesh_reach * fmax(bone->radius_from_mm, bone->radius_to_mm);
    struct iso_vec3 p = bone->from_mm, q = bone->to_mm, o = grid->origin_mm;
    const double pitch = grid->pitch_mm;
    int i0, i1, j0, j1, k0, k1;
    reach_along(p.x, q.x, r, o.x, pitch, grid->nx, &i0, &i1);
    reach_along(p.y, q.y, r, o.y, pitch, grid->ny, &j0, &j1);
    reach_along(p.z, q.z, r, o.z, pitch, grid->nz, &k0, &k1);
    for (int k = k0; k <= k1; k++) {
        for (int j = j0; j <= j1; j++) {
            double *row =
                &grid->value[((size_t)k * (size_t)grid->ny + (size_t)j) * (size_t)grid->nx];
            for (int i = i0; i <= i1; i++) {
                row[i] += sim_flesh_bone(bone, iso_madd(o, pitch, iso_vec3(i, j, k)));
            }
        }
    }
}

static int polygonise_at(const struct sim_skeleton *skeleton, double pitch_mm,
                         struct iso_mesh **out)
{
    struct sim_field_grid grid = grid_about(skeleton, pitch_mm);
    grid.value = calloc((size_t)grid.nx * (size_t)grid.ny * (size_t)grid.nz, sizeof *grid.value);
    if (!grid.value) {
        return -ENOMEM;
    }
    for (int b = 0; b < skeleton->n_bones; b++) {
        add_bone(&skeleton->bone[b], &grid);
    }
    const int error = sim_polygonise(&grid, sim_flesh_level, out);
    free(grid.value);
    return error;
}

/* Chooses a grid fine enough for thinning to n_vertices. A coarse grid first measures the amount
 * of surface. */
static int polygonise_skeleton(const struct sim_skeleton *skeleton, int32_t n_vertices,
                               struct iso_mesh **out)
{
    double pitch_mm = 6.0;
    int error = 0;
    struct iso_mesh *mesh = NULL;
    for (int pass = 0; pass < 2 && !error; pass++) {
        iso_mesh_free(mesh);
        mesh = NULL;
        error = polygonise_at(skeleton, pitch_mm, &mesh);
        if (!error) {
            pitch_mm *= sqrt((double)mesh->n_vertices / ((double)FINER * n_vertices));
        }
    }
    if (error) {
        return error;
    }
    *out = mesh;
    return 0;
}

/* ---- well-shaped triangles --------------------------------------------------------- */

/* Keeps the largest of several unconnected surfaces and removes the triangles of the others. */
static int keep_largest(struct iso_mesh *mesh)
{
    const size_t n = (size_t)mesh->n_triangles;
    int32_t(*adjacent)[3] = calloc(n, sizeof *adjacent), *component = calloc(n, sizeof *component);
    int error = adjacent && component ? iso_mesh_adjacency(mesh, adjacent) : -ENOMEM;
    if (!error) {
        const int32_t found = iso_mesh_components(mesh, (const int32_t(*)[3])adjacent, component);
        error = found < 0 ? found : 0;
    }
    int32_t kept = 0;
    for (int32_t t = 0; !error && t < mesh->n_triangles; t++) {
        if (component[t] == 0) {
            memcpy(mesh->triangles[kept++], mesh->triangles[t], sizeof *mesh->triangles);
        }
    }
    mesh->n_triangles = error ? mesh->n_triangles : kept;
    free(adjacent);
    free(component);
    return error;
}

static int thin_mesh(struct iso_mesh *mesh, int32_t n_vertices)
{
    const int error = keep_largest(mesh);
    if (error) {
        return error;
    }
    return sim_thin(&(struct iso_coloured_mesh){.mesh = mesh}, n_vertices);
}

/* Moves a point along the gradient onto the surface by Newton steps of at most 1 mm. */
static struct iso_vec3 onto_surface(const struct sim_skeleton *skeleton, struct iso_vec3 p)
{
    for (int i = 0; i < 3; i++) {
        struct iso_vec3 g = sim_flesh_gradient(skeleton, p);
        const double slope2 = iso_dot(g, g);
        if (slope2 < 1e-12) {
            break;
        }
        const double step = (sim_flesh_level - sim_flesh_field(skeleton, p)) / slope2;
        const double length = fabs(step) * sqrt(slope2);
        p = iso_madd(p, length > 1.0 ? step / length : step, g);
    }
    return p;
}

/* Makes the triangles more even: each vertex moves 70 % of the way to the mean of the middles of
 * its triangles, weighted by their areas, and back onto the surface. */
static int relax_mesh(const struct sim_skeleton *skeleton, struct iso_mesh *mesh)
{
    const size_t n = (size_t)mesh->n_vertices;
    struct iso_vec3 *sum = calloc(n, sizeof *sum);
    double *weight = calloc(n, sizeof *weight);
    for (int step = 0; sum && weight && step < RELAX_STEPS; step++) {
        memset(sum, 0, n * sizeof *sum);
        memset(weight, 0, n * sizeof *weight);
        for (int32_t t = 0; t < mesh->n_triangles; t++) {
            const int32_t *c = mesh->triangles[t];
            const double area = iso_mesh_triangle_area(mesh, t);
            struct iso_vec3 middle = iso_scale(
                1.0 / 3.0, iso_add(iso_add(mesh->vertices_mm[c[0]], mesh->vertices_mm[c[1]]),
                                   mesh->vertices_mm[c[2]]));
            for (int k = 0; k < 3; k++) {
                sum[c[k]] = iso_madd(sum[c[k]], area, middle);
                weight[c[k]] += area;
            }
        }
        for (size_t v = 0; v < n; v++) {
            struct iso_vec3 *p = &mesh->vertices_mm[v];
            if (weight[v] > 0.0) {
                struct iso_vec3 middle = iso_scale(1.0 / weight[v], sum[v]);
                *p = onto_surface(skeleton, iso_madd(*p, 0.7, iso_sub(middle, *p)));
            }
        }
    }
    const int error = sum && weight ? 0 : -ENOMEM;
    free(sum);
    free(weight);
    return error;
}

/* ---- pose ---------------------------------------------------------------------------- */

static struct iso_vec3 posed_point(const struct sim_skeleton *skeleton,
                                   const struct iso_rigid *posed_from_rest, struct iso_vec3 p)
{
    struct iso_vec3 sum = {0, 0, 0};
    double total = 0.0;
    for (int b = 0; b < skeleton->n_bones; b++) {
        const double share = sim_flesh_bone(&skeleton->bone[b], p);
        if (share > 0.0) {
            sum = iso_madd(sum, share, iso_rigid_apply(&posed_from_rest[b], p));
            total += share;
        }
    }
    return total > 0.0 ? iso_scale(1.0 / total, sum) : p;
}

/* An approximately uniform rotation: up to half a turn about a random axis. */
static struct iso_mat3 random_turn(struct sim_random *random)
{
    struct iso_vec3 axis = iso_unit(
        iso_vec3(sim_random_normal(random), sim_random_normal(random), sim_random_normal(random)));
    return iso_mat3_rotation(iso_scale(sim_random_between(random, 0.0, M_PI), axis));
}

/* Makes the mesh at rest, in the skeleton's own frame, on a randomly placed grid. */
static int mesh_at_rest(const struct sim_skeleton *skeleton, int32_t n_vertices,
                        struct sim_random *random, struct iso_mesh **out)
{
    struct iso_mat3 turn = random_turn(random), back = iso_mat3_transpose(&turn);
    struct sim_skeleton turned = *skeleton;
    struct iso_mesh *mesh = NULL;
    sim_skeleton_turn(&turned, &turn);
    int error = polygonise_skeleton(&turned, n_vertices, &mesh);
    if (!error) {
        error = thin_mesh(mesh, n_vertices);
    }
    if (!error) {
        error = relax_mesh(&turned, mesh);
    }
    for (int32_t v = 0; !error && v < mesh->n_vertices; v++) {
        mesh->vertices_mm[v] = iso_mat3_apply(&back, mesh->vertices_mm[v]);
    }
    if (error) {
        iso_mesh_free(mesh);
        return error;
    }
    *out = mesh;
    return 0;
}

int sim_creature_new(const struct sim_skeleton *skeleton,
                     const struct sim_creature_options *options, struct sim_random *grid,
                     struct sim_random *pose, struct sim_creature **out)
{
    if (options->n_vertices < VERTICES_MIN || !(options->pose >= 0.0) || skeleton->n_bones < 1) {
        return -EINVAL;
    }
    struct iso_rigid posed_from_rest[SIM_BONES_MAX];
    struct sim_creature *creature = calloc(1, sizeof *creature);
    int error = creature ? mesh_at_rest(skeleton, options->n_vertices, grid, &creature->mesh)
                         : -ENOMEM;
    if (!error) {
        const size_t n = (size_t)creature->mesh->n_vertices;
        creature->rest_mm = calloc(n, sizeof *creature->rest_mm);
        error = creature->rest_mm ? 0 : -ENOMEM;
    }
    if (error) {
        sim_creature_free(creature);
        return error;
    }
    sim_skeleton_pose(skeleton, options->pose, pose, posed_from_rest);
    for (int32_t v = 0; v < creature->mesh->n_vertices; v++) {
        struct iso_vec3 *p = &creature->mesh->vertices_mm[v];
        creature->rest_mm[v] = *p;
        *p = posed_point(skeleton, posed_from_rest, *p);
    }
    *out = creature;
    return 0;
}

void sim_creature_free(struct sim_creature *creature)
{
    if (creature) {
        iso_mesh_free(creature->mesh);
        free(creature->rest_mm);
        free(creature);
    }
}

/* Releases heat at a vertex of a triangle mesh and traces the isotherm about it.
 *
 *     heat_on_mesh MESH.off VERTEX T_MM2 RADIUS_MM
 *
 * T_MM2 is the time that the heat flows: it spreads over about sqrt(T_MM2) millimetres. The
 * isotherm of radius r is the curve of equal temperature that encloses the area of a disc of radius
 * r. The curve's points go to standard output, one "x y z" a line. */
#include <errno.h>
#include <isotherm/heat_kernel.h>
#include <isotherm/isotherm_curve.h>
#include <isotherm/mesh.h>
#include <isotherm/stiffness_mass.h>

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Reads a mesh in the Object File Format: "OFF", the counts, the vertices, then the triangles. */
static struct iso_mesh *read_off(const char *path)
{
    FILE *file = fopen(path, "r");
    int n_vertices = 0, n_triangles = 0, corners = 0;
    struct iso_mesh *mesh = NULL;
    bool good = file && fscanf(file, "OFF %d %d %*d", &n_vertices, &n_triangles) == 2 &&
                iso_mesh_new(n_vertices, n_triangles, &mesh) == 0;
    for (int v = 0; good && v < n_vertices; v++) {
        struct iso_vec3 *p = &mesh->vertices_mm[v];
        good = fscanf(file, "%lf %lf %lf", &p->x, &p->y, &p->z) == 3;
    }
    for (int t = 0; good && t < n_triangles; t++) {
        int32_t *corner = mesh->triangles[t];
        good = fscanf(file, "%d %d %d %d", &corners, &corner[0], &corner[1], &corner[2]) == 4 &&
               corners == 3;
    }
    if (file) {
        fclose(file);
    }
    if (good) {
        mesh->n_vertices = n_vertices;
        mesh->n_triangles = n_triangles;
        good = iso_mesh_check(mesh, NULL) == 0;
    }
    if (!good) {
        iso_mesh_free(mesh);
        fprintf(stderr, "%s: not a mesh of triangles in the Object File Format\n", path);
        return NULL;
    }
    return mesh;
}

/* A vertex as a point on the surface: the corner of one of its triangles. */
static bool find_vertex(const struct iso_mesh *mesh, int32_t vertex, struct iso_surface_point *out)
{
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        for (int k = 0; k < 3; k++) {
            if (mesh->triangles[t][k] == vertex) {
                *out = (struct iso_surface_point){.triangle = t};
                out->weight[k] = 1.0;
                return true;
            }
        }
    }
    return false;
}

/* Computes the temperature at each vertex: one column of the heat kernel. *total is its integral
 * over the surface, which is the released heat: 1 at any time. */
static int solve(const struct iso_mesh *mesh, const struct iso_surface_point *source, double t_mm2,
                 double *temperature, double *total)
{
    const int32_t n = mesh->n_vertices, nnz = n + 3 * mesh->n_triangles;
    const struct iso_heat_direct_options options = {.n_capacity = n, .nnz_capacity = nnz};
    struct iso_symmetric *stiffness = NULL, *mass = NULL;
    struct iso_heat_direct *solver = NULL;
    double *heat = calloc((size_t)n, sizeof *heat); /* of each vertex: mass times temperature */

    int error = heat ? iso_symmetric_new(n, nnz, &stiffness) : -ENOMEM;
    if (!error) {
        error = iso_symmetric_new(n, nnz, &mass);
    }
    if (!error) {
        error = iso_stiffness_mass(mesh, ISO_MASS_LUMPED, stiffness, mass);
    }
    if (!error) {
        error = iso_heat_direct_new(&options, &solver);
    }
    if (!error) {
        error = iso_heat_direct(solver, mesh, stiffness, mass, source, 1, &t_mm2, 1, temperature);
    }
    if (!error) {
        iso_symmetric_multiply(mass, temperature, heat);
        *total = 0.0;
        for (int32_t v = 0; v < n; v++) {
            *total += heat[v];
        }
    }
    iso_heat_direct_free(solver);
    iso_symmetric_free(mass);
    iso_symmetric_free(stiffness);
    free(heat);
    return error;
}

/* Traces the isotherm and prints its points. A message says how far they are from the source. */
static int trace(const struct iso_mesh *mesh, const double *temperature, struct iso_vec3 source_mm,
                 double radius_mm)
{
    int32_t(*adjacent)[3] = calloc((size_t)mesh->n_triangles, sizeof *adjacent);
    struct iso_tracer *tracer = NULL;
    double level = 0.0, sum_mm = 0.0;
    int n_curves = 0, n_points = 0;

    int error = adjacent ? iso_mesh_adjacency(mesh, adjacent) : -ENOMEM;
    if (!error) {
        error = iso_tracer_new(mesh->n_triangles, &tracer);
    }
    if (!error) {
        error = iso_isotherm_level(mesh, temperature, radius_mm, &level);
    }
    if (!error) {
        n_curves = iso_tracer_run(tracer, mesh, (const int32_t(*)[3])adjacent, temperature, level);
        error = n_curves < 0 ? n_curves : 0;
    }
    for (int c = 0; c < n_curves; c++) {
        const struct iso_curve curve = iso_tracer_curve(tracer, c);
        for (int32_t i = 0; i < curve.n; i++) {
            const struct iso_vec3 p = curve.points_mm[i];
            printf("%.3f %.3f %.3f\n", p.x, p.y, p.z);
            sum_mm += iso_norm(iso_sub(p, source_mm));
            n_points++;
        }
    }
    if (!error && n_points > 0) {
        fprintf(stderr, "isotherm: %d curve(s) of %d points, %.2f mm from the source on average\n",
                n_curves, n_points, sum_mm / n_points);
    }
    iso_tracer_free(tracer);
    free(adjacent);
    return error;
}

int main(int argc, char **argv)
{
    if (argc != 5) {
        fprintf(stderr, "usage: %s MESH.off VERTEX T_MM2 RADIUS_MM\n", argv[0]);
        return 2;
    }
    struct iso_mesh *mesh = read_off(argv[1]);
    if (!mesh) {
        return 1;
    }
    struct iso_surface_point source;
    double *temperature = calloc((size_t)mesh->n_vertices, sizeof *temperature);
    double total = 0.0;
    int error = temperature ? 0 : -ENOMEM;
    if (!error && !find_vertex(mesh, atoi(argv[2]), &source)) {
        fprintf(stderr, "%s: no triangle has the vertex %s\n", argv[1], argv[2]);
        error = -EINVAL;
    }
    if (!error) {
        error = solve(mesh, &source, atof(argv[3]), temperature, &total);
    }
    if (!error) {
        fprintf(stderr, "heat on the surface: %.6f\n", total);
        error = trace(mesh, temperature, iso_mesh_point_at(mesh, source), atof(argv[4]));
    }
    if (error) {
        fprintf(stderr, "%s: %s\n", argv[1], strerror(-error));
    }
    free(temperature);
    iso_mesh_free(mesh);
    return error ? 1 : 0;
}

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
#include <isotherm/mesh_file.h>
#include <isotherm/stiffness_mass.h>

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Reads a mesh in the Object File Format. The library takes the contents of the file, and says what
 * is wrong with them. */
static int read_off(const char *path, struct iso_coloured_mesh *out)
{
    enum { LARGEST = 1 << 26 };
    FILE *file = fopen(path, "rb");
    char *bytes = malloc(LARGEST + 1);
    const size_t size = file && bytes ? fread(bytes, 1, LARGEST, file) : 0;
    struct iso_fault fault = {.text = ""};
    int error = -EIO;
    if (file) {
        fclose(file);
    }
    if (size == 0) {
        fprintf(stderr, "%s: cannot be read\n", path);
    } else {
        bytes[size] = '\0';
        error = iso_mesh_parse(ISO_MESH_FORMAT_OFF, path, bytes, size, NULL, out, &fault);
    }
    free(bytes);
    if (fault.text[0]) {
        fprintf(stderr, "%s\n", fault.text);
    }
    return error;
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
    struct iso_coloured_mesh read = {NULL, NULL};
    if (read_off(argv[1], &read)) {
        return 1;
    }
    const struct iso_mesh *mesh = read.mesh;
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
    iso_coloured_mesh_done(&read);
    return error ? 1 : 0;
}

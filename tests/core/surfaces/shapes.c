#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "tests/core/surfaces/shapes.h"

static struct iso_mesh *new_mesh(int32_t n_vertices, int32_t n_triangles)
{
    struct iso_mesh *mesh = NULL;
    assert_int_equal(iso_mesh_new(n_vertices, n_triangles, &mesh), 0);
    return mesh;
}

static void add_triangle(struct iso_mesh *mesh, int32_t a, int32_t b, int32_t c)
{
    int32_t *v = mesh->triangles[mesh->n_triangles++];
    v[0] = a;
    v[1] = b;
    v[2] = c;
}

struct iso_mesh *shape_sheet(int columns, int rows, double pitch_mm)
{
    struct iso_mesh *mesh = new_mesh(columns * rows, 2 * (columns - 1) * (rows - 1));
    for (int row = 0; row < rows; row++) {
        for (int column = 0; column < columns; column++) {
            mesh->vertices_mm[mesh->n_vertices++] = iso_vec3(
                pitch_mm * (column - 0.5 * (columns - 1)), pitch_mm * (row - 0.5 * (rows - 1)),
                0.0);
        }
    }
    for (int row = 0; row + 1 < rows; row++) {
        for (int column = 0; column + 1 < columns; column++) {
            int32_t a = row * columns + column, b = a + 1, c = a + columns, d = c + 1;
            if ((row + column) % 2) {
                add_triangle(mesh, a, b, c);
                add_triangle(mesh, b, d, c);
            } else {
                add_triangle(mesh, a, b, d);
                add_triangle(mesh, a, d, c);
            }
        }
    }
    return mesh;
}

/* Returns the vertex in the middle of an edge. If the edge was split before, it finds that vertex
 * again. */
static int32_t split_edge(struct iso_mesh *mesh, int32_t (*split)[3], int32_t *n_split, int32_t a,
                          int32_t b)
{
    int32_t low = a < b ? a : b, high = a < b ? b : a;
    for (int32_t i = 0; i < *n_split; i++) {
        if (split[i][0] == low && split[i][1] == high) {
            /* Each edge has two triangles: the record is no longer needed. */
            int32_t middle = split[i][2];
            --*n_split;
            for (int k = 0; k < 3; k++) {
                split[i][k] = split[*n_split][k];
            }
            return middle;
        }
    }
    int32_t middle = mesh->n_vertices++;
    struct iso_vec3 p = iso_add(mesh->vertices_mm[a], mesh->vertices_mm[b]);
    mesh->vertices_mm[middle] = iso_unit(p);
    split[*n_split][0] = low;
    split[*n_split][1] = high;
    split[*n_split][2] = middle;
    ++*n_split;
    return middle;
}

static void split_faces(struct iso_mesh *mesh)
{
    int32_t n = mesh->n_triangles, n_split = 0;
    int32_t(*split)[3] = calloc(3 * (size_t)n, sizeof *split);
    assert_non_null(split);
    for (int32_t t = 0; t < n; t++) {
        int32_t *v = mesh->triangles[t];
        int32_t ab = split_edge(mesh, split, &n_split, v[0], v[1]);
        int32_t bc = split_edge(mesh, split, &n_split, v[1], v[2]);
        int32_t ca = split_edge(mesh, split, &n_split, v[2], v[0]);
        add_triangle(mesh, v[0], ab, ca);
        add_triangle(mesh, v[1], bc, ab);
        add_triangle(mesh, v[2], ca, bc);
        v[0] = ab;
        v[1] = bc;
        v[2] = ca;
    }
    free(split);
}

struct iso_mesh *shape_sphere(int splits, double radius_mm)
{
    static const int32_t faces[20][3] = {
        {0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
        {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
        {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1},
    };
    const double g = 0.5 * (1.0 + sqrt(5.0));
    const struct iso_vec3 corners[12] = {
        {-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
        {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1},
    };
    int32_t quads = 1 << (2 * splits);
    struct iso_mesh *mesh = new_mesh(10 * quads + 2, 20 * quads);
    for (int i = 0; i < 12; i++) {
        mesh->vertices_mm[mesh->n_vertices++] = iso_unit(corners[i]);
    }
    for (int i = 0; i < 20; i++) {
        add_triangle(mesh, faces[i][0], faces[i][1], faces[i][2]);
    }
    for (int i = 0; i < splits; i++) {
        split_faces(mesh);
    }
    for (int32_t i = 0; i < mesh->n_vertices; i++) {
        mesh->vertices_mm[i] = iso_scale(radius_mm, mesh->vertices_mm[i]);
    }
    return mesh;
}

struct iso_mesh *shape_disc(int rings, double radius_mm)
{
    struct iso_mesh *mesh = new_mesh(1 + 3 * rings * (rings + 1), 6 * rings * rings);
    mesh->vertices_mm[mesh->n_vertices++] = iso_vec3(0, 0, 0);
    for (int ring = 1; ring <= rings; ring++) {
        int32_t outer = mesh->n_vertices, inner = outer - (ring > 1 ? 6 * (ring - 1) : 1);
        for (int i = 0; i < 6 * ring; i++) {
            double r = radius_mm * ring / rings, angle = 2.0 * M_PI * i / (6 * ring);
            mesh->vertices_mm[mesh->n_vertices++] = iso_vec3(r * cos(angle), r * sin(angle), 0.0);
        }
        int32_t n_outer = 6 * ring, n_inner = ring > 1 ? 6 * (ring - 1) : 1;
        for (int sector = 0; sector < 6; sector++) {
            for (int i = 0; i < ring; i++) {
                int32_t o = outer + sector * ring + i;
                int32_t next = outer + (sector * ring + i + 1) % n_outer;
                int32_t in = inner + (sector * (ring - 1) + i) % n_inner;
                add_triangle(mesh, o, next, in);
                if (i + 1 < ring) {
                    int32_t in_next = inner + (sector * (ring - 1) + i + 1) % n_inner;
                    add_triangle(mesh, next, in_next, in);
                }
            }
        }
    }
    return mesh;
}

static double bump(double x, double y, double at_x, double at_y, double wide, double high)
{
    double u = (x - at_x) / wide, v = (y - at_y) / high;
    return exp(-0.5 * (u * u + v * v));
}

/* The height of an artificial face: nose, eye sockets, cheeks and mouth on a curved ground. */
static double relief(double x, double y)
{
    return -0.5 * x * x / 90.0 - 0.5 * y * y / 160.0 + 26.0 * bump(x, y, 0, 0, 9, 13) +
           9.0 * bump(x, y, 1, 20, 7, 16) - 8.0 * bump(x, y, -32, 33, 12, 8) -
           8.0 * bump(x, y, 32, 33, 12, 8) + 5.0 * bump(x, y, -40, -5, 14, 14) +
           5.0 * bump(x, y, 41, -4, 14, 14) + 6.0 * bump(x, y, 0, -32, 16, 4) -
           3.0 * bump(x, y, 2, -36, 18, 2.5);
}

/* Keeps the triangles within a radius about the z axis, and the vertices that they use. */
static void crop(struct iso_mesh *mesh, double radius_mm)
{
    int32_t *number = calloc((size_t)mesh->n_vertices, sizeof *number);
    assert_non_null(number);
    int32_t n_triangles = 0, n_vertices = 0;
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        const int32_t v[3] = {mesh->triangles[t][0], mesh->triangles[t][1], mesh->triangles[t][2]};
        double reach = 0.0;
        for (int k = 0; k < 3; k++) {
            reach = fmax(reach, hypot(mesh->vertices_mm[v[k]].x, mesh->vertices_mm[v[k]].y));
        }
        for (int k = 0; k < 3 && reach <= radius_mm; k++) {
            mesh->triangles[n_triangles][k] = v[k];
            number[v[k]] = 1;
        }
        n_triangles += reach <= radius_mm;
    }
    for (int32_t i = 0; i < mesh->n_vertices; i++) {
        if (number[i]) {
            mesh->vertices_mm[n_vertices] = mesh->vertices_mm[i];
            number[i] = n_vertices++;
        }
    }
    for (int32_t t = 0; t < n_triangles; t++) {
        for (int k = 0; k < 3; k++) {
            mesh->triangles[t][k] = number[mesh->triangles[t][k]];
        }
    }
    mesh->n_vertices = n_vertices;
    mesh->n_triangles = n_triangles;
    free(number);
}

struct iso_mesh *shape_relief(double pitch_mm)
{
    const double radius_mm = 100.0;
    int side = 2 * (int)ceil(radius_mm / pitch_mm) + 1;
    struct iso_mesh *mesh = shape_sheet(side, side, pitch_mm);
    for (int32_t i = 0; i < mesh->n_vertices; i++) {
        struct iso_vec3 *p = &mesh->vertices_mm[i];
        p->z = relief(p->x, p->y);
    }
    crop(mesh, radius_mm);
    return mesh;
}

void shape_roll(struct iso_mesh *mesh, double radius_mm)
{
    for (int32_t i = 0; i < mesh->n_vertices; i++) {
        struct iso_vec3 *p = &mesh->vertices_mm[i];
        double angle = p->x / radius_mm;
        *p = iso_vec3(radius_mm * sin(angle), p->y, radius_mm * (cos(angle) - 1.0));
    }
}

struct iso_surface_point shape_locate(const struct iso_mesh *mesh, double x_mm, double y_mm)
{
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        const int32_t *v = mesh->triangles[t];
        struct iso_vec3 a = mesh->vertices_mm[v[0]];
        struct iso_vec3 b = iso_sub(mesh->vertices_mm[v[1]], a);
        struct iso_vec3 c = iso_sub(mesh->vertices_mm[v[2]], a);
        double x = x_mm - a.x, y = y_mm - a.y, area = b.x * c.y - b.y * c.x;
        double w1 = (x * c.y - y * c.x) / area, w2 = (b.x * y - b.y * x) / area;
        if (w1 >= -1e-12 && w2 >= -1e-12 && w1 + w2 <= 1.0 + 1e-12) {
            return (struct iso_surface_point){t, {1.0 - w1 - w2, w1, w2}};
        }
    }
    fail_msg("no surface at (%g, %g)", x_mm, y_mm);
    return (struct iso_surface_point){0};
}

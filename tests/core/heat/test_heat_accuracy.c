/* The distance between the isotherms of both methods and those of a reference with eleven correct
 * digits, on surfaces like a face. The test asserts the limits that the product promises, and
 * prints the other figures. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "core/surface/raster.h"
#include "isotherm/head_model.h"
#include "isotherm/heat_kernel.h"
#include "isotherm/isotherm_curve.h"
#include "isotherm/triangulate.h"
#include "tests/core/surfaces/matrices.h"
#include "tests/core/surfaces/reference_heat.h"
#include "tests/core/surfaces/shapes.h"
#include "tests/core/surfaces/shipped_model.h"

enum { SOURCES = 3, TIMES = 5, RADII = 3, POINTS = 64, EIGENPAIRS = 100 };

static const double t_mm2[TIMES] = {50, 75, 100, 150, 200};
static const double radius_mm[RADII] = {10, 18, 30};
static const double promised_mm = 0.05;

/* Sources near the nose tip, the inner eye corner and the mouth corner. */
static const double place_mm[SOURCES][2] = {{0.3, 0.4}, {17.3, 33.1}, {-24.4, -33.7}};

struct face {
    struct iso_mesh *mesh;
    int32_t (*adjacent)[3];
    struct matrices m;
    struct iso_tracer *tracer;
    struct iso_surface_point source[SOURCES];
};

static struct face face_of(struct iso_mesh *mesh)
{
    struct face f = {.mesh = mesh, .m = matrices_of(mesh, ISO_MASS_CONSISTENT)};
    f.adjacent = calloc((size_t)mesh->n_triangles, sizeof *f.adjacent);
    assert_non_null(f.adjacent);
    assert_int_equal(iso_mesh_adjacency(mesh, f.adjacent), 0);
    assert_int_equal(iso_tracer_new(mesh->n_triangles, &f.tracer), 0);
    for (int s = 0; s < SOURCES; s++) {
        f.source[s] = shape_locate(mesh, place_mm[s][0], place_mm[s][1]);
    }
    return f;
}

static void face_done(struct face *f)
{
    iso_mesh_free(f->mesh);
    free(f->adjacent);
    matrices_free(&f->m);
    iso_tracer_free(f->tracer);
}

/* Returns false if the heat has no such isotherm about the source. */
static bool isotherm_of(struct face *f, const double *heat, int source, double radius,
                        struct iso_isotherm *out)
{
    struct iso_vec3 centre = iso_mesh_point_at(f->mesh, f->source[source]);
    double level;
    if (iso_isotherm_level(f->mesh, heat, radius, &level)) {
        return false;
    }
    assert_true(iso_tracer_run(f->tracer, f->mesh, (const int32_t(*)[3])f->adjacent, heat, level) >
                0);
    int curve = iso_tracer_enclosing(f->tracer, centre);
    if (curve < 0) {
        return false;
    }
    assert_int_equal(
        iso_isotherm_sample_polar(iso_tracer_curve(f->tracer, curve), centre, POINTS, out), 0);
    return true;
}

/* Returns the root mean square distance between the isotherms of `heat` and of `exact`, over all
 * sources. It is infinite if an isotherm of `heat` does not exist. */
static double isotherm_error(struct face *f, const double *heat, const double *exact, int time,
                             double radius)
{
    size_t n = (size_t)f->mesh->n_vertices;
    double square = 0.0;
    int points = 0;
    for (int s = 0; s < SOURCES; s++) {
        size_t column = ((size_t)s * TIMES + (size_t)time) * n;
        struct iso_isotherm a, b;
        assert_true(isotherm_of(f, &exact[column], s, radius, &a));
        if (!isotherm_of(f, &heat[column], s, radius, &b)) {
            return INFINITY;
        }
        for (int i = 0; i < POINTS; i++) {
            if (a.weight[i] == 0.0f) { /* the surface ends inside the isotherm */
                continue;
            }
            if (b.weight[i] == 0.0f) {
                return INFINITY;
            }
            struct iso_vec3 off = iso_sub(a.points_mm[i], b.points_mm[i]);
            square += iso_dot(off, off);
            points++;
        }
    }
    assert_true(points > SOURCES * POINTS * 9 / 10);
    return sqrt(square / points);
}

/* Prints a table, and checks the promise for times from t_promised on. */
static void compare(struct face *f, const char *name, const double *heat, const double *exact,
                    double t_promised)
{
    for (int j = 0; j < TIMES; j++) {
        char line[160];
        int at = snprintf(line, sizeof line, "%s, t = %3g mm^2: rms", name, t_mm2[j]);
        for (int r = 0; r < RADII; r++) {
            double error = isotherm_error(f, heat, exact, j, radius_mm[r]);
            at += snprintf(&line[at], sizeof line - (size_t)at, "  r %g: %.4f mm", radius_mm[r],
                           error);
            assert_true(t_mm2[j] < t_promised || error < promised_mm);
        }
        print_message("%s\n", line);
    }
}

/* The product computes one time in each call. */
static void release_directly(const struct face *f, double *heat)
{
    size_t n = (size_t)f->mesh->n_vertices;
    const struct iso_heat_direct_options options = {.n_capacity = f->m.mass->n,
                                                    .nnz_capacity = f->m.mass->nnz};
    struct iso_heat_direct *solver = NULL;
    assert_int_equal(iso_heat_direct_new(&options, &solver), 0);
    for (int s = 0; s < SOURCES; s++) {
        for (int j = 0; j < TIMES; j++) {
            double *column = &heat[((size_t)s * TIMES + (size_t)j) * n];
            assert_int_equal(iso_heat_direct(solver, f->mesh, f->m.stiffness, f->m.mass,
                                             &f->source[s], 1, &t_mm2[j], 1, column),
                             0);
        }
    }
    iso_heat_direct_free(solver);
}

static void compare_both_methods(struct iso_mesh *mesh)
{
    struct face f = face_of(mesh);
    size_t n = (size_t)mesh->n_vertices, columns = SOURCES * TIMES;
    double *exact = calloc(columns * n, sizeof *exact), *heat = calloc(columns * n, sizeof *heat);
    assert_true(exact && heat);
    print_message("%d vertices\n", mesh->n_vertices);
    for (int s = 0; s < SOURCES; s++) {
        reference_heat(mesh, &f.m, f.source[s], t_mm2, TIMES, &exact[(size_t)s * TIMES * n]);
    }
    release_directly(&f, heat);
    compare(&f, "direct", heat, exact, 100.0);
    struct iso_eigenpairs *pairs = NULL;
    assert_int_equal(iso_eigenpairs_new(f.m.stiffness, f.m.mass, EIGENPAIRS, 1e-10, &pairs), 0);
    iso_heat_spectral(pairs, mesh, f.source, SOURCES, t_mm2, TIMES, heat);
    compare(&f, "100 eigenpairs", heat, exact, 200.0);
    double coldest = 0.0;
    for (size_t i = 0; i < n; i++) {
        coldest = fmin(coldest, heat[i]); /* first source, t = 50 */
    }
    print_message("100 eigenpairs, t =  50 mm^2: coldest %.2f %% of the peak\n",
                  100.0 * coldest * 4.0 * M_PI * t_mm2[0]);
    iso_eigenpairs_free(pairs);
    free(exact);
    free(heat);
    face_done(&f);
}

static void on_a_relief(void **state)
{
    (void)state;
    compare_both_methods(shape_relief(2.0));
}

/* The mean face within 100 mm of the nose tip as a depth grid of 2 mm, as a mesh in the face frame.
 */
static struct iso_mesh *mean_face(const struct iso_head_model *model)
{
    enum { SIDE = 101 };
    const double far_mm = 250.0;
    const struct iso_camera camera = {.projection = ISO_ORTHOGRAPHIC,
                                      .width_px = SIDE,
                                      .height_px = SIDE,
                                      .pitch_mm = 2.0,
                                      .cx_px = SIDE / 2,
                                      .cy_px = SIDE / 2};
    struct iso_frame *frame = NULL;
    assert_int_equal(iso_frame_new(&camera, SIDE, SIDE, false, &frame), 0);
    const struct iso_raster raster = {
        .camera = camera, .width_px = SIDE, .height_px = SIDE, .depth_mm = frame->depth_mm};
    struct iso_vec3 *seen = calloc(model->n_vertices, sizeof *seen);
    assert_non_null(seen);
    for (uint32_t i = 0; i < model->n_vertices; i++) {
        struct iso_vec3 p = model->mean_mm[i];
        seen[i] = iso_vec3(p.x, -p.y, far_mm - p.z);
    }
    iso_raster_clear(&raster);
    iso_raster_triangles(&raster, seen, (const uint32_t(*)[3])model->triangles,
                         (int32_t)model->n_triangles, 0, 1.0, 1);
    free(seen);
    for (int i = 0; i < SIDE * SIDE; i++) {
        if (hypot(i % SIDE - SIDE / 2, i / SIDE - SIDE / 2) > SIDE / 2) {
            frame->depth_mm[i] = 0.0f;
        }
    }
    /* The steep sides of the nose stay connected, as on a face patch. */
    const struct iso_triangulate_options options = {.jump_mm = 250.0, .largest_only = true};
    struct iso_triangulator *triangulator = NULL;
    struct iso_mesh *mesh = NULL;
    assert_int_equal(iso_triangulator_new(SIDE * SIDE, &options, &triangulator), 0);
    assert_int_equal(iso_mesh_new(SIDE * SIDE, 2 * SIDE * SIDE, &mesh), 0);
    assert_int_equal(iso_triangulate(triangulator, frame, mesh), 0);
    for (int32_t i = 0; i < mesh->n_vertices; i++) {
        struct iso_vec3 p = mesh->vertices_mm[i];
        mesh->vertices_mm[i] = iso_vec3(p.x, -p.y, far_mm - p.z);
    }
    iso_triangulator_free(triangulator);
    iso_frame_free(frame);
    return mesh;
}

static void on_the_mean_face(void **state)
{
    (void)state;
    struct iso_head_model *model = shipped_head_model();
    struct iso_mesh *mesh = mean_face(model);
    iso_head_model_free(model);
    compare_both_methods(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(on_a_relief),
        cmocka_unit_test(on_the_mean_face),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

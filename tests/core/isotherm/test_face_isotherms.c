/* The isotherms of a whole face: circles on a plane with the plane's own heat, and mirror images on
 * the mean face. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/isotherm/face_isotherms.h"
#include "isotherm/heat_kernel.h"
#include "isotherm/triangulate.h"
#include "tests/core/surfaces/matrices.h"
#include "tests/core/surfaces/rendered_head.h"
#include "tests/core/surfaces/shapes.h"
#include "tests/core/surfaces/shipped_model.h"

enum { COLUMNS = 91, ROWS = 81, POINTS = 24 };

static const double pitch_mm = 2.0, t_mm2 = 100.0;
static const double radius_mm[] = {9.0, 18.0};

enum { RADII = sizeof radius_mm / sizeof radius_mm[0] };

struct fixture {
    struct iso_head_model *model;
    struct iso_face_patch *patch;
    struct iso_mesh *mesh;
    int32_t (*adjacent)[3];
    double *heat;
    struct iso_tracer *tracer;
    struct iso_heated_face face;
    struct iso_template tmpl;
};

/* Builds the patch of the mean face. The triangles that reach x = cut_x_mm or beyond are not
 * measured. */
static void make_patch(struct fixture *f, double cut_x_mm)
{
    const struct iso_face_patch_options options = {
        .radius_mm = 100.0, .spacing_mm = 2.0, .smoothing_mm = 0.0, .outlier_mm = 20.0};
    struct iso_rigid pose = rendered_head_pose(0.0, 0.0, iso_vec3(0, 0, 600));
    struct iso_mesh *head = rendered_head_mesh(f->model, NULL, &pose);
    int32_t kept = 0;
    for (int32_t t = 0; t < head->n_triangles; t++) {
        int32_t *v = head->triangles[t];
        bool kept_whole = true;
        for (int k = 0; k < 3; k++) {
            kept_whole &= head->vertices_mm[v[k]].x < cut_x_mm;
        }
        if (kept_whole) {
            memmove(head->triangles[kept++], v, sizeof head->triangles[0]);
        }
    }
    head->n_triangles = kept;
    assert_int_equal(iso_face_patch_new(f->model, &options, &f->patch), 0);
    (void)iso_face_patch_build(f->patch, head, &pose);
    iso_mesh_free(head);
}

/* Makes the rest of the fixture after its patch and its mesh. All heat is 0. */
static void make_rest(struct fixture *f)
{
    size_t triangles = (size_t)f->mesh->n_triangles, vertices = (size_t)f->mesh->n_vertices;
    f->adjacent = calloc(triangles, sizeof *f->adjacent);
    f->heat = calloc(ISO_LANDMARKS * vertices, sizeof *f->heat);
    assert_true(f->adjacent && f->heat);
    assert_int_equal(iso_mesh_adjacency(f->mesh, f->adjacent), 0);
    assert_int_equal(iso_tracer_new(f->mesh->n_triangles, &f->tracer), 0);
    f->face.mesh = f->mesh;
    f->face.adjacent = (const int32_t(*)[3])f->adjacent;
    f->face.patch = f->patch;
    f->face.heat = f->heat;
    memset(&f->tmpl, 0x5a, sizeof f->tmpl); /* any earlier content */
    f->tmpl.n_radii = RADII;
    f->tmpl.n_points = POINTS;
    for (int r = 0; r < RADII; r++) {
        f->tmpl.radius_mm[r] = (float)radius_mm[r];
    }
}

static void release_on_plane(struct fixture *f, int landmark, struct iso_vec3 at)
{
    double *heat = &f->heat[(size_t)landmark * (size_t)f->mesh->n_vertices];
    f->face.landmark_mm[landmark] = at;
    for (int32_t i = 0; i < f->mesh->n_vertices; i++) {
        double r = iso_norm(iso_sub(f->mesh->vertices_mm[i], at));
        heat[i] = exp(-r * r / (4.0 * t_mm2)) / (4.0 * M_PI * t_mm2);
    }
}

static struct iso_vec3 place_on_plane(int landmark)
{
    return iso_vec3(12.3 * (landmark % 4) - 20.0, 17.9 * (landmark / 4) - 15.0, 0.0);
}

static int set_up_plane(void **state)
{
    struct fixture *f = calloc(1, sizeof *f);
    assert_non_null(f);
    f->model = shipped_head_model();
    make_patch(f, 10.0);
    f->mesh = shape_sheet(COLUMNS, ROWS, pitch_mm);
    make_rest(f);
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        release_on_plane(f, l, place_on_plane(l));
    }
    *state = f;
    return 0;
}

/* The patch of the mean face, with true heat from its landmarks. */
static int set_up_face(void **state)
{
    struct fixture *f = calloc(1, sizeof *f);
    assert_non_null(f);
    f->model = shipped_head_model();
    make_patch(f, INFINITY);
    const struct iso_frame *grid = iso_face_patch_frame(f->patch);
    const int n_px = grid->width_px * grid->height_px;
    const struct iso_triangulate_options whole = {.jump_mm = ISO_FACE_PATCH_ORIGIN_MM};
    struct iso_triangulator *triangulator = NULL;
    assert_int_equal(iso_triangulator_new((size_t)n_px, &whole, &triangulator), 0);
    assert_int_equal(iso_mesh_new(n_px, 2 * n_px, &f->mesh), 0);
    assert_int_equal(iso_triangulate(triangulator, grid, f->mesh), 0);
    for (int32_t i = 0; i < f->mesh->n_vertices; i++) {
        f->mesh->vertices_mm[i] = iso_face_from_patch(f->mesh->vertices_mm[i]);
    }
    make_rest(f);
    struct iso_surface_point sources[ISO_LANDMARKS];
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        struct iso_vec3 at = iso_head_point_on(f->model, f->model->mean_mm,
                                               f->model->landmarks[iso_landmark_ibug[l]]);
        double column, row;
        iso_face_patch_pixel(f->patch, at.x, at.y, &column, &row);
        assert_int_equal(iso_triangulate_locate(triangulator, column, row, &sources[l]), 0);
        f->face.landmark_mm[l] = iso_mesh_point_at(f->mesh, sources[l]);
    }
    iso_triangulator_free(triangulator);
    struct matrices m = matrices_of(f->mesh, ISO_MASS_CONSISTENT);
    const struct iso_heat_direct_options options = {.n_capacity = m.stiffness->n,
                                                    .nnz_capacity = m.stiffness->nnz};
    struct iso_heat_direct *solver = NULL;
    assert_int_equal(iso_heat_direct_new(&options, &solver), 0);
    assert_int_equal(iso_heat_direct(solver, f->mesh, m.stiffness, m.mass, sources, ISO_LANDMARKS,
                                     &t_mm2, 1, f->heat),
                     0);
    iso_heat_direct_free(solver);
    matrices_free(&m);
    *state = f;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *f = *state;
    iso_tracer_free(f->tracer);
    iso_mesh_free(f->mesh);
    iso_face_patch_free(f->patch);
    iso_head_model_free(f->model);
    free(f->adjacent);
    free(f->heat);
    free(f);
    return 0;
}

static void on_a_plane_isotherms_are_circles(void **state)
{
    struct fixture *f = *state;
    assert_int_equal(iso_face_isotherms(f->tracer, &f->face, &f->tmpl), 0);
    for (int r = 0; r < RADII; r++) {
        for (int l = 0; l < ISO_LANDMARKS; l++) {
            struct iso_vec3 centre = place_on_plane(l);
            for (int i = 0; i < POINTS; i++) {
                const float *p = f->tmpl.points_mm[r][l][i];
                double angle = 2.0 * M_PI * i / POINTS; /* from +y towards -x */
                double x = centre.x - radius_mm[r] * sin(angle);
                double y = centre.y + radius_mm[r] * cos(angle);
                assert_true(hypot((double)p[0] - x, (double)p[1] - y) < 0.1);
                assert_true(p[2] == 0.0f);
            }
        }
    }
}

static void points_have_weight_where_the_face_was_measured(void **state)
{
    struct fixture *f = *state;
    double total = 0.0;
    int none = 0, full = 0;
    assert_int_equal(iso_face_isotherms(f->tracer, &f->face, &f->tmpl), 0);
    for (int r = 0; r < RADII; r++) {
        for (int l = 0; l < ISO_LANDMARKS; l++) {
            for (int i = 0; i < POINTS; i++) {
                const float *p = f->tmpl.points_mm[r][l][i];
                float weight = f->tmpl.weight[r][l][i];
                /* The patch was measured up to a border of triangles at x = 10. */
                assert_true(p[0] < 12.0f || weight == 0.0f);
                assert_true(p[0] > -5.0f || p[0] < -60.0f || weight == 1.0f);
                none += weight == 0.0f;
                full += weight == 1.0f;
                total += (double)weight;
            }
        }
    }
    assert_true(none > 0 && full > 0);
    assert_true(fabs((double)f->tmpl.quality - total / (RADII * ISO_LANDMARKS * POINTS)) < 1e-6);
}

static void an_isotherm_beyond_the_border_has_no_weight(void **state)
{
    struct fixture *f = *state;
    /* One landmark is 5 mm from the sheet's left border, and one has no heat. */
    double left_mm = -pitch_mm * (COLUMNS - 1) / 2.0;
    release_on_plane(f, ISO_LM_ALA_R, iso_vec3(left_mm + 5.0, 3.0, 0.0));
    memset(&f->heat[ISO_LM_MOUTH_L * (size_t)f->mesh->n_vertices], 0,
           (size_t)f->mesh->n_vertices * sizeof *f->heat);
    assert_int_equal(iso_face_isotherms(f->tracer, &f->face, &f->tmpl), 0);
    for (int r = 0; r < RADII; r++) {
        /* Point 6 of 24 is towards the face's -x, outside. */
        const float *outside = f->tmpl.points_mm[r][ISO_LM_ALA_R][6];
        assert_true(outside[0] == 0.0f && outside[1] == 0.0f && outside[2] == 0.0f);
        assert_true(f->tmpl.weight[r][ISO_LM_ALA_R][6] == 0.0f);
        const float *inside = f->tmpl.points_mm[r][ISO_LM_ALA_R][18];
        assert_true((double)inside[0] > left_mm + 5.0 + radius_mm[r] - 0.2);
        for (int i = 0; i < POINTS; i++) {
            assert_true(f->tmpl.weight[r][ISO_LM_MOUTH_L][i] == 0.0f);
            assert_true(f->tmpl.points_mm[r][ISO_LM_MOUTH_L][i][0] == 0.0f);
        }
    }
}

static void unused_parts_of_a_template_are_zero(void **state)
{
    struct fixture *f = *state;
    assert_int_equal(iso_face_isotherms(f->tracer, &f->face, &f->tmpl), 0);
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        for (int i = 0; i < ISO_TEMPLATE_POINTS_MAX; i++) {
            assert_true(f->tmpl.weight[RADII][l][i] == 0.0f);
            assert_true(i < POINTS || f->tmpl.weight[0][l][i] == 0.0f);
        }
    }
}

static void a_small_tracer_is_refused(void **state)
{
    struct fixture *f = *state;
    struct iso_tracer *small = NULL;
    assert_int_equal(iso_tracer_new(f->mesh->n_triangles - 1, &small), 0);
    assert_int_equal(iso_face_isotherms(small, &f->face, &f->tmpl), -ENOSPC);
    iso_tracer_free(small);
}

static void on_the_mean_face_they_are_whole_and_about_their_landmark(void **state)
{
    struct fixture *f = *state;
    assert_int_equal(iso_face_isotherms(f->tracer, &f->face, &f->tmpl), 0);
    assert_true(f->tmpl.quality > 0.999f);
    for (int r = 0; r < RADII; r++) {
        for (int l = 0; l < ISO_LANDMARKS; l++) {
            struct iso_vec3 centre = f->face.landmark_mm[l];
            for (int i = 0; i < POINTS; i++) {
                const float *p = f->tmpl.points_mm[r][l][i];
                double angle = 2.0 * M_PI * i / POINTS;
                double x = (double)p[0] - centre.x, y = (double)p[1] - centre.y;
                double reach = hypot(x, y);
                assert_true(fabs(x + reach * sin(angle)) < 1e-3);
                assert_true(fabs(y - reach * cos(angle)) < 1e-3);
                /* Seen from the front, relief makes distances shorter; it cannot make them much
                 * longer. */
                assert_true(reach > 0.3 * radius_mm[r] && reach < 1.5 * radius_mm[r]);
            }
        }
    }
}

static const enum iso_landmark mirrored[ISO_LANDMARKS] = {
    [ISO_LM_NASION] = ISO_LM_NASION,       [ISO_LM_NOSE_TIP] = ISO_LM_NOSE_TIP,
    [ISO_LM_SUBNASALE] = ISO_LM_SUBNASALE, [ISO_LM_ALA_R] = ISO_LM_ALA_L,
    [ISO_LM_ALA_L] = ISO_LM_ALA_R,         [ISO_LM_EYE_IN_R] = ISO_LM_EYE_IN_L,
    [ISO_LM_EYE_IN_L] = ISO_LM_EYE_IN_R,   [ISO_LM_EYE_OUT_R] = ISO_LM_EYE_OUT_L,
    [ISO_LM_EYE_OUT_L] = ISO_LM_EYE_OUT_R, [ISO_LM_LIP_UPPER] = ISO_LM_LIP_UPPER,
    [ISO_LM_MOUTH_R] = ISO_LM_MOUTH_L,     [ISO_LM_MOUTH_L] = ISO_LM_MOUTH_R,
};

/* The mean face is symmetric, but its mesh and the grid's diagonals are not quite. A place beside
 * the nose may move along the steep side. */
static void left_and_right_are_mirror_images(void **state)
{
    struct fixture *f = *state;
    assert_int_equal(iso_face_isotherms(f->tracer, &f->face, &f->tmpl), 0);
    for (int r = 0; r < RADII; r++) {
        for (int l = 0; l < ISO_LANDMARKS; l++) {
            double squares = 0.0;
            for (int i = 0; i < POINTS; i++) {
                const float *a = f->tmpl.points_mm[r][l][i];
                const float *b = f->tmpl.points_mm[r][mirrored[l]][(POINTS - i) % POINTS];
                struct iso_vec3 off = {(double)(a[0] + b[0]), (double)(a[1] - b[1]),
                                       (double)(a[2] - b[2])};
                squares += iso_dot(off, off);
            }
            assert_true(sqrt(squares / POINTS) < 1.0);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(on_a_plane_isotherms_are_circles, set_up_plane, tear_down),
        cmocka_unit_test_setup_teardown(points_have_weight_where_the_face_was_measured,
                                        set_up_plane, tear_down),
        cmocka_unit_test_setup_teardown(an_isotherm_beyond_the_border_has_no_weight, set_up_plane,
                                        tear_down),
        cmocka_unit_test_setup_teardown(unused_parts_of_a_template_are_zero, set_up_plane,
                                        tear_down),
        cmocka_unit_test_setup_teardown(a_small_tracer_is_refused, set_up_plane, tear_down),
        cmocka_unit_test_setup_teardown(on_the_mean_face_they_are_whole_and_about_their_landmark,
                                        set_up_face, tear_down),
        cmocka_unit_test_setup_teardown(left_and_right_are_mirror_images, set_up_face, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

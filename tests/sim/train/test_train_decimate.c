/* Decimation of shapes with a known result: a plate, a ball, a ridge. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "sim/train/head/decimate.h"

enum { COLUMNS = 23, ROWS = 15, VERTICES_MAX = 4096, TRIANGLES_MAX = 8192 };

static long allocations_left = -1; /* until one fails; negative: none fails */

void *__real_calloc(size_t n, size_t size);
void *__wrap_calloc(size_t n, size_t size);

void *__wrap_calloc(size_t n, size_t size)
{
    bool denied = allocations_left >= 0 && allocations_left-- == 0;
    return denied ? NULL : __real_calloc(n, size);
}

struct mesh {
    uint32_t n_vertices, n_triangles;
    struct iso_vec3 p[VERTICES_MAX];
    uint32_t triangles[TRIANGLES_MAX][3];
};

static void add_triangle(struct mesh *m, uint32_t a, uint32_t b, uint32_t c)
{
    const uint32_t corners[3] = {a, b, c};
    memcpy(m->triangles[m->n_triangles++], corners, sizeof corners);
}

/* COLUMNS x ROWS vertices, 2 mm apart in x and 3 mm in y, all in z = 0, facing +z. */
static struct mesh *plate(void)
{
    struct mesh *m = calloc(1, sizeof *m);
    assert_non_null(m);
    for (uint32_t i = 0; i < COLUMNS * ROWS; i++) {
        uint32_t column = i % COLUMNS, row = i / COLUMNS;
        m->p[m->n_vertices++] = iso_vec3(2.0 * column, 3.0 * row, 0.0);
    }
    for (uint32_t row = 0; row + 1 < ROWS; row++) {
        for (uint32_t column = 0; column + 1 < COLUMNS; column++) {
            uint32_t v = row * COLUMNS + column;
            add_triangle(m, v, v + 1, v + COLUMNS);
            add_triangle(m, v + 1, v + COLUMNS + 1, v + COLUMNS);
        }
    }
    return m;
}

static uint32_t midpoint(struct mesh *m, uint32_t a, uint32_t b)
{
    struct iso_vec3 p = iso_unit(iso_add(m->p[a], m->p[b]));
    for (uint32_t i = 0; i < m->n_vertices; i++) {
        if (iso_norm(iso_sub(m->p[i], p)) < 1e-9) {
            return i;
        }
    }
    m->p[m->n_vertices] = p;
    return m->n_vertices++;
}

/* An octahedron, each face split in four `times` times, on the unit sphere. */
static struct mesh *ball(int times)
{
    static const uint32_t faces[8][3] = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                         {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    static const struct iso_vec3 corners[6] = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                               {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};
    struct mesh *m = calloc(1, sizeof *m);
    assert_non_null(m);
    memcpy(m->p, corners, sizeof corners);
    memcpy(m->triangles, faces, sizeof faces);
    m->n_vertices = 6;
    m->n_triangles = 8;
    for (; times > 0; times--) {
        for (uint32_t t = m->n_triangles; t-- > 0;) {
            uint32_t a = m->triangles[t][0], b = m->triangles[t][1], c = m->triangles[t][2];
            uint32_t ab = midpoint(m, a, b), bc = midpoint(m, b, c), ca = midpoint(m, c, a);
            const uint32_t middle[3] = {ab, bc, ca};
            memcpy(m->triangles[t], middle, sizeof middle);
            add_triangle(m, a, ab, ca);
            add_triangle(m, ab, b, bc);
            add_triangle(m, ca, bc, c);
        }
    }
    return m;
}

static struct iso_vec3 area_vector(const struct mesh *m, uint32_t t)
{
    const uint32_t *v = m->triangles[t];
    return iso_scale(0.5,
                     iso_cross(iso_sub(m->p[v[1]], m->p[v[0]]), iso_sub(m->p[v[2]], m->p[v[0]])));
}

static uint32_t mark_used(const struct mesh *m, uint8_t used[VERTICES_MAX])
{
    uint32_t n = 0;
    memset(used, 0, VERTICES_MAX);
    for (uint32_t i = 0; i < 3 * m->n_triangles; i++) {
        uint32_t v = m->triangles[i / 3][i % 3];
        n += !used[v];
        used[v] = 1;
    }
    return n;
}

static uint32_t used_vertices(const struct mesh *m)
{
    uint8_t used[VERTICES_MAX];
    return mark_used(m, used);
}

static void decimate(struct mesh *m, const struct sim_decimate_options *options)
{
    assert_int_equal(sim_decimate(m->p, m->n_vertices, options, m->triangles, &m->n_triangles), 0);
}

static void a_plate_stays_the_same_plate(void **state)
{
    (void)state;
    struct mesh *m = plate();
    struct sim_decimate_options options = {.n_target = 24};
    decimate(m, &options);
    assert_int_equal(used_vertices(m), 24);
    double area = 0.0;
    for (uint32_t t = 0; t < m->n_triangles; t++) {
        struct iso_vec3 a = area_vector(m, t);
        assert_true(a.z > 0.0); /* no triangle was turned over */
        area += a.z;
    }
    assert_true(fabs(area - 44.0 * 42.0) < 1e-9); /* the outline has not moved */
    free(m);
}

static void the_fan_stays_a_surface(void **state)
{
    (void)state;
    /* For a closed surface of genus 0, V - E + F = 2 with 3 F = 2 E, at every size. */
    for (uint32_t target = 700; target > 20; target /= 2) {
        struct mesh *m = ball(4);
        assert_int_equal(m->n_vertices, 1026);
        struct sim_decimate_options options = {.n_target = target};
        decimate(m, &options);
        assert_int_equal(used_vertices(m), target);
        assert_int_equal(m->n_triangles, 2 * target - 4);
        free(m);
    }
}

static void a_ball_stays_round(void **state)
{
    (void)state;
    struct mesh *m = ball(4);
    struct sim_decimate_options options = {.n_target = 200};
    decimate(m, &options);
    double volume = 0.0;
    for (uint32_t t = 0; t < m->n_triangles; t++) {
        const uint32_t *v = m->triangles[t];
        struct iso_vec3 a = area_vector(m, t);
        volume += iso_dot(a, m->p[v[0]]) / 3.0;
        /* The triangles face outward. They are no further inside than the cap of a triangle of
         * average size. */
        struct iso_vec3 centre = iso_scale(1.0 / 3.0,
                                           iso_add(m->p[v[0]], iso_add(m->p[v[1]], m->p[v[2]])));
        assert_true(iso_dot(a, centre) > 0.0);
        assert_true(iso_norm(centre) > 0.94);
    }
    assert_true(volume > 0.96 * 4.0 / 3.0 * M_PI && volume < 4.0 / 3.0 * M_PI);
    free(m);
}

static void vertices_to_keep_are_kept(void **state)
{
    (void)state;
    struct mesh *m = plate();
    uint8_t keep[COLUMNS * ROWS] = {0}, used[VERTICES_MAX];
    static const uint32_t wanted[] = {0, 7, 100, 101, 102, 333};
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        keep[wanted[i]] = 1;
    }
    struct sim_decimate_options options = {.n_target = 0, .keep = keep};
    decimate(m, &options); /* as far as possible */
    assert_true(mark_used(m, used) < 30);
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        assert_true(used[wanted[i]]);
    }
    free(m);
}

static void importance_draws_vertices(void **state)
{
    (void)state;
    struct mesh *m = ball(4);
    double importance[VERTICES_MAX];
    for (uint32_t i = 0; i < m->n_vertices; i++) {
        importance[i] = m->p[i].y > 0.0 ? 20.0 : 1.0;
    }
    struct sim_decimate_options options = {.n_target = 200, .importance = importance};
    decimate(m, &options);
    uint8_t used[VERTICES_MAX];
    uint32_t n_above = 0;
    assert_int_equal(mark_used(m, used), 200);
    for (uint32_t i = 0; i < m->n_vertices; i++) {
        n_above += used[i] && m->p[i].y > 0.0;
    }
    assert_true(n_above > 130);
    free(m);
}

/* The plate is folded along a column. The fold must remain while the flat parts are decimated. */
static void a_ridge_survives(void **state)
{
    (void)state;
    struct mesh *m = plate();
    const uint32_t fold = 9;
    for (uint32_t i = 0; i < m->n_vertices; i++) {
        m->p[i].z = -0.5 * fabs(m->p[i].x - 2.0 * fold);
    }
    struct sim_decimate_options options = {.n_target = 20};
    decimate(m, &options);
    for (uint32_t t = 0; t < m->n_triangles; t++) {
        /* No triangle crosses the fold: all its corners are on one side or on the fold. */
        double low = 0.0, high = 0.0;
        for (int k = 0; k < 3; k++) {
            double x = m->p[m->triangles[t][k]].x - 2.0 * fold;
            low = fmin(low, x);
            high = fmax(high, x);
        }
        assert_true(low == 0.0 || high == 0.0);
    }
    free(m);
}

static void the_same_mesh_gives_the_same_result(void **state)
{
    (void)state;
    struct mesh *a = ball(4), *b = ball(4);
    struct sim_decimate_options options = {.n_target = 123};
    decimate(a, &options);
    decimate(b, &options);
    assert_int_equal(a->n_triangles, b->n_triangles);
    assert_memory_equal(a->triangles, b->triangles, a->n_triangles * sizeof a->triangles[0]);
    free(a);
    free(b);
}

static void refuses_a_vertex_that_is_not_there(void **state)
{
    (void)state;
    struct mesh *m = plate();
    struct sim_decimate_options options = {.n_target = 10};
    m->triangles[5][1] = m->n_vertices;
    assert_int_equal(sim_decimate(m->p, m->n_vertices, &options, m->triangles, &m->n_triangles),
                     -EINVAL);
    free(m);
}

static void refuses_a_crowded_vertex(void **state)
{
    (void)state;
    struct mesh *m = calloc(1, sizeof *m);
    assert_non_null(m);
    m->n_vertices = 26;
    for (uint32_t i = 1; i < 26; i++) { /* 25 triangles about vertex 0 */
        m->p[i] = iso_vec3(cos(i * 2.0 * M_PI / 25.0), sin(i * 2.0 * M_PI / 25.0), 0.0);
        add_triangle(m, 0, i, i % 25 + 1);
    }
    struct sim_decimate_options options = {.n_target = 10};
    assert_int_equal(sim_decimate(m->p, m->n_vertices, &options, m->triangles, &m->n_triangles),
                     -EINVAL);
    free(m);
}

static void survives_any_failed_allocation(void **state)
{
    (void)state;
    struct mesh *m = plate(), *untouched = plate();
    struct sim_decimate_options options = {.n_target = 50};
    for (long n = 0; n < 3; n++) {
        allocations_left = n;
        int error = sim_decimate(m->p, m->n_vertices, &options, m->triangles, &m->n_triangles);
        allocations_left = -1;
        assert_int_equal(error, -ENOMEM);
        assert_memory_equal(m, untouched, sizeof *m);
    }
    free(m);
    free(untouched);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_plate_stays_the_same_plate),
        cmocka_unit_test(the_fan_stays_a_surface),
        cmocka_unit_test(a_ball_stays_round),
        cmocka_unit_test(vertices_to_keep_are_kept),
        cmocka_unit_test(importance_draws_vertices),
        cmocka_unit_test(a_ridge_survives),
        cmocka_unit_test(the_same_mesh_gives_the_same_result),
        cmocka_unit_test(refuses_a_vertex_that_is_not_there),
        cmocka_unit_test(refuses_a_crowded_vertex),
        cmocka_unit_test(survives_any_failed_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* Eigenvalues, rigid motion and principal components, compared with closed forms. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "sim/train/principal.h"

static long allocations_left = -1; /* until one fails; negative: none fails */

void *__real_calloc(size_t n, size_t size);
void *__wrap_calloc(size_t n, size_t size);

void *__wrap_calloc(size_t n, size_t size)
{
    bool denied = allocations_left >= 0 && allocations_left-- == 0;
    return denied ? NULL : __real_calloc(n, size);
}

static void assert_near(double value, double expected, double tolerance)
{
    if (!(fabs(value - expected) <= tolerance)) {
        fail_msg("%.9g is not %.9g +- %.3g", value, expected, tolerance);
    }
}

/* The matrix of second differences. Its eigenvalues are 4 sin^2(k pi / (2 (n + 1))). */
static void finds_the_modes_of_a_string(void **state)
{
    enum { N = 17 };
    double a[N * N] = {0.0}, value[N], vector[N * N];
    (void)state;
    for (int i = 0; i < N; i++) {
        a[i * N + i] = 2.0;
        if (i > 0) {
            a[i * N + i - 1] = a[(i - 1) * N + i] = -1.0;
        }
    }
    sim_symmetric_eigen(a, N, value, vector);
    for (int k = 0; k < N; k++) {
        double s = sin((N - k) * M_PI / (2.0 * (N + 1)));
        assert_near(value[k], 4.0 * s * s, 1e-12); /* sorted from large to small */
        double squared = 0.0, sign = vector[k * N] < 0.0 ? -1.0 : 1.0;
        for (int i = 0; i < N; i++) {
            squared += vector[k * N + i] * vector[k * N + i];
            double shape = sqrt(2.0 / (N + 1)) * sin((N - k) * (i + 1) * M_PI / (N + 1));
            assert_near(sign * vector[k * N + i], shape, 1e-9);
        }
        assert_near(squared, 1.0, 1e-12);
    }
}

static void leaves_a_diagonal_matrix_alone(void **state)
{
    double a[9] = {2.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 5.0}, value[3], vector[9];
    (void)state;
    sim_symmetric_eigen(a, 3, value, vector);
    assert_near(value[0], 5.0, 0.0);
    assert_near(value[1], 2.0, 0.0);
    assert_near(value[2], -1.0, 0.0);
    assert_near(fabs(vector[2]), 1.0, 0.0);
}

enum { POINTS = 7 };

static const struct iso_vec3 mean[POINTS] = {{10, 0, 3},  {-4, 8, 1}, {2, -9, 0}, {5, 5, 7},
                                             {-6, -3, 2}, {1, 4, -8}, {0, 2, 6}};
static const double weight[POINTS] = {1.0, 2.0, 0.5, 1.5, 3.0, 0.0, 0.0};

static void takes_out_rigid_motion(void **state)
{
    const struct iso_vec3 shift = {1.0, -2.0, 0.5}, turn = {0.01, 0.03, -0.02};
    float field[2][POINTS][3];
    (void)state;
    for (int i = 0; i < POINTS; i++) {
        struct iso_vec3 d = iso_add(shift, iso_cross(turn, mean[i]));
        const float rigid[3] = {(float)d.x, (float)d.y, (float)d.z};
        memcpy(field[0][i], rigid, sizeof rigid);
        memcpy(field[1][i], rigid, sizeof rigid);
    }
    field[1][6][1] += 4.0f; /* weight 0: it stays, and does not disturb the fit */
    assert_int_equal(sim_remove_rigid(mean, POINTS, weight, 2, &field[0][0][0]), 0);
    for (int i = 0; i < POINTS; i++) {
        for (int k = 0; k < 3; k++) {
            assert_near((double)field[0][i][k], 0.0, 1e-5);
            assert_near((double)field[1][i][k], i == 6 && k == 1 ? 4.0 : 0.0, 1e-5);
        }
    }
}

static void the_remainder_has_no_rigid_part(void **state)
{
    float field[POINTS][3];
    (void)state;
    for (int i = 0; i < 3 * POINTS; i++) {
        field[i / 3][i % 3] = sinf(1.0f + 2.7f * (float)i);
    }
    assert_int_equal(sim_remove_rigid(mean, POINTS, weight, 1, &field[0][0]), 0);
    struct iso_vec3 force = {0, 0, 0}, torque = {0, 0, 0};
    for (int i = 0; i < POINTS; i++) {
        struct iso_vec3 d = {(double)field[i][0], (double)field[i][1], (double)field[i][2]};
        force = iso_madd(force, weight[i], d);
        torque = iso_madd(torque, weight[i], iso_cross(mean[i], d));
    }
    assert_near(iso_norm(force), 0.0, 1e-5);
    assert_near(iso_norm(torque), 0.0, 1e-4);
}

static void points_in_line_fix_no_pose(void **state)
{
    const struct iso_vec3 line[POINTS] = {{0, 0, 0}, {1, 2, 3}, {2, 4, 6}, {3, 6, 9}};
    float field[POINTS][3] = {{0.0f}};
    (void)state;
    assert_int_equal(sim_remove_rigid(line, 4, weight, 1, &field[0][0]), -EDOM);
}

/* Fields that are orthogonal under the weights keep their shape. They are sorted by weighted
 * variance. */
static void orders_orthogonal_fields(void **state)
{
    float fields[3][2][3] = {{{1, 0, 0}, {0, 0, 0}},   /* variance 1 * 1 */
                             {{0, 0, 0}, {0, 2, 0}},   /* 3 * 4 */
                             {{0, 0, -2}, {0, 0, 0}}}; /* 1 * 4 */
    const double weights[2] = {1.0, 3.0};
    float out[2][2][3];
    double variance[3];
    (void)state;
    assert_int_equal(
        sim_principal(&fields[0][0][0], 3, 2, weights, NULL, 2, &out[0][0][0], variance), 0);
    assert_near(variance[0], 12.0, 1e-9);
    assert_near(variance[1], 4.0, 1e-9);
    assert_near(variance[2], 1.0, 1e-9);
    assert_near((double)out[0][1][1], 2.0, 1e-6);
    assert_near((double)out[1][0][2], 2.0, 1e-6); /* the sign makes the largest value positive */
    assert_near((double)out[0][0][0], 0.0, 1e-6);
    assert_near((double)out[1][0][0], 0.0, 1e-6);
}

/* If all components are kept, the sum of outer products equals fields * moment * fields'. */
static void keeps_the_covariance(void **state)
{
    enum { FIELDS = 4, VALUES = 3 * POINTS };
    const double ones[POINTS] = {1, 1, 1, 1, 1, 1, 1};
    const double root[FIELDS][2] = {{1.0, 0.2}, {-0.5, 0.7}, {0.3, 0.3}, {0.0, 0.0}};
    double moment[FIELDS * FIELDS], variance[FIELDS];
    float fields[FIELDS][VALUES], out[FIELDS][VALUES];
    (void)state;
    for (int i = 0; i < FIELDS * FIELDS; i++) { /* of rank 2 */
        const double *a = root[i / FIELDS], *b = root[i % FIELDS];
        moment[i] = a[0] * b[0] + a[1] * b[1];
    }
    for (int i = 0; i < FIELDS * VALUES; i++) {
        fields[i / VALUES][i % VALUES] = sinf(0.7f + 1.9f * (float)i);
    }
    assert_int_equal(
        sim_principal(&fields[0][0], FIELDS, POINTS, ones, moment, FIELDS, &out[0][0], variance),
        0);
    assert_true(variance[0] > variance[1] && variance[1] > 0.05);
    assert_near(variance[2], 0.0, 1e-6);
    for (int a = 0; a < VALUES; a++) {
        for (int b = 0; b < VALUES; b++) {
            double expected = 0.0, found = 0.0;
            for (int i = 0; i < FIELDS * FIELDS; i++) {
                expected += moment[i] * (double)(fields[i / FIELDS][a] * fields[i % FIELDS][b]);
            }
            for (int k = 0; k < FIELDS; k++) {
                found += (double)(out[k][a] * out[k][b]);
            }
            assert_near(found, expected, 1e-5);
        }
    }
}

static void refuses_too_many(void **state)
{
    float field[3] = {1, 2, 3}, out[6];
    double one = 1.0, variance[2];
    (void)state;
    assert_int_equal(sim_principal(field, 1, 1, &one, NULL, 2, out, variance), -EINVAL);
    assert_int_equal(sim_principal(field, SIM_FIELDS_MAX + 1, 1, &one, NULL, 1, out, variance),
                     -EINVAL);
}

static void survives_any_failed_allocation(void **state)
{
    float field[3] = {1, 2, 3}, out[3];
    double one = 1.0, variance[1];
    (void)state;
    for (long n = 0; n < 3; n++) {
        allocations_left = n;
        int error = sim_principal(field, 1, 1, &one, NULL, 1, out, variance);
        allocations_left = -1;
        assert_int_equal(error, -ENOMEM);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(finds_the_modes_of_a_string),
        cmocka_unit_test(leaves_a_diagonal_matrix_alone),
        cmocka_unit_test(takes_out_rigid_motion),
        cmocka_unit_test(the_remainder_has_no_rigid_part),
        cmocka_unit_test(points_in_line_fix_no_pose),
        cmocka_unit_test(orders_orthogonal_fields),
        cmocka_unit_test(keeps_the_covariance),
        cmocka_unit_test(refuses_too_many),
        cmocka_unit_test(survives_any_failed_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* Closed-form fits and ICP, compared with known transforms. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "core/registration/icp.h"
#include "core/registration/rigid.h"

/* The working memory of registrations. */
static struct iso_icp_workspace registration;

enum { N = 60 };

/* Points of an irregular cloud, different along each axis. */
static struct iso_vec3 cloud_point(int i)
{
    return iso_vec3(40.0 * sin(1.7 * i), 25.0 * cos(0.9 * i) + 0.1 * i, 12.0 * sin(0.37 * i * i));
}

static struct iso_rigid known_motion(void)
{
    return (struct iso_rigid){iso_mat3_rotation(iso_vec3(0.3, -0.8, 1.9)), {5.0, -70.0, 600.0}};
}

static double rigid_difference(const struct iso_rigid *a, const struct iso_rigid *b)
{
    double worst = iso_norm(iso_sub(a->translation_mm, b->translation_mm));
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            worst = fmax(worst, fabs(a->rotation.m[i][j] - b->rotation.m[i][j]));
        }
    }
    return worst;
}

static void rigid_fit_finds_a_known_motion(void **state)
{
    (void)state;
    struct iso_rigid truth = known_motion(), found;
    struct iso_vec3 source[N], target[N];
    double weight[N];
    for (int i = 0; i < N; i++) {
        source[i] = cloud_point(i);
        target[i] = iso_rigid_apply(&truth, source[i]);
        weight[i] = 1.0 + i % 3;
    }
    assert_int_equal(iso_rigid_fit(source, target, weight, N, &found), 0);
    assert_true(rigid_difference(&truth, &found) < 1e-9);
}

static void rigid_fit_ignores_points_of_weight_zero(void **state)
{
    (void)state;
    struct iso_rigid truth = known_motion(), found;
    struct iso_vec3 source[N], target[N];
    double weight[N];
    for (int i = 0; i < N; i++) {
        source[i] = cloud_point(i);
        target[i] = i < 10 ? iso_vec3(1e3, i, -1e3) : iso_rigid_apply(&truth, source[i]);
        weight[i] = i < 10 ? 0.0 : 1.0;
    }
    assert_int_equal(iso_rigid_fit(source, target, weight, N, &found), 0);
    assert_true(rigid_difference(&truth, &found) < 1e-9);
}

/* The result must be a proper rotation even where a reflection would fit better. */
static void rigid_fit_never_reflects(void **state)
{
    (void)state;
    struct iso_vec3 source[N], target[N];
    for (int i = 0; i < N; i++) {
        source[i] = cloud_point(i);
        target[i] = iso_vec3(-source[i].x, source[i].y, source[i].z);
    }
    struct iso_rigid found;
    assert_int_equal(iso_rigid_fit(source, target, NULL, N, &found), 0);
    struct iso_vec3 x = {found.rotation.m[0][0], found.rotation.m[1][0], found.rotation.m[2][0]};
    struct iso_vec3 y = {found.rotation.m[0][1], found.rotation.m[1][1], found.rotation.m[2][1]};
    struct iso_vec3 z = {found.rotation.m[0][2], found.rotation.m[1][2], found.rotation.m[2][2]};
    assert_true(fabs(iso_dot(iso_cross(x, y), z) - 1.0) < 1e-9);
}

static void rigid_fit_needs_three_points(void **state)
{
    (void)state;
    struct iso_vec3 source[2] = {{1, 2, 3}, {4, 5, 7}};
    struct iso_rigid found;
    assert_int_equal(iso_rigid_fit(source, source, NULL, 2, &found), -EINVAL);
}

static void affine_fit_finds_a_known_map(void **state)
{
    (void)state;
    const struct iso_affine truth = {
        {{1.1, 0.2, -0.3, 4}, {0.05, 0.8, 0.4, -5}, {0, -0.6, 1.3, 6}}};
    struct iso_affine found;
    struct iso_vec3 source[N], target[N];
    for (int i = 0; i < N; i++) {
        source[i] = cloud_point(i);
        target[i] = iso_affine_apply(&truth, source[i]);
    }
    assert_int_equal(iso_affine_fit(source, target, NULL, N, &found), 0);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 4; j++) {
            assert_true(fabs(truth.m[i][j] - found.m[i][j]) < 1e-9);
        }
    }
}

static void affine_fit_refuses_a_plane(void **state)
{
    (void)state;
    struct iso_vec3 source[N];
    for (int i = 0; i < N; i++) {
        source[i] = cloud_point(i);
        source[i].z = 2.0 * source[i].x - source[i].y;
    }
    struct iso_affine found;
    assert_int_equal(iso_affine_fit(source, source, NULL, N, &found), -EDOM);
    assert_int_equal(iso_affine_fit(source, source, NULL, 3, &found), -EINVAL);
}

/* Three bent rings of 20 points, moved by `motion`. */
static void make_rings(float point[N][3], float weight[N], const struct iso_rigid *motion)
{
    for (int i = 0; i < N; i++) {
        double angle = 2.0 * M_PI * (i % 20) / 20.0;
        int ring = i / 20;
        struct iso_vec3 p = {30.0 * ring + 18.0 * cos(angle), (15.0 + ring) * sin(angle),
                             5.0 * cos(2.0 * angle + ring)};
        p = iso_rigid_apply(motion, p);
        point[i][0] = (float)p.x;
        point[i][1] = (float)p.y;
        point[i][2] = (float)p.z;
        weight[i] = 1.0f;
    }
}

static void icp_recovers_a_motion_despite_outliers(void **state)
{
    (void)state;
    float source[N][3], target[N][3], source_weight[N], target_weight[N];
    struct iso_rigid none = iso_rigid_identity();
    struct iso_rigid truth = {iso_mat3_rotation(iso_vec3(0.02, -0.05, 0.03)), {2.0, -1.5, 3.0}};
    make_rings(source, source_weight, &none);
    make_rings(target, target_weight, &truth);
    for (int i = 0; i < N; i += 6) {
        target[i][2] += 15.0f; /* a sixth is wrong; the trim of 0.8 leaves it out */
    }
    target_weight[7] = 0.0f;
    struct iso_icp_points a = {3, 20, (const float(*)[3])source, source_weight};
    struct iso_icp_points b = {3, 20, (const float(*)[3])target, target_weight};
    const struct iso_icp_options options = {ISO_ICP_RIGID, ISO_ICP_ORDERED, 0.8, 50, 1e-6, NULL};
    struct iso_icp_result result;
    assert_int_equal(iso_icp(&registration, &a, &b, &options, &result), 0);
    assert_true(result.converged);
    assert_int_equal(result.pairs, N - 1);
    assert_true(result.distance_mm < 1e-4);
    for (int i = 0; i < 3; i++) {
        assert_true(fabs(result.target_from_source.m[i][i] - truth.rotation.m[i][i]) < 1e-5);
    }
}

static void icp_refuses_what_it_cannot_do(void **state)
{
    (void)state;
    float point[N][3], weight[N];
    struct iso_rigid none = iso_rigid_identity();
    make_rings(point, weight, &none);
    struct iso_icp_points a = {3, 20, (const float(*)[3])point, weight}, b = a;
    struct iso_icp_options options = {ISO_ICP_RIGID, ISO_ICP_NEAREST, 0.8, 5, 1e-6, NULL};
    struct iso_icp_result result;
    b.n_groups = 2;
    assert_int_equal(iso_icp(&registration, &a, &b, &options, &result), -EINVAL);
    b = a;
    options.trim = 0.0;
    assert_int_equal(iso_icp(&registration, &a, &b, &options, &result), -EINVAL);
    options.trim = 1.0;
    float empty[N] = {0};
    b.weight = empty;
    assert_int_equal(iso_icp(&registration, &a, &b, &options, &result), -ENODATA);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rigid_fit_finds_a_known_motion),
        cmocka_unit_test(rigid_fit_ignores_points_of_weight_zero),
        cmocka_unit_test(rigid_fit_never_reflects),
        cmocka_unit_test(rigid_fit_needs_three_points),
        cmocka_unit_test(affine_fit_finds_a_known_map),
        cmocka_unit_test(affine_fit_refuses_a_plane),
        cmocka_unit_test(icp_recovers_a_motion_despite_outliers),
        cmocka_unit_test(icp_refuses_what_it_cannot_do),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

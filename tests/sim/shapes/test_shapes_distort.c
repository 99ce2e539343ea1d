/* Distortions have their stated strength, and the filter removes noise. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "sim/shapes/make/distort.h"
#include "sim/shapes/make/smooth.h"
#include "tests/support/near.h"

enum { RINGS = 40, SECTORS = 60 };

/* An ellipsoid with half axes of 50, 30, 20 mm, whose centre is far from the origin. */
static struct iso_coloured_mesh ellipsoid(void)
{
    struct iso_mesh *mesh = NULL;
    assert_int_equal(iso_mesh_new(RINGS * SECTORS + 2, 2 * RINGS * SECTORS, &mesh), 0);
    for (int r = 0; r < RINGS; r++) {
        for (int s = 0; s < SECTORS; s++) {
            double a = M_PI * (r + 1) / (RINGS + 1), b = 2.0 * M_PI * (s + 0.5 * r) / SECTORS;
            mesh->vertices_mm[mesh->n_vertices++] = iso_vec3(100 + 50 * sin(a) * cos(b),
                                                             30 * sin(a) * sin(b), 20 * cos(a));
        }
    }
    int32_t top = mesh->n_vertices++, bottom = mesh->n_vertices++;
    mesh->vertices_mm[top] = iso_vec3(100, 0, 20);
    mesh->vertices_mm[bottom] = iso_vec3(100, 0, -20);
    for (int r = 0; r <= RINGS; r++) {
        for (int s = 0; s < SECTORS; s++) {
            int32_t a = (r - 1) * SECTORS + s, b = (r - 1) * SECTORS + (s + 1) % SECTORS;
            int32_t c = a + SECTORS, d = b + SECTORS;
            if (r > 0) {
                int32_t *t = mesh->triangles[mesh->n_triangles++];
                memcpy(t, (int32_t[3]){a, r < RINGS ? c : bottom, b}, 3 * sizeof *t);
            }
            if (r < RINGS) {
                int32_t *t = mesh->triangles[mesh->n_triangles++];
                memcpy(t, (int32_t[3]){r > 0 ? b : top, c, d}, 3 * sizeof *t);
            }
        }
    }
    return (struct iso_coloured_mesh){.mesh = mesh};
}

/* Returns the variance of the coordinates about their mean or, with `other`, their mean squared
 * difference from that mesh. */
static double variance(const struct iso_mesh *mesh, const struct iso_mesh *other)
{
    struct iso_vec3 mean = {0, 0, 0};
    double sum = 0.0;
    for (int32_t v = 0; !other && v < mesh->n_vertices; v++) {
        mean = iso_madd(mean, 1.0 / mesh->n_vertices, mesh->vertices_mm[v]);
    }
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        struct iso_vec3 d = iso_sub(mesh->vertices_mm[v], other ? other->vertices_mm[v] : mean);
        sum += iso_dot(d, d) / (3.0 * mesh->n_vertices);
    }
    return sum;
}

static struct iso_coloured_mesh distorted(enum sim_distortion_kind kind, int level)
{
    struct iso_coloured_mesh mesh = ellipsoid();
    struct sim_random random = sim_random_seeded(3, 4, 5);
    assert_int_equal(sim_distort((struct sim_distortion){kind, level}, &random, &mesh), 0);
    return mesh;
}

static void noise_has_its_ratio(void **state)
{
    static const double nsr[] = {1e-4, 1e-3, 1e-2};
    struct iso_coloured_mesh clean = ellipsoid();
    (void)state;
    for (int level = 1; level <= 3; level++) {
        double signal = variance(clean.mesh, NULL);
        struct iso_coloured_mesh white = distorted(SIM_DISTORTION_WHITE, level);
        struct iso_coloured_mesh shot = distorted(SIM_DISTORTION_SHOT, level);
        assert_near(variance(white.mesh, clean.mesh) / signal / nsr[level - 1], 1.0, 0.1);
        assert_near(variance(shot.mesh, clean.mesh) / signal / nsr[level - 1], 1.0, 0.5);
        int32_t hit = 0;
        for (int32_t v = 0; v < clean.mesh->n_vertices; v++) {
            hit += memcmp(&shot.mesh->vertices_mm[v], &clean.mesh->vertices_mm[v],
                          sizeof *clean.mesh->vertices_mm) != 0;
        }
        assert_true(hit > 10 && hit < 40); /* one in a hundred of 2402 */
        iso_coloured_mesh_done(&white);
        iso_coloured_mesh_done(&shot);
    }
    iso_coloured_mesh_done(&clean);
}

static void scale_and_cuts_are_as_large_as_they_say(void **state)
{
    static const double factor[] = {1.5, 2.0, 3.0}, share[] = {0.05, 0.10, 0.20};
    struct iso_coloured_mesh clean = ellipsoid();
    double area = iso_mesh_area(clean.mesh);
    (void)state;
    for (int level = 1; level <= 3; level++) {
        struct iso_coloured_mesh scaled = distorted(SIM_DISTORTION_SCALE, level);
        struct iso_coloured_mesh missing = distorted(SIM_DISTORTION_MISSING, level);
        double ratio = sqrt(iso_mesh_area(scaled.mesh) / area);
        assert_near(fabs(log(ratio)), log(factor[level - 1]), 1e-9);
        assert_near(1.0 - iso_mesh_area(missing.mesh) / area, share[level - 1], 0.005);
        iso_coloured_mesh_done(&scaled);
        iso_coloured_mesh_done(&missing);
    }
    iso_coloured_mesh_done(&clean);
}

static void deformations_are_not_isometric(void **state)
{
    struct iso_coloured_mesh clean = ellipsoid();
    double signal = variance(clean.mesh, NULL), last = 0.0;
    (void)state;
    for (int level = 1; level <= 3; level++) {
        struct iso_coloured_mesh bulging = distorted(SIM_DISTORTION_BULGE, level);
        double moved = variance(bulging.mesh, clean.mesh) * 3.0 / signal;
        double wanted = sim_distortion_strength(
            (struct sim_distortion){SIM_DISTORTION_BULGE, level});
        assert_near(sqrt(moved) / wanted, 1.0, 0.5); /* rms, of one random field */
        assert_true(moved > last);
        last = moved;
        iso_coloured_mesh_done(&bulging);
        struct iso_coloured_mesh stretched = distorted(SIM_DISTORTION_STRETCH, level);
        assert_true(variance(stretched.mesh, clean.mesh) > 1e-4 * signal);
        iso_coloured_mesh_done(&stretched);
    }
    iso_coloured_mesh_done(&clean);
}

static void the_filter_takes_noise_not_shape(void **state)
{
    struct iso_coloured_mesh clean = ellipsoid(), noisy = distorted(SIM_DISTORTION_WHITE, 2);
    double area = iso_mesh_area(clean.mesh), signal = variance(clean.mesh, NULL);
    double before = variance(noisy.mesh, clean.mesh);
    (void)state;
    assert_int_equal(sim_smooth(noisy.mesh, 10), 0);
    double after = variance(noisy.mesh, clean.mesh);
    print_message("noise %.5f of the signal, %.5f filtered\n", before / signal, after / signal);
    assert_true(after < 0.3 * before);
    assert_int_equal(sim_smooth(clean.mesh, 10), 0);
    assert_near(iso_mesh_area(clean.mesh) / area, 1.0, 0.01);
    iso_coloured_mesh_done(&clean);
    iso_coloured_mesh_done(&noisy);
}

static void reads_words(void **state)
{
    struct sim_distortion distortion = {SIM_DISTORTION_BULGE, 9};
    (void)state;
    assert_int_equal(sim_distortion_parse("missing:2", &distortion), 0);
    assert_int_equal(distortion.kind, SIM_DISTORTION_MISSING);
    assert_int_equal(distortion.level, 2);
    static const char *const wrong[] = {"missing",    "missing:", "missing:4", "missing:0",
                                        "missing:22", "miss:2",   ":2",        ""};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        assert_int_equal(sim_distortion_parse(wrong[i], &distortion), -EINVAL);
        assert_int_equal(distortion.level, 2);
    }
    struct iso_coloured_mesh mesh = ellipsoid();
    struct sim_random random = sim_random_seeded(1, 1, 1);
    assert_int_equal(sim_distort((struct sim_distortion){SIM_DISTORTION_SCALE, 0}, &random, &mesh),
                     -EINVAL);
    assert_int_equal(sim_distort((struct sim_distortion){SIM_DISTORTIONS, 1}, &random, &mesh),
                     -EINVAL);
    iso_coloured_mesh_done(&mesh);
    assert_null(sim_distortion_name(SIM_DISTORTIONS));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(noise_has_its_ratio),
        cmocka_unit_test(scale_and_cuts_are_as_large_as_they_say),
        cmocka_unit_test(deformations_are_not_isometric),
        cmocka_unit_test(the_filter_takes_noise_not_shape),
        cmocka_unit_test(reads_words),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

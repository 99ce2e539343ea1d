#include "tests/sim/lab/drawn_face.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "sim/lab/methods/anthroface.h"

static const double radius_mm = 86.0;

struct sim_scan *drawn_surface(drawn_height *z, const void *context)
{
    struct sim_scan *scan = NULL;
    assert_int_equal(sim_scan_new(DRAWN_SIDE, DRAWN_SPACING_MM, &scan), 0);
    for (int row = 0; row < DRAWN_SIDE; row++) {
        for (int column = 0; column < DRAWN_SIDE; column++) {
            struct iso_vec3 p = sim_scan_point(scan, column, row);
            if (hypot(p.x, p.y) <= radius_mm) {
                scan->z_mm[row * DRAWN_SIDE + column] = (float)z(context, p.x, p.y);
                scan->measured[row * DRAWN_SIDE + column] = 1;
            }
        }
    }
    return scan;
}

double drawn_relief(const void *context, double x, double y)
{
    const struct drawn_person *p = context;
    struct sim_random shape = sim_random_seeded(7, p->key, 0);
    double tilted = x * cos(p->yaw_rad), z = -(tilted * tilted + 0.6 * y * y) / 140.0;
    z += 22.0 * exp(-(x * x + 0.4 * (y - 6.0) * (y - 6.0)) / 200.0) - x * sin(p->yaw_rad);
    for (int k = 0; k < 10; k++) {
        double u = sim_random_between(&shape, -60.0, 60.0);
        double v = sim_random_between(&shape, -60.0, 60.0), h = 2.5 * sim_random_normal(&shape);
        z += h * exp(-((x - u) * (x - u) + (y - v) * (y - v)) / 400.0);
    }
    return z + (p->noise_mm > 0.0 ? p->noise_mm * sim_random_normal(p->random) : 0.0);
}

void drawn_skin(struct sim_scan *scan, uint64_t key, double tone)
{
    if (!scan->reflectance) {
        scan->reflectance = calloc(sim_scan_pixels(scan), sizeof *scan->reflectance);
        assert_non_null(scan->reflectance);
    }
    for (int i = 0; i < DRAWN_SIDE * DRAWN_SIDE; i++) {
        struct iso_vec3 p = sim_scan_point(scan, i % DRAWN_SIDE, i / DRAWN_SIDE);
        scan->reflectance[i] = (float)(tone * (1.0 + 0.6 * sin(0.1 * p.x + (double)key) *
                                                         sin(0.12 * p.y + 2.0 * (double)key)));
    }
}

static const double places[ISO_LANDMARKS][2] = {
    {0, 32},  {0, 0},    {0, -12}, {-15, -6}, {15, -6},   {-16, 30},
    {16, 30}, {-44, 32}, {44, 32}, {0, -22},  {-24, -30}, {24, -30},
};

struct sim_scan *drawn_face(uint64_t key, double noise_mm, uint64_t take)
{
    struct sim_random random = sim_random_seeded(8, key, take);
    struct sim_random own = sim_random_seeded(9, key, 0);
    struct drawn_person person = {key, noise_mm, 0.0, &random};
    struct sim_scan *scan = drawn_surface(drawn_relief, &person);
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        double x = places[l][0] + 2.5 * sim_random_normal(&own);
        double y = places[l][1] + 2.5 * sim_random_normal(&own), z = 0.0;
        x += noise_mm * sim_random_normal(&random);
        y += noise_mm * sim_random_normal(&random);
        assert_true(sim_scan_height(scan, x, y, &z, NULL));
        scan->source_mm[l] = scan->landmark_mm[l] = iso_vec3(x, y, z);
        int mark = sim_mark_find(iso_landmark_name((enum iso_landmark)l));
        assert_true(mark >= 0);
        scan->mark_known[mark] = true;
        scan->mark_mm[mark] = scan->landmark_mm[l];
    }
    drawn_skin(scan, key, 1.0);
    return scan;
}

void *described(const struct sim_method *method, const void *knowledge, const struct sim_scan *scan)
{
    void *description = NULL;
    assert_int_equal(method->describe(knowledge, scan, &description), 0);
    return description;
}

double method_distance(const struct sim_method *method, const void *knowledge, const void *probe,
                       const void *gallery)
{
    double d = NAN;
    assert_int_equal(method->distance(knowledge, probe, gallery, &d), 0);
    assert_true(d >= -1e-6);
    return d;
}

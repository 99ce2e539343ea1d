/* The grid heat solver. On a plane its columns are Gaussian. Earlier calls do not change them, and
 * the solver refuses problems that it cannot solve. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "core/heat/grid/chebyshev.h"
#include "core/heat/grid/heat_grid.h"
#include "tests/core/surfaces/grid_surface.h"

static struct iso_heat_grid *new_solver(const struct grid_surface *s, int n_sources)
{
    struct iso_heat_grid *solver = NULL;
    assert_int_equal(iso_heat_grid_new(s->grid, n_sources, &solver), 0);
    return solver;
}

static void the_expansion_is_the_exponential(void **state)
{
    (void)state;
    static double c[ISO_CHEBYSHEV_TERMS_MAX];
    const double z[] = {0.01, 0.5, 20.0, 112.5, 1750.0};
    for (size_t i = 0; i < sizeof z / sizeof z[0]; i++) {
        int terms = iso_chebyshev_exp(z[i], 1e-9, c);
        assert_true(terms > 1);
        for (int k = 0; k <= 100; k++) {
            double x = -1.0 + 0.02 * k, sum = 0.0;
            for (int j = terms - 1; j >= 0; j--) {
                sum += c[j] * cos(j * acos(x));
            }
            assert_true(fabs(sum - exp(-z[i] * (1.0 + x))) < 1.1e-9);
        }
        assert_true(iso_chebyshev_exp(z[i], 1e-4, c) < terms);
    }
    assert_int_equal(iso_chebyshev_exp(1e5, 1e-9, c), -ERANGE);
    assert_int_equal(iso_chebyshev_exp(0.0, 1e-9, c), -ERANGE);
    assert_int_equal(iso_chebyshev_exp(NAN, 1e-9, c), -ERANGE);
}

static void on_a_plane_heat_is_gaussian(void **state)
{
    (void)state;
    struct grid_surface s = grid_surface_hills(2.0, 0.0);
    struct iso_heat_grid *solver = new_solver(&s, 1);
    const double t_mm2 = 60.0, x_mm = 3.7, y_mm = -5.2;
    struct iso_grid_point source = grid_surface_point(&s, x_mm, y_mm);
    const struct iso_heat_grid_request request = {&source, 1, t_mm2, 20.0};
    assert_int_equal(iso_heat_grid(solver, s.grid, &request), 0);
    struct iso_grid_field column = iso_heat_grid_column(solver, 0);
    double total = 0.0;
    for (int row = 0; row < s.grid->height; row++) {
        for (int i = row * s.grid->stride; i < row * s.grid->stride + s.grid->width; i++) {
            total += (double)(column.value[i] * s.grid->share_mm2[i]);
            struct iso_vec3 p = iso_grid_vertex(s.grid, i);
            double r = hypot(p.x - x_mm, p.y - y_mm);
            if (r < 22.0) {
                double exact = exp(-r * r / (4.0 * t_mm2)) / (4.0 * M_PI * t_mm2);
                /* The limit is the accuracy of a mesh of 2 mm for a point source. */
                assert_true(fabs((double)column.value[i] / exact - 1.0) < 0.03);
            }
        }
    }
    assert_true(total < 1.0 && total > 0.97); /* the rest has left over the window's cold border */
    iso_heat_grid_free(solver);
    grid_surface_done(&s);
}

enum { SOURCES = 5 };

static void make_sources(const struct grid_surface *s, struct iso_grid_point source[SOURCES])
{
    const double place_mm[SOURCES][2] = {
        {3.3, -4.1}, {-61.0, 40.2}, {30.0, 21.7}, {-20.5, -47.9}, {66.9, 13.3}};
    for (int i = 0; i < SOURCES; i++) {
        source[i] = grid_surface_point(s, place_mm[i][0], place_mm[i][1]);
    }
}

/* Returns the largest difference of two columns, relative to the peak of the first. */
static double difference(const struct iso_grid *grid, struct iso_grid_field a,
                         struct iso_grid_field b)
{
    double most = 0.0, peak = 0.0;
    for (int i = 0; i < grid->height * grid->stride; i++) {
        peak = fmax(peak, (double)a.value[i]);
        most = fmax(most, fabs((double)a.value[i] - (double)b.value[i]));
    }
    assert_true(peak > 0.0);
    return most / peak;
}

static void a_column_does_not_depend_on_earlier_requests(void **state)
{
    (void)state;
    struct grid_surface s = grid_surface_hills(2.0, 1.0);
    struct iso_grid_point source[SOURCES];
    make_sources(&s, source);
    const double t_mm2[] = {40.0, 100.0};
    struct iso_heat_grid *fresh = new_solver(&s, SOURCES);
    struct iso_heat_grid *used = new_solver(&s, SOURCES);
    for (int i = 0; i < 2; i++) {
        const struct iso_heat_grid_request request = {source, SOURCES, t_mm2[i], 18.0};
        const struct iso_heat_grid_request before = {&source[1 + i], 2, 40.0, 50.0};
        assert_int_equal(iso_heat_grid(fresh, s.grid, &request), 0);
        assert_int_equal(iso_heat_grid(used, s.grid, &before), 0);
        assert_int_equal(iso_heat_grid(used, s.grid, &request), 0);
        for (int k = 0; k < SOURCES; k++) {
            struct iso_grid_field a = iso_heat_grid_column(fresh, k);
            struct iso_grid_field b = iso_heat_grid_column(used, k);
            assert_memory_equal(&a.window, &b.window, sizeof a.window);
            assert_true(difference(s.grid, a, b) == 0.0);
        }
    }
    assert_int_equal(iso_heat_grid_effort(fresh).steps, iso_heat_grid_effort(used).steps);
    assert_true(iso_heat_grid_effort(fresh).pixels > 1e5);
    iso_heat_grid_free(fresh);
    iso_heat_grid_free(used);
    grid_surface_done(&s);
}

static void requests_that_are_too_stiff_are_declined(void **state)
{
    (void)state;
    struct grid_surface s = grid_surface_hills(2.0, 1.0);
    struct iso_heat_grid *solver = new_solver(&s, 1);
    struct iso_grid_point source = grid_surface_point(&s, 3.3, -4.1);
    struct iso_heat_grid_request request = {&source, 1, 100.0, 18.0};
    assert_int_equal(iso_heat_grid(solver, s.grid, &request), 0);
    double stiffness = iso_heat_grid_effort(solver).stiffness_max;
    assert_true(stiffness > 200.0 && stiffness < 1000.0);
    request.t_mm2 *= 0.9 * ISO_HEAT_GRID_STIFFNESS_MAX / stiffness;
    assert_int_equal(iso_heat_grid(solver, s.grid, &request), 0);
    request.t_mm2 *= 1.2;
    assert_int_equal(iso_heat_grid(solver, s.grid, &request), -ERANGE);
    request.t_mm2 = 1e-5; /* a very short time: the expansion still exists */
    assert_int_equal(iso_heat_grid(solver, s.grid, &request), 0);
    iso_heat_grid_free(solver);
    grid_surface_done(&s);
}

static void bad_requests_are_refused(void **state)
{
    (void)state;
    struct grid_surface s = grid_surface_hills(2.0, 1.0);
    struct iso_heat_grid *solver = new_solver(&s, 1);
    struct iso_grid_point source = grid_surface_point(&s, 3.3, -4.1), off = source;
    struct iso_grid_point two[2] = {source, source};
    off.corner[1] = 35 * s.grid->stride + 58; /* in the hole */
    const struct iso_heat_grid_request bad[] = {
        {&source, 0, 100.0, 18.0},    {two, 2, 100.0, 18.0},    {&source, 1, 0.0, 18.0},
        {&source, 1, INFINITY, 18.0}, {&source, 1, 100.0, 0.0}, {&source, 1, 100.0, NAN},
        {&off, 1, 100.0, 18.0},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_int_equal(iso_heat_grid(solver, s.grid, &bad[i]), -EINVAL);
    }
    const struct iso_heat_grid_request good = {&source, 1, 100.0, 18.0};
    struct iso_grid *other = NULL;
    assert_int_equal(iso_grid_new(s.grid->width, s.grid->height + 1, &other), 0);
    assert_int_equal(iso_heat_grid(solver, other, &good), -EINVAL);
    iso_grid_free(other);
    const int n_sources[] = {0, -1, 65};
    struct iso_heat_grid *none = NULL;
    for (size_t i = 0; i < sizeof n_sources / sizeof n_sources[0]; i++) {
        assert_int_equal(iso_heat_grid_new(s.grid, n_sources[i], &none), -EINVAL);
    }
    assert_null(none);
    iso_heat_grid_free(NULL);
    iso_heat_grid_free(solver);
    grid_surface_done(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_expansion_is_the_exponential),
        cmocka_unit_test(on_a_plane_heat_is_gaussian),
        cmocka_unit_test(a_column_does_not_depend_on_earlier_requests),
        cmocka_unit_test(requests_that_are_too_stiff_are_declined),
        cmocka_unit_test(bad_requests_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

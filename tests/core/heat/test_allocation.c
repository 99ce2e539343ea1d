/* Every allocation of every constructor fails in turn. The result is -ENOMEM, nothing leaks (the
 * sanitised build checks this), and the output stays unchanged. The test compiles the sources under
 * test into itself, so that the linker's --wrap affects them. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "core/heat/grid/grid_stencil.h"
#include "core/heat/grid/heat_grid.h"
#include "core/isotherm/grid_isotherm.h"
#include "isotherm/heat_kernel.h"
#include "isotherm/triangulate.h"
#include "tests/core/surfaces/matrices.h"
#include "tests/core/surfaces/shapes.h"
#include "tests/support/memory/scarce_memory.h"

enum { ALLOCATIONS_MAX = 50 };

/* Calls `make` with the first, second, ... allocation failing until it succeeds. Returns how many
 * allocations there are. */
static int deny_in_turn(int (*make)(void **out), void (*release)(void *made))
{
    for (int n = 0; n < ALLOCATIONS_MAX; n++) {
        char untouched;
        void *made = &untouched;
        scarce_memory_left = n;
        int error = make(&made);
        bool reached = scarce_memory_left < 0;
        scarce_memory_left = -1;
        if (error == 0) {
            release(made);
            return n;
        }
        assert_true(reached);
        assert_int_equal(error, -ENOMEM);
        assert_ptr_equal(made, &untouched);
    }
    fail_msg("more than %d allocations", ALLOCATIONS_MAX);
    return 0;
}

#define MAKER(name, type, make_call)       \
    static int make_##name(void **out)     \
    {                                      \
        struct type *made = *out;          \
        int error = make_call;             \
        *out = made;                       \
        return error;                      \
    }                                      \
    static void release_##name(void *made) \
    {                                      \
        type##_free(made);                 \
    }

static const struct iso_camera camera = {.projection = ISO_ORTHOGRAPHIC, .pitch_mm = 1.0};
static const struct iso_triangulate_options largest = {.jump_mm = 5.0, .largest_only = true};
static const struct iso_heat_direct_options heat = {.n_capacity = 9, .nnz_capacity = 40};
static struct matrices sheet;
static struct iso_grid *grid;

MAKER(frame, iso_frame, iso_frame_new(&camera, 4, 3, true, &made))
MAKER(mesh, iso_mesh, iso_mesh_new(4, 3, &made))
MAKER(triangulator, iso_triangulator, iso_triangulator_new(12, &largest, &made))
MAKER(symmetric, iso_symmetric, iso_symmetric_new(4, 8, &made))
MAKER(heat_direct, iso_heat_direct, iso_heat_direct_new(&heat, &made))
MAKER(tracer, iso_tracer, iso_tracer_new(5, &made))
MAKER(grid, iso_grid, iso_grid_new(6, 4, &made))
MAKER(grid_stencil, iso_grid_stencil, iso_grid_stencil_new(grid, &made))
MAKER(heat_grid, iso_heat_grid, iso_heat_grid_new(grid, 2, &made))
MAKER(grid_tracer, iso_grid_tracer, iso_grid_tracer_new(grid, &made))
MAKER(eigenpairs, iso_eigenpairs, iso_eigenpairs_new(sheet.stiffness, sheet.mass, 3, 0.0, &made))

static void constructors_survive_any_failed_allocation(void **state)
{
    (void)state;
    struct iso_mesh *mesh = shape_sheet(5, 4, 1.0);
    sheet = matrices_of(mesh, ISO_MASS_LUMPED);
    assert_int_equal(deny_in_turn(make_frame, release_frame), 3);
    assert_int_equal(deny_in_turn(make_mesh, release_mesh), 3);
    assert_int_equal(deny_in_turn(make_symmetric, release_symmetric), 4);
    assert_true(deny_in_turn(make_triangulator, release_triangulator) >= 3);
    assert_true(deny_in_turn(make_heat_direct, release_heat_direct) >= 6);
    assert_true(deny_in_turn(make_tracer, release_tracer) >= 3);
    assert_true(deny_in_turn(make_eigenpairs, release_eigenpairs) >= 10);
    matrices_free(&sheet);
    iso_mesh_free(mesh);
}

static void constructors_on_grids_survive_any_failed_allocation(void **state)
{
    (void)state;
    assert_int_equal(iso_grid_new(6, 4, &grid), 0);
    assert_int_equal(deny_in_turn(make_grid, release_grid), 3);
    assert_int_equal(deny_in_turn(make_grid_stencil, release_grid_stencil), 2);
    assert_int_equal(deny_in_turn(make_heat_grid, release_heat_grid), 5);
    assert_true(deny_in_turn(make_grid_tracer, release_grid_tracer) >= 7);
    iso_grid_free(grid);
}

static void topology_survives_any_failed_allocation(void **state)
{
    (void)state;
    struct iso_mesh *mesh = shape_sheet(3, 3, 1.0);
    int32_t adjacent[8][3], piece[8];
    scarce_memory_left = 0;
    assert_int_equal(iso_mesh_adjacency(mesh, adjacent), -ENOMEM);
    scarce_memory_left = -1;
    assert_int_equal(iso_mesh_adjacency(mesh, adjacent), 0);
    int n = 0;
    for (int32_t pieces = -ENOMEM; pieces != 1; n++) {
        scarce_memory_left = n;
        pieces = iso_mesh_components(mesh, (const int32_t(*)[3])adjacent, piece);
        scarce_memory_left = -1;
        assert_true(pieces == 1 || pieces == -ENOMEM);
        assert_true(n < ALLOCATIONS_MAX);
    }
    assert_true(n > 1);
    iso_mesh_free(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(constructors_survive_any_failed_allocation),
        cmocka_unit_test(constructors_on_grids_survive_any_failed_allocation),
        cmocka_unit_test(topology_survives_any_failed_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* The vertices that coefficients make of modes: those of plain sums, and the same bits on each kind
 * of processor. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/landmark/shape_vertices.h"

enum { VERTICES = 23, STRIDES = 5, MODES_MAX = 72 };

static const int strides[STRIDES] = {4, 8, 12, 60, MODES_MAX};

/* How far mode k moves a vertex along an axis. */
static float mode_of(size_t place, int axis, int k)
{
    const uint32_t x = (uint32_t)(place * 977u + (size_t)axis * 131u + (size_t)k) * 2654435761u;
    return (float)(x >> 8) / (float)(1u << 23) - 1.0f;
}

static float *new_modes(int stride)
{
    const size_t floats = iso_shape_modes_floats(VERTICES, stride);
    float *modes = aligned_alloc(ISO_GRAM_LINE, floats * sizeof *modes);
    assert_non_null(modes);
    memset(modes, 0, floats * sizeof *modes);
    for (size_t place = 0; place < VERTICES; place++) {
        for (int k = 0; k < stride; k++) {
            float *at = &modes[iso_shape_modes_of(place, stride) + iso_shape_mode_at(k)];
            for (int axis = 0; axis < ISO_SHAPE_AXES; axis++) {
                at[axis * ISO_GRAM_LANES] = mode_of(place, axis, k);
            }
        }
    }
    return modes;
}

static void set_coefficients(int stride, float *coefficient)
{
    for (int k = 0; k < stride; k++) {
        coefficient[k] = mode_of(91, 2, 3 * k);
    }
}

/* Vertices of whole groups, as many as the functions may write. */
enum { ROOM = (VERTICES + ISO_SHAPE_GROUP - 1) / ISO_SHAPE_GROUP * ISO_SHAPE_GROUP };

static void sums_are_those_of_double_precision(void **state)
{
    (void)state;
    for (int s = 0; s < STRIDES; s++) {
        _Alignas(ISO_GRAM_LINE) float coefficient[MODES_MAX];
        float *modes = new_modes(strides[s]), moved_mm[ROOM][ISO_SHAPE_AXES];
        set_coefficients(strides[s], coefficient);
        iso_shape_vertices(modes, strides[s], coefficient, VERTICES, moved_mm);
        for (size_t place = 0; place < VERTICES; place++) {
            for (int axis = 0; axis < ISO_SHAPE_AXES; axis++) {
                double sum = 0.0;
                for (int k = 0; k < strides[s]; k++) {
                    sum += (double)coefficient[k] * (double)mode_of(place, axis, k);
                }
                assert_true(fabs((double)moved_mm[place][axis] - sum) <= 1e-5);
            }
        }
        free(modes);
    }
}

/* Each vertex is the same, however many are made at once and on whatever processor. */
static void variants_have_the_same_bits(void **state)
{
    (void)state;
    iso_shape_vertices_function *variant = NULL;
#if defined __x86_64__
    variant = __builtin_cpu_supports("avx2") ? iso__shape_vertices_avx2 : NULL;
#endif
    if (!variant) {
        skip();
    }
    for (int s = 0; s < STRIDES; s++) {
        _Alignas(ISO_GRAM_LINE) float coefficient[MODES_MAX];
        float *modes = new_modes(strides[s]);
        set_coefficients(strides[s], coefficient);
        for (int n = 1; n <= VERTICES; n++) {
            float first[ROOM][ISO_SHAPE_AXES], second[ROOM][ISO_SHAPE_AXES];
            iso__shape_vertices_baseline(modes, strides[s], coefficient, n, first);
            variant(modes, strides[s], coefficient, n, second);
            assert_memory_equal(first, second, (size_t)n * sizeof first[0]);
        }
        free(modes);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sums_are_those_of_double_precision),
        cmocka_unit_test(variants_have_the_same_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

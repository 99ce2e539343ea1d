/* The step in which the depths of a frame come, on slopes with known steps. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "core/frame/depth_step.h"

enum { W = 60, H = 40 };

/* A slope of 0.9 mm a pixel. Its depths are multiples of step_mm; 0: they are not rounded. */
static struct iso_frame slope(float depth[W * H], double step_mm)
{
    for (int i = 0; i < W * H; i++) {
        const double z = 700.0 + 0.9 * (i % W) + 0.37 * (i / W) * sin(i);
        depth[i] = (float)(step_mm > 0.0 ? step_mm * nearbyint(z / step_mm) : z);
    }
    return (struct iso_frame){.width_px = W, .height_px = H, .depth_mm = depth};
}

static void a_step_is_found_to_the_quarter_of_a_millimetre(void **state)
{
    (void)state;
    float depth[W * H];
    for (double step_mm = 1.0; step_mm <= 16.0; step_mm += 0.25) {
        const struct iso_frame frame = slope(depth, step_mm);
        assert_true(fabs(iso_depth_step(&frame) - step_mm) < 1e-9);
    }
}

static void depths_without_steps_have_a_small_step(void **state)
{
    (void)state;
    float depth[W * H];
    const struct iso_frame frame = slope(depth, 0.0);
    assert_true(iso_depth_step(&frame) <= 1.0);
}

static void edges_and_holes_do_not_count(void **state)
{
    (void)state;
    float depth[W * H];
    const struct iso_frame frame = slope(depth, 4.0);
    for (int row = 0; row < H; row++) {
        depth[row * W + 10] = 0.0f;
        for (int column = 30; column < W; column++) {
            depth[row * W + column] += 301.0f;
        }
    }
    assert_true(fabs(iso_depth_step(&frame) - 4.0) < 1e-9);
}

static void too_few_differences_tell_nothing(void **state)
{
    (void)state;
    float depth[W * H];
    for (int i = 0; i < W * H; i++) {
        depth[i] = 700.0f;
    }
    const struct iso_frame flat = {.width_px = W, .height_px = H, .depth_mm = depth};
    assert_true(iso_depth_step(&flat) == 0.0);
    depth[5] = 708.0f;
    assert_true(iso_depth_step(&flat) == 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_step_is_found_to_the_quarter_of_a_millimetre),
        cmocka_unit_test(depths_without_steps_have_a_small_step),
        cmocka_unit_test(edges_and_holes_do_not_count),
        cmocka_unit_test(too_few_differences_tell_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

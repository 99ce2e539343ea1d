/* The size of a face whose forehead is covered by a fringe. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "core/presentation/presentation.h"
#include "tests/core/surfaces/rendered_head.h"
#include "tests/core/surfaces/shipped_model.h"

enum { BROW_IBUG = 19 };

struct rig {
    struct iso_head_model *model;
    struct iso_frame *frame;
    struct iso_sizer *sizer;
    struct iso_rigid pose;
};

static int set_up(void **state)
{
    static struct rig rig;
    rig = (struct rig){.pose = rendered_head_pose(4.0, -3.0, iso_vec3(10, -10, 560))};
    rig.model = shipped_head_model();
    rig.frame = rendered_head_frame();
    assert_int_equal(iso_sizer_new(rig.model, &rig.sizer), 0);
    *state = &rig;
    return 0;
}

static int tear_down(void **state)
{
    struct rig *rig = *state;
    iso_sizer_free(rig->sizer);
    iso_frame_free(rig->frame);
    iso_head_model_free(rig->model);
    return 0;
}

/* Draws the mean head in a size, then moves what is between two heights of the face frame towards
 * the camera by `thick_mm`. */
static struct iso_size measure_with(struct rig *rig, double size, double from_mm, double to_mm,
                                    float thick_mm)
{
    const struct iso_rigid face_from_camera = iso_rigid_inverse(&rig->pose);
    rendered_head_clear(rig->frame);
    rendered_head_draw(rig->frame, rig->model, NULL, size, &rig->pose);
    for (int row = 0; row < rig->frame->height_px; row++) {
        for (int column = 0; column < rig->frame->width_px; column++) {
            float *depth = &rig->frame->depth_mm[row * rig->frame->width_px + column];
            if (!(*depth > 0.0f)) {
                continue;
            }
            const struct iso_vec3 at = iso_rigid_apply(&face_from_camera,
                                                       iso_frame_point_at(rig->frame, column, row));
            *depth -= at.y > from_mm && at.y < to_mm ? thick_mm : 0.0f;
        }
    }
    struct iso_size found = {0};
    assert_int_equal(iso_size_measure(rig->sizer, rig->frame, &rig->pose, &found), 0);
    print_message("size %.2f, %.0f mm of hair above %.0f mm: scale %.3f, cost %.2f mm2\n", size,
                  (double)thick_mm, from_mm, found.scale, found.cost_mm2);
    return found;
}

static double brow_mm(const struct rig *rig)
{
    return iso_head_point_on(rig->model, rig->model->mean_mm, rig->model->landmarks[BROW_IBUG]).y;
}

/* A fringe over the whole forehead changes neither the scale nor the cost by much, however thick it
 * is. The bounds are those of presentation.h with room for noise. */
static void a_head_with_a_fringe_keeps_its_size(void **state)
{
    struct rig *rig = *state;
    const struct iso_presentation_options o = iso_presentation_options_default();
    const struct iso_size bare = measure_with(rig, 1.0, 0.0, 0.0, 0.0f);
    for (float thick_mm = 6.0f; thick_mm <= 18.0f; thick_mm += 4.0f) {
        const struct iso_size haired = measure_with(rig, 1.0, brow_mm(rig) + 4.0, 200.0, thick_mm);
        assert_true(fabs(log(haired.scale / bare.scale)) < 0.02);
        assert_true(haired.cost_mm2 < bare.cost_mm2 + 0.5);
        assert_true(haired.cost_mm2 < o.no_size_cost_mm2 / 3.0);
    }
}

/* A mask of a wrong size is noticed although it has a fringe. */
static void a_mask_with_a_fringe_keeps_its_size(void **state)
{
    struct rig *rig = *state;
    const double sizes[] = {0.7, 0.8, 1.25, 1.45};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        const struct iso_size found = measure_with(rig, sizes[i], sizes[i] * brow_mm(rig) + 4.0,
                                                   200.0, 8.0f);
        assert_true(fabs(log(found.scale / sizes[i])) < 0.04);
    }
}

/* A surface in front of the cheeks is not taken for hair, so it raises the cost. */
static void only_the_forehead_may_have_hair(void **state)
{
    struct rig *rig = *state;
    const struct iso_size bare = measure_with(rig, 1.0, 0.0, 0.0, 0.0f);
    const struct iso_size ridged = measure_with(rig, 1.0, 10.0, 20.0, 8.0f);
    assert_true(ridged.cost_mm2 > bare.cost_mm2 + 1.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_head_with_a_fringe_keeps_its_size),
        cmocka_unit_test(a_mask_with_a_fringe_keeps_its_size),
        cmocka_unit_test(only_the_forehead_may_have_hair),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}

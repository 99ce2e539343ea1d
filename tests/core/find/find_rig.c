#include "tests/core/find/find_rig.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "core/frame/shrink.h"
#include "tests/core/surfaces/rendered_head.h"
#include "tests/core/surfaces/shipped_model.h"

enum { COARSE_PX_MAX = 640 * 480 };

const struct iso_candidate_options find_rig_range = {.near_mm = 200.0, .far_mm = 2000.0};
static const struct iso_shape_fit_options rough_fit = {
    .rigid_iterations = 1,
    .jaws = 1,
    .iterations = 4,
    .cutoff_first_mm = 12.0,
    .cutoff_last_mm = 4.0,
    .soft_weight = 0.3,
    .identity_stiffness_mm2 = 20.0,
    .expression_stiffness_mm2 = 5.0,
};

int find_rig_new(void **state)
{
    struct find_rig *f = calloc(1, sizeof *f);
    assert_non_null(f);
    f->model = shipped_head_model();
    f->frame = rendered_head_frame();
    f->coarse.depth_mm = calloc(COARSE_PX_MAX, sizeof *f->coarse.depth_mm);
    assert_non_null(f->coarse.depth_mm);
    assert_int_equal(iso_candidate_finder_new(COARSE_PX_MAX, &f->finder), 0);
    assert_int_equal(iso_pose_vertices_new(f->model, 220, 1.0, &f->vertices), 0);
    f->search = (struct iso_pose_search){
        .vertices = f->vertices,
        .frame = &f->coarse,
        .cost_max_mm2 = 14.0,
        .coverage_min = 0.5,
    };
    assert_int_equal(iso_shape_fitter_new(f->model, &rough_fit, &f->search.fitter), 0);
    *state = f;
    return 0;
}

int find_rig_free(void **state)
{
    struct find_rig *f = *state;
    iso_shape_fitter_free(f->search.fitter);
    iso_pose_vertices_free(f->vertices);
    iso_candidate_finder_free(f->finder);
    free(f->coarse.depth_mm);
    iso_frame_free(f->frame);
    iso_head_model_free(f->model);
    free(f);
    return 0;
}

int find_rig_find(struct find_rig *rig, int factor, struct iso_pose_fit *fit)
{
    struct iso_window all = {0, 0, rig->frame->width_px, rig->frame->height_px};
    assert_int_equal(iso_frame_shrink(rig->frame, all, factor, COARSE_PX_MAX, &rig->coarse), 0);
    assert_int_equal(iso_candidates_find(rig->finder, &rig->coarse, &find_rig_range,
                                         rig->candidates, &rig->n_candidates, &rig->n_parts),
                     0);
    return iso_pose_search(&rig->search, rig->candidates, rig->n_candidates, fit, &rig->several);
}

#include "tests/core/extract/extract_rig.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "tests/core/surfaces/rendered_head.h"
#include "tests/core/surfaces/shipped_model.h"

int extract_rig_new(void **state)
{
    struct extract_rig *rig = calloc(1, sizeof *rig);
    assert_non_null(rig);
    rig->model = shipped_head_model();
    rig->options = iso_extract_options_default();
    rig->frame = rendered_head_frame();
    assert_int_equal(iso_extractor_new(rig->model, &rig->options, &rig->extractor), 0);
    *state = rig;
    return 0;
}

int extract_rig_free(void **state)
{
    struct extract_rig *rig = *state;
    iso_extractor_free(rig->extractor);
    iso_head_model_free(rig->model);
    iso_frame_free(rig->frame);
    free(rig);
    return 0;
}

void extract_rig_renew(struct extract_rig *rig)
{
    iso_extractor_free(rig->extractor);
    rig->extractor = NULL;
    assert_int_equal(iso_extractor_new(rig->model, &rig->options, &rig->extractor), 0);
}

void extract_rig_draw(struct extract_rig *rig, double yaw_deg, double pitch_deg,
                      struct iso_vec3 nose_mm)
{
    struct iso_rigid pose = rendered_head_pose(yaw_deg, pitch_deg, nose_mm);
    rendered_head_clear(rig->frame);
    rendered_head_draw(rig->frame, rig->model, NULL, 1.0, &pose);
}

enum iso_capture extract_rig_run(struct extract_rig *rig)
{
    assert_int_equal(iso_extractor_run(rig->extractor, rig->frame, &rig->out), 0);
    return rig->out.outcome;
}

enum iso_capture extract_rig_outcome(struct extract_rig *rig, double yaw_deg, double pitch_deg,
                                     struct iso_vec3 nose_mm)
{
    extract_rig_draw(rig, yaw_deg, pitch_deg, nose_mm);
    return extract_rig_run(rig);
}

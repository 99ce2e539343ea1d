/* An object that stands still before the camera, such as furniture, causes no report. */
#include "tests/firmware/rigs/cmocka_headers.h"
#include "tests/firmware/rigs/rig.h"

/* A chair is no face. It gets no hint, because it does not move. */
static void only_a_moving_object_gets_the_hint_not_a_face(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    rig_show_unusable(rig, ISO_CAPTURE_NOT_A_FACE, 60);
    rig_run(rig, 2100);
    assert_string_equal(rig_news(rig), "");
    assert_int_equal(iso_appliance_status(rig->appliance).view->capture, ISO_CAPTURE_NOBODY);
    rig->sensor.scene_moves = true;
    rig_show_unusable(rig, ISO_CAPTURE_NOT_A_FACE, 60);
    rig_run(rig, 2100);
    assert_string_equal(rig_news(rig), "hint not-a-face");
    assert_int_equal(iso_appliance_status(rig->appliance).view->capture, ISO_CAPTURE_NOT_A_FACE);
    rig->sensor.scene_moves = false;
    rig_show_unusable(rig, ISO_CAPTURE_NOT_A_FACE, 120);
    rig_run(rig, 4000);
    assert_int_equal(iso_appliance_status(rig->appliance).view->capture, ISO_CAPTURE_NOBODY);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(only_a_moving_object_gets_the_hint_not_a_face, rig_setup,
                                        rig_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* One enrolment with the frontal face alone. */
#include <errno.h>
#include <string.h>

#include "tests/firmware/recognise/enrolment_rig.h"

static void completes_with_frames_that_agree(void **state)
{
    (void)state;
    assert_true(frame(50));
    assert_true(frame(53));
    assert_int_equal(enrolment.stage, 2);
    assert_int_equal(enrolment.state, ISO_ENROLMENT_ACTIVE);
    assert_true(frame(47));
    assert_int_equal(enrolment.state, ISO_ENROLMENT_COMPLETED);
    assert_int_equal(puppet_face_of(&enrolment.fused[0]), 50);
    assert_int_equal(enrolment.fused[0].n_frames, 3);
    assert_int_equal(enrolment.fused[0].algorithm, PUPPET_ALGORITHM);
}

static void leaves_a_misfit_out(void **state)
{
    (void)state;
    assert_true(frame(50));
    assert_true(frame(56));
    assert_false(frame(62)); /* it agrees with the second face, but not with the first */
    assert_true(frame(52));
    assert_int_equal(enrolment.state, ISO_ENROLMENT_COMPLETED);
    assert_int_equal(enrolment.misfits, 1);
}

static void fails_when_nothing_agrees(void **state)
{
    (void)state;
    assert_true(frame(50));
    assert_false(frame(80));
    assert_false(frame(81));
    assert_false(frame(82));
    assert_int_equal(enrolment.state, ISO_ENROLMENT_FAILED);
}

static void finds_a_duplicate(void **state)
{
    const struct iso_template known = puppet_template(54, PUPPET_ALGORITHM);
    const struct iso_search_entry entries[] = {{.person = 9, .tmpl = &known}};
    (void)state;
    gallery.everybody = first_of(entries, 1);
    assert_true(frame(50));
    assert_true(frame(51));
    assert_true(frame(52));
    assert_int_equal(enrolment.state, ISO_ENROLMENT_DUPLICATE);
    assert_int_equal(enrolment.duplicate_of, 9);
}

static void a_duplicate_may_be_allowed(void **state)
{
    const struct iso_template known = puppet_template(54, PUPPET_ALGORITHM);
    const struct iso_search_entry entries[] = {{.person = 9, .tmpl = &known}};
    (void)state;
    gallery.everybody = first_of(entries, 1);
    enrolment.options.allow_duplicate = true;
    (void)frame(50);
    (void)frame(51);
    (void)frame(52);
    assert_int_equal(enrolment.state, ISO_ENROLMENT_COMPLETED);
}

static void a_less_similar_person_is_no_duplicate(void **state)
{
    const struct iso_template known = puppet_template(55, PUPPET_ALGORITHM);
    const struct iso_search_entry entries[] = {{.person = 9, .tmpl = &known}};
    (void)state;
    gallery.everybody = first_of(entries, 1);
    (void)frame(50);
    (void)frame(51);
    (void)frame(52);
    assert_int_equal(enrolment.state, ISO_ENROLMENT_COMPLETED);
}

/* An enrolled person gets another template. The person's own templates are no duplicates, but a hit
 * with a lower score may still be another person. */
static void adds_to_a_person(void **state)
{
    const struct iso_template known = puppet_template(51, PUPPET_ALGORITHM);
    const struct iso_template other = puppet_template(54, PUPPET_ALGORITHM);
    const struct iso_search_entry entries[] = {{.person = 3, .tmpl = &known},
                                               {.person = 9, .tmpl = &other}};
    (void)state;
    gallery = (struct iso_enrolment_gallery){first_of(entries, 1), first_of(entries, 1), 3};
    (void)frame(50);
    (void)frame(51);
    (void)frame(52);
    assert_int_equal(enrolment.state, ISO_ENROLMENT_COMPLETED);

    assert_int_equal(enrolment_rig_setup(NULL), 0);
    gallery = (struct iso_enrolment_gallery){first_of(entries, 2), first_of(entries, 1), 3};
    (void)frame(50);
    (void)frame(51);
    (void)frame(52);
    assert_int_equal(enrolment.state, ISO_ENROLMENT_DUPLICATE);
    assert_int_equal(enrolment.duplicate_of, 9);
}

static void does_not_add_somebody_else_to_a_person(void **state)
{
    const struct iso_template known = puppet_template(90, PUPPET_ALGORITHM);
    const struct iso_search_entry entries[] = {{.person = 3, .tmpl = &known}};
    (void)state;
    gallery = (struct iso_enrolment_gallery){first_of(entries, 1), first_of(entries, 1), 3};
    (void)frame(50);
    (void)frame(51);
    (void)frame(52);
    assert_int_equal(enrolment.state, ISO_ENROLMENT_OTHER_FACE);
}

static void ends_in_time(void **state)
{
    (void)state;
    iso_enrolment_time(&enrolment, 65 * ISO_NS_PER_S - 1);
    assert_int_equal(enrolment.state, ISO_ENROLMENT_ACTIVE);
    iso_enrolment_time(&enrolment, 65 * ISO_NS_PER_S);
    assert_int_equal(enrolment.state, ISO_ENROLMENT_TIMED_OUT);
}

static void ends_without_a_sensor(void **state)
{
    (void)state;
    iso_enrolment_disconnect(&enrolment);
    assert_int_equal(enrolment.state, ISO_ENROLMENT_DISCONNECTED);
}

static void a_frame_without_enough_points_agrees_with_none(void **state)
{
    (void)state;
    assert_true(frame(50));
    puppet.search_error = -ENODATA;
    assert_false(frame(50));
    assert_int_equal(enrolment.state, ISO_ENROLMENT_ACTIVE);
}

static void returns_an_error_of_the_search(void **state)
{
    const struct iso_template tmpl = puppet_template(50, PUPPET_ALGORITHM);
    bool passed = true;
    (void)state;
    assert_true(frame(50));
    puppet.search_error = -ENOMEM;
    assert_int_equal(iso_enrolment_frame(&enrolment, &tmpl, now_ns, &pipeline, &gallery, &passed),
                     -ENOMEM);
    assert_true(passed); /* unchanged */
    assert_int_equal(enrolment.stage, 1);
}

static void wipes_its_templates(void **state)
{
    const struct iso_template nothing = {0};
    (void)state;
    (void)frame(50);
    (void)frame(51);
    (void)frame(52);
    iso_enrolment_wipe(&enrolment);
    assert_memory_equal(&enrolment.frames[1], &nothing, sizeof nothing);
    assert_memory_equal(&enrolment.fused[0], &nothing, sizeof nothing);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(completes_with_frames_that_agree, enrolment_rig_setup),
        cmocka_unit_test_setup(leaves_a_misfit_out, enrolment_rig_setup),
        cmocka_unit_test_setup(fails_when_nothing_agrees, enrolment_rig_setup),
        cmocka_unit_test_setup(finds_a_duplicate, enrolment_rig_setup),
        cmocka_unit_test_setup(a_duplicate_may_be_allowed, enrolment_rig_setup),
        cmocka_unit_test_setup(a_less_similar_person_is_no_duplicate, enrolment_rig_setup),
        cmocka_unit_test_setup(adds_to_a_person, enrolment_rig_setup),
        cmocka_unit_test_setup(does_not_add_somebody_else_to_a_person, enrolment_rig_setup),
        cmocka_unit_test_setup(ends_in_time, enrolment_rig_setup),
        cmocka_unit_test_setup(ends_without_a_sensor, enrolment_rig_setup),
        cmocka_unit_test_setup(a_frame_without_enough_points_agrees_with_none, enrolment_rig_setup),
        cmocka_unit_test_setup(returns_an_error_of_the_search, enrolment_rig_setup),
        cmocka_unit_test_setup(wipes_its_templates, enrolment_rig_setup),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* One enrolment in poses. */
#include <errno.h>
#include <string.h>

#include "tests/firmware/recognise/enrolment_rig.h"

/* Goes on with poses of two frames each, 10 s long. The frontal step is complete with face 50. */
static void begin_poses(void)
{
    struct iso_enrolment_options options = enrolment.options;
    options.poses = true;
    options.pose_stages = 2;
    options.pose_timeout_ns = 10 * ISO_NS_PER_S;
    iso_enrolment_begin(&enrolment, &options, now_ns);
    assert_int_equal(enrolment.stages, 11);
    assert_true(frame(50));
    assert_true(frame(50));
    assert_true(frame(50));
    assert_int_equal(enrolment.pose, ISO_ENROLL_LEFT);
}

static void keeps_a_template_of_each_pose(void **state)
{
    (void)state;
    begin_poses();
    for (int pose = ISO_ENROLL_LEFT; pose < ISO_ENROLL_POSES; pose++) {
        assert_true(frame(50 + pose));
        assert_int_equal(enrolment.state, ISO_ENROLMENT_ACTIVE);
        assert_true(frame(50 + pose));
    }
    assert_int_equal(enrolment.state, ISO_ENROLMENT_COMPLETED);
    for (int pose = 0; pose < ISO_ENROLL_POSES; pose++) {
        assert_true(enrolment.kept[pose]);
        assert_int_equal(puppet_face_of(&enrolment.fused[pose]), 50 + pose);
    }
}

/* A frame has to agree with the frontal template and with its own step, not with other poses. */
static void a_pose_has_to_show_the_same_face(void **state)
{
    (void)state;
    begin_poses();
    assert_false(frame(57));
    assert_true(frame(55));
    assert_false(frame(48)); /* agrees with the frontal face alone */
    assert_true(frame(50));
    assert_int_equal(enrolment.pose, ISO_ENROLL_RIGHT);
    assert_true(frame(45)); /* differs by 10 from the other pose */
    assert_true(frame(45));
    assert_int_equal(enrolment.misfits, 0);
    assert_true(enrolment.kept[ISO_ENROLL_LEFT] && enrolment.kept[ISO_ENROLL_RIGHT]);
}

/* Misfits end the pose, and the frontal face is kept. */
static void a_pose_of_another_face_is_left_out(void **state)
{
    const struct iso_template nothing = {0};
    (void)state;
    begin_poses();
    assert_true(frame(50));
    assert_false(frame(80));
    assert_false(frame(80));
    assert_int_equal(enrolment.pose, ISO_ENROLL_LEFT);
    assert_false(frame(80));
    assert_int_equal(enrolment.pose, ISO_ENROLL_RIGHT);
    assert_int_equal(enrolment.stage, 3);
    assert_int_equal(enrolment.stages, 9);
    assert_memory_equal(&enrolment.fused[ISO_ENROLL_LEFT], &nothing, sizeof nothing);
    for (int i = 0; i < 9; i++) {
        assert_false(frame(80));
    }
    assert_int_equal(enrolment.state, ISO_ENROLMENT_COMPLETED);
    assert_true(enrolment.kept[ISO_ENROLL_FRONTAL]);
    assert_false(enrolment.kept[ISO_ENROLL_UP]);
}

/* The frames of a look-alike agree, with a score of 4, and their template does not belong to the
 * person, because it would need a score of 5. */
static void a_pose_of_a_look_alike_is_left_out(void **state)
{
    const struct iso_template nothing = {0};
    (void)state;
    begin_poses();
    assert_true(frame(56));
    assert_false(frame(56)); /* no stage is passed, because the pose is left out */
    assert_int_equal(enrolment.pose, ISO_ENROLL_RIGHT);
    assert_false(enrolment.kept[ISO_ENROLL_LEFT]);
    assert_int_equal(enrolment.stage, 3);
    assert_memory_equal(&enrolment.fused[ISO_ENROLL_LEFT], &nothing, sizeof nothing);
    assert_true(frame(55));
    assert_true(frame(55));
    assert_true(enrolment.kept[ISO_ENROLL_RIGHT]);
}

/* Adds a frame of face 50 without measured points. It agrees with others, because the puppets
 * compare the radius alone, and cannot be fused. */
static int frame_without_points(bool *passed)
{
    struct iso_template tmpl = puppet_template(50, PUPPET_ALGORITHM);
    memset(tmpl.weight, 0, sizeof tmpl.weight);
    return iso_enrolment_frame(&enrolment, &tmpl, now_ns, &pipeline, &gallery, passed);
}

static void a_pose_whose_frames_cannot_be_fused_is_left_out(void **state)
{
    bool passed = true;
    (void)state;
    begin_poses();
    assert_true(frame(50));
    assert_int_equal(frame_without_points(&passed), 0);
    assert_false(passed);
    assert_int_equal(enrolment.state, ISO_ENROLMENT_ACTIVE);
    assert_int_equal(enrolment.pose, ISO_ENROLL_RIGHT);
    assert_false(enrolment.kept[ISO_ENROLL_LEFT]);
    assert_int_equal(enrolment.stage, 3);
    assert_int_equal(enrolment.stages, 9);
}

/* The frontal pose is necessary. */
static void frontal_frames_that_cannot_be_fused_end_the_enrolment(void **state)
{
    bool passed = false;
    (void)state;
    assert_true(frame(50));
    assert_true(frame(50));
    assert_int_equal(frame_without_points(&passed), -ENODATA);
    assert_false(passed);
    assert_int_equal(enrolment.state, ISO_ENROLMENT_FAILED);
}

static void leaves_a_pose_out_in_time(void **state)
{
    (void)state;
    now_ns = 7 * ISO_NS_PER_S;
    begin_poses();
    assert_int_equal(iso_enrolment_due_ns(&enrolment), 17 * ISO_NS_PER_S);
    assert_true(frame(50));
    iso_enrolment_time(&enrolment, 17 * ISO_NS_PER_S - 1);
    assert_int_equal(enrolment.pose, ISO_ENROLL_LEFT);
    iso_enrolment_time(&enrolment, 17 * ISO_NS_PER_S);
    assert_int_equal(enrolment.pose, ISO_ENROLL_RIGHT);
    assert_int_equal(enrolment.stage, 3);
    assert_int_equal(enrolment.stages, 9);
    assert_int_equal(iso_enrolment_due_ns(&enrolment), 27 * ISO_NS_PER_S);
    iso_enrolment_time(&enrolment, 67 * ISO_NS_PER_S);
    assert_int_equal(enrolment.state, ISO_ENROLMENT_COMPLETED);
    assert_true(enrolment.kept[ISO_ENROLL_FRONTAL]);
    assert_false(enrolment.kept[ISO_ENROLL_LEFT]);
}

/* An attack frame after the last good one has the result that it has in the frontal step: nothing
 * is kept when time is over. */
static void an_attack_frame_in_the_last_pose_keeps_nothing(void **state)
{
    (void)state;
    enrolment.options.attack_frames = 2;
    now_ns = 7 * ISO_NS_PER_S;
    begin_poses();
    iso_enrolment_time(&enrolment, 17 * ISO_NS_PER_S);
    iso_enrolment_attack(&enrolment, ISO_CAPTURE_BENT);
    iso_enrolment_time(&enrolment, 27 * ISO_NS_PER_S);
    iso_enrolment_time(&enrolment, 37 * ISO_NS_PER_S);
    assert_int_equal(enrolment.pose, ISO_ENROLL_UP);
    assert_int_equal(enrolment.state, ISO_ENROLMENT_ACTIVE);
    iso_enrolment_time(&enrolment, 67 * ISO_NS_PER_S);
    assert_int_equal(enrolment.state, ISO_ENROLMENT_TIMED_OUT);

    assert_int_equal(enrolment_rig_setup(NULL), 0);
    enrolment.options.attack_frames = 2;
    begin_poses();
    iso_enrolment_attack(&enrolment, ISO_CAPTURE_BENT);
    for (int i = 0; i < 12; i++) {
        assert_false(frame(80));
    }
    assert_int_equal(enrolment.state, ISO_ENROLMENT_FAILED);
}

/* Attack frames count together also if a pose was left out between them. A good frame clears them.
 */
static void attack_frames_count_over_poses(void **state)
{
    (void)state;
    enrolment.options.attack_frames = 2;
    now_ns = 7 * ISO_NS_PER_S;
    begin_poses();
    iso_enrolment_attack(&enrolment, ISO_CAPTURE_BENT);
    iso_enrolment_time(&enrolment, 17 * ISO_NS_PER_S);
    assert_int_equal(enrolment.pose, ISO_ENROLL_RIGHT);
    assert_true(frame(50));
    iso_enrolment_attack(&enrolment, ISO_CAPTURE_BENT);
    iso_enrolment_time(&enrolment, 27 * ISO_NS_PER_S);
    assert_int_equal(enrolment.state, ISO_ENROLMENT_ACTIVE);
    iso_enrolment_attack(&enrolment, ISO_CAPTURE_BENT);
    assert_int_equal(enrolment.state, ISO_ENROLMENT_ATTACK);
}

static void a_frontal_face_alone_is_judged_as_before(void **state)
{
    const struct iso_template known = puppet_template(90, PUPPET_ALGORITHM);
    const struct iso_search_entry entries[] = {{.person = 3, .tmpl = &known}};
    (void)state;
    enrolment.options.poses = true;
    enrolment.options.pose_stages = 2;
    gallery = (struct iso_enrolment_gallery){first_of(entries, 1), first_of(entries, 1), 3};
    (void)frame(50);
    (void)frame(51);
    (void)frame(52);
    assert_int_equal(enrolment.state, ISO_ENROLMENT_OTHER_FACE); /* before anybody turns */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(keeps_a_template_of_each_pose, enrolment_rig_setup),
        cmocka_unit_test_setup(a_pose_has_to_show_the_same_face, enrolment_rig_setup),
        cmocka_unit_test_setup(a_pose_of_another_face_is_left_out, enrolment_rig_setup),
        cmocka_unit_test_setup(a_pose_of_a_look_alike_is_left_out, enrolment_rig_setup),
        cmocka_unit_test_setup(a_pose_whose_frames_cannot_be_fused_is_left_out,
                               enrolment_rig_setup),
        cmocka_unit_test_setup(frontal_frames_that_cannot_be_fused_end_the_enrolment,
                               enrolment_rig_setup),
        cmocka_unit_test_setup(leaves_a_pose_out_in_time, enrolment_rig_setup),
        cmocka_unit_test_setup(an_attack_frame_in_the_last_pose_keeps_nothing, enrolment_rig_setup),
        cmocka_unit_test_setup(attack_frames_count_over_poses, enrolment_rig_setup),
        cmocka_unit_test_setup(a_frontal_face_alone_is_judged_as_before, enrolment_rig_setup),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

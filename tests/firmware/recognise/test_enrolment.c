/* One enrolment with the faces of the puppets. Two faces agree if they differ by at most 6, and
 * they are duplicates if they differ by at most 4. */
#include <errno.h>
#include <math.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/base/times.h"
#include "firmware/recognise/enrolment.h"
#include "tests/firmware/rigs/puppets.h"

static struct iso_enrolment enrolment;
static struct puppet_pipeline puppet;
static struct iso_pipeline pipeline;
static struct iso_enrolment_gallery gallery;
static int64_t now_ns;

static int setup(void **state)
{
    const struct iso_enrolment_options options = {
        .stages = 3,
        .agree_score = 4,
        .duplicate_score = 6,
        .timeout_ns = 60 * ISO_NS_PER_S,
    };
    (void)state;
    puppet = (struct puppet_pipeline){0};
    pipeline = puppet_pipeline(&puppet);
    gallery = (struct iso_enrolment_gallery){0};
    now_ns = 5 * ISO_NS_PER_S;
    iso_enrolment_begin(&enrolment, &options, now_ns);
    return 0;
}

/* Adds a frame of that face. Returns whether it passed. */
static bool frame(int face)
{
    const struct iso_template tmpl = puppet_template(face, PUPPET_ALGORITHM);
    bool passed = false;
    assert_int_equal(enrolment.state, ISO_ENROLMENT_ACTIVE);
    assert_int_equal(iso_enrolment_frame(&enrolment, &tmpl, now_ns, &pipeline, &gallery, &passed),
                     0);
    return passed;
}

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

static struct iso_candidate_list first_of(const struct iso_search_entry *entries, int n)
{
    return (struct iso_candidate_list){.entries = entries, .n_entries = n};
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

    assert_int_equal(setup(NULL), 0);
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

/* ---- poses ---- */

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
    assert_true(frame(56));
    assert_int_equal(enrolment.pose, ISO_ENROLL_RIGHT);
    assert_false(enrolment.kept[ISO_ENROLL_LEFT]);
    assert_int_equal(enrolment.stage, 3);
    assert_memory_equal(&enrolment.fused[ISO_ENROLL_LEFT], &nothing, sizeof nothing);
    assert_true(frame(55));
    assert_true(frame(55));
    assert_true(enrolment.kept[ISO_ENROLL_RIGHT]);
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
        cmocka_unit_test_setup(completes_with_frames_that_agree, setup),
        cmocka_unit_test_setup(leaves_a_misfit_out, setup),
        cmocka_unit_test_setup(fails_when_nothing_agrees, setup),
        cmocka_unit_test_setup(finds_a_duplicate, setup),
        cmocka_unit_test_setup(a_duplicate_may_be_allowed, setup),
        cmocka_unit_test_setup(a_less_similar_person_is_no_duplicate, setup),
        cmocka_unit_test_setup(adds_to_a_person, setup),
        cmocka_unit_test_setup(does_not_add_somebody_else_to_a_person, setup),
        cmocka_unit_test_setup(ends_in_time, setup),
        cmocka_unit_test_setup(ends_without_a_sensor, setup),
        cmocka_unit_test_setup(a_frame_without_enough_points_agrees_with_none, setup),
        cmocka_unit_test_setup(returns_an_error_of_the_search, setup),
        cmocka_unit_test_setup(keeps_a_template_of_each_pose, setup),
        cmocka_unit_test_setup(a_pose_has_to_show_the_same_face, setup),
        cmocka_unit_test_setup(a_pose_of_another_face_is_left_out, setup),
        cmocka_unit_test_setup(a_pose_of_a_look_alike_is_left_out, setup),
        cmocka_unit_test_setup(leaves_a_pose_out_in_time, setup),
        cmocka_unit_test_setup(a_frontal_face_alone_is_judged_as_before, setup),
        cmocka_unit_test_setup(wipes_its_templates, setup),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

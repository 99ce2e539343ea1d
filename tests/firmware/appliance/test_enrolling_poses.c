/* A client enrols a person in five poses: a visitor who turns as told, one who does not, another
 * person who steps in, and attacks. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/firmware/rigs/rig.h"
#include "tests/support/scratch.h"

static const struct attitude {
    double yaw_deg, pitch_deg;
} attitudes[] = {{0, 0}, {18, 0}, {-18, 0}, {0, -15}, {0, 15}};

static void turn(struct rig *rig, struct attitude attitude)
{
    rig->puppet.yaw_rad = attitude.yaw_deg * ISO_RAD_PER_DEG;
    rig->puppet.pitch_rad = attitude.pitch_deg * ISO_RAD_PER_DEG;
}

static void enroll(struct rig *rig, const char *person)
{
    const struct iso_enroll_request request = {.person = person, .poses = true};
    rig_start_enrolling(rig, &request);
}

/* Shows n frames of a face in an attitude. */
static void show(struct rig *rig, int face, struct attitude attitude, int n)
{
    turn(rig, attitude);
    rig_show(rig, face, n);
    rig_run(rig, 33 * n + 10);
}

/* Begins to enrol face 50, and completes the frontal step. */
static void enroll_frontal(struct rig *rig)
{
    rig_start_claimed(rig);
    enroll(rig, "anna");
    show(rig, 50, attitudes[0], 3);
    assert_string_equal(rig_news(rig),
                        "step 1/5 frontal begun; enroll stage-passed 1/11; enroll stage-passed "
                        "2/11; enroll stage-passed 3/11; step 1/5 frontal passed; step 2/5 left "
                        "begun");
}

static void a_visitor_who_turns_as_told_is_enrolled_in_all_poses(void **state)
{
    struct rig *rig = *state;
    enroll_frontal(rig);
    show(rig, 50, attitudes[1], 2);
    assert_string_equal(rig_news(rig), "enroll stage-passed 4/11; enroll stage-passed 5/11; "
                                       "step 2/5 left passed; step 3/5 right begun");
    for (int pose = 2; pose < 5; pose++) {
        show(rig, 50, attitudes[pose], 2);
    }
    assert_string_equal(rig_news(rig),
                        "enroll stage-passed 6/11; enroll stage-passed 7/11; step 3/5 right "
                        "passed; step 4/5 down begun; enroll stage-passed 8/11; enroll "
                        "stage-passed 9/11; step 4/5 down passed; step 5/5 up begun; enroll "
                        "stage-passed 10/11; enroll stage-passed 11/11; step 5/5 up passed; "
                        "enroll completed 11/11 done");
    assert_int_equal(iso_gallery_find(rig->gallery, "anna")->usable, 5);
    assert_non_null(strstr(rig_record(rig, "enroll"),
                           "\"reason\":\"completed\",\"frames\":11,\"note\":\"poses: frontal left "
                           "right down up\"}"));
}

static void the_hint_says_which_way_and_how_far(void **state)
{
    struct rig *rig = *state;
    rig->config.hint.interval_ms = 0;
    enroll_frontal(rig);
    show(rig, 50, attitudes[0], 3);
    assert_string_equal(rig_news(rig), "step 2/5 left turn by 18; enroll retry-turn-left 3/11");
    show(rig, 50, (struct attitude){27, 0}, 4);
    assert_non_null(strstr(rig_news(rig), "step 2/5 left turn by 9; enroll retry-turn-right 3/11"));
    show(rig, 50, attitudes[1], 2);
    (void)rig_news(rig);
    show(rig, 50, attitudes[1], 3);
    assert_string_equal(rig_news(rig), "step 3/5 right turn by 36; enroll retry-turn-right 5/11");
    show(rig, 50, attitudes[2], 2);
    (void)rig_news(rig);
    show(rig, 50, attitudes[0], 3);
    assert_string_equal(rig_news(rig), "step 4/5 down turn by 15; enroll retry-look-down 7/11");
    /* A fault of the face itself has no angle. */
    rig->puppet.expression = 2;
    show(rig, 50, attitudes[3], 6);
    const char *news = rig_news(rig);
    assert_non_null(strstr(news, "enroll retry-expression 7/11"));
    assert_null(strstr(news, "step "));
}

static void a_visitor_who_does_not_turn_is_enrolled_frontally(void **state)
{
    struct rig *rig = *state;
    enroll_frontal(rig);
    rig_run(rig, 9800);
    assert_string_equal(rig_news(rig), "");
    rig_run(rig, 200);
    assert_string_equal(rig_news(rig), "step 2/5 left left-out; step 3/5 right begun");
    rig_run(rig, 30000);
    assert_string_equal(rig_news(rig),
                        "step 3/5 right left-out; step 4/5 down begun; step 4/5 down left-out; "
                        "step 5/5 up begun; step 5/5 up left-out; enroll completed 3/3 done");
    assert_int_equal(iso_gallery_find(rig->gallery, "anna")->usable, 1);
    assert_non_null(strstr(rig_record(rig, "enroll"), "\"note\":\"poses: frontal\"}"));
}

/* A step that is left out half way does not count, and the enrolment goes on with the next one. */
static void a_pose_that_is_not_complete_is_left_out(void **state)
{
    struct rig *rig = *state;
    enroll_frontal(rig);
    show(rig, 50, attitudes[1], 1);
    rig_run(rig, 10000);
    assert_string_equal(rig_news(rig),
                        "enroll stage-passed 4/11; step 2/5 left left-out; step 3/5 right begun");
    show(rig, 50, attitudes[2], 2);
    show(rig, 50, attitudes[3], 2);
    show(rig, 50, attitudes[4], 2);
    assert_non_null(strstr(rig_news(rig), "enroll completed 9/9 done"));
    assert_int_equal(iso_gallery_find(rig->gallery, "anna")->usable, 4);
    assert_non_null(
        strstr(rig_record(rig, "enroll"), "\"note\":\"poses: frontal right down up\"}"));
}

static void the_whole_enrolment_takes_its_time_at_most(void **state)
{
    struct rig *rig = *state;
    rig->config.enroll.timeout_ms = 15000;
    enroll_frontal(rig);
    rig_run(rig, 14800);
    assert_string_equal(rig_news(rig), "step 2/5 left left-out; step 3/5 right begun");
    rig_run(rig, 200);
    assert_string_equal(rig_news(rig), "step 3/5 right left-out; step 4/5 down left-out; step 5/5 "
                                       "up left-out; enroll completed 3/3 done");
    assert_int_equal(iso_gallery_find(rig->gallery, "anna")->usable, 1);
}

static void the_frontal_pose_is_necessary(void **state)
{
    struct rig *rig = *state;
    rig_start_claimed(rig);
    enroll(rig, "anna");
    show(rig, 50, attitudes[1], 3);
    rig_run(rig, 60000);
    const char *news = rig_news(rig);
    assert_non_null(strstr(news, "step 1/5 frontal turn by 18; enroll retry-turn-right 0/11"));
    assert_non_null(strstr(news, "enroll timed-out 0/11 done"));
    assert_null(iso_gallery_find(rig->gallery, "anna"));
}

/* Nothing of the other person is kept. */
static void another_person_who_steps_in_is_left_out(void **state)
{
    struct rig *rig = *state;
    enroll_frontal(rig);
    show(rig, 50, attitudes[1], 2);
    (void)rig_news(rig);
    show(rig, 90, attitudes[2], 3);
    assert_string_equal(rig_news(rig), "enroll stage-misfit 5/11; enroll stage-misfit 5/11; enroll "
                                       "stage-misfit 5/9; step 3/5 right left-out; step 4/5 down "
                                       "begun");
    show(rig, 90, attitudes[3], 3);
    show(rig, 90, attitudes[4], 3);
    assert_non_null(strstr(rig_news(rig), "enroll completed 5/5 done"));
    assert_int_equal(iso_gallery_find(rig->gallery, "anna")->usable, 2);
    assert_non_null(strstr(rig_record(rig, "enroll"), "\"note\":\"poses: frontal left\"}"));
}

static void an_attack_in_a_pose_ends_the_enrolment(void **state)
{
    struct rig *rig = *state;
    enroll_frontal(rig);
    show(rig, 50, attitudes[1], 2);
    (void)rig_news(rig);
    rig_show_unusable(rig, ISO_CAPTURE_BENT, 3);
    rig_run(rig, 200);
    assert_string_equal(rig_news(rig), "enroll attack 5/11 done");
    assert_null(iso_gallery_find(rig->gallery, "anna"));
}

/* The turned head is similar to an enrolled person, the frontal one is less so. */
static void a_pose_may_be_the_duplicate(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "bob", 55);
    enroll_frontal(rig);
    show(rig, 52, attitudes[1], 2);
    assert_string_equal(rig_news(rig), "enroll stage-passed 4/11; enroll stage-passed 5/11; "
                                       "enroll duplicate 5/11 done bob");
    assert_null(iso_gallery_find(rig->gallery, "anna"));
}

static void all_templates_of_a_person_need_room(void **state)
{
    struct rig *rig = *state;
    struct iso_enroll_request request = {.person = "anna", .poses = true};
    struct iso_fault fault = {.text = ""};
    for (int i = 0; i < 12; i++) {
        rig_enrol(rig, "anna", 50);
    }
    rig_start_claimed(rig);
    assert_int_equal(iso_appliance_enroll(rig->appliance, &request, &fault), -EDQUOT);
    assert_string_equal(fault.text, "anna has 12 templates, and 5 more exceed the 16 that one "
                                    "person can have");
    request.poses = false;
    assert_int_equal(iso_appliance_enroll(rig->appliance, &request, &fault), 0);
}

/* Shows all poses but the last frames of the last one, and makes those ready. */
static void enroll_to_the_last_frames(struct rig *rig)
{
    enroll_frontal(rig);
    for (int pose = 1; pose < 4; pose++) {
        show(rig, 50, attitudes[pose], 2);
    }
    turn(rig, attitudes[4]);
    rig_show(rig, 50, 2);
}

static void a_full_disk_of_the_log_keeps_no_pose(void **state)
{
    struct rig *rig = *state;
    enroll_to_the_last_frames(rig);
    rig_fill_disk();
    rig_run(rig, 200);
    rig_free_disk();
    assert_non_null(strstr(rig_news(rig), "enroll not-stored 11/11 done"));
    assert_string_equal(rig_record(rig, "enroll"), ""); /* the gallery was not reached */
    assert_null(iso_gallery_find(rig->gallery, "anna"));
}

static off_t size_of(const char *path)
{
    struct stat file;
    assert_int_equal(stat(path, &file), 0);
    return file.st_size;
}

/* The log can be written and the gallery cannot: none of the templates is stored. */
static void a_full_disk_of_the_gallery_keeps_no_pose(void **state)
{
    enum { RECORDS = 4096 }; /* room for a few of them */
    struct rig *rig = *state;
    const char *log = scratch_path(rig->directory, "a.log");
    const char *gallery = scratch_path(rig->directory, "g.db");
    enroll_to_the_last_frames(rig);
    assert_true(size_of(log) + RECORDS < size_of(gallery));
    rig_fill_disk_from(size_of(log) + RECORDS);
    rig_run(rig, 200);
    rig_free_disk();
    assert_non_null(strstr(rig_news(rig), "enroll not-stored 11/11 done"));
    assert_non_null(strstr(rig_record(rig, "enroll"), "\"reason\":\"not-stored\""));
    assert_null(iso_gallery_find(rig->gallery, "anna"));
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, rig_setup, rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_visitor_who_turns_as_told_is_enrolled_in_all_poses),
        TEST(the_hint_says_which_way_and_how_far),
        TEST(a_visitor_who_does_not_turn_is_enrolled_frontally),
        TEST(a_pose_that_is_not_complete_is_left_out),
        TEST(the_whole_enrolment_takes_its_time_at_most),
        TEST(the_frontal_pose_is_necessary),
        TEST(another_person_who_steps_in_is_left_out),
        TEST(an_attack_in_a_pose_ends_the_enrolment),
        TEST(a_pose_may_be_the_duplicate),
        TEST(all_templates_of_a_person_need_room),
        TEST(a_full_disk_of_the_log_keeps_no_pose),
        TEST(a_full_disk_of_the_gallery_keeps_no_pose),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

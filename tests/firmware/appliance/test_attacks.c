/* Presentation attacks at the door. They are denied and counted, and each attempt has one record.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/door/door_null.h"
#include "tests/firmware/rigs/rig.h"
#include "tests/support/scratch.h"

/* ---- attacks ---- */

static void an_attack_is_denied_counted_and_on_record(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    rig_show_unusable(rig, ISO_CAPTURE_SCREEN, 1);
    rig_run(rig, 40);
    rig_show_unusable(rig, ISO_CAPTURE_FLAT, 5);
    rig_run(rig, 200);
    assert_string_equal(rig_news(rig), "visit deny attack 0");
    assert_non_null(
        strstr(rig_record(rig, "visit"),
               "\"verdict\":\"deny\",\"reason\":\"attack\",\"threshold\":6,"
               "\"frames\":0,\"attack_frames\":2,\"sensor\":\"started\",\"note\":\"flat\"}"));
    assert_string_equal(rig_record(rig, "attack"), ""); /* the attempt may still go on */
    rig_run(rig, 10000);
    assert_non_null(strstr(rig_record(rig, "attack"), "\"reason\":\"flat\",\"attack_frames\":6,"
                                                      "\"note\":\"within 0.2 s\"}"));
    const struct iso_appliance_counts counts = iso_appliance_status(rig->appliance).counts;
    assert_int_equal(counts.allowed, 0);
    assert_int_equal(counts.denied, 1);
    assert_int_equal(counts.attacks, 1);
    assert_int_equal(counts.attack_frames, 6);
    rig_show(rig, 50, 2);
    rig_run(rig, 100);
    assert_string_equal(rig_news(rig), "door unlocked grant; visit allow anna match 2");
    assert_int_equal(iso_appliance_status(rig->appliance).counts.allowed, 1);
}

static void a_single_cue_is_on_record_and_delays_nobody(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    rig_show_unusable(rig, ISO_CAPTURE_BENT, 1);
    rig_run(rig, 40);
    rig_show(rig, 50, 2);
    rig_run(rig, 100);
    assert_string_equal(rig_news(rig), "door unlocked grant; visit allow anna match 2");
    assert_non_null(strstr(rig_record(rig, "visit"), "\"frames\":2,\"attack_frames\":1,"
                                                     "\"sensor\":\"started\",\"note\":\"bent\"}"));
    iso_appliance_stop(rig->appliance); /* the attempt is not over, but is recorded */
    assert_non_null(strstr(rig_record(rig, "attack"), "\"reason\":\"bent\",\"attack_frames\":1,"));
}

/* Shows n frames of a face that is turned too far, and then two usable ones. */
static void show_turned(struct rig *rig, int n)
{
    for (int i = 1; i <= n; i++) {
        puppet_sensor_add(&rig->sensor, rig->now_ns + 33 * i * ISO_NS_PER_MS, 50,
                          ISO_CAPTURE_TURN_LEFT);
    }
    rig_run(rig, 33 * n + 20);
    rig_show(rig, 50, 2);
    rig_run(rig, 100);
}

/* A turned head with a cue of an attack may be that of a living person, who is told to turn. Its
 * frames count as frames of nobody. So an attacker who holds a mask at an angle cannot get in with
 * two good frames among many with a cue. */
static void a_cue_of_a_turned_head_counts_against_it(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    show_turned(rig, 4);
    assert_non_null(strstr(rig_news(rig), "door unlocked grant; visit allow anna match 2"));
    rig_run(rig, 20000);
    (void)rig_news(rig);
    rig->puppet.cue = ISO_CAPTURE_EYES_CUT;
    show_turned(rig, 4);
    assert_non_null(strstr(rig_news(rig), "visit deny unknown 6"));
    rig_run(rig, 20000);
    (void)rig_news(rig);
    show_turned(rig, 2);
    assert_non_null(strstr(rig_news(rig), "door unlocked grant; visit allow anna match 4"));
    assert_int_equal(iso_appliance_status(rig->appliance).counts.attack_frames, 0);
}

/* The frames of the puppet are equal bit by bit, as if an attacker played one frame again and
 * again. */
static void frames_that_repeat_are_an_attack(void **state)
{
    struct rig *rig = *state;
    rig->config.motion.frozen_frames = 3;
    rig->config.decision.agree = 6;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    for (int i = 0; i < 6; i++) {
        rig_show_at(rig, 50, 0, 33 * (i + 1));
    }
    rig_run(rig, 250);
    const char *news = rig_news(rig);
    assert_non_null(strstr(news, "visit deny attack"));
    assert_null(strstr(news, "allow"));
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, rig_setup, rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(an_attack_is_denied_counted_and_on_record),
        TEST(a_single_cue_is_on_record_and_delays_nobody),
        TEST(a_cue_of_a_turned_head_counts_against_it),
        TEST(frames_that_repeat_are_an_attack),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

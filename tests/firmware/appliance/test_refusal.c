/* Visits that are denied for any face: lock-out and lockdown of a whole appliance, and late or
 * repeated frames. */
#include <errno.h>
#include <string.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/firmware/rigs/rig.h"
#include "tests/support/scratch.h"

static char path[4096];

/* cmocka set-up: an appliance that keeps its lock-out in a file. It is not started. */
static int setup(void **state)
{
    const int error = rig_setup(state);
    struct rig *rig = *state;
    (void)snprintf(path, sizeof path, "%s", scratch_path(rig->directory, "lockout"));
    rig->config.lockout.failures = 2;
    rig->config.lockout.attacks = 2;
    rig->config.lockout.first_ms = 60000;
    rig->borrowed.lockout_path = path;
    iso_appliance_free(rig->appliance);
    return error ? error : iso_appliance_new(&rig->borrowed, &rig->appliance);
}

/* Ends the appliance and starts another one, as a service manager does. */
static void restart(struct rig *rig)
{
    iso_appliance_stop(rig->appliance);
    iso_appliance_free(rig->appliance);
    assert_int_equal(iso_appliance_new(&rig->borrowed, &rig->appliance), 0);
    rig_start(rig);
}

/* Makes one visit and waits until the door is locked again. Returns the reports. */
static const char *visit(struct rig *rig, int face)
{
    rig_show(rig, face, 6);
    rig_run(rig, 9000);
    return rig_news(rig);
}

static const char *attack(struct rig *rig)
{
    rig_show_unusable(rig, ISO_CAPTURE_FLAT, 2);
    rig_run(rig, 9000);
    return rig_news(rig);
}

static void strangers_lock_the_door_for_everybody(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    assert_string_equal(visit(rig, 80), "visit deny unknown 6");
    assert_string_equal(visit(rig, 80), "visit deny unknown 6");
    assert_non_null(strstr(rig_record(rig, "lockout"), "\"reason\":\"locked\","
                                                       "\"note\":\"60 s: 2 failures"));
    assert_in_range(iso_appliance_status(rig->appliance).lockout_ns, 1, 60 * ISO_NS_PER_S);
    assert_string_equal(visit(rig, 50), "visit deny locked-out 6");
    const char *record = rig_record(rig, "visit");
    assert_null(strstr(record, "anna")); /* the record does not say whether she was recognised */
    assert_null(strstr(record, "score"));
    rig_run(rig, 60000);
    assert_non_null(strstr(rig_record(rig, "lockout"), "\"reason\":\"over\""));
    assert_string_equal(visit(rig, 50),
                        "door unlocked grant; visit allow anna match 2; door locked time");
}

static void attacks_lock_the_door(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    assert_string_equal(attack(rig), "visit deny attack 0");
    assert_non_null(strstr(visit(rig, 50), "visit allow anna"));
    assert_string_equal(attack(rig), "visit deny attack 0");
    assert_string_equal(visit(rig, 50), "visit deny locked-out 6");
}

static void an_administrator_clears_a_lock_out(void **state)
{
    struct rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    (void)visit(rig, 80);
    (void)visit(rig, 80);
    assert_int_equal(iso_appliance_clear_lockout(rig->appliance, &fault), 0);
    assert_non_null(strstr(rig_record(rig, "lockout"), "\"reason\":\"cleared\""));
    assert_non_null(strstr(visit(rig, 50), "visit allow anna"));
}

static void a_call_that_cannot_be_logged_clears_nothing(void **state)
{
    struct rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    rig_start(rig);
    assert_int_equal(iso_appliance_lockdown(rig->appliance, true, &fault), 0);
    rig_fill_disk();
    assert_int_equal(iso_appliance_lockdown(rig->appliance, false, &fault), -ENOSPC);
    assert_int_equal(iso_appliance_clear_lockout(rig->appliance, &fault), -ENOSPC);
    rig_free_disk();
    assert_true(iso_appliance_status(rig->appliance).lockdown);
    assert_int_equal(iso_appliance_lockdown(rig->appliance, false, &fault), 0);
    rig_fill_disk();
    assert_int_equal(iso_appliance_lockdown(rig->appliance, true, &fault), -ENOSPC);
    rig_free_disk();
    assert_true(iso_appliance_status(rig->appliance).lockdown); /* a safe change takes effect */
}

static void a_lock_outlasts_a_restart(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    (void)visit(rig, 80);
    restart(rig);
    (void)visit(rig, 80); /* the first failure was stored */
    restart(rig);
    assert_string_equal(visit(rig, 50), "visit deny locked-out 6");
    rig_run(rig, 60000);
    assert_non_null(strstr(visit(rig, 50), "visit allow anna"));
}

static void lockdown_outlasts_a_restart_until_it_is_ended(void **state)
{
    struct rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    assert_int_equal(iso_appliance_lockdown(rig->appliance, true, &fault), 0);
    assert_string_equal(visit(rig, 50), "visit deny lockdown 6");
    restart(rig);
    assert_string_equal(visit(rig, 50), "visit deny lockdown 6");
    assert_int_equal(iso_appliance_lockdown(rig->appliance, false, &fault), 0);
    assert_non_null(strstr(visit(rig, 50), "visit allow anna"));
}

static void lockdown_in_the_middle_of_a_visit(void **state)
{
    struct rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    rig_show(rig, 50, 6);
    rig_run(rig, 50); /* one of the two frames */
    assert_int_equal(iso_appliance_lockdown(rig->appliance, true, &fault), 0);
    rig_run(rig, 1000);
    assert_false(rig_relay(rig));
    assert_int_equal(iso_appliance_lockdown(rig->appliance, false, &fault), 0);
    rig_run(rig, 9000);
    assert_null(strstr(rig_news(rig), "allow"));
}

static void a_damaged_lock_out_file_begins_a_lockdown(void **state)
{
    struct rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    rig_enrol(rig, "anna", 50);
    scratch_write_text(path, "isotherm-lockout 1 0 0 0 0 open 12345678\n");
    rig_start(rig);
    assert_non_null(strstr(rig_record(rig, "lockdown"), "\"reason\":\"damaged\""));
    assert_string_equal(visit(rig, 50), "visit deny lockdown 6");
    assert_int_equal(iso_appliance_lockdown(rig->appliance, false, &fault), 0);
    restart(rig);
    assert_non_null(strstr(visit(rig, 50), "visit allow anna"));
}

static void a_missing_lock_out_file_begins_a_lockdown(void **state)
{
    struct rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    assert_int_equal(unlink(path), 0);
    restart(rig);
    assert_non_null(strstr(rig_record(rig, "lockdown"), "\"reason\":\"stale\""));
    assert_string_equal(visit(rig, 50), "visit deny lockdown 6");
    assert_int_equal(iso_appliance_lockdown(rig->appliance, false, &fault), 0);
    restart(rig);
    assert_non_null(strstr(visit(rig, 50), "visit allow anna"));
}

static void a_client_is_refused_during_a_lock_out(void **state)
{
    struct rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    for (int i = 0; i < 2; i++) { /* failures of a client count */
        assert_int_equal(iso_appliance_claim(rig->appliance), 0);
        assert_int_equal(iso_appliance_verify(rig->appliance, "anna", &fault), 0);
        rig_show(rig, 80, 6);
        rig_run(rig, 300);
        assert_non_null(strstr(rig_news(rig), "verify no-match anna done"));
        iso_appliance_release(rig->appliance);
    }
    assert_int_equal(iso_appliance_claim(rig->appliance), 0);
    assert_int_equal(iso_appliance_verify(rig->appliance, "anna", &fault), -EPERM);
    assert_int_equal(iso_appliance_identify(rig->appliance, &fault), -EPERM);
    assert_non_null(strstr(fault.text, "locked-out"));
    const struct iso_enroll_request bert = {.person = "bert"};
    assert_int_equal(iso_appliance_enroll(rig->appliance, &bert, &fault), 0);
}

static void a_frame_that_comes_too_late_is_not_looked_at(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    for (int i = 0; i < 6; i++) { /* exposed now, available after six seconds */
        puppet_sensor_add(&rig->sensor, rig->now_ns + i * 33 * ISO_NS_PER_MS, 50, ISO_CAPTURE_OK);
    }
    rig->now_ns += 6 * ISO_NS_PER_S;
    rig_run(rig, 9000);
    assert_string_equal(rig_news(rig),
                        "door fault fault; door locked recovered"); /* and no visit */
    assert_non_null(strstr(visit(rig, 50), "visit allow anna"));
}

/* All frames of the puppet are equal. With the check for frozen frames, a repeated frame does not
 * count as a second one. */
static void a_frame_does_not_agree_with_itself(void **state)
{
    struct rig *rig = *state;
    rig->config.motion.frozen_frames = 64;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    rig_show(rig, 50, 6);
    rig_run(rig, 9000);
    assert_string_equal(rig_news(rig), "visit deny left 1");
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, setup, rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(strangers_lock_the_door_for_everybody),
        TEST(attacks_lock_the_door),
        TEST(an_administrator_clears_a_lock_out),
        TEST(a_call_that_cannot_be_logged_clears_nothing),
        TEST(a_lock_outlasts_a_restart),
        TEST(lockdown_outlasts_a_restart_until_it_is_ended),
        TEST(lockdown_in_the_middle_of_a_visit),
        TEST(a_damaged_lock_out_file_begins_a_lockdown),
        TEST(a_missing_lock_out_file_begins_a_lockdown),
        TEST(a_client_is_refused_during_a_lock_out),
        TEST(a_frame_that_comes_too_late_is_not_looked_at),
        TEST(a_frame_does_not_agree_with_itself),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

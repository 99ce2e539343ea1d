/* A setting that is changed holds at once in every part of the appliance that has a copy of it. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/appliance/administration/administration.h"
#include "tests/firmware/rigs/rig.h"
#include "tests/support/scratch.h"

static int set(struct rig *rig, const char *section, const char *key, const char *value,
               struct iso_fault *fault)
{
    char now[ISO_LIVE_VALUE_SIZE] = "";
    const struct iso_setting_request request = {section, key, value, "asked by user 7"};
    return iso_appliance_set_setting(rig->appliance, &request, now, fault);
}

static void need(struct rig *rig, const char *section, const char *key, const char *value)
{
    struct iso_fault fault = {.text = ""};
    if (set(rig, section, key, value, &fault)) {
        fail_msg("%s.%s: %s", section, key, fault.text);
    }
}

/* A face that differs by 3 from the enrolled one has the score 7. */
static void the_threshold_holds_at_once(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 10);
    rig_start(rig);
    need(rig, "decision", "threshold", "8");
    rig_show(rig, 13, 8);
    rig_run(rig, 12000);
    assert_non_null(strstr(rig_news(rig), "visit deny"));
    need(rig, "decision", "threshold", NULL); /* 6 */
    rig_show(rig, 13, 8);
    rig_run(rig, 12000);
    assert_non_null(strstr(rig_news(rig), "visit allow anna"));
}

static void the_times_of_the_door_hold_at_once(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 10);
    rig_start(rig);
    need(rig, "door", "unlock_ms", "9000");
    rig_show(rig, 10, 3);
    rig_run(rig, 5000);
    assert_true(rig_relay(rig));
    rig_run(rig, 5000);
    assert_false(rig_relay(rig));
}

/* Failures that were counted before count on. */
static void the_lockout_holds_at_once(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 10);
    rig_start(rig);
    for (int i = 0; i < 2; i++) {
        rig_show(rig, 50, 8);
        rig_run(rig, 12000);
    }
    assert_true(iso_appliance_status(rig->appliance).lockout_ns == 0);
    need(rig, "lockout", "failures", "3");
    need(rig, "lockout", "first_ms", "60000");
    rig_show(rig, 50, 8);
    rig_run(rig, 3000);
    assert_true(iso_appliance_status(rig->appliance).lockout_ns > 0);
    rig_run(rig, 40000);
    assert_true(iso_appliance_status(rig->appliance).lockout_ns > 0);
    rig_run(rig, 30000);
    assert_true(iso_appliance_status(rig->appliance).lockout_ns == 0);
}

static void hints_hold_at_once(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    need(rig, "hint", "hold_frames", "8");
    rig_show_unusable(rig, ISO_CAPTURE_TOO_FAR, 7);
    rig_run(rig, 1000);
    assert_null(strstr(rig_news(rig), "hint"));
    need(rig, "hint", "hold_frames", "2");
    rig_show_unusable(rig, ISO_CAPTURE_TOO_FAR, 3);
    rig_run(rig, 1000);
    assert_non_null(strstr(rig_news(rig), "hint too-far"));
}

static void an_enrolment_follows_the_settings_and_is_not_changed_by_them(void **state)
{
    struct rig *rig = *state;
    const struct iso_enroll_request request = {.person = "bea"};
    struct iso_fault fault = {.text = ""};
    rig_start(rig);
    need(rig, "enroll", "stages", "2");
    assert_int_equal(iso_appliance_claim(rig->appliance), 0);
    rig_start_enrolling(rig, &request);
    assert_int_equal(set(rig, "enroll", "stages", "5", &fault), -EBUSY);
    rig_show(rig, 20, 3);
    rig_run(rig, 1000);
    assert_non_null(strstr(rig_news(rig), "enroll completed 2/2 done"));
    assert_int_equal(rig->config.enroll.stages, 2);
}

static void a_change_is_on_record_before_it_is_made(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    need(rig, "update", "templates", "3");
    const char *line = rig_record(rig, "setting");
    assert_non_null(strstr(line, "\"reason\":\"set\""));
    assert_non_null(strstr(line, "\"before\":\"0\",\"after\":\"3\""));
    assert_non_null(strstr(line, "\"note\":\"update.templates, asked by user 7\""));
    assert_int_equal(rig->config.update.templates, 3);
}

/* Neither the setting nor the file changes if the record or the file cannot be written. */
static void a_full_disk_changes_nothing(void **state)
{
    struct rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    rig_start(rig);
    rig_fill_disk();
    assert_int_not_equal(set(rig, "decision", "margin", "4", &fault), 0);
    rig_free_disk();
    assert_true(fault.text[0] != '\0');
    assert_true(rig->config.decision.margin < 2);
    assert_false(scratch_exists(rig->settings_path));
}

static void the_file_holds_after_a_restart(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    need(rig, "decision", "margin", "2.5");
    need(rig, "lockout", "failures", "9");
    iso_appliance_stop(rig->appliance);
    iso_appliance_free(rig->appliance);
    rig->config = rig->settings.configured;
    iso_live_settings_init(&rig->settings, &rig->config, rig->settings_path, rig->borrowed.ring);
    assert_int_equal(iso_appliance_new(&rig->borrowed, &rig->appliance), 0);
    rig_start(rig);
    assert_int_equal(rig->config.lockout.failures, 9);
    assert_true(rig->config.decision.margin > 2);
    assert_non_null(strstr(rig_record(rig, "setting"), "\"note\":\"file 2, settings changed: 2\""));
}

static void a_damaged_file_is_reported_and_the_configuration_holds(void **state)
{
    struct rig *rig = *state;
    scratch_write_text(rig->settings_path,
                       "ISOSETS1 nonsense that is long enough to be sealed ....");
    rig_start(rig);
    assert_true(rig->config.decision.margin < 2);
    assert_non_null(strstr(rig->warned, "settings that were changed are lost"));
    assert_non_null(strstr(rig_record(rig, "setting"), "\"reason\":\"damaged\""));
}

static void an_appliance_without_such_settings_says_so(void **state)
{
    struct rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    iso_appliance_free(rig->appliance);
    rig->borrowed.settings = NULL;
    assert_int_equal(iso_appliance_new(&rig->borrowed, &rig->appliance), 0);
    rig_start(rig);
    assert_int_equal(set(rig, "decision", "margin", "4", &fault), -ENOSYS);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, rig_setup, rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(the_threshold_holds_at_once),
        TEST(the_times_of_the_door_hold_at_once),
        TEST(the_lockout_holds_at_once),
        TEST(hints_hold_at_once),
        TEST(an_enrolment_follows_the_settings_and_is_not_changed_by_them),
        TEST(a_change_is_on_record_before_it_is_made),
        TEST(a_full_disk_changes_nothing),
        TEST(the_file_holds_after_a_restart),
        TEST(a_damaged_file_is_reported_and_the_configuration_holds),
        TEST(an_appliance_without_such_settings_says_so),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

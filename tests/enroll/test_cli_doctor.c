/* isotherm doctor against a scripted daemon. Its findings follow from texts and codes of the
 * daemon, and its remedies follow from the codes. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

#include "enroll/cli/doctor/remedy.h"
#include "tests/enroll/rigs/cli.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

static void doctor_finds_nothing_wrong(void **state)
{
    struct cli_result result = cli_run(&cli_two_people, "doctor --json");
    json_t *document = cli_json(&result), *check;
    size_t i;

    (void)state;
    cli_expect_exit(&result, 0);
    assert_true(json_is_true(json_object_get(document, "healthy")));
    assert_int_equal(json_array_size(json_object_get(document, "checks")), 10);
    json_array_foreach(json_object_get(document, "checks"), i, check)
    {
        assert_string_equal(json_string_value(json_object_get(check, "state")), "ok");
    }
    json_decref(document);
    assert_non_null(strstr(result.calls, "GetStatus;Release"));
    assert_null(strstr(result.calls, "Claim"));
}

static void doctor_lists_the_devices_that_the_driver_sees(void **state)
{
    const struct fake_script script = {
        .sensor_devices = "1d27/0600@1/4 (Maker Eye)",
        .sensor_calibration = "60.0 mm apart, 0.21 px rms of 24 pairs",
        .door_lines = "relay GPIO17; contact GPIO5 pull-up"};
    const struct cli_result result = cli_run(&script, "doctor");

    (void)state;
    cli_expect_exit(&result, 0);
    assert_non_null(strstr(result.out, "ok       devices     1d27/0600@1/4 (Maker Eye)\n"));
    assert_non_null(strstr(result.out, "ok       calibration 60.0 mm apart, 0.21 px rms of 24 "
                                       "pairs\n"));
    assert_non_null(strstr(result.out, "ok       lines       gpiod: relay GPIO17; contact GPIO5 "
                                       "pull-up\n"));
}

/* A status of the daemon, and the doctor's finding. The sentences are arbitrary, because the codes
 * decide. */
static const struct {
    struct fake_script script;
    int exit;
    const char *text;
    enum iso_fault_code code; /* the code whose remedy is printed; NONE: no remedy */
} cases[] = {
    {{.sensor_state = "lost"}, 4, "fault    sensor      lost\n", ISO_FAULT_NONE},
    {{.sensor_state = "lost", .sensor_fault = "what is so", .sensor_fault_code = "sensor-denied"},
     4,
     "fault    sensor      lost: what is so\n",
     ISO_FAULT_SENSOR_DENIED},
    {{.sensor_state = "lost",
      .sensor_fault = "sensor v4l2: /dev/video0: cannot be opened: Permission denied"},
     4,
     "fault    sensor      lost: sensor v4l2: /dev/video0: cannot be opened: Permission "
     "denied\n",
     ISO_FAULT_NONE},
    {{.sensor_state = "lost", .sensor_fault = "news", .sensor_fault_code = "of-a-newer-daemon"},
     4,
     "fault    sensor      lost: news\n",
     ISO_FAULT_NONE},
    {{.sensor_health = "idle", .sensor_health_code = "recording-missing"},
     0,
     "warning  sensor      started: idle\n",
     ISO_FAULT_RECORDING_MISSING},
    {{.sensor_devices = "/dev/video0 (closed)", .sensor_devices_code = "sensor-denied"},
     0,
     "warning  devices     /dev/video0 (closed)\n",
     ISO_FAULT_SENSOR_DENIED},
    {{.sensor_calibration = "0.83", .sensor_calibration_code = "calibration-poor"},
     0,
     "warning  calibration 0.83\n",
     ISO_FAULT_CALIBRATION_POOR},
    {{.sensor_calibration = "a.ini", .sensor_calibration_code = "calibration-nominal"},
     0,
     "warning  calibration a.ini\n",
     ISO_FAULT_CALIBRATION_NOMINAL},
    {{.clock_fault = "late", .clock_fault_code = "clock-behind"},
     4,
     "fault    clock       late\n",
     ISO_FAULT_CLOCK_BEHIND},
    {{.clock_fault_code = "clock-unset"},
     4,
     "fault    clock       The clock is not set.\n",
     ISO_FAULT_CLOCK_UNSET},
    {{.door_state = "forced"}, 4, "fault    door        forced\n", ISO_FAULT_DOOR_FORCED},
    {{.door_state = "fault"}, 4, "fault    door        fault\n", ISO_FAULT_DOOR_AT_FAULT},
    {{.door_state = "held-open"}, 0, "warning  door        held-open\n", ISO_FAULT_DOOR_HELD_OPEN},
    {{.door = "null"},
     0,
     "warning  lines       null: nothing is switched\n",
     ISO_FAULT_DOOR_UNWIRED},
    {{.door_fault = "cut", .door_fault_code = "line-busy"},
     4,
     "fault    lines       cut\n",
     ISO_FAULT_LINE_BUSY},
    {{.storage_fault = "full", .storage_fault_code = "disk-full"},
     4,
     "fault    disk        full\n",
     ISO_FAULT_DISK_FULL},
    {{.storage_fault = "eio", .storage_fault_code = "lockout-unreadable"},
     4,
     "fault    disk        eio\n",
     ISO_FAULT_LOCKOUT_UNREADABLE},
    {{.stale_fault = "slow", .stale_fault_code = "time-short"},
     0,
     "warning  time        slow\n",
     ISO_FAULT_TIME_SHORT},
    {{.door_ordinary = true},
     0,
     "warning  door thread no real-time priority: the door may be late on a busy machine\n",
     ISO_FAULT_NOT_REALTIME},
    {{.counter_fault = "away", .counter_fault_code = "tpm-missing"},
     4,
     "fault    counter     away\n",
     ISO_FAULT_TPM_MISSING},
    {{.counter_fault = "cleared", .counter_fault_code = "counter-gone"},
     4,
     "fault    counter     cleared\n",
     ISO_FAULT_COUNTER_GONE},
    {{.panel_fault = "quiet", .panel_fault_code = "panel-silent"},
     4,
     "fault    panel       quiet\n",
     ISO_FAULT_PANEL_SILENT},
    {{.model = ""}, 4, "fault    model       not loaded\n", ISO_FAULT_MODEL_ABSENT},
    {{.version = "0.0.1"}, 0, "warning  version     0.0.1", ISO_FAULT_VERSION_DIFFERS},
    {{0}, 0, "warning  gallery     0 people, 0 usable templates\n", ISO_FAULT_GALLERY_EMPTY},
    {{.site = "provisional", .site_people = 2},
     0,
     "warning  metric      provisional: learned from 2 of the 3 people that it needs\n",
     ISO_FAULT_SITE_PROVISIONAL},
    {{.site = "adapted", .site_people = 7},
     0,
     "ok       metric      adapted to 7 people\n",
     ISO_FAULT_NONE},
    {{0}, 0, "ok       metric      as shipped: adapt = no\n", ISO_FAULT_NONE},
    {{.fail_method = "Release", .fail_error = "org.freedesktop.DBus.Error.AccessDenied"},
     1,
     "denied   permission  ",
     ISO_FAULT_NOT_PERMITTED},
    {{.fail_method = "GetStatus", .fail_error = "org.freedesktop.DBus.Error.AccessDenied"},
     1,
     "denied   permission  not permitted: ",
     ISO_FAULT_NOT_PERMITTED},
    {{.fail_method = "GetStatus", .fail_error = "org.isotherm.Error.Internal"},
     4,
     "fault    status      the fake says so\n",
     ISO_FAULT_NO_STATUS},
};

static void doctor_names_each_fault_and_its_remedy(void **state)
{

    (void)state;
    for (size_t i = 0; i < COUNT(cases); i++) {
        const struct cli_result result = cli_run(&cases[i].script, "doctor");
        const char *found = strstr(result.out, cases[i].text);
        if (!found) {
            fail_msg("'%s' is not in:\n%s", cases[i].text, result.out);
        }
        cli_expect_exit(&result, cases[i].exit);
        char remedy[256] = "";
        (void)snprintf(remedy, sizeof remedy, "\n                     -> %s\n",
                       cli_remedy(cases[i].code) ? cli_remedy(cases[i].code) : "");
        const char *line = strchr(found, '\n');
        const bool told = strncmp(line, remedy, strlen("\n                     -> ")) == 0;
        assert_int_equal(told, cases[i].code != ISO_FAULT_NONE);
        if (told && strncmp(line, remedy, strlen(remedy)) != 0) {
            fail_msg("not the remedy '%s' in:\n%s", remedy, result.out);
        }
    }
}

static void doctor_tells_programs_the_code(void **state)
{
    const struct fake_script script = {.storage_fault = "full", .storage_fault_code = "disk-full"};
    const struct cli_result result = cli_run(&script, "doctor --json");
    json_t *document = cli_json(&result), *check;
    bool found = false;
    size_t i;

    (void)state;
    json_array_foreach(json_object_get(document, "checks"), i, check)
    {
        const char *code = json_string_value(json_object_get(check, "code"));
        const char *subject = json_string_value(json_object_get(check, "subject"));
        const bool good = strcmp(json_string_value(json_object_get(check, "state")), "ok") == 0;
        assert_int_equal(good, code == NULL);
        found |= code && strcmp(subject, "disk") == 0 && strcmp(code, "disk-full") == 0;
    }
    assert_true(found);
    json_decref(document);
}

static void doctor_without_a_daemon(void **state)
{
    const struct cli_result result = cli_run(NULL, "doctor");

    (void)state;
    cli_expect_exit(&result, 4);
    assert_non_null(strstr(result.out, "fault    daemon      isothermd is not on the bus\n"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(doctor_finds_nothing_wrong),
        cmocka_unit_test(doctor_lists_the_devices_that_the_driver_sees),
        cmocka_unit_test(doctor_names_each_fault_and_its_remedy),
        cmocka_unit_test(doctor_tells_programs_the_code),
        cmocka_unit_test(doctor_without_a_daemon),
    };

    setenv("TZ", "UTC", 1); /* the programs print local time */
    return cli_find_bus() ? cmocka_run_group_tests(tests, NULL, cli_teardown) : TEST_SKIPPED;
}

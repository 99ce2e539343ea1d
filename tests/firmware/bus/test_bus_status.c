/* The status of the service: its keys, and the codes of its faults. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/contract/contract.h"
#include "tests/firmware/rigs/bus_rig.h"

/* ---- the status ---- */

/* Returns the value of a key of GetStatus as text. */
static const char *status_of(struct bus_rig *f, const char *key)
{
    static char text[128];
    struct bus_answer *answer = bus_rig_send(f, 0, bus_rig_new_call(f, 0, ISO_CONTRACT_GET_STATUS));
    const char *name, *contents;
    char type;
    assert_true(sd_bus_message_enter_container(answer->reply, 'a', "{sv}") > 0);
    while (sd_bus_message_enter_container(answer->reply, 'e', "sv") > 0) {
        assert_true(sd_bus_message_read(answer->reply, "s", &name) > 0);
        assert_true(sd_bus_message_peek_type(answer->reply, &type, &contents) > 0);
        if (strcmp(name, key) == 0) {
            const char *s;
            uint32_t u;
            uint64_t t = 0; /* a boolean fills half of it */
            double d;
            switch (*contents) {
            case 's':
                assert_true(sd_bus_message_read(answer->reply, "v", "s", &s) > 0);
                (void)snprintf(text, sizeof text, "s %s", s);
                return text;
            case 'u':
                assert_true(sd_bus_message_read(answer->reply, "v", "u", &u) > 0);
                (void)snprintf(text, sizeof text, "u %u", u);
                return text;
            case 'd':
                assert_true(sd_bus_message_read(answer->reply, "v", "d", &d) > 0);
                (void)snprintf(text, sizeof text, "d %g", d);
                return text;
            default:
                assert_true(sd_bus_message_read(answer->reply, "v", contents, &t) > 0);
                (void)snprintf(text, sizeof text, "%c %llu", *contents, (unsigned long long)t);
                return text;
            }
        }
        assert_true(sd_bus_message_skip(answer->reply, "v") > 0);
        assert_true(sd_bus_message_exit_container(answer->reply) > 0);
    }
    return "missing";
}

static void reports_its_state(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    rig_enrol(f->rig, "anna", 50);
    rig_enrol(f->rig, "anna", 51);
    rig_show(f->rig, 50, 2);
    bus_rig_run(f, 250);
    static const char *const wanted[][2] = {
        {"version", "s " ISOTHERM_VERSION},
        {"sensor", "s replay"},
        {"sensor-model", "s puppet9"},
        {"sensor-state", "s started"},
        {"sensor-fault", "s "},
        {"sensor-devices", "s "},
        {"sensor-calibration", "s "},
        {"door-lines", "s "},
        {"door", "s null"},
        {"door-state", "s unlocked"},
        {"mode", "s watch"},
        {"people", "u 1"},
        {"templates", "u 2"},
        {"templates-usable", "u 2"},
        {"capacity", "u 1000"},
        {"frames", "t 2"},
        {"last-outcome", "s allow anna"},
        {"image-check", "s flag"},
        {"model", "s 00000abc"},
        {"algorithm", "s 00000051"},
        {"threshold", "d 6"},
        {"uptime-ms", "x 250"},
        {"visits-allowed", "t 1"},
        {"visits-denied", "t 0"},
        {"visits-attack", "t 0"},
        {"attack-frames", "t 0"},
        {"capture", "s ok"},
        {"distance-mm", "d 700"},
        {"right-mm", "d 0"},
        {"yaw-deg", "d 0"},
        {"coverage", "d 0.9"},
        {"residual-mm", "d 1.5"},
        {"landmark-sigma-mm", "d 2.5"},
        {"speed-mm-s", "d 0"},
    };
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        assert_string_equal(status_of(f, wanted[i][0]), wanted[i][1]);
    }
    assert_memory_equal(status_of(f, "log-sequence"), "t ", 2);
}

/* Without faults the keys exist and are empty. */
static void reports_the_codes_of_its_faults(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    static const char *const keys[] = {
        "sensor-fault-code",   "sensor-health-code", "sensor-calibration-code",
        "sensor-devices-code", "door-fault-code",    "storage-fault-code",
        "clock-fault-code",    "stale-fault-code",   "counter-fault-code"};
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
        assert_string_equal(status_of(f, keys[i]), "s ");
    }
}

static void carries_faults_that_are_no_utf8(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    f->rig->sensor.open_error = f->rig->sensor.wait_error = -ENODEV;
    f->rig->sensor.text = "/srv/\xff\xfe: gone";
    bus_rig_run(f, 100);
    f->rig->sensor.open_error = f->rig->sensor.wait_error = 0;
    assert_string_equal(status_of(f, "sensor-fault"), "s /srv/?\?: gone");
    assert_string_equal(status_of(f, "sensor-fault-code"), "s sensor-gone");
}

/* ---- lockdown ---- */

static void an_administrator_shuts_the_door(void **state)
{
    struct bus_rig *f = bus_rig_need(state);
    rig_enrol(f->rig, "anna", 50);
    sd_bus_message *call = bus_rig_new_call(f, 0, ISO_CONTRACT_SET_LOCKDOWN);
    assert_true(sd_bus_message_append(call, "b", 1) >= 0);
    assert_string_equal(bus_rig_send(f, 0, call)->error, "");
    assert_string_equal(status_of(f, "lockdown"), "b 1");
    assert_string_equal(status_of(f, "lockout-ms"), "x 0");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_CLAIM, NULL), "");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_VERIFY_START, "anna"), "LockedOut");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_CLEAR_LOCKOUT, NULL), "");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_VERIFY_START, "anna"), "LockedOut");
    call = bus_rig_new_call(f, 0, ISO_CONTRACT_SET_LOCKDOWN);
    assert_true(sd_bus_message_append(call, "b", 0) >= 0);
    assert_string_equal(bus_rig_send(f, 0, call)->error, "");
    assert_string_equal(bus_rig_call(f, 0, ISO_CONTRACT_VERIFY_START, "anna"), "");
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, bus_rig_setup, bus_rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(reports_its_state),
        TEST(reports_the_codes_of_its_faults),
        TEST(carries_faults_that_are_no_utf8),
        TEST(an_administrator_shuts_the_door),
    };
    return cmocka_run_group_tests(tests, bus_rig_group_setup, bus_rig_group_teardown);
}

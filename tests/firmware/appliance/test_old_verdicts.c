/* An old verdict does not open the door. A verdict becomes old by slow records, slow frames, a
 * stopped process, or a suspended machine. The test controls the clocks. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/door/door_null.h"
#include "firmware/appliance/administration/administration.h"
#include "tests/firmware/rigs/rig.h"
#include "tests/firmware/rigs/stores.h"
#include "tests/support/devices/manual_clock.h"

enum { STALE_MS = 1000 };

static struct rig *the_rig;

/* Delays of the record of a grant, of a frame, and of the switching of the relay. Each has a time
 * that passes, and a time for which the machine is suspended. */
static struct delays {
    int64_t record_ms, record_asleep_ms, frame_ms, frame_asleep_ms, relay_ms;
} delays;
static int relay_switchings;
static bool relay;

static void pass(int64_t ms, int64_t asleep_ms)
{
    the_rig->now_ns += ms * ISO_NS_PER_MS;
    the_rig->asleep_ns += asleep_ms * ISO_NS_PER_MS;
}

static void on_written(void *context, const struct iso_audit_record *record, uint64_t sequence,
                       const char *head)
{
    (void)context;
    (void)sequence;
    (void)head;
    if (strcmp(record->event, "grant") == 0 || strcmp(record->event, "door-test") == 0) {
        pass(delays.record_ms, delays.record_asleep_ms);
    }
}

static int set_output(void *self, enum iso_door_output output, bool active, struct iso_fault *fault)
{
    if (output == ISO_DOOR_RELAY) {
        relay_switchings++;
        relay = active;
        pass(active ? delays.relay_ms : 0, 0);
    }
    return iso_door_null_ops.set_output(self, output, active, fault);
}

static struct iso_pipeline_ops slow_ops;
static const struct iso_pipeline_ops *puppet_ops;

static int extract(void *self, const struct iso_frame *frame, const char *sensor,
                   struct iso_extraction *out)
{
    pass(delays.frame_ms, delays.frame_asleep_ms);
    return puppet_ops->extract(self, frame, sensor, out);
}

static void open_door(struct rig *rig)
{
    static struct iso_door_io_ops ops;
    static const struct iso_door_outputs unpowered;
    const struct iso_clock clock = manual_clock(&rig->now_ns);
    ops = iso_door_null_ops;
    ops.set_output = set_output;
    iso_door_io_close(rig->door_io);
    assert_int_equal(iso_door_io_open_ops(&ops, NULL, 0, &clock, &unpowered, &rig->door_io, NULL),
                     0);
    rig->borrowed.door_io = rig->door_io;
}

static void open_log(struct rig *rig)
{
    struct iso_audit_options audit = stores_audit(rig->directory);
    audit.written = on_written;
    iso_audit_close(rig->audit);
    assert_int_equal(iso_audit_open(&audit, &rig->borrowed.times, &rig->audit, NULL), 0);
    rig->borrowed.audit = rig->audit;
}

static int setup(void **state)
{
    if (rig_setup(state)) {
        return -1;
    }
    struct rig *rig = the_rig = *state;
    iso_appliance_free(rig->appliance);
    open_door(rig);
    open_log(rig);
    puppet_ops = rig->borrowed.pipeline.ops;
    slow_ops = *puppet_ops;
    slow_ops.extract = extract;
    rig->borrowed.pipeline.ops = &slow_ops;
    rig->config.sensor.stale_ms = STALE_MS;
    rig->config.sensor.pause_ms = 600000;
    rig->asleep_ns = 7 * ISO_NS_PER_S; /* suspended at an earlier time */
    delays = (struct delays){0};
    rig_enrol(rig, "anna", 50);
    const int error = iso_appliance_new(&rig->borrowed, &rig->appliance);
    if (!error) {
        rig_start(rig);
        relay_switchings = 0;
    }
    return error;
}

static void come(struct rig *rig)
{
    rig_show(rig, 50, 2);
    rig_run(rig, 100);
}

/* Asserts that nobody was admitted, and that the log says so after the grant. */
static void expect_denial(struct rig *rig, const char *reason)
{
    char news[64], behind[96];
    (void)snprintf(news, sizeof news, "visit deny anna %s 2", reason);
    assert_string_equal(rig_news(rig), news);
    const char *number = strstr(rig_record(rig, "grant"), "\"sequence\":");
    assert_non_null(number);
    (void)snprintf(behind, sizeof behind, "\"verdict\":\"deny\",\"grant\":%lu,\"reason\":\"%s\"",
                   strtoul(number + strlen("\"sequence\":"), NULL, 10), reason);
    assert_non_null(strstr(rig_record(rig, "visit"), behind));
    assert_false(relay);
    rig_run(rig, 5000); /* and not later */
    assert_false(relay);
}

static void a_record_may_take_250_ms_and_no_longer(void **state)
{
    struct rig *rig = *state;
    delays.record_ms = 250;
    come(rig);
    assert_string_equal(rig_news(rig), "door unlocked grant; visit allow anna match 2");
    rig_run(rig, 10000);
    (void)rig_news(rig);
    relay_switchings = 0;
    delays.record_ms = 251;
    come(rig);
    expect_denial(rig, "not-on-record");
    assert_int_equal(relay_switchings, 0);
}

static void a_machine_that_is_suspended_over_the_record_lets_nobody_in(void **state)
{
    struct rig *rig = *state;
    delays.record_asleep_ms = 3000;
    come(rig);
    expect_denial(rig, "not-on-record");
    assert_int_equal(relay_switchings, 0);
}

/* At the verdict the first of the two frames is older than stale_ms, and the second is not. */
static void frames_that_have_become_old_let_nobody_in(void **state)
{
    struct rig *rig = *state;
    delays.frame_ms = STALE_MS - 33 - 1;
    rig_show_at(rig, 50, 0, 33);
    rig_show_at(rig, 50, 0, 33 + 1 + STALE_MS - 33);
    rig_run(rig, 3000);
    expect_denial(rig, "stale");
    assert_int_equal(relay_switchings, 0);
}

static void frames_that_are_just_young_enough_let_in(void **state)
{
    struct rig *rig = *state;
    delays.frame_ms = 450;
    rig_show_at(rig, 50, 0, 33);
    rig_show_at(rig, 50, 0, 33 + 100); /* processed when the first frame is 450 ms old */
    delays.record_ms = 100;            /* 1000 ms in total */
    rig_run(rig, 1500);
    assert_string_equal(rig_news(rig), "door unlocked grant; visit allow anna match 2");
}

static void a_machine_that_is_suspended_over_a_frame_lets_nobody_in(void **state)
{
    struct rig *rig = *state;
    delays.frame_asleep_ms = 600; /* shorter than stale_ms; twice that is longer */
    rig_show_at(rig, 50, 0, 33);
    rig_run(rig, 50);
    delays.frame_asleep_ms = 3000;
    rig_show_at(rig, 50, 0, 33);
    rig_show_at(rig, 50, 0, 66);
    rig_run(rig, 200);
    assert_int_equal(relay_switchings, 0);
    assert_null(strstr(rig_news(rig), "allow"));
}

/* The second frame agrees with the first. The machine is suspended while the second frame is
 * processed. By the clock of the frames both frames are fresh. */
static void a_machine_that_is_suspended_over_the_frame_that_decides_lets_nobody_in(void **state)
{
    struct rig *rig = *state;
    rig_show(rig, 50, 1);
    rig_run(rig, 50);
    delays.frame_asleep_ms = 3000;
    rig_show(rig, 50, 1);
    rig_run(rig, 50);
    expect_denial(rig, "stale");
    assert_int_equal(relay_switchings, 0);
}

/* The frame was exposed before the machine was suspended, and fetched afterwards. */
static void frames_from_before_a_suspension_are_not_looked_at(void **state)
{
    struct rig *rig = *state;
    rig_show(rig, 50, 2);
    rig->now_ns += 70 * ISO_NS_PER_MS; /* by the clock of the frames they are fresh */
    rig->asleep_ns += 3 * ISO_NS_PER_S;
    rig_run(rig, 500);
    assert_string_equal(rig_news(rig), "");
    come(rig);
    assert_string_equal(rig_news(rig), "door unlocked grant; visit allow anna match 2");
}

static void a_visit_does_not_go_on_after_a_suspension(void **state)
{
    struct rig *rig = *state;
    rig_show(rig, 50, 1);
    rig_run(rig, 50);
    rig->asleep_ns += 3 * ISO_NS_PER_S;
    rig_show(rig, 50, 1);
    rig_run(rig, 50);
    assert_string_equal(rig_news(rig), "");
    rig_show(rig, 50, 1);
    rig_run(rig, 50);
    assert_string_equal(rig_news(rig), "door unlocked grant; visit allow anna match 2");
}

/* The process is stopped between the reading of the clock and the switching. */
static void a_lock_that_was_switched_too_late_is_switched_back(void **state)
{
    struct rig *rig = *state;
    delays.relay_ms = 3000;
    come(rig);
    assert_int_equal(relay_switchings, 2);
    assert_false(relay);
    assert_string_equal(rig_news(rig), "door unlocked grant; door locked not-switched; "
                                       "visit deny anna stale 2");
}

/* A door that was unlocked before the machine was suspended locks when the machine continues. */
static void the_door_locks_after_a_suspension(void **state)
{
    struct rig *rig = *state;
    come(rig);
    assert_true(relay);
    rig->asleep_ns += 60 * ISO_NS_PER_S;
    rig_run(rig, 0);
    assert_false(relay);
}

static void a_test_of_the_door_needs_its_record_in_time(void **state)
{
    struct rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    delays.record_ms = 251;
    assert_int_equal(iso_appliance_test_door(rig->appliance, &fault), -ETIMEDOUT);
    assert_non_null(strstr(fault.text, "the record took 251 ms to get to the disk"));
    assert_int_equal(relay_switchings, 0);
}

/* ---- a warning before verdicts become old ---- */

static void a_slow_sensor_is_reported_at_the_start(void **state)
{
    struct rig *rig = *state;
    rig->sensor.rate_hz = 3;
    iso_appliance_free(rig->appliance);
    assert_int_equal(iso_appliance_new(&rig->borrowed, &rig->appliance), 0);
    rig_start(rig);
    assert_non_null(strstr(rig->warned, "a grant may need 916 ms (2 frames at 3 a second, "));
    const struct iso_appliance_status status = iso_appliance_status(rig->appliance);
    const size_t length = strlen(status.stale_fault);
    assert_memory_equal(status.stale_fault, rig->warned, length);
    assert_string_equal(rig->warned + length, " [time-short]");
    assert_int_equal(status.stale_fault_code, ISO_FAULT_TIME_SHORT);
}

static void a_slow_machine_is_reported_when_it_was_measured(void **state)
{
    struct rig *rig = *state;
    assert_string_equal(iso_appliance_status(rig->appliance).stale_fault, "");
    assert_int_equal(iso_appliance_status(rig->appliance).stale_fault_code, ISO_FAULT_NONE);
    delays.frame_ms = 600;
    come(rig);
    assert_non_null(strstr(iso_appliance_status(rig->appliance).stale_fault, "ms of work), and "
                                                                             "[sensor] stale_ms "
                                                                             "is 1000"));
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, setup, rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_record_may_take_250_ms_and_no_longer),
        TEST(a_machine_that_is_suspended_over_the_record_lets_nobody_in),
        TEST(frames_that_have_become_old_let_nobody_in),
        TEST(frames_that_are_just_young_enough_let_in),
        TEST(a_machine_that_is_suspended_over_a_frame_lets_nobody_in),
        TEST(a_machine_that_is_suspended_over_the_frame_that_decides_lets_nobody_in),
        TEST(frames_from_before_a_suspension_are_not_looked_at),
        TEST(a_visit_does_not_go_on_after_a_suspension),
        TEST(a_lock_that_was_switched_too_late_is_switched_back),
        TEST(the_door_locks_after_a_suspension),
        TEST(a_test_of_the_door_needs_its_record_in_time),
        TEST(a_slow_sensor_is_reported_at_the_start),
        TEST(a_slow_machine_is_reported_when_it_was_measured),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

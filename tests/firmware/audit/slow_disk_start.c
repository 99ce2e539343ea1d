#include "tests/firmware/audit/slow_disk_story.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/config/door_options.h"
#include "tests/firmware/audit/slow_disk_rig.h"
#include "tests/support/devices/wired_door.h"
#include "tests/support/disk/slow_disk.h"

static void *start_appliance(void *context)
{
    const struct rig *rig = context;
    const int error = iso_appliance_start(rig->appliance, NULL);
    return (void *)(intptr_t)error;
}

/* Starts the appliance in a thread, on a disk that hangs, and returns when the thread waits for the
 * disk. */
static pthread_t start_slowly(struct rig *rig)
{
    pthread_t thread;
    slow_disk_hang();
    assert_int_equal(pthread_create(&thread, NULL, start_appliance, rig), 0);
    slow_disk_await();
    return thread;
}

static void end_start(pthread_t thread)
{
    void *result = NULL;
    slow_disk_go_on();
    assert_int_equal(pthread_join(thread, &result), 0);
    assert_null(result);
}

void the_exit_button_works_before_the_start_is_on_record(void **state)
{
    struct rig *rig = *state;
    const pthread_t thread = start_slowly(rig);
    for (unsigned press = 1; press <= 3; press++) {
        wired_door_press();
        wired_door_await(ISO_DOOR_RELAY, 2 * press);
    }
    assert_int_equal(slow_disk_waiting(), 1);
    assert_int_equal(rig->sensor.opened, 0); /* the sensor is opened after the records */
    end_start(thread);
    assert_non_null(
        strstr(slow_disk_rig_record(rig, "door"), "\"reason\":\"time\",\"note\":\"locked\""));
    assert_non_null(strstr(slow_disk_rig_record(rig, "start"), "\"sequence\":1,"));
}

static int64_t time_of(const char *record)
{
    const char *member = strstr(record, "\"monotonic_ns\":");
    assert_non_null(member);
    return strtoll(member + strlen("\"monotonic_ns\":"), NULL, 10);
}

/* As in the daemon, the door works before gallery and log are open. The records of that time come
 * after "start", and have the time of their events. */
void a_door_that_works_already_is_taken_over(void **state)
{
    struct rig *rig = *state;
    struct iso_door_guard *guard = NULL;
    const struct iso_door_guard_options options = iso_door_options_of(
        &rig->config.door, &rig->borrowed.times, rig->door_io, true);
    iso_appliance_free(rig->appliance);
    assert_int_equal(iso_door_guard_new(&options, &guard), 0);
    assert_int_equal(iso_door_guard_start(guard), 0);
    wired_door_press();
    wired_door_await(ISO_DOOR_RELAY, 2);
    while (iso_door_guard_look(guard).state != ISO_DOOR_LOCKED) {
        slow_disk_rig_wait_a_moment();
    }
    const int64_t before_ns = iso_times_now_ns(&rig->borrowed.times);
    rig->borrowed.door = guard;
    assert_int_equal(iso_appliance_new(&rig->borrowed, &rig->appliance), 0);
    const pthread_t thread = start_slowly(rig);
    assert_int_equal(slow_disk_waiting(), 1);
    end_start(thread);
    const char *door = slow_disk_rig_record(rig, "door");
    assert_non_null(strstr(door, "\"sequence\":4,"));
    assert_non_null(strstr(door, "\"reason\":\"time\",\"note\":\"locked\""));
    assert_true(time_of(door) <= before_ns);
    iso_appliance_stop(rig->appliance);
    iso_appliance_free(rig->appliance);
    rig->appliance = NULL;
    iso_door_guard_free(guard);
}

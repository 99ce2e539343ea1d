#include "tests/firmware/audit/slow_disk_story.h"

#include <pthread.h>
#include <string.h>
#include <time.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/firmware/audit/slow_disk_rig.h"
#include "tests/support/devices/wired_door.h"
#include "tests/support/disk/slow_disk.h"

enum { PAUSE_MS = 100, STALL_MS = 3 * PAUSE_MS };

int slow_disk_stall_setup(void **state)
{
    if (slow_disk_rig_setup(state)) {
        return -1;
    }
    struct rig *rig = *state;
    iso_appliance_free(rig->appliance);
    rig->config.door.fail = ISO_DOOR_FAIL_SAFE;
    rig->config.sensor.pause_ms = PAUSE_MS;
    rig->config.sensor.stale_ms = PAUSE_MS;
    rig->config.sensor.silence_ms = 2 * PAUSE_MS;
    rig->sensor.streams = true;
    return iso_appliance_new(&rig->borrowed, &rig->appliance);
}

/* Adds a frame without a person, as a camera delivers them all the time. */
static void show_nobody(struct rig *rig)
{
    const int64_t now_ns = iso_times_now_ns(&rig->borrowed.times);
    puppet_sensor_add(&rig->sensor, now_ns, 0, ISO_CAPTURE_NO_FACE);
}

/* Removes anna, for which the disk takes STALL_MS. Frames from before and during this time wait
 * until it is over. */
static void stall(struct rig *rig)
{
    const struct timespec stall = {.tv_nsec = STALL_MS * 1000000L};
    pthread_t thread;
    void *result = NULL;
    slow_disk_hang();
    assert_int_equal(pthread_create(&thread, NULL, slow_disk_rig_remove_anna, rig), 0);
    slow_disk_await();
    show_nobody(rig);
    (void)nanosleep(&stall, NULL);
    slow_disk_go_on();
    assert_int_equal(pthread_join(thread, &result), 0);
    assert_null(result);
}

void a_slow_disk_does_not_release_a_fail_safe_door(void **state)
{
    struct rig *rig = *state;
    show_nobody(rig);
    slow_disk_rig_start(rig);
    wired_door_await(ISO_DOOR_RELAY, 1); /* the magnet holds the door */
    (void)iso_appliance_step(rig->appliance);
    stall(rig);
    (void)iso_appliance_step(rig->appliance); /* fetches the old frame */
    for (int i = 0; i < 20; i++) {
        show_nobody(rig);
        (void)iso_appliance_step(rig->appliance);
    }
    assert_int_equal(wired_door_switchings(ISO_DOOR_RELAY), 1);
    assert_true(wired_door_level(ISO_DOOR_RELAY));
    assert_null(strstr(rig_news(rig), "fault"));
}

/* Frames with berta from before the stall do not admit her. */
void frames_from_before_a_stall_let_nobody_in(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "berta", 60);
    show_nobody(rig);
    slow_disk_rig_start(rig);
    wired_door_await(ISO_DOOR_RELAY, 1);
    (void)iso_appliance_step(rig->appliance);
    for (int i = 0; i < 4; i++) {
        puppet_sensor_add(&rig->sensor, iso_times_now_ns(&rig->borrowed.times), 60, ISO_CAPTURE_OK);
    }
    stall(rig);
    for (int i = 0; i < 6; i++) {
        (void)iso_appliance_step(rig->appliance);
    }
    assert_int_equal(wired_door_switchings(ISO_DOOR_RELAY), 1);
    assert_null(strstr(rig_news(rig), "visit allow"));
}

/* No frame comes after the stall. */
void a_dead_sensor_is_a_fault_behind_a_stall(void **state)
{
    struct rig *rig = *state;
    char all[4096] = "";
    show_nobody(rig);
    slow_disk_rig_start(rig);
    wired_door_await(ISO_DOOR_RELAY, 1);
    (void)iso_appliance_step(rig->appliance);
    stall(rig);
    while (!strstr(all, "door fault fault")) { /* the time-out of the test ends this loop if the
                                                  report never comes */
        (void)iso_appliance_step(rig->appliance);
        (void)strncat(all, rig_news(rig), sizeof all - strlen(all) - 1);
        slow_disk_rig_wait_a_moment();
    }
    wired_door_await(ISO_DOOR_RELAY, 2);
    assert_false(wired_door_level(ISO_DOOR_RELAY));
}

#include "tests/firmware/audit/slow_disk_rig.h"

#include <pthread.h>
#include <string.h>
#include <time.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/firmware/rigs/stores.h"
#include "tests/support/devices/wired_door.h"
#include "tests/support/disk/slow_disk.h"

enum { UNLOCK_MS = 50, LONG_MS = 600000 };

int slow_disk_rig_setup(void **state)
{
    if (rig_setup(state)) {
        return -1;
    }
    struct rig *rig = *state;
    iso_appliance_free(rig->appliance);
    iso_door_io_close(rig->door_io);
    iso_audit_close(rig->audit);
    rig->borrowed.times = iso_times_system();
    rig->borrowed.threads = true;
    rig->sensor.clock = rig->borrowed.times.monotonic;
    rig->borrowed.door_io = rig->door_io = wired_door_open();
    const struct iso_audit_options audit = stores_audit(rig->directory);
    assert_int_equal(iso_audit_open(&audit, &rig->borrowed.times, &rig->audit, NULL), 0);
    rig->borrowed.audit = rig->audit;
    rig->config.door.unlock_ms = UNLOCK_MS;
    rig->config.decision.refractory_ms = 1;
    rig->config.sensor.stale_ms = LONG_MS; /* on a busy machine, no frame is too old */
    rig_enrol(rig, "anna", 50);
    return iso_appliance_new(&rig->borrowed, &rig->appliance);
}

int slow_disk_rig_teardown(void **state)
{
    slow_disk_take_ms(0);
    slow_disk_go_on();
    return rig_teardown(state);
}

void slow_disk_rig_settle(struct rig *rig)
{
    (void)iso_audit_writer_hold(iso_appliance_log(rig->appliance));
    iso_audit_writer_release(iso_appliance_log(rig->appliance));
}

void slow_disk_rig_start(struct rig *rig)
{
    rig_start(rig);
    slow_disk_rig_settle(rig);
    (void)rig_news(rig);
}

void slow_disk_rig_hang(void)
{
    slow_disk_hang();
    wired_door_press();
    slow_disk_await();
}

void slow_disk_rig_wait_a_moment(void)
{
    const struct timespec moment = {.tv_nsec = 1000000};
    (void)nanosleep(&moment, NULL);
}

const char *slow_disk_rig_visit(struct rig *rig)
{
    static char all[4096];
    all[0] = '\0';
    while (!strstr(all, "visit ")) {
        if (rig->sensor.next == rig->sensor.n_frames) {
            const int64_t now_ns = iso_times_now_ns(&rig->borrowed.times);
            puppet_sensor_add(&rig->sensor, now_ns, 50, ISO_CAPTURE_OK);
        }
        (void)iso_appliance_step(rig->appliance);
        (void)strncat(all, rig_news(rig), sizeof all - strlen(all) - 1);
        slow_disk_rig_wait_a_moment();
    }
    return all;
}

const char *slow_disk_rig_record(struct rig *rig, const char *event)
{
    slow_disk_rig_settle(rig);
    return rig_record(rig, event);
}

void *slow_disk_rig_remove_anna(void *context)
{
    struct rig *rig = context;
    const int error = iso_appliance_remove(rig->appliance, "anna", NULL);
    return (void *)(intptr_t)error;
}

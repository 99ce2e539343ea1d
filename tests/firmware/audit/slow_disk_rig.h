/* The appliance of test_slow_disk.c: with its threads, on the system's clock, with a door on its
 * lines (tests/support/devices/wired_door.h) and a disk that hangs on request
 * (tests/support/disk/slow_disk.h). "anna" is enrolled. */
#ifndef TESTS_FIRMWARE_AUDIT_SLOW_DISK_RIG_H
#define TESTS_FIRMWARE_AUDIT_SLOW_DISK_RIG_H

#include "tests/firmware/rigs/rig.h"

/* A test makes at most so many visits of anna until she is admitted. */
enum { SLOW_DISK_RIG_VISITS_MAX = 100 };

/* cmocka set-up and tear-down; the tear-down makes the disk work again. */
int slow_disk_rig_setup(void **state);
int slow_disk_rig_teardown(void **state);

/* Waits until the disk has all records that were posted. */
void slow_disk_rig_settle(struct rig *rig);

/* Starts the appliance, and waits until the disk has the records of the start. */
void slow_disk_rig_start(struct rig *rig);

/* Makes the disk hang and presses the exit button. Returns when the button's record waits for the
 * disk. */
void slow_disk_rig_hang(void);

/* Waits a millisecond for the other threads. */
void slow_disk_rig_wait_a_moment(void);

/* Anna comes, and the appliance steps until it has a verdict. Returns what the appliance reported;
 * valid until the next call. */
const char *slow_disk_rig_visit(struct rig *rig);

/* Waits until all records are on the disk, and returns the last record that has this event; "" if
 * there is none. The text is valid until the next call. */
const char *slow_disk_rig_record(struct rig *rig, const char *event);

/* A thread that removes anna; the context is the rig. It returns NULL on success. */
void *slow_disk_rig_remove_anna(void *context);

#endif

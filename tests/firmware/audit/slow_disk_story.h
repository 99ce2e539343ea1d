/* The tests of test_firmware_slow_disk are in several files; the table in test_slow_disk.c has
 * their order. Each test begins with the appliance of slow_disk_rig.h. */
#ifndef TESTS_FIRMWARE_AUDIT_SLOW_DISK_STORY_H
#define TESTS_FIRMWARE_AUDIT_SLOW_DISK_STORY_H

/* Grants and their records (slow_disk_grant.c). */
void a_known_person_is_admitted_while_the_disk_works(void **state);
void a_grant_that_is_not_on_record_lets_nobody_in(void **state);
void a_grant_that_was_not_begun_is_forgotten(void **state);
void a_full_queue_lets_nobody_in(void **state);

/* Work for the disk that must not delay a visit: a chattering contact, a journal that hangs, and
 * administration (slow_disk_load.c). */
void a_chattering_contact_keeps_nobody_out(void **state);
void a_stuck_journal_keeps_nobody_out(void **state);
void administration_does_not_keep_the_door_waiting(void **state);

/* A start on a disk that hangs (slow_disk_start.c). */
void the_exit_button_works_before_the_start_is_on_record(void **state);
void a_door_that_works_already_is_taken_over(void **state);

/* A sensor whose frames wait for the main thread, while the main thread waits for the disk
 * (slow_disk_stall.c). */
int slow_disk_stall_setup(void **state); /* with a fail-safe door and short times */
void a_slow_disk_does_not_release_a_fail_safe_door(void **state);
void frames_from_before_a_stall_let_nobody_in(void **state);
void a_dead_sensor_is_a_fault_behind_a_stall(void **state);

#endif

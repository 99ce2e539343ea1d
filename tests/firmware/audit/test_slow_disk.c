/* The door does not wait for the disk: an appliance with its threads runs on a disk that hangs. The
 * tests check what happens before the disk answers, and never how long it takes. */
#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/firmware/audit/slow_disk_rig.h"
#include "tests/firmware/audit/slow_disk_story.h"
#include "tests/support/devices/wired_door.h"
#include "tests/support/disk/slow_disk.h"

enum { STOPPED_S = 3 };

/* ---- the door ---- */

/* Meanwhile no thread steps the appliance, as if the work on one frame never ended. */
static void relay_and_exit_do_not_wait_for_the_disk(void **state)
{
    struct rig *rig = *state;
    slow_disk_rig_start(rig);
    slow_disk_rig_hang();
    wired_door_await(ISO_DOOR_RELAY, 2); /* switched on, and off again */
    for (unsigned press = 2; press <= 20; press++) {
        wired_door_press();
        wired_door_await(ISO_DOOR_RELAY, 2 * press);
    }
    assert_false(wired_door_level(ISO_DOOR_RELAY));
    assert_int_equal(slow_disk_waiting(), 1); /* the disk has not answered yet */
}

static void contact_and_tamper_do_not_wait_for_the_disk(void **state)
{
    struct rig *rig = *state;
    slow_disk_rig_start(rig);
    slow_disk_rig_hang();
    wired_door_await(ISO_DOOR_RELAY, 2);
    wired_door_set(ISO_DOOR_TAMPER, true);
    wired_door_await(ISO_DOOR_BUZZER, 1);
    wired_door_set(ISO_DOOR_TAMPER, false);
    wired_door_await(ISO_DOOR_BUZZER, 2);
    wired_door_set(ISO_DOOR_CONTACT, true); /* the door was forced */
    wired_door_await(ISO_DOOR_BUZZER, 3);
    wired_door_set(ISO_DOOR_CONTACT, false);
    wired_door_await(ISO_DOOR_BUZZER, 4);
    assert_int_equal(slow_disk_waiting(), 1);
    slow_disk_go_on();
    assert_non_null(
        strstr(slow_disk_rig_record(rig, "door"), "\"reason\":\"closed\",\"note\":\"locked\""));
}

/* ---- a stopped process ---- */

/* Runs in a process of its own, which stops itself when the record of the grant is to be
 * synchronised. Returns its exit code: 0 if nobody was admitted. */
static int be_stopped(void)
{
    void *state = NULL;
    if (slow_disk_rig_setup(&state)) {
        return 2;
    }
    struct rig *rig = state;
    rig->config.sensor.stale_ms = 1000;
    slow_disk_rig_start(rig);
    slow_disk_stop_process();
    const bool denied = strstr(slow_disk_rig_visit(rig), "visit deny anna ") != NULL;
    iso_appliance_stop(rig->appliance);
    const bool moved = wired_door_switchings(ISO_DOOR_RELAY) > 0;
    if (slow_disk_rig_teardown(&state)) {
        return 3;
    }
    return denied && !moved ? 0 : 1;
}

static void a_stopped_process_lets_nobody_in_when_it_goes_on(void **state)
{
    const struct timespec stopped = {.tv_sec = STOPPED_S};
    int status = 0;
    (void)state;
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        _exit(be_stopped());
    }
    assert_int_equal(waitpid(child, &status, WUNTRACED), child);
    assert_true(WIFSTOPPED(status));
    (void)nanosleep(&stopped, NULL);
    assert_int_equal(kill(child, SIGCONT), 0);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, slow_disk_rig_setup, slow_disk_rig_teardown)
#define TEST_SAFE(f) \
    cmocka_unit_test_setup_teardown(f, slow_disk_stall_setup, slow_disk_rig_teardown)
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_stopped_process_lets_nobody_in_when_it_goes_on),
        TEST(a_known_person_is_admitted_while_the_disk_works),
        TEST(relay_and_exit_do_not_wait_for_the_disk),
        TEST(contact_and_tamper_do_not_wait_for_the_disk),
        TEST(a_grant_that_is_not_on_record_lets_nobody_in),
        TEST(a_grant_that_was_not_begun_is_forgotten),
        TEST(a_full_queue_lets_nobody_in),
        TEST(a_chattering_contact_keeps_nobody_out),
        TEST(a_stuck_journal_keeps_nobody_out),
        TEST(administration_does_not_keep_the_door_waiting),
        TEST(the_exit_button_works_before_the_start_is_on_record),
        TEST(a_door_that_works_already_is_taken_over),
        TEST_SAFE(a_slow_disk_does_not_release_a_fail_safe_door),
        TEST_SAFE(frames_from_before_a_stall_let_nobody_in),
        TEST_SAFE(a_dead_sensor_is_a_fault_behind_a_stall),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* The disk cannot read the lock-out file. The door stays locked, and works again by itself when the
 * file can be read. A readable but damaged file is another case (test_refusal.c). */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/door/door_null.h"
#include "tests/firmware/rigs/rig.h"
#include "tests/support/scratch.h"

static char path[4096];

/* ---- a bad sector: reading this file fails with EIO ---- */

static bool sector_is_bad;

ssize_t __real_read(int fd, void *bytes, size_t size);
ssize_t __wrap_read(int fd, void *bytes, size_t size);

ssize_t __wrap_read(int fd, void *bytes, size_t size)
{
    struct stat file, bad;
    if (sector_is_bad && fstat(fd, &file) == 0 && stat(path, &bad) == 0 &&
        file.st_ino == bad.st_ino && file.st_dev == bad.st_dev) {
        errno = EIO;
        return -1;
    }
    return __real_read(fd, bytes, size);
}

/* ---- the appliance ---- */

static int setup(void **state)
{
    const int error = rig_setup(state);
    struct rig *rig = *state;
    (void)snprintf(path, sizeof path, "%s", scratch_path(rig->directory, "lockout"));
    rig->config.lockout.failures = 2;
    rig->config.lockout.first_ms = 60000;
    rig->borrowed.lockout_path = path;
    iso_appliance_free(rig->appliance);
    rig_enrol(rig, "anna", 50);
    sector_is_bad = false;
    return error ? error : iso_appliance_new(&rig->borrowed, &rig->appliance);
}

static int teardown(void **state)
{
    sector_is_bad = false;
    return rig_teardown(state);
}

static void restart(struct rig *rig)
{
    iso_appliance_stop(rig->appliance);
    iso_appliance_free(rig->appliance);
    assert_int_equal(iso_appliance_new(&rig->borrowed, &rig->appliance), 0);
    rig_start(rig);
}

static const char *visit(struct rig *rig)
{
    rig_show(rig, 50, 6);
    rig_run(rig, 9000);
    return rig_news(rig);
}

/* The appliance starts again, and the file cannot be read. */
static void start_unread(struct rig *rig)
{
    sector_is_bad = true;
    restart(rig);
    assert_string_equal(visit(rig), "visit deny no-lockout 6");
}

/* ---- tests ---- */

static void the_door_opens_when_the_file_can_be_read(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    start_unread(rig);
    assert_non_null(strstr(iso_appliance_status(rig->appliance).storage_fault, "lockout: "));
    assert_int_equal(iso_appliance_status(rig->appliance).storage_fault_code,
                     ISO_FAULT_LOCKOUT_UNREADABLE);
    assert_non_null(strstr(rig_record(rig, "lockout"), "\"reason\":\"unreadable\""));
    assert_string_equal(rig_record(rig, "lockdown"), "");
    assert_false(iso_appliance_status(rig->appliance).lockdown);
    sector_is_bad = false;
    rig_run(rig, 4000);
    assert_non_null(strstr(rig_record(rig, "lockout"), "\"reason\":\"readable\""));
    assert_string_equal(iso_appliance_status(rig->appliance).storage_fault, "");
    assert_int_equal(iso_appliance_status(rig->appliance).storage_fault_code, ISO_FAULT_NONE);
    (void)rig_news(rig);
    assert_non_null(strstr(visit(rig), "visit allow anna"));
}

static void the_exit_button_works_meanwhile(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    start_unread(rig);
    assert_int_equal(iso_door_null_set_input(rig->door_io, ISO_DOOR_EXIT_BUTTON, true), 0);
    rig_run(rig, 60);
    assert_true(rig_relay(rig));
}

static void the_state_of_the_file_holds_when_it_can_be_read(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    assert_int_equal(iso_appliance_lockdown(rig->appliance, true, NULL), 0);
    start_unread(rig);
    assert_int_equal(iso_appliance_clear_lockout(rig->appliance, NULL), -EIO);
    sector_is_bad = false;
    rig_run(rig, 4000);
    assert_true(iso_appliance_status(rig->appliance).lockdown);
    (void)rig_news(rig);
    assert_string_equal(visit(rig), "visit deny lockdown 6");
}

/* Meanwhile the appliance does not replace the file, and it does not forget a new lock. */
static void a_lockdown_that_begins_meanwhile_goes_on(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    start_unread(rig);
    assert_int_equal(iso_appliance_lockdown(rig->appliance, true, NULL), -EIO);
    sector_is_bad = false;
    rig_run(rig, 4000);
    assert_true(iso_appliance_status(rig->appliance).lockdown);
    restart(rig);
    assert_true(iso_appliance_status(rig->appliance).lockdown);
}

static void an_administrator_replaces_a_file_that_can_never_be_read(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    start_unread(rig);
    assert_int_equal(iso_appliance_lockdown(rig->appliance, false, NULL), 0);
    sector_is_bad = false; /* the new file is in another place on the disk */
    (void)rig_news(rig);
    assert_non_null(strstr(visit(rig), "visit allow anna"));
    restart(rig);
    (void)rig_news(rig);
    assert_non_null(strstr(visit(rig), "visit allow anna"));
}

static void a_file_that_turns_out_to_be_damaged_begins_a_lockdown(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    start_unread(rig);
    scratch_write_text(path, "isotherm-lockout 1 0 0 0 0 open 12345678\n");
    sector_is_bad = false;
    rig_run(rig, 4000);
    assert_non_null(strstr(rig_record(rig, "lockdown"), "\"reason\":\"damaged\""));
    (void)rig_news(rig);
    assert_string_equal(visit(rig), "visit deny lockdown 6");
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, setup, teardown)
    const struct CMUnitTest tests[] = {
        TEST(the_door_opens_when_the_file_can_be_read),
        TEST(the_exit_button_works_meanwhile),
        TEST(the_state_of_the_file_holds_when_it_can_be_read),
        TEST(a_lockdown_that_begins_meanwhile_goes_on),
        TEST(an_administrator_replaces_a_file_that_can_never_be_read),
        TEST(a_file_that_turns_out_to_be_damaged_begins_a_lockdown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

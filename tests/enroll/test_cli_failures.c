/* How every command fails, and the commands that need no daemon: help and version. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "enroll/cli/machine/places.h"
#include "tests/enroll/rigs/cli.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* Every command as a user types it, without options. */
static const char *const commands[] = {
    "enroll anna", "identify", "verify anna",          "list",           "remove anna", "status",
    "log",         "aim",      "validity anna --none", "rename anna eve"};

static void output_that_cannot_be_written_is_a_fault(void **state)
{
    static const char *const words[] = {"list",   "list --json", "status",   "log",
                                        "doctor", "--help",      "--version"};
    struct fake_script script = cli_two_people;

    (void)state;
    script.n_records = 3;
    for (size_t i = 0; i < COUNT(words); i++) {
        const struct cli_result result = cli_run_to("/dev/full", &script, words[i]);
        const char *end = strchr(result.err, '\n');
        if (result.exit != 4 || strncmp(result.err, "isotherm: standard output: ", 27) != 0 ||
            !end || end[1]) {
            fail_msg("%s: exit code %d, %s", words[i], result.exit, result.err);
        }
    }
}

static void every_command_fails_clearly_without_a_daemon(void **state)
{
    char words[64];

    (void)state;
    for (size_t i = 0; i < COUNT(commands); i++) {
        (void)snprintf(words, sizeof words, "%s --json", commands[i]);
        struct cli_result result = cli_run(NULL, words);
        cli_expect_error(&result, 4, "no-daemon");
        result = cli_run(NULL, commands[i]);
        cli_expect_exit(&result, 4);
        assert_non_null(strstr(result.err, "isotherm: isothermd is not running on this bus"));
    }
}

static void every_command_fails_clearly_without_a_bus(void **state)
{
    char words[96];

    (void)state;
    for (size_t i = 0; i < COUNT(commands); i++) {
        (void)snprintf(words, sizeof words, "%s --json --bus unix:path=/nowhere/bus", commands[i]);
        const struct cli_result result = cli_run(NULL, words);
        cli_expect_error(&result, 4, "no-bus");
    }
    const struct cli_result result = cli_run(NULL, "doctor --bus unix:path=/nowhere/bus");
    cli_expect_exit(&result, 4);
    assert_non_null(strstr(result.out, "fault    bus "));
}

static void every_error_of_the_bus_has_its_exit_code(void **state)
{
    static const struct {
        const char *error;
        int exit;
        const char *code;
    } errors[] = {
        {"org.isotherm.Error.AlreadyInUse", 4, "already-in-use"},
        {"org.isotherm.Error.ClaimDevice", 4, "claim-device"},
        {"org.isotherm.Error.NoSuchPerson", 3, "no-such-person"},
        {"org.isotherm.Error.NoActionInProgress", 4, "no-action-in-progress"},
        {"org.isotherm.Error.ActionInProgress", 4, "action-in-progress"},
        {"org.isotherm.Error.InvalidName", 2, "invalid-name"},
        {"org.isotherm.Error.InvalidArgument", 2, "invalid-argument"},
        {"org.isotherm.Error.GalleryFull", 4, "gallery-full"},
        {"org.isotherm.Error.NameInUse", 1, "name-in-use"},
        {"org.isotherm.Error.DeviceFault", 4, "device-fault"},
        {"org.isotherm.Error.Storage", 4, "storage"},
        {"org.isotherm.Error.Internal", 4, "internal"},
        {"org.freedesktop.DBus.Error.AccessDenied", 1, "access-denied"},
        {"org.freedesktop.DBus.Error.NoReply", 5, "no-reply"},
        {"org.freedesktop.DBus.Error.UnknownMethod", 4, "internal"},
    };

    (void)state;
    for (size_t i = 0; i < COUNT(errors); i++) {
        const struct fake_script script = {.fail_method = "VerifyStart",
                                           .fail_error = errors[i].error};
        const struct cli_result result = cli_run(&script, "verify anna --json");
        cli_expect_error(&result, errors[i].exit, errors[i].code);
    }
}

static void usage_errors_are_told_in_the_form_asked_for(void **state)
{
    struct cli_result result = cli_run(NULL, "list --bogus --json");

    (void)state;
    cli_expect_error(&result, 2, "usage");
    result = cli_run(NULL, "list --bogus");
    cli_expect_exit(&result, 2);
    assert_string_equal(result.out, "");
    assert_non_null(strstr(result.err, "--bogus"));
}

static void help_and_version_need_no_daemon(void **state)
{
    struct cli_result result = cli_run(NULL, "--help");

    (void)state;
    cli_expect_exit(&result, 0);
    for (size_t i = 0; i < COUNT(commands); i++) {
        char name[16] = "  ";
        strncat(name, commands[i], strcspn(commands[i], " "));
        assert_non_null(strstr(result.out, name));
    }
    result = cli_run(NULL, "--version");
    assert_string_equal(result.out, "isotherm " ISOTHERM_VERSION "\n");
    result = cli_run(NULL, "enroll --help");
    cli_expect_exit(&result, 0);
    assert_non_null(strstr(result.out, "--allow-duplicate"));
}

/* Without its configuration a unit does not start. The remedy is `isotherm setup`. */
static void a_daemon_that_is_not_configured_is_reported(void **state)
{
    static const char *const words[] = {"status", "list", "log", "identify", "doctor"};
    const bool configured = access(cli_setup_installed.config, F_OK) == 0;
    const char *expected = configured ? "systemctl start isothermd"
                                      : "isothermd is not configured yet: run isotherm setup";

    (void)state;
    for (size_t i = 0; i < COUNT(words); i++) {
        const struct cli_result result = cli_run_on_system_bus(words[i]);
        cli_expect_exit(&result, 4);
        if (!strstr(result.out, expected) && !strstr(result.err, expected)) {
            fail_msg("%s says: %s%s", words[i], result.out, result.err);
        }
    }
    /* The configuration of the installed daemon does not apply to another bus. */
    assert_non_null(strstr(cli_run(NULL, "status").err, "systemctl start isothermd"));
}

/* --help, -h and the word help do the same, for the program and for a command. */
static void help_is_shown_however_it_is_asked_for(void **state)
{
    static const char *const same[][3] = {
        {"--help", "-h", "help"},
        {"lockout --help", "lockout -h", "help lockout"},
        {"log --help", "-h log", "help log"},
    };

    (void)state;
    for (size_t i = 0; i < COUNT(same); i++) {
        char *help = strdup(cli_run(NULL, same[i][0]).out);
        assert_int_equal(strncmp(help, "Usage: isotherm ", 16), 0);
        for (size_t j = 1; j < COUNT(same[i]); j++) {
            const struct cli_result result = cli_run(NULL, same[i][j]);
            cli_expect_exit(&result, 0);
            assert_string_equal(result.out, help);
        }
        free(help);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(output_that_cannot_be_written_is_a_fault),
        cmocka_unit_test(every_command_fails_clearly_without_a_daemon),
        cmocka_unit_test(every_command_fails_clearly_without_a_bus),
        cmocka_unit_test(every_error_of_the_bus_has_its_exit_code),
        cmocka_unit_test(usage_errors_are_told_in_the_form_asked_for),
        cmocka_unit_test(help_and_version_need_no_daemon),
        cmocka_unit_test(a_daemon_that_is_not_configured_is_reported),
        cmocka_unit_test(help_is_shown_however_it_is_asked_for),
    };

    setenv("TZ", "UTC", 1); /* the programs print local time */
    return cli_find_bus() ? cmocka_run_group_tests(tests, NULL, cli_teardown) : TEST_SKIPPED;
}

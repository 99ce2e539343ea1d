/* `isotherm factory-reset`: the services are stopped, the real isothermd deletes the state, and
 * what ran before is started again. systemctl is a program of the test. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "enroll/cli/commands/commands.h"
#include "tests/support/scratch.h"

/* Notes what it is asked. isotherm-link does not run; with a file REFUSES nothing can be stopped.
 */
static const char systemctl[] = "#!/bin/sh\n"
                                "echo \"$*\" >>\"$0.asked\"\n"
                                "case $* in\n"
                                "'--quiet is-active isotherm-link.service') exit 3 ;;\n"
                                "'--quiet stop '*) [ ! -e \"$0.refuses\" ] ;;\n"
                                "esac\n";

struct machine {
    struct cli_reset_places places;
    const char *asked, *gallery, *key, *accounts;
};

/* An appliance with a state, and the services of the test. */
static void make_machine(const char *scratch, struct machine *machine)
{
    char config[1024];
    const char *program = scratch_path(scratch, "systemctl");

    scratch_write_text(program, systemctl);
    assert_int_equal(chmod(program, 0700), 0);
    *machine = (struct machine){
        .places = {.daemon = ISOTHERM_BINARY_DIR "/firmware/isothermd",
                   .config = scratch_path(scratch, "isotherm.conf"),
                   .systemctl = program},
        .asked = scratch_path(scratch, "systemctl.asked"),
        .gallery = scratch_path(scratch, "gallery.db"),
        .key = scratch_path(scratch, "gallery.db.key"),
        .accounts = scratch_path(scratch_path(scratch, "web"), "accounts"),
    };
    scratch_mkdir(scratch_path(scratch, "web"));
    scratch_write_text(machine->accounts, "ada");
    scratch_write_text(machine->gallery, "people");
    scratch_write_text(machine->key, "key");
    (void)snprintf(config, sizeof config,
                   "[gallery]\npath = %s\n[log]\npath = %s/audit.log\n"
                   "[reset]\nweb = %s/web\nlink = %s/link\ncredential = %s/credential\n",
                   machine->gallery, scratch, scratch, scratch, scratch);
    scratch_write_text(machine->places.config, config);
}

static enum cli_exit reset(const struct machine *machine, bool yes, struct cli_fault *fault)
{
    const struct cli_arguments arguments = {.verb = CLI_FACTORY_RESET, .yes = yes, .json = true};
    const int nowhere = open("/dev/null", O_RDWR), in = dup(STDIN_FILENO), out = dup(STDOUT_FILENO);

    assert_true(nowhere >= 0 && in >= 0 && out >= 0);
    (void)fflush(stdout);
    assert_true(dup2(nowhere, STDIN_FILENO) >= 0 && dup2(nowhere, STDOUT_FILENO) >= 0);
    const enum cli_exit exit = cli_factory_reset(&machine->places, &arguments, fault);
    (void)fflush(stdout);
    assert_true(dup2(in, STDIN_FILENO) >= 0 && dup2(out, STDOUT_FILENO) >= 0);
    close(nowhere);
    close(in);
    close(out);
    return exit;
}

static void the_state_is_deleted_between_stop_and_start(void **state)
{
    struct machine machine;
    struct cli_fault fault = {.text = ""};

    make_machine(*state, &machine);
    assert_int_equal(reset(&machine, true, &fault), CLI_EXIT_OK);
    assert_false(scratch_exists(machine.gallery));
    assert_false(scratch_exists(machine.key));
    assert_false(scratch_exists(machine.accounts));
    assert_true(scratch_exists(machine.places.config));
    char *asked = scratch_read_text(machine.asked);
    assert_string_equal(asked, "--quiet is-active isotherm-link.service\n"
                               "--quiet is-active isotherm-web.socket\n"
                               "--quiet is-active isotherm-web.service\n"
                               "--quiet is-active isothermd.service\n"
                               "--quiet stop isotherm-web.socket\n"
                               "--quiet stop isotherm-web.service\n"
                               "--quiet stop isothermd.service\n"
                               "--no-block start isothermd.service\n"
                               "--no-block start isotherm-web.service\n"
                               "--no-block start isotherm-web.socket\n");
    free(asked);
}

static void without_a_confirmation_nothing_happens(void **state)
{
    struct machine machine;
    struct cli_fault fault = {.text = ""};

    make_machine(*state, &machine);
    assert_int_equal(reset(&machine, false, &fault), CLI_EXIT_USAGE);
    assert_non_null(strstr(fault.text, "confirm with --yes"));
    assert_true(scratch_exists(machine.key));
    assert_false(scratch_exists(machine.asked));
}

static void a_service_that_does_not_stop_keeps_the_state(void **state)
{
    struct machine machine;
    struct cli_fault fault = {.text = ""};

    make_machine(*state, &machine);
    scratch_write_text(scratch_path(*state, "systemctl.refuses"), "");
    assert_int_equal(reset(&machine, true, &fault), CLI_EXIT_FAULT);
    assert_string_equal(fault.text, "isotherm-web.socket cannot be stopped; nothing was deleted");
    assert_true(scratch_exists(machine.key));
    assert_true(scratch_exists(machine.accounts));
}

/* The fault is that of isothermd, and the services are started again. */
static void a_reset_that_fails_says_why(void **state)
{
    struct machine machine;
    struct cli_fault fault = {.text = ""};

    make_machine(*state, &machine);
    scratch_write_text(machine.places.config, "[gallery]\npath = relative\nnonsense\n");
    assert_int_equal(reset(&machine, true, &fault), CLI_EXIT_FAULT);
    assert_non_null(strstr(fault.text, "isotherm.conf"));
    assert_true(scratch_exists(machine.key));
    char *asked = scratch_read_text(machine.asked);
    assert_non_null(strstr(asked, "--no-block start isothermd.service\n"));
    free(asked);
}

static void only_root_may_reset(void **state)
{
    struct machine machine;
    struct cli_fault fault = {.text = ""};

    if (geteuid() == 0) {
        skip();
    }
    make_machine(*state, &machine);
    machine.places.root = true;
    assert_int_equal(reset(&machine, true, &fault), CLI_EXIT_NO);
    assert_true(scratch_exists(machine.key));
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, scratch_setup, scratch_teardown)
    const struct CMUnitTest tests[] = {
        TEST(the_state_is_deleted_between_stop_and_start),
        TEST(without_a_confirmation_nothing_happens),
        TEST(a_service_that_does_not_stop_keeps_the_state),
        TEST(a_reset_that_fails_says_why),
        TEST(only_root_may_reset),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* The arguments of the module, which services are asked for Enter, and which logins are remote. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <string.h>

#include "enroll/pam/arguments.h"
#include "enroll/pam/place.h"

static struct login_arguments arguments;

/* Reads up to three arguments. Returns the fault, "" for none. */
static const char *fault_of(const char *first, const char *second, const char *third)
{
    static struct iso_fault fault;
    const char *const argv[] = {first, second, third};
    int argc = 0;
    while (argc < 3 && argv[argc]) {
        argc++;
    }
    fault = (struct iso_fault){.text = ""};
    const struct login_arguments before = arguments;
    const int error = login_arguments_read(argc, argv, "/etc/users", &arguments, &fault);
    assert_true(error == 0 || error == -EINVAL);
    assert_true(error == 0 || memcmp(&before, &arguments, sizeof before) == 0);
    return error ? fault.text : "";
}

static void nothing_is_needed(void **state)
{
    (void)state;
    assert_string_equal(fault_of(NULL, NULL, NULL), "");
    assert_string_equal(arguments.bus, "unix:path=/run/dbus/system_bus_socket");
    assert_string_equal(arguments.users, "/etc/users");
    assert_int_equal(arguments.timeout_s, 10);
}

static void every_argument_can_be_given(void **state)
{
    (void)state;
    assert_string_equal(fault_of("bus=unix:path=/run/b", "users=/x", "timeout=60"), "");
    assert_string_equal(arguments.bus, "unix:path=/run/b");
    assert_string_equal(arguments.users, "/x");
    assert_int_equal(arguments.timeout_s, 60);
    assert_string_equal(fault_of("ask=all", "bus=unix:abstract=/b", "timeout=1"), "");
    assert_string_equal(arguments.bus, "unix:abstract=/b");
    assert_int_equal(arguments.timeout_s, 1);
}

static void wrong_arguments_are_refused(void **state)
{
    static const struct {
        const char *first, *second, *says;
    } wrong[] = {
        {"debug", NULL, "argument debug: it is not known"},
        {"timeout", NULL, "argument timeout: it is not known"},
        {"timeouts=5", NULL, "argument timeouts=5: it is not known"},
        {"timeout=", NULL, "argument timeout=: it has no value, or is there twice"},
        {"timeout=5", "timeout=5", "argument timeout=5: it has no value, or is there twice"},
        {"timeout=0", NULL, "argument timeout=0: not 1 to 60 seconds"},
        {"timeout=61", NULL, "argument timeout=61: not 1 to 60 seconds"},
        {"timeout=005", NULL, "argument timeout=005: not 1 to 60 seconds"},
        {"timeout=-5", NULL, "argument timeout=-5: not 1 to 60 seconds"},
        {"timeout=5s", NULL, "argument timeout=5s: not 1 to 60 seconds"},
        {"users=pam-users", NULL, "argument users=pam-users: not an absolute path"},
        {"bus=session", NULL, "argument bus=session: not unix:path=/FILE or unix:abstract=NAME"},
        {"bus=unixexec:path=/bin/sh", NULL,
         "argument bus=unixexec:path=/bin/sh: not unix:path=/FILE or unix:abstract=NAME"},
        {"bus=unix:path=", NULL,
         "argument bus=unix:path=: not unix:path=/FILE or "
         "unix:abstract=NAME"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        assert_string_equal(fault_of(wrong[i].first, wrong[i].second, NULL), wrong[i].says);
    }
}

static void services_that_give_rights_are_asked(void **state)
{
    static const char *const rights[] = {"sudo", "sudo-i", "su", "su-l", "polkit-1", "passwd"};
    static const char *const logins[] = {"login", "gdm-password", "swaylock", "sud", "sudo-ix", ""};
    (void)state;
    assert_string_equal(fault_of(NULL, NULL, NULL), "");
    for (size_t i = 0; i < sizeof rights / sizeof *rights; i++) {
        assert_true(login_arguments_ask(&arguments, rights[i]));
    }
    for (size_t i = 0; i < sizeof logins / sizeof *logins; i++) {
        assert_false(login_arguments_ask(&arguments, logins[i]));
    }
    assert_true(login_arguments_ask(&arguments, NULL));
}

static void the_list_of_services_can_be_changed(void **state)
{
    (void)state;
    assert_string_equal(fault_of("ask=vlock,login", NULL, NULL), "");
    assert_true(login_arguments_ask(&arguments, "vlock"));
    assert_true(login_arguments_ask(&arguments, "login"));
    assert_false(login_arguments_ask(&arguments, "sudo"));
    assert_string_equal(fault_of("ask=all", NULL, NULL), "");
    assert_true(login_arguments_ask(&arguments, "login"));
    assert_string_equal(fault_of("ask=none", NULL, NULL), "");
    assert_false(login_arguments_ask(&arguments, "sudo"));
    assert_false(login_arguments_ask(&arguments, NULL));
}

static void logins_from_elsewhere_are_known(void **state)
{
    static const struct {
        struct login_place place;
        bool remote;
    } cases[] = {
        {{.service = "login", .tty = "tty1"}, false},
        {{.service = "login", .rhost = "", .tty = "/dev/tty1"}, false},
        {{.service = "gdm-password", .rhost = "localhost", .tty = ":0"}, false},
        {{NULL, NULL, NULL, false}, false},
        {{.service = "login", .rhost = "192.0.2.7"}, true},
        {{.service = "login", .rhost = "127.0.0.1"}, true}, /* a proxy on this machine */
        {{.service = "login", .rhost = "localhost.evil.example"}, true},
        {{.service = "sshd"}, true},
        {{.service = "sshd", .rhost = "localhost"}, true},
        {{.service = "cockpit"}, true},
        {{.service = "login", .tty = "ssh"}, true},
        {{.service = "sudo", .tty = "/dev/pts/3", .remote_session = true}, true},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_int_equal(login_place_remote(&cases[i].place) != NULL, cases[i].remote);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_is_needed),
        cmocka_unit_test(every_argument_can_be_given),
        cmocka_unit_test(wrong_arguments_are_refused),
        cmocka_unit_test(services_that_give_rights_are_asked),
        cmocka_unit_test(the_list_of_services_can_be_changed),
        cmocka_unit_test(logins_from_elsewhere_are_known),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* The module before a daemon that misbehaves, before none, and before a bus that hangs: only the
 * daemon's own "verify-match", after it has accepted the call, lets anybody in. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <grp.h>
#include <security/pam_appl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "tests/enroll/pam/pam_rig.h"
#include "tests/enroll/pam/puppet_daemon.h"
#include "tests/support/child_end.h"
#include "tests/support/programs/private_bus.h"
#include "tests/support/scratch.h"

enum { NOBODY_UID = 65534 };

static struct private_bus bus;
static struct pam_rig rig;

static int setup(void **state)
{
    (void)state;
    assert_int_equal(chmod(bus.directory, 0755), 0);
    pam_rig_init(&rig, bus.address);
    pam_rig_write_users(&rig, "ada Ada\n");
    return 0;
}

static int teardown(void **state)
{
    (void)state;
    pam_rig_done(&rig);
    private_bus_stop(&bus);
    return 0;
}

/* Logs ada in before a daemon that acts like this. */
static void log_in_before(enum puppet_act act, struct pam_login *login)
{
    const pid_t daemon = puppet_daemon_start(bus.address, act);
    login->user = login->user ? login->user : "ada";
    pam_rig_log_in(&rig, login);
    puppet_daemon_stop(daemon);
}

static void the_verdict_of_the_daemon_counts(void **state)
{
    struct pam_login login = {.user = "ada"};
    (void)state;
    log_in_before(PUPPET_MATCHES, &login);
    pam_rig_expect(&login, PAM_SUCCESS);
    assert_string_equal(login.told, "Look at the camera.; ");
    assert_string_equal(login.logged, "");
    log_in_before(PUPPET_SPEAKS_OTHERWISE, &login);
    pam_rig_expect(&login, PAM_AUTH_ERR);
    assert_string_equal(login.logged, "the result is attack\n");
}

static void a_verdict_of_another_client_does_not_count(void **state)
{
    struct pam_login login = {.arguments = "timeout=2"};
    (void)state;
    log_in_before(PUPPET_IS_FORGED, &login);
    pam_rig_expect(&login, PAM_AUTH_ERR);
    assert_string_equal(login.logged, "the result is no-match\n");
    log_in_before(PUPPET_IS_FORGED_ALONE, &login);
    pam_rig_expect(&login, PAM_AUTHINFO_UNAVAIL);
}

static void a_verdict_before_the_call_was_accepted_does_not_count(void **state)
{
    struct pam_login login = {.user = "ada"};
    (void)state;
    log_in_before(PUPPET_IS_EARLY, &login);
    pam_rig_expect(&login, PAM_AUTH_ERR);
}

static void hints_are_told_once(void **state)
{
    struct pam_login login = {.user = "ada"};
    (void)state;
    log_in_before(PUPPET_GIVES_HINTS, &login);
    pam_rig_expect(&login, PAM_AUTHINFO_UNAVAIL);
    assert_string_equal(login.told, "Look at the camera.; come closer; hold still; "
                                    "No face was recognised.; ");
    assert_string_equal(login.logged, "the result is timed-out\n");
}

static void a_daemon_that_leaves_ends_the_login(void **state)
{
    struct pam_login login = {.arguments = "timeout=60"};
    (void)state;
    log_in_before(PUPPET_LEAVES, &login);
    pam_rig_expect(&login, PAM_AUTHINFO_UNAVAIL);
    assert_true(login.looked);
    assert_non_null(strstr(login.logged, "isothermd: "));
}

static void a_daemon_that_does_not_answer_is_not_waited_for(void **state)
{
    struct pam_login login = {.user = "ada"};
    (void)state;
    log_in_before(PUPPET_SAYS_NOTHING, &login);
    pam_rig_expect(&login, PAM_AUTHINFO_UNAVAIL);
    assert_false(login.looked);
}

static void another_client_is_waited_for_a_while(void **state)
{
    struct pam_login login = {.user = "ada"};
    (void)state;
    log_in_before(PUPPET_BUSY_TWICE, &login);
    pam_rig_expect(&login, PAM_SUCCESS);
    log_in_before(PUPPET_STAYS_BUSY, &login);
    pam_rig_expect(&login, PAM_AUTHINFO_UNAVAIL);
    assert_string_equal(login.logged, "isothermd refuses: busy\n");
}

static void a_refusal_is_logged(void **state)
{
    struct pam_login login = {.user = "ada"};
    (void)state;
    log_in_before(PUPPET_REFUSES, &login);
    pam_rig_expect(&login, PAM_AUTHINFO_UNAVAIL);
    assert_string_equal(login.told, "");
    assert_string_equal(login.logged, "isothermd refuses: no camera\n");
}

static void without_a_daemon_the_module_steps_aside(void **state)
{
    struct pam_login login = {.user = "ada"};
    struct pam_rig nowhere = rig;
    (void)state;
    pam_rig_log_in(&rig, &login);
    pam_rig_expect(&login, PAM_AUTHINFO_UNAVAIL);
    assert_string_equal(login.logged, "isothermd is not running\n");
    (void)snprintf(nowhere.bus, sizeof nowhere.bus, "unix:path=/nowhere/bus");
    pam_rig_log_in(&nowhere, &login);
    pam_rig_expect(&login, PAM_AUTHINFO_UNAVAIL);
    assert_non_null(strstr(login.logged, "the message bus: "));
}

/* A socket that accepts connections and says nothing. */
static void a_bus_that_hangs_is_not_waited_for(void **state)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    struct pam_login login = {.user = "ada"};
    struct pam_rig hung = rig;
    const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    (void)state;
    (void)snprintf(address.sun_path, sizeof address.sun_path, "%s/hung", rig.directory);
    assert_int_equal(bind(fd, (const struct sockaddr *)&address, sizeof address), 0);
    assert_int_equal(listen(fd, 4), 0);
    (void)snprintf(hung.bus, sizeof hung.bus, "unix:path=%s", address.sun_path);
    pam_rig_log_in(&hung, &login);
    pam_rig_expect(&login, PAM_AUTHINFO_UNAVAIL);
    assert_string_equal(login.logged, "the message bus: Connection timed out\n");
    assert_int_equal(close(fd), 0);
}

/* A caller could name a bus of his or her own in the environment. */
static void the_environment_names_no_bus(void **state)
{
    static const char *const names[] = {"DBUS_SYSTEM_BUS_ADDRESS", "DBUS_SESSION_BUS_ADDRESS",
                                        "DBUS_STARTER_ADDRESS"};
    struct pam_login login = {.user = "ada"};
    struct pam_rig standard = rig;
    (void)state;
    standard.bus[0] = '\0';
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        assert_int_equal(setenv(names[i], bus.address, 1), 0);
    }
    const pid_t daemon = puppet_daemon_start(bus.address, PUPPET_MATCHES);
    pam_rig_log_in(&standard, &login);
    puppet_daemon_stop(daemon);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        assert_int_equal(unsetenv(names[i]), 0);
    }
    pam_rig_expect(&login, PAM_AUTHINFO_UNAVAIL);
}

/* ---- a caller that is not root, such as a screen locker ---- */

/* Logs a user in, in a process of the user nobody. Returns the result. */
static int log_in_as_nobody(enum puppet_act act, const char *user)
{
    const pid_t daemon = puppet_daemon_start(bus.address, act);
    const gid_t group = NOBODY_UID;
    struct pam_login login = {.user = user};
    struct child child;
    char err[CHILD_ERR_SIZE];
    pam_rig_log_in(&rig, &login); /* as root; writes the service file */
    if (child_fork(&child, "a screen locker") == 0) {
        if (setgroups(1, &group) || setgid(NOBODY_UID) || setuid(NOBODY_UID)) {
            _exit(100);
        }
        pam_rig_log_in(&rig, &login);
        _exit(login.result);
    }
    const int result = child_wait(&child, err);
    puppet_daemon_stop(daemon);
    return result;
}

static void a_user_is_verified_as_himself_alone(void **state)
{
    (void)state;
    assert_int_equal(log_in_as_nobody(PUPPET_MATCHES, "nobody"), PAM_SUCCESS);
    assert_int_equal(log_in_as_nobody(PUPPET_IS_OTHER_USER, "nobody"), PAM_AUTHINFO_UNAVAIL);
    assert_int_equal(log_in_as_nobody(PUPPET_IS_OTHER_USER, "root"), PAM_AUTHINFO_UNAVAIL);
    assert_int_equal(log_in_as_nobody(PUPPET_MATCHES, "root"), PAM_AUTHINFO_UNAVAIL);
    assert_int_equal(log_in_as_nobody(PUPPET_MATCHES, "ada"), PAM_AUTHINFO_UNAVAIL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_verdict_of_the_daemon_counts),
        cmocka_unit_test(a_verdict_of_another_client_does_not_count),
        cmocka_unit_test(a_verdict_before_the_call_was_accepted_does_not_count),
        cmocka_unit_test(hints_are_told_once),
        cmocka_unit_test(a_daemon_that_leaves_ends_the_login),
        cmocka_unit_test(a_daemon_that_does_not_answer_is_not_waited_for),
        cmocka_unit_test(another_client_is_waited_for_a_while),
        cmocka_unit_test(a_refusal_is_logged),
        cmocka_unit_test(without_a_daemon_the_module_steps_aside),
        cmocka_unit_test(a_bus_that_hangs_is_not_waited_for),
        cmocka_unit_test(the_environment_names_no_bus),
        cmocka_unit_test(a_user_is_verified_as_himself_alone),
    };
    return pam_rig_is_root() && private_bus_start(&bus)
               ? cmocka_run_group_tests(tests, setup, teardown)
               : TEST_SKIPPED;
}

/* Logins by face with the real daemon, which reads stored frames. The tests check who gets in, who
 * does not get in, and when the camera is not used at all. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <grp.h>
#include <security/pam_appl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/e2e/appliance.h"
#include "tests/enroll/pam/pam_rig.h"
#include "tests/support/child_end.h"
#include "tests/support/scratch.h"

enum { NOBODY_UID = 65534 };

static struct pam_rig rig;

/* A lock-out would end the tests of strangers and photographs after a few. */
static const char desk_keys[] = "[lockout]\nfailures = 0\nattacks = 0\n[login]\ndesk = %s\n"
                                "users = %s\n";

static void configure(struct appliance *appliance, bool desk)
{
    static char keys[512];
    (void)snprintf(keys, sizeof keys, desk_keys, desk ? "yes" : "no", rig.users);
    appliance_end_daemon(appliance, SIGTERM);
    appliance->keys = keys;
    appliance_configure(appliance);
    appliance_start_daemon(appliance);
}

static int setup(void **state)
{
    (void)appliance_setup(state);
    struct appliance *appliance = *state;
    assert_int_equal(chmod(appliance->bus.directory, 0755), 0);
    pam_rig_init(&rig, appliance->bus.address);
    pam_rig_write_users(&rig, "ada p01\nroot p01\nbob p02\ncarl zoe\nnobody p01\n");
    configure(appliance, true);
    appliance_expect(appliance_run(appliance, "enroll --quick p01", "p01-enrol"), 0);
    appliance_expect(appliance_run(appliance, "enroll --quick p02", "p02-enrol"), 0);
    return 0;
}

static int teardown(void **state)
{
    pam_rig_done(&rig);
    return appliance_teardown(state);
}

/* ---- who comes before the camera ---- */

struct visitor {
    struct appliance *appliance;
    const char *recording;
};

static void comes(void *context)
{
    const struct visitor *visitor = context;
    appliance_show(visitor->appliance, visitor->recording);
}

/* Logs a user in. The visitor comes when the camera looks; NULL: nobody comes. */
static void log_in(struct appliance *appliance, struct pam_login *login, const char *recording)
{
    struct visitor visitor = {appliance, recording};
    if (recording) {
        login->on_look = comes;
        login->context = &visitor;
    }
    pam_rig_log_in(&rig, login);
    appliance_show(appliance, NULL);
}

/* ---- the verdicts ---- */

static void the_person_gets_in_as_his_or_her_user(void **state)
{
    struct pam_login ada = {.user = "ada"}, bob = {.user = "bob"};
    log_in(*state, &ada, "p01-v1");
    pam_rig_expect(&ada, PAM_SUCCESS);
    assert_string_equal(ada.logged, "");
    log_in(*state, &bob, "p02-v1");
    pam_rig_expect(&bob, PAM_SUCCESS);
}

static void nobody_else_gets_in(void **state)
{
    static const char *const others[] = {"x01-v1", "p02-v1"}; /* a stranger, and another user */
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        struct pam_login login = {.user = "ada"};
        log_in(*state, &login, others[i]);
        pam_rig_expect(&login, PAM_AUTH_ERR);
        assert_string_equal(login.logged, "the result is no-match\n");
        assert_non_null(strstr(login.told, "Your face was not recognised.; "));
    }
}

static void a_photograph_does_not_get_in(void **state)
{
    struct pam_login login = {.user = "ada"};
    log_in(*state, &login, "none-photo1");
    pam_rig_expect(&login, PAM_AUTH_ERR);
    assert_string_equal(login.logged, "the result is attack\n");
}

static void nobody_comes(void **state)
{
    struct pam_login login = {.user = "ada", .arguments = "timeout=1"};
    log_in(*state, &login, NULL);
    pam_rig_expect(&login, PAM_AUTHINFO_UNAVAIL);
    assert_true(login.looked);
    assert_string_equal(login.told, "Look at the camera.; No face was recognised.; ");
    log_in(*state, &login, "none-nobody1");
    pam_rig_expect(&login, PAM_AUTHINFO_UNAVAIL);
}

static void who_is_not_enrolled_is_asked_for_the_password(void **state)
{
    struct pam_login carl = {.user = "carl"}, eve = {.user = "eve"};
    log_in(*state, &carl, NULL);
    pam_rig_expect(&carl, PAM_AUTHINFO_UNAVAIL);
    assert_false(carl.looked);
    assert_string_equal(carl.logged, "isothermd refuses: zoe: no such person\n");
    log_in(*state, &eve, NULL);
    pam_rig_expect(&eve, PAM_AUTHINFO_UNAVAIL);
    assert_non_null(strstr(eve.logged, "no person belongs to this user"));
}

/* ---- where, and with what intent ---- */

static void a_remote_login_does_not_look(void **state)
{
    struct pam_login logins[] = {
        {.user = "ada", .rhost = "192.0.2.7"},
        {.user = "ada", .service = "sshd"},
        {.user = "ada", .tty = "ssh"},
        {.user = "ada", .remote_session = true},
        {.user = "ada", .service = "sudo", .answer = "", .remote_session = true},
    };
    for (size_t i = 0; i < sizeof logins / sizeof *logins; i++) {
        log_in(*state, &logins[i], NULL);
        pam_rig_expect(&logins[i], PAM_AUTHINFO_UNAVAIL);
        assert_false(logins[i].looked);
        assert_int_equal(logins[i].questions, 0);
        assert_non_null(strstr(logins[i].logged, "so no face before this one counts"));
    }
}

static void without_enter_the_camera_does_not_look(void **state)
{
    struct pam_login login = {.user = "ada", .service = "sudo", .answer = ""};
    log_in(*state, &login, "p01-v1");
    pam_rig_expect(&login, PAM_SUCCESS);
    assert_int_equal(login.questions, 1);
    login.answer = NULL; /* nobody can be asked */
    log_in(*state, &login, NULL);
    pam_rig_expect(&login, PAM_AUTHINFO_UNAVAIL);
    assert_false(login.looked);
    assert_int_equal(login.questions, 1);
    login.arguments = "ask=none";
    log_in(*state, &login, "p01-v1");
    pam_rig_expect(&login, PAM_SUCCESS);
    assert_int_equal(login.questions, 0);
}

/* What the person types in place of Enter is for the next module, which reads it as the password.
 */
static void a_typed_password_goes_to_the_next_module(void **state)
{
    char *script = strdup(scratch_path(rig.directory, "read_password"));
    const char *seen = scratch_path(rig.directory, "seen");
    char text[256], next[256];
    (void)snprintf(text, sizeof text, "#!/bin/sh\nexec cat >%s\n", seen);
    scratch_write_text(script, text);
    assert_int_equal(chmod(script, 0755), 0);
    (void)snprintf(next, sizeof next, "auth optional pam_exec.so expose_authtok quiet %s\n",
                   script);
    struct pam_login login = {
        .user = "ada", .service = "su", .answer = "open sesame", .next = next};
    log_in(*state, &login, NULL);
    pam_rig_expect(&login, PAM_AUTHINFO_UNAVAIL);
    assert_false(login.looked);
    assert_string_equal(login.logged, "");
    char *typed = scratch_read_text(seen);
    assert_string_equal(typed, "open sesame");
    free(typed);
    free(script);
}

/* ---- the file of the users ---- */

static void expect_file_fault(struct appliance *appliance, const char *says)
{
    struct pam_login login = {.user = "ada"};
    log_in(appliance, &login, NULL);
    pam_rig_expect(&login, PAM_AUTHINFO_UNAVAIL);
    assert_false(login.looked);
    if (!strstr(login.logged, says)) {
        fail_msg("logged: %s, not: %s", login.logged, says);
    }
}

static void a_file_of_users_that_others_can_change_is_refused(void **state)
{
    char *text = scratch_read_text(rig.users);
    char other[160];
    assert_int_equal(chown(rig.users, NOBODY_UID, 0), 0);
    expect_file_fault(*state, "belongs to user 65534, not to user 0");
    assert_int_equal(chown(rig.users, 0, 0), 0);
    assert_int_equal(chmod(rig.users, 0664), 0);
    expect_file_fault(*state, "others than its owner may write it");
    (void)snprintf(other, sizeof other, "%s.other", rig.users);
    assert_int_equal(chmod(rig.users, 0644), 0);
    assert_int_equal(rename(rig.users, other), 0);
    expect_file_fault(*state, "No such file");
    assert_int_equal(symlink(other, rig.users), 0);
    expect_file_fault(*state, "is a symbolic link, not a file");
    pam_rig_write_users(&rig, "ada p01\nbob\n");
    expect_file_fault(*state, "users:2: not `USER PERSON`");
    pam_rig_write_users(&rig, text);
    free(text);
}

static void wrong_arguments_let_nobody_in(void **state)
{
    static const char *const wrong[] = {"timeout=0", "nonsense", "bus=unix:path=/run/x", "ask="};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        struct pam_login login = {.user = "ada", .arguments = wrong[i]};
        log_in(*state, &login, NULL);
        pam_rig_expect(&login, PAM_AUTHINFO_UNAVAIL);
        assert_false(login.looked);
        assert_non_null(strstr(login.logged, "argument "));
    }
}

/* ---- the daemon ---- */

static void kill_daemon(void *context)
{
    (void)kill(((struct appliance *)context)->daemon.pid, SIGKILL);
}

static void the_daemon_is_killed_in_the_wait(void **state)
{
    struct appliance *appliance = *state;
    struct pam_login login = {
        .user = "ada", .arguments = "timeout=60", .on_look = kill_daemon, .context = appliance};
    pam_rig_log_in(&rig, &login);
    pam_rig_expect(&login, PAM_AUTHINFO_UNAVAIL);
    assert_true(login.looked);
    run_finish(&appliance->daemon);
    log_in(appliance, &login, NULL);
    pam_rig_expect(&login, PAM_AUTHINFO_UNAVAIL);
    assert_string_equal(login.logged, "isothermd is not running\n");
    appliance_start_daemon(appliance);
    login.arguments = NULL;
    log_in(appliance, &login, "p01-v1");
    pam_rig_expect(&login, PAM_SUCCESS);
}

static void a_lockdown_is_for_logins_too(void **state)
{
    struct pam_login login = {.user = "ada"};
    appliance_expect(appliance_run(*state, "lockdown on", NULL), 0);
    log_in(*state, &login, NULL);
    pam_rig_expect(&login, PAM_AUTHINFO_UNAVAIL);
    assert_false(login.looked);
    appliance_expect(appliance_run(*state, "lockdown off", NULL), 0);
}

static void a_door_gives_no_login_its_camera(void **state)
{
    struct pam_login login = {.user = "ada"};
    configure(*state, false);
    log_in(*state, &login, NULL);
    pam_rig_expect(&login, PAM_AUTHINFO_UNAVAIL);
    assert_false(login.looked);
    assert_non_null(strstr(login.logged, "guards a door and serves no logins"));
    configure(*state, true);
}

/* ---- two logins at once, and a user ---- */

static void say_that_it_looks(void *context)
{
    assert_int_equal(write(*(int *)context, "l", 1), 1);
}

/* Begins a login of bob in a process of its own, and waits until it has the camera. */
static void begin_other_login(struct child *child, const char *arguments)
{
    int looks[2];
    char byte;
    assert_int_equal(pipe(looks), 0);
    if (child_fork(child, "another login") == 0) {
        struct pam_login bob = {.user = "bob",
                                .service = "other-login",
                                .arguments = arguments,
                                .on_look = say_that_it_looks,
                                .context = &looks[1]};
        pam_rig_log_in(&rig, &bob);
        _exit(bob.result);
    }
    (void)close(looks[1]);
    assert_int_equal(read(looks[0], &byte, 1), 1);
    (void)close(looks[0]);
}

static void the_second_of_two_logins_waits_for_a_while(void **state)
{
    struct pam_login login = {.user = "ada"};
    struct child other;
    begin_other_login(&other, "timeout=2");
    log_in(*state, &login, "p01-v1");
    pam_rig_expect(&login, PAM_SUCCESS);
    child_expect(&other, PAM_AUTHINFO_UNAVAIL);
    begin_other_login(&other, "timeout=14");
    log_in(*state, &login, NULL);
    pam_rig_expect(&login, PAM_AUTHINFO_UNAVAIL);
    assert_false(login.looked);
    assert_non_null(strstr(login.logged, "another client has the camera"));
    assert_int_equal(kill(other.pid, SIGKILL), 0);
    child_expect(&other, 1000 + SIGKILL);
}

/* Logs a user in, in a process of the user nobody, as a screen locker does. */
static int log_in_as_nobody(struct appliance *appliance, const char *user, const char *recording)
{
    const gid_t group = NOBODY_UID;
    struct child child;
    char err[CHILD_ERR_SIZE];
    int looks[2];
    char byte;
    assert_int_equal(pipe(looks), 0);
    if (child_fork(&child, "a screen locker") == 0) {
        struct pam_login login = {.user = user, .on_look = say_that_it_looks, .context = &looks[1]};
        if (setgroups(1, &group) || setgid(NOBODY_UID) || setuid(NOBODY_UID)) {
            _exit(100);
        }
        pam_rig_log_in(&rig, &login);
        _exit(login.result);
    }
    (void)close(looks[1]);
    if (read(looks[0], &byte, 1) == 1) {
        appliance_show(appliance, recording);
    }
    (void)close(looks[0]);
    const int result = child_wait(&child, err);
    appliance_show(appliance, NULL);
    return result;
}

/* The service file of the child is that of the last login of root. */
static void a_screen_locker_verifies_its_user_alone(void **state)
{
    struct pam_login login = {.user = "ada"};
    log_in(*state, &login, "p01-v1");
    pam_rig_expect(&login, PAM_SUCCESS);
    assert_int_equal(log_in_as_nobody(*state, "nobody", "p01-v2"), PAM_SUCCESS);
    assert_int_equal(log_in_as_nobody(*state, "nobody", "p02-v1"), PAM_AUTH_ERR);
    assert_int_equal(log_in_as_nobody(*state, "bob", "p02-v1"), PAM_AUTHINFO_UNAVAIL);
    assert_int_equal(log_in_as_nobody(*state, "root", "p01-v2"), PAM_AUTHINFO_UNAVAIL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_person_gets_in_as_his_or_her_user),
        cmocka_unit_test(nobody_else_gets_in),
        cmocka_unit_test(a_photograph_does_not_get_in),
        cmocka_unit_test(nobody_comes),
        cmocka_unit_test(who_is_not_enrolled_is_asked_for_the_password),
        cmocka_unit_test(a_remote_login_does_not_look),
        cmocka_unit_test(without_enter_the_camera_does_not_look),
        cmocka_unit_test(a_typed_password_goes_to_the_next_module),
        cmocka_unit_test(a_file_of_users_that_others_can_change_is_refused),
        cmocka_unit_test(wrong_arguments_let_nobody_in),
        cmocka_unit_test(the_daemon_is_killed_in_the_wait),
        cmocka_unit_test(a_lockdown_is_for_logins_too),
        cmocka_unit_test(a_door_gives_no_login_its_camera),
        cmocka_unit_test(the_second_of_two_logins_waits_for_a_while),
        cmocka_unit_test(a_screen_locker_verifies_its_user_alone),
    };
    return pam_rig_is_root() && appliance_find() ? cmocka_run_group_tests(tests, setup, teardown)
                                                 : TEST_SKIPPED;
}

#include "tests/enroll/pam/pam_rig.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <security/pam_appl.h>
#include <security/pam_ext.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <systemd/sd-login.h>
#include <unistd.h>

#include "tests/support/scratch.h"

#define MODULE ISOTHERM_BINARY_DIR "/enroll/pam/pam_isotherm.so"

static struct pam_login *current;

/* ---- what the module calls in place of the functions of libpam and libsystemd ---- */

static void append(char *text, size_t size, const char *more, const char *end)
{
    const size_t used = strlen(text);
    (void)snprintf(text + used, size - used, "%s%s", more, end);
}

void pam_syslog(const pam_handle_t *pam, int priority, const char *format, ...)
{
    char line[512];
    va_list arguments;
    (void)pam;
    (void)priority;
    va_start(arguments, format);
    (void)vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    append(current->logged, sizeof current->logged, line, "\n");
}

int sd_pid_get_session(pid_t pid, char **session)
{
    (void)pid;
    *session = strdup("c1");
    return 0;
}

int sd_session_is_remote(const char *session)
{
    return strcmp(session, "c1") == 0 && current->remote_session;
}

/* ---- the person ---- */

static int answer(struct pam_login *login, const struct pam_message *message,
                  struct pam_response *response)
{
    if (message->msg_style == PAM_PROMPT_ECHO_OFF) {
        login->questions++;
        response->resp = login->answer ? strdup(login->answer) : NULL;
        return login->answer ? PAM_SUCCESS : PAM_CONV_ERR;
    }
    append(login->told, sizeof login->told, message->msg, "; ");
    if (strcmp(message->msg, "Look at the camera.") == 0) {
        login->looked = true;
        if (login->on_look) {
            login->on_look(login->context);
        }
    }
    return PAM_SUCCESS;
}

static int converse(int n, const struct pam_message **messages, struct pam_response **responses,
                    void *context)
{
    struct pam_response *made = calloc((size_t)n, sizeof *made);
    int r = made ? PAM_SUCCESS : PAM_BUF_ERR;
    for (int i = 0; r == PAM_SUCCESS && i < n; i++) {
        r = answer(context, messages[i], &made[i]);
    }
    if (r != PAM_SUCCESS) {
        free(made);
        return r;
    }
    *responses = made;
    return PAM_SUCCESS;
}

/* ---- the rig ---- */

void pam_rig_init(struct pam_rig *rig, const char *bus)
{
    size_t size;
    (void)snprintf(rig->directory, sizeof rig->directory, "/tmp/isotherm-pam-XXXXXX");
    assert_non_null(mkdtemp(rig->directory));
    assert_int_equal(chmod(rig->directory, 0755), 0);
    (void)snprintf(rig->bus, sizeof rig->bus, "%s", bus);
    (void)snprintf(rig->users, sizeof rig->users, "%s/users", rig->directory);
    void *module = scratch_read(MODULE, &size);
    const char *copy = scratch_path(rig->directory, "pam_isotherm.so");
    scratch_write(copy, module, size);
    assert_int_equal(chmod(copy, 0755), 0);
    free(module);
    /* PAM complains if there is no such file. */
    scratch_write_text(scratch_path(rig->directory, "other"), "auth required pam_deny.so\n");
}

void pam_rig_done(struct pam_rig *rig)
{
    void *directory = strdup(rig->directory);
    assert_int_equal(scratch_teardown(&directory), 0);
}

void pam_rig_write_users(const struct pam_rig *rig, const char *text)
{
    (void)unlink(rig->users);
    scratch_write_text(rig->users, text);
    assert_int_equal(chmod(rig->users, 0644), 0);
}

static void write_service(const struct pam_rig *rig, const struct pam_login *login,
                          const char *service)
{
    char text[1024];
    (void)snprintf(text, sizeof text, "auth required %s/pam_isotherm.so %s%s users=%s %s\n%s",
                   rig->directory, rig->bus[0] ? "bus=" : "", rig->bus, rig->users,
                   login->arguments ? login->arguments : "timeout=10",
                   login->next ? login->next : "");
    const char *path = scratch_path(rig->directory, service);
    scratch_write_text(path, text);
    assert_int_equal(chmod(path, 0644), 0);
}

void pam_rig_log_in(const struct pam_rig *rig, struct pam_login *login)
{
    const char *service = login->service ? login->service : "login";
    const struct pam_conv conversation = {converse, login};
    pam_handle_t *pam = NULL;
    current = login;
    login->result = -1;
    login->questions = 0;
    login->looked = false;
    login->told[0] = login->logged[0] = '\0';
    if (geteuid() == 0) {
        write_service(rig, login, service);
    }
    assert_int_equal(pam_start_confdir(service, login->user, &conversation, rig->directory, &pam),
                     PAM_SUCCESS);
    assert_int_equal(pam_set_item(pam, PAM_RHOST, login->rhost), PAM_SUCCESS);
    assert_int_equal(pam_set_item(pam, PAM_TTY, login->tty), PAM_SUCCESS);
    login->result = pam_authenticate(pam, 0);
    if (login->result == PAM_SUCCESS) {
        assert_int_equal(pam_setcred(pam, PAM_ESTABLISH_CRED), PAM_SUCCESS);
    }
    assert_int_equal(pam_end(pam, login->result), PAM_SUCCESS);
}

void pam_rig_expect(const struct pam_login *login, int result)
{
    if (login->result != result) {
        fail_msg("the login ends with %d (%s), not %d (%s); told: %s logged: %s", login->result,
                 pam_strerror(NULL, login->result), result, pam_strerror(NULL, result), login->told,
                 login->logged);
    }
}

bool pam_rig_is_root(void)
{
    if (geteuid() != 0) {
        print_message("skipped: the file of the users must belong to root, and this is not root\n");
        return false;
    }
    return true;
}

/* The PAM module pam_isotherm.so: authentication by the face before the camera of this machine
 * (pam_isotherm(8)). It lets a user in for the verdict of the daemon alone, refuses a face that is
 * somebody else's, and steps aside for the next module in every other case. */
#include <security/pam_ext.h>
#include <security/pam_modules.h>
#include <security/pam_modutil.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <syslog.h>
#include <unistd.h>

#include "enroll/cli/text/hint_text.h"
#include "enroll/pam/arguments.h"
#include "enroll/pam/place.h"
#include "enroll/pam/verify.h"
#include "firmware/contract/login_users.h"

/* One call of pam_sm_authenticate. */
struct login {
    pam_handle_t *pam;
    bool silent; /* nothing is told */
    bool began;  /* the camera has looked */
    char last_hint[32];
};

static int step_aside(const struct login *login, const struct iso_fault *fault)
{
    pam_syslog(login->pam, LOG_NOTICE, "%s", fault->text);
    return PAM_AUTHINFO_UNAVAIL;
}

static const char *text_item(const struct login *login, int item)
{
    const void *text = NULL;
    return pam_get_item(login->pam, item, &text) == PAM_SUCCESS ? text : NULL;
}

static void tell(const struct login *login, const char *text)
{
    if (!login->silent) {
        (void)pam_info(login->pam, "%s", text);
    }
}

static void on_begin(void *context)
{
    struct login *login = context;
    login->began = true;
    tell(login, "Look at the camera.");
}

/* The daemon repeats a hint that is still valid; a person reads it once. */
static void on_hint(void *context, const char *word)
{
    struct login *login = context;
    const char *text = cli_hint_text(word);
    if (text && strcmp(login->last_hint, word) != 0) {
        (void)snprintf(login->last_hint, sizeof login->last_hint, "%s", word);
        tell(login, text);
    }
}

/* ---- the intent ---- */

/* Asks for Enter. PAM_SUCCESS: the person wants the camera to look. What he or she types instead is
 * a password, which the next module takes (try_first_pass). */
static int ask_for_enter(const struct login *login)
{
    struct iso_fault fault;
    char *typed = NULL;
    int r = pam_prompt(login->pam, PAM_PROMPT_ECHO_OFF, &typed, "%s",
                       "Press Enter to look into the camera, or type the password: ");
    if (r != PAM_SUCCESS || !typed) {
        (void)iso_fault_set(&fault, -1, "nobody can be asked for Enter, so the camera stays off");
        r = step_aside(login, &fault);
    } else if (*typed) {
        (void)pam_set_item(login->pam, PAM_AUTHTOK, typed);
        r = PAM_AUTHINFO_UNAVAIL;
    }
    if (typed) {
        explicit_bzero(typed, strlen(typed));
        free(typed);
    }
    return r;
}

/* ---- the user ---- */

/* Fills in for whom to ask. Root asks for the person of any user, every other user, such as a
 * screen locker, only for himself or herself. PAM_SUCCESS, or what the module returns. */
static int find_person(const struct login *login, const struct login_arguments *arguments,
                       const char *user, char person[ISO_PERSON_NAME_SIZE],
                       struct login_request *request)
{
    struct iso_fault fault;
    if (geteuid() == 0) {
        request->person = person;
        return iso_login_users_find(arguments->users, 0, user, person, &fault)
                   ? step_aside(login, &fault)
                   : PAM_SUCCESS;
    }
    const struct passwd *row = pam_modutil_getpwnam(login->pam, user);
    if (!row || row->pw_uid != getuid() || row->pw_uid != geteuid()) {
        (void)iso_fault_set(&fault, -1, "only root may log in another user");
        return step_aside(login, &fault);
    }
    request->user = row->pw_uid;
    return PAM_SUCCESS;
}

static int look(struct login *login, const struct login_request *request)
{
    struct iso_fault fault = {.text = ""};
    switch (login_verify(request, &fault)) {
    case LOGIN_MATCH:
        return PAM_SUCCESS;
    case LOGIN_REFUSED:
        pam_syslog(login->pam, LOG_NOTICE, "%s", fault.text);
        tell(login, "Your face was not recognised.");
        return PAM_AUTH_ERR;
    default:
        if (login->began) {
            tell(login, "No face was recognised.");
        }
        return step_aside(login, &fault);
    }
}

/* ---- what PAM calls ---- */

PAM_EXTERN int pam_sm_authenticate(pam_handle_t *pamh, int flags, int argc, const char **argv)
{
    struct login login = {.pam = pamh, .silent = ((unsigned)flags & PAM_SILENT) != 0};
    const char *user = NULL, *service = text_item(&login, PAM_SERVICE);
    struct login_arguments arguments;
    struct iso_fault fault;
    char person[ISO_PERSON_NAME_SIZE];
    if (login_arguments_read(argc, argv, ISOTHERM_LOGIN_USERS, &arguments, &fault)) {
        return step_aside(&login, &fault);
    }
    const struct login_place place = {.service = service,
                                      .rhost = text_item(&login, PAM_RHOST),
                                      .tty = text_item(&login, PAM_TTY),
                                      .remote_session = login_place_in_remote_session()};
    const char *remote = login_place_remote(&place);
    if (remote) {
        (void)iso_fault_set(&fault, -1, "%s, so no face before this one counts", remote);
        return step_aside(&login, &fault);
    }
    int r = pam_get_user(pamh, &user, NULL);
    if (r != PAM_SUCCESS || !user || !*user) {
        return r == PAM_SUCCESS ? PAM_USER_UNKNOWN : r;
    }
    struct login_request request = {.bus = arguments.bus,
                                    .timeout_s = arguments.timeout_s,
                                    .began = on_begin,
                                    .hint = on_hint,
                                    .context = &login};
    r = find_person(&login, &arguments, user, person, &request);
    if (r == PAM_SUCCESS && login_arguments_ask(&arguments, service)) {
        r = ask_for_enter(&login);
    }
    return r == PAM_SUCCESS ? look(&login, &request) : r;
}

/* There are no credentials to set. PAM asks each module that has let a user in. */
PAM_EXTERN int pam_sm_setcred(pam_handle_t *pamh, int flags, int argc, const char **argv)
{
    (void)pamh;
    (void)flags;
    (void)argc;
    (void)argv;
    return PAM_SUCCESS;
}

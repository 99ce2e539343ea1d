/* Who may use a web server: logins, sessions and accounts, as routes of its API. The routes are the
 * same for every server of the project; what an account does is put on record by the server's own
 * recorder. */
#ifndef WEB_LOGIN_LOGIN_H
#define WEB_LOGIN_LOGIN_H

#include "enroll/web/account/account.h"
#include "enroll/web/account/guess.h"
#include "enroll/web/http/route.h"
#include "enroll/web/http/server.h"
#include "enroll/web/session/note_limit.h"
#include "enroll/web/session/session.h"

struct web_turns; /* enroll/web/login/turns.h: requests with a password */

/* Why something cannot be done, as it is answered. */
struct web_problem {
    unsigned status;
    const char *code, *detail;
};

/* Where acts are put on record. */
struct web_recorder {
    const char *program; /* for lines on stderr: "isotherm-web" */
    /* Puts on record that an account does `act` to `concerned` (an account, a person or ""), and
     * then calls `done` once, with NULL if it is on record. `done` is not called before this
     * function has returned, except if there is no memory. The texts are copied. */
    void (*record)(void *recorder, const char *account, const char *act, const char *concerned,
                   void (*done)(void *context, const struct web_problem *problem), void *context);
    /* What is answered to a login while there is too much to record; NULL: nothing hinders it. */
    const struct web_problem *(*hindrance)(void *recorder);
};

/* The context of the handlers below. A server whose handlers have another context puts this at the
 * beginning of it. */
struct web_login {
    struct web_accounts *accounts;
    struct web_sessions *sessions;
    struct web_guess *guess;
    struct web_note_limit notes; /* of logins and logouts */
    const char *setup_code;      /* the file of the one-time code */
    struct web_turns *turns;
    struct web_server *server; /* NULL until it runs */
    const struct web_recorder *recorder;
    void *recorder_context;
};

/* ---- sessions (session_routes.c) ---- */
void web_login_get_session(void *login, struct web_exchange *exchange);
void web_login_log_in(void *login, struct web_exchange *exchange);
void web_login_log_out(void *login, struct web_exchange *exchange);
void web_login_set_own_password(void *login, struct web_exchange *exchange);
void web_login_set_up(void *login, struct web_exchange *exchange);

/* ---- accounts (account_routes.c) ---- */
void web_login_list_accounts(void *login, struct web_exchange *exchange);
void web_login_add_account(void *login, struct web_exchange *exchange);
void web_login_change_account(void *login, struct web_exchange *exchange);
void web_login_remove_account(void *login, struct web_exchange *exchange);

/* Whether the session of the exchange goes on. Returns false after answering 401 "login-required".
 * Asked after an act was put on record and before it is done: meanwhile the account may have been
 * removed, or have got another role. */
bool web_login_goes_on(const struct web_login *login, struct web_exchange *exchange);

#endif

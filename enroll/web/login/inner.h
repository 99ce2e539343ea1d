/* What the handlers of sessions and accounts share. Internal to enroll/web/login.
 *
 * A change is put on record before it is made. Between the two the event loop goes on, so
 * everything that the change depends on is looked at again. */
#ifndef WEB_LOGIN_INNER_H
#define WEB_LOGIN_INNER_H

#include "enroll/web/login/login.h"

/* The date, in seconds since 1970. */
int64_t web__login_now_s(void);

/* Puts on record that the account of the exchange does `act` to `concerned` (an account or "");
 * then calls `go`, which answers. If there is no record, or if the session has ended meanwhile, the
 * exchange is answered with a problem and `go` is not called. */
void web__login_act(struct web_login *login, struct web_exchange *exchange, const char *act,
                    const char *concerned,
                    void (*go)(struct web_login *login, struct web_exchange *exchange));

/* The same for what must work also if nothing can be recorded: a failure is only reported on
 * stderr. A login or logout beyond the limit of note_limit.h is not recorded; the next one is
 * "login-after-17" after 17 of them. `act` lives as long as the program. */
void web__login_note(struct web_login *login, const char *account, const char *act);

/* Answers a fault of enroll/web/account as a problem. */
void web__login_account_problem(struct web_exchange *exchange, int error,
                                const struct iso_fault *fault);

/* Answers 429 and returns true if this account may not be tried from this address yet. */
bool web__login_must_wait(struct web_login *login, struct web_exchange *exchange,
                          const char *account);

/* Ends the streams of sessions that have ended. */
void web__login_end_streams(struct web_login *login);

/* {"account": ..., "role": ...} of a session, {"name": ..., "role": ...} of an account. */
json_t *web__login_session_json(const char *account, enum web_role role);
json_t *web__login_account_json(const struct web_account *account);

#endif

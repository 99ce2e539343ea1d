/* Acts of an account, and what the handlers of accounts share. Internal to enroll/web/api.
 *
 * A change is put on record before it is made. Between the two, the daemon answers, so everything
 * that the change depends on is looked at again. */
#ifndef WEB_API_ACT_H
#define WEB_API_ACT_H

#include "enroll/web/api/api.h"

/* The date, in seconds since 1970. */
int64_t web__api_now_s(void);

/* Puts on record that the account of the exchange does `act` to `concerned` (an account, a person
 * or ""); then calls `go`, which answers. If there is no record, or if the session has ended
 * meanwhile, the exchange is answered with a problem and `go` is not called. `act` lives as long as
 * the program. */
void web__api_act(struct web_api *api, struct web_exchange *exchange, const char *act,
                  const char *concerned,
                  void (*go)(struct web_api *api, struct web_exchange *exchange));

/* The same for what must work without the daemon: a failure is only reported on stderr. A login or
 * logout beyond the limit of note_limit.h is not recorded; the next one is "login-after-17" after
 * 17 of them. `act` lives as long as the program. */
void web__api_note(struct web_api *api, const char *account, const char *act);

/* Answers a fault of enroll/web/account as a problem. */
void web__api_account_problem(struct web_exchange *exchange, int error,
                              const struct iso_fault *fault);

/* Answers 429 and returns true if this account may not be tried from this address yet. */
bool web__api_must_wait(struct web_api *api, struct web_exchange *exchange, const char *account);

/* Ends the streams of sessions that have ended. */
void web__api_end_streams(struct web_api *api);

/* {"account": ..., "role": ...} of a session, {"name": ..., "role": ...} of an account. */
json_t *web__api_session_json(const char *account, enum web_role role);
json_t *web__api_account_json(const struct web_account *account);

#endif

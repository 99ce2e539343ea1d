/* Acts of an account, which the daemon puts on record before they are done. Internal to
 * enroll/web/api.
 *
 * Between the two the daemon answers, so everything that a change depends on is looked at again. */
#ifndef WEB_API_ACT_H
#define WEB_API_ACT_H

#include "enroll/web/api/api.h"

/* Puts on record that the account of the exchange does `act` to `concerned` (a person or ""); then
 * calls `go`, which answers. If there is no record, or if the session has ended meanwhile, the
 * exchange is answered with a problem and `go` is not called. `act` lives as long as the program.
 */
void web__api_act(struct web_api *api, struct web_exchange *exchange, const char *act,
                  const char *concerned,
                  void (*go)(struct web_api *api, struct web_exchange *exchange));

/* An error of the daemon as a problem: what web_api_daemon_problem() answers. Its texts live as
 * long as the error. */
struct web_problem web__api_problem_of(const sd_bus_error *error);

#endif

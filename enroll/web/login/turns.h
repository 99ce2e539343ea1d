/* Requests that check or make a password, one after the other. The hash of a password takes about a
 * tenth of a second on the only thread. Between two of them the event loop goes on with everything
 * else: answers of the daemon, streams, and other requests. Internal to enroll/web/login and to the
 * programs. */
#ifndef WEB_LOGIN_TURNS_H
#define WEB_LOGIN_TURNS_H

#include <systemd/sd-event.h>

#include "enroll/web/login/login.h"

struct web_turns;

/* `login` has to live longer. -ENOMEM, or an errno of sd-event. */
int web_turns_new(sd_event *event, struct web_login *login, struct web_turns **out)
    __attribute__((warn_unused_result));

/* Answers all that wait with 503 "busy", and ends. Called before the server is freed. NULL is
 * accepted. */
void web_turns_free(struct web_turns *turns);

/* Calls `go` when it is the turn of this exchange, not before web_turns_wait() has returned; `go`
 * answers. Without memory the exchange is answered here. There are no more turns than connections:
 * one that waits for its answer makes no other request. */
void web_turns_wait(struct web_turns *turns, struct web_exchange *exchange,
                    void (*go)(struct web_login *login, struct web_exchange *exchange));

#endif

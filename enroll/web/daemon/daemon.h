/* The web server's connection to isothermd. It never gives up: a bus or a daemon that is gone is
 * tried again every second. No call blocks; every call is answered by its callback, also when the
 * daemon is gone. One thread. */
#ifndef WEB_DAEMON_DAEMON_H
#define WEB_DAEMON_DAEMON_H

#include <jansson.h>
#include <stdbool.h>
#include <systemd/sd-bus.h>
#include <systemd/sd-event.h>

#include "enroll/web/calls/call_queue.h"

struct web_daemon;

/* Makes a connection on an event loop. `address` is "system", "session" or a D-Bus address.
 * -ENOMEM, or an errno of sd-event. */
int web_daemon_new(sd_event *event, const char *address, struct web_daemon **out)
    __attribute__((warn_unused_result));

/* Answers all calls that wait, and ends the connection for good. The program calls it before it
 * frees the server, because exchanges wait for calls; then it frees the feed, the enrolment and the
 * other listeners, and last the connection. */
void web_daemon_close(struct web_daemon *daemon);

/* The same, and frees the connection. NULL is accepted. */
void web_daemon_free(struct web_daemon *daemon);

/* Somebody who listens to the daemon. It belongs to the caller. */
struct web_daemon_listener {
    /* Called each second with the reply of GetStatus as a JSON object, and with NULL when the
     * daemon is gone or does not answer. NULL is accepted. */
    void (*on_status)(void *context, const json_t *status);
    /* Called for each signal of the daemon, which is at its beginning. Signals of other clients of
     * the bus are not passed on. NULL is accepted. */
    void (*on_signal)(void *context, const char *member, sd_bus_message *signal);
    void *context;
    struct web_daemon_listener *next; /* for the connection */
};

/* Begins and ends listening. A listener must not end it while it is called. */
void web_daemon_listen(struct web_daemon *daemon, struct web_daemon_listener *listener);
void web_daemon_unlisten(struct web_daemon *daemon, struct web_daemon_listener *listener);

/* Whether the daemon answered the last time it was asked for its state. */
bool web_daemon_is_there(const struct web_daemon *daemon);

/* The answer of a call (call_queue.h). */
typedef web_call_reply_fn web_daemon_reply_fn;

/* Makes a call of a method of the contract, to which the caller appends arguments.
 * web_daemon_send() takes it over; NULL, after a failure, is accepted there. */
sd_bus_message *web_daemon_message(struct web_daemon *daemon, const char *method);

/* Sends the call. on_reply is called once, and not before web_daemon_send() has returned, except if
 * there is no memory for the call. A call waits while the daemon would refuse it as one too many;
 * calls that protect the door or belong to an enrolment go first. timeout_us: how long the daemon
 * may take; 0 for 10 s. */
void web_daemon_send(struct web_daemon *daemon, sd_bus_message *call, uint64_t timeout_us,
                     web_daemon_reply_fn on_reply, void *context);

/* The error with which calls are answered while there is no connection. */
extern const sd_bus_error web_daemon_is_gone;

/* How many calls wait because the daemon would refuse them. */
size_t web_daemon_waiting(const struct web_daemon *daemon);

/* Puts on record that an account does something (RecordAct), before it is done. `person` is the
 * person concerned or "". The caller acts in on_reply, and only if there is no error. */
void web_daemon_record(struct web_daemon *daemon, const char *account, const char *act,
                       const char *person, web_daemon_reply_fn on_reply, void *context);

#endif

/* The calls of the web server to the daemon, and the order in which they are sent. All who use the
 * web server are one client for the daemon, which answers a client only so many calls. So calls
 * beyond a somewhat smaller allowance wait. Urgent calls are sent before all others that wait: what
 * protects the door, and an enrolment before which a person stands, do not wait for those who read
 * lists. One thread. */
#ifndef WEB_CALLS_CALL_QUEUE_H
#define WEB_CALLS_CALL_QUEUE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <systemd/sd-bus.h>
#include <systemd/sd-event.h>

/* The answer of a call: `reply` has the values; or, after a failure, it is NULL and `error` has the
 * D-Bus name of the error and its text. Both are valid during the callback. */
typedef void (*web_call_reply_fn)(void *context, sd_bus_message *reply, const sd_bus_error *error);

struct web_call_queue;

/* Makes an empty queue. `gone`: the error with which calls are answered that cannot be sent; it has
 * to live longer. -ENOMEM, or an errno of sd-event. */
int web_call_queue_new(sd_event *event, const sd_bus_error *gone, struct web_call_queue **out)
    __attribute__((warn_unused_result));

/* Frees the queue, which has to be empty. NULL is accepted. */
void web_call_queue_free(struct web_call_queue *queue);

struct web_call_request {
    sd_bus_message *message; /* taken over; NULL: the call is answered with `gone` */
    uint64_t timeout_us;
    bool urgent;
    web_call_reply_fn on_reply;
    void *context;
};

/* Sends a call on the bus of its message, or lets it wait. on_reply is called once, and not before
 * this has returned, except if there is no memory for the call. */
void web_call_queue_send(struct web_call_queue *queue, const struct web_call_request *request);

/* How many calls wait because the daemon would refuse them. */
size_t web_call_queue_waiting(const struct web_call_queue *queue);

/* Gives up all calls, because the connection ends. They are answered by the next
 * web_call_queue_fail, or soon. */
void web_call_queue_drop(struct web_call_queue *queue);

/* Answers the calls that could not be sent, or were given up. */
void web_call_queue_fail(struct web_call_queue *queue);

/* Whether calls of this method are urgent, and records (RecordAct) of this act. */
bool web_call_is_urgent(const char *method);
bool web_act_is_urgent(const char *act);

#endif

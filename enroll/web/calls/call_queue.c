#include "enroll/web/calls/call_queue.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/queue.h>
#include <time.h>

#include "firmware/contract/contract.h"

/* The daemon answers a client 40 calls at once and 20 a second (firmware/bus/call_rate.h). */
static const double allowance_most = 30.0, allowance_per_s = 15.0;
static const uint64_t wait_us = 70000;

static const sd_bus_error no_memory = SD_BUS_ERROR_MAKE_CONST(SD_BUS_ERROR_NO_MEMORY,
                                                              "There is no memory for the call.");

struct web_call {
    TAILQ_ENTRY(web_call) link;
    struct web_call_queue *queue;
    /* Of a call that has been sent there is a slot, and of one that waits there is a message. One
     * that has neither could not be sent, and is answered with an error. */
    sd_bus_slot *slot;
    struct web_call_request request;
};

struct web_call_queue {
    const sd_bus_error *gone;
    sd_event_source *failing, *waiting;
    double allowance; /* calls that may be sent at allowance_ns */
    int64_t allowance_ns;
    TAILQ_HEAD(, web_call) calls;
};

/* ---- which calls go first ---- */

static bool is_among(const char *word, const char *const words[], size_t n)
{
    for (size_t i = 0; i < n; i++) {
        if (strcmp(word, words[i]) == 0) {
            return true;
        }
    }
    return false;
}

bool web_call_is_urgent(const char *method)
{
    static const char *const methods[] = {ISO_CONTRACT_SET_LOCKDOWN, ISO_CONTRACT_CLEAR_LOCKOUT,
                                          ISO_CONTRACT_CLAIM,        ISO_CONTRACT_RELEASE,
                                          ISO_CONTRACT_WATCH_RELIEF, ISO_CONTRACT_ENROLL_START,
                                          ISO_CONTRACT_ENROLL_STOP};
    return is_among(method, methods, sizeof methods / sizeof *methods);
}

bool web_act_is_urgent(const char *act)
{
    static const char *const acts[] = {"lockdown-on", "lockdown-off", "lockout-clear", "consent",
                                       "enroll"};
    return is_among(act, acts, sizeof acts / sizeof *acts);
}

/* ---- answers ---- */

static void answer(struct web_call *call, sd_bus_message *reply, const sd_bus_error *error)
{
    TAILQ_REMOVE(&call->queue->calls, call, link);
    call->request.on_reply(call->request.context, reply, error);
    sd_bus_slot_unref(call->slot);
    sd_bus_message_unref(call->request.message);
    free(call);
}

static int on_answer(sd_bus_message *reply, void *context, sd_bus_error *out)
{
    (void)out;
    if (sd_bus_message_is_method_error(reply, NULL)) {
        answer(context, NULL, sd_bus_message_get_error(reply));
    } else {
        answer(context, reply, NULL);
    }
    return 0;
}

void web_call_queue_fail(struct web_call_queue *queue)
{
    for (struct web_call *call = TAILQ_FIRST(&queue->calls), *next; call; call = next) {
        next = TAILQ_NEXT(call, link);
        if (!call->slot && !call->request.message) {
            answer(call, NULL, queue->gone);
            next = TAILQ_FIRST(&queue->calls); /* the callback may have answered others */
        }
    }
}

static int on_failing(sd_event_source *source, void *context)
{
    (void)source;
    web_call_queue_fail(context);
    return 0;
}

void web_call_queue_drop(struct web_call_queue *queue)
{
    struct web_call *call;
    TAILQ_FOREACH(call, &queue->calls, link)
    {
        call->slot = sd_bus_slot_unref(call->slot);
        call->request.message = sd_bus_message_unref(call->request.message);
    }
    (void)sd_event_source_set_enabled(queue->failing, SD_EVENT_ONESHOT);
}

/* ---- sending ---- */

static int64_t now_ns(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

/* Whether one more call may be sent now; such a call is counted. */
static bool take_allowance(struct web_call_queue *queue)
{
    const int64_t t_ns = now_ns();
    queue->allowance += allowance_per_s * (double)(t_ns - queue->allowance_ns) / 1e9;
    queue->allowance = queue->allowance < allowance_most ? queue->allowance : allowance_most;
    queue->allowance_ns = t_ns;
    if (queue->allowance < 1.0) {
        return false;
    }
    queue->allowance -= 1.0;
    return true;
}

/* Sends the calls that wait, in their order, as far as they may be sent. */
static void send_waiting(struct web_call_queue *queue)
{
    struct web_call *call;
    TAILQ_FOREACH(call, &queue->calls, link)
    {
        if (!call->request.message) {
            continue;
        }
        if (!take_allowance(queue)) {
            (void)sd_event_source_set_time_relative(queue->waiting, wait_us);
            (void)sd_event_source_set_enabled(queue->waiting, SD_EVENT_ONESHOT);
            return;
        }
        if (sd_bus_call_async(sd_bus_message_get_bus(call->request.message), &call->slot,
                              call->request.message, on_answer, call,
                              call->request.timeout_us) < 0) {
            call->slot = NULL;
            (void)sd_event_source_set_enabled(queue->failing, SD_EVENT_ONESHOT);
        }
        call->request.message = sd_bus_message_unref(call->request.message);
    }
}

static int on_waiting(sd_event_source *source, uint64_t usec, void *context)
{
    (void)source;
    (void)usec;
    send_waiting(context);
    return 0;
}

/* An urgent call stands before the first one that waits and is not urgent, behind those that are.
 */
static void insert(struct web_call_queue *queue, struct web_call *call)
{
    struct web_call *other;
    TAILQ_FOREACH(other, &queue->calls, link)
    {
        if (call->request.urgent && other->request.message && !other->request.urgent) {
            TAILQ_INSERT_BEFORE(other, call, link);
            return;
        }
    }
    TAILQ_INSERT_TAIL(&queue->calls, call, link);
}

void web_call_queue_send(struct web_call_queue *queue, const struct web_call_request *request)
{
    struct web_call *call = calloc(1, sizeof *call);
    if (!call) {
        sd_bus_message_unref(request->message);
        request->on_reply(request->context, NULL, &no_memory);
        return;
    }
    *call = (struct web_call){.queue = queue, .request = *request};
    insert(queue, call);
    if (request->message) {
        send_waiting(queue);
    } else {
        (void)sd_event_source_set_enabled(queue->failing, SD_EVENT_ONESHOT);
    }
}

size_t web_call_queue_waiting(const struct web_call_queue *queue)
{
    const struct web_call *call;
    size_t n = 0;
    TAILQ_FOREACH(call, &queue->calls, link)
    {
        n += call->request.message != NULL;
    }
    return n;
}

/* ---- begin and end ---- */

int web_call_queue_new(sd_event *event, const sd_bus_error *gone, struct web_call_queue **out)
{
    struct web_call_queue *queue = calloc(1, sizeof *queue);
    if (!queue) {
        return -ENOMEM;
    }
    TAILQ_INIT(&queue->calls);
    queue->gone = gone;
    queue->allowance = allowance_most;
    queue->allowance_ns = now_ns();
    int r = sd_event_add_defer(event, &queue->failing, on_failing, queue);
    if (r >= 0) {
        r = sd_event_source_set_enabled(queue->failing, SD_EVENT_OFF);
    }
    if (r >= 0) {
        r = sd_event_add_time_relative(event, &queue->waiting, CLOCK_MONOTONIC, 0, 1000, on_waiting,
                                       queue);
    }
    if (r < 0) {
        web_call_queue_free(queue);
        return r;
    }
    *out = queue;
    return 0;
}

void web_call_queue_free(struct web_call_queue *queue)
{
    if (queue) {
        sd_event_source_disable_unref(queue->failing);
        sd_event_source_disable_unref(queue->waiting);
        free(queue);
    }
}

#include "enroll/web/daemon/daemon.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/queue.h>

#include "enroll/cli/client/state.h"
#include "enroll/web/http/now.h"
#include "firmware/contract/bus_connect.h"
#include "firmware/contract/contract.h"

static const uint64_t retry_us = 1000000;
static const uint64_t status_us = 3000000; /* a daemon that does not answer within this is gone */
static const uint64_t call_us = 10000000;

/* The daemon answers a client 40 calls at once and 20 a second (firmware/bus/call_rate.h). All who
 * use the web server are one client, so calls beyond a somewhat smaller allowance wait. */
static const double allowance_most = 30.0, allowance_per_s = 15.0;
static const uint64_t wait_us = 70000;

const sd_bus_error web_daemon_is_gone = SD_BUS_ERROR_MAKE_CONST(
    "org.freedesktop.DBus.Error.Disconnected", "The daemon does not answer.");
static const sd_bus_error no_memory = SD_BUS_ERROR_MAKE_CONST(SD_BUS_ERROR_NO_MEMORY,
                                                              "There is no memory for the call.");

struct web_call {
    TAILQ_ENTRY(web_call) link;
    struct web_daemon *daemon;
    /* Of a call that has been sent there is a slot, and of one that waits there is a message. One
     * that has neither could not be sent, and is answered with an error. */
    sd_bus_slot *slot;
    sd_bus_message *message;
    uint64_t timeout_us;
    web_daemon_reply_fn on_reply;
    void *context;
};

struct web_daemon {
    sd_event *event;
    sd_event_source *tick, *failing, *waiting;
    double allowance; /* calls that may be sent at allowance_ns */
    int64_t allowance_ns;
    sd_bus *bus; /* NULL: not connected */
    sd_bus_slot *signals, *owners;
    char *address;
    char owner[64]; /* the daemon's name on the bus; "": not known */
    bool is_asking, is_there;
    struct web_daemon_listener *listeners;
    TAILQ_HEAD(, web_call) calls;
};

/* ---- calls ---- */

static void answer(struct web_call *call, sd_bus_message *reply, const sd_bus_error *error)
{
    TAILQ_REMOVE(&call->daemon->calls, call, link);
    call->on_reply(call->context, reply, error);
    sd_bus_slot_unref(call->slot);
    sd_bus_message_unref(call->message);
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

/* Answers the calls that could not be sent. */
static int on_failing(sd_event_source *source, void *context)
{
    struct web_daemon *daemon = context;
    (void)source;
    for (struct web_call *call = TAILQ_FIRST(&daemon->calls), *next; call; call = next) {
        next = TAILQ_NEXT(call, link);
        if (!call->slot && !call->message) {
            answer(call, NULL, &web_daemon_is_gone);
            next = TAILQ_FIRST(&daemon->calls); /* the callback may have answered others */
        }
    }
    return 0;
}

sd_bus_message *web_daemon_message(struct web_daemon *daemon, const char *method)
{
    sd_bus_message *call = NULL;
    if (!daemon->bus ||
        sd_bus_message_new_method_call(daemon->bus, &call, ISO_CONTRACT_NAME, ISO_CONTRACT_PATH,
                                       ISO_CONTRACT_INTERFACE, method) < 0) {
        return NULL;
    }
    return call;
}

/* Whether one more call may be sent now; such a call is counted. */
static bool take_allowance(struct web_daemon *daemon)
{
    const int64_t t_ns = web_now_ns();
    daemon->allowance += allowance_per_s * (double)(t_ns - daemon->allowance_ns) / 1e9;
    daemon->allowance = daemon->allowance < allowance_most ? daemon->allowance : allowance_most;
    daemon->allowance_ns = t_ns;
    if (daemon->allowance < 1.0) {
        return false;
    }
    daemon->allowance -= 1.0;
    return true;
}

/* Sends the calls that wait, in their order, as far as they may be sent. */
static void send_waiting(struct web_daemon *daemon)
{
    for (struct web_call *call = TAILQ_FIRST(&daemon->calls); call; call = TAILQ_NEXT(call, link)) {
        if (!call->message) {
            continue;
        }
        if (!take_allowance(daemon)) {
            (void)sd_event_source_set_time_relative(daemon->waiting, wait_us);
            (void)sd_event_source_set_enabled(daemon->waiting, SD_EVENT_ONESHOT);
            return;
        }
        if (sd_bus_call_async(daemon->bus, &call->slot, call->message, on_answer, call,
                              call->timeout_us) < 0) {
            call->slot = NULL;
            (void)sd_event_source_set_enabled(daemon->failing, SD_EVENT_ONESHOT);
        }
        call->message = sd_bus_message_unref(call->message);
    }
}

static int on_waiting(sd_event_source *source, uint64_t usec, void *context)
{
    (void)source;
    (void)usec;
    send_waiting(context);
    return 0;
}

void web_daemon_send(struct web_daemon *daemon, sd_bus_message *message, uint64_t timeout_us,
                     web_daemon_reply_fn on_reply, void *context)
{
    struct web_call *call = calloc(1, sizeof *call);
    if (!call) {
        sd_bus_message_unref(message);
        on_reply(context, NULL, &no_memory);
        return;
    }
    *call = (struct web_call){.daemon = daemon,
                              .message = message,
                              .timeout_us = timeout_us ? timeout_us : call_us,
                              .on_reply = on_reply,
                              .context = context};
    TAILQ_INSERT_TAIL(&daemon->calls, call, link);
    if (message) {
        send_waiting(daemon);
    } else {
        (void)sd_event_source_set_enabled(daemon->failing, SD_EVENT_ONESHOT);
    }
}

size_t web_daemon_waiting(const struct web_daemon *daemon)
{
    size_t n = 0;
    for (const struct web_call *call = TAILQ_FIRST(&daemon->calls); call;
         call = TAILQ_NEXT(call, link)) {
        n += call->message != NULL;
    }
    return n;
}

void web_daemon_record(struct web_daemon *daemon, const char *account, const char *act,
                       const char *person, web_daemon_reply_fn on_reply, void *context)
{
    sd_bus_message *call = web_daemon_message(daemon, ISO_CONTRACT_RECORD_ACT);
    if (call && sd_bus_message_append(call, "sss", account, act, person) < 0) {
        call = sd_bus_message_unref(call);
    }
    web_daemon_send(daemon, call, 0, on_reply, context);
}

/* ---- listeners ---- */

void web_daemon_listen(struct web_daemon *daemon, struct web_daemon_listener *listener)
{
    struct web_daemon_listener **end = &daemon->listeners;
    while (*end) {
        end = &(*end)->next;
    }
    listener->next = NULL;
    *end = listener;
}

void web_daemon_unlisten(struct web_daemon *daemon, struct web_daemon_listener *listener)
{
    for (struct web_daemon_listener **p = &daemon->listeners; *p; p = &(*p)->next) {
        if (*p == listener) {
            *p = listener->next;
            return;
        }
    }
}

static void tell_status(struct web_daemon *daemon, const json_t *status)
{
    daemon->is_there = status != NULL;
    for (struct web_daemon_listener *l = daemon->listeners; l; l = l->next) {
        if (l->on_status) {
            l->on_status(l->context, status);
        }
    }
}

/* A signal to one client may come from anybody, whatever the match says. So its sender has to be
 * the one that answered GetStatus. */
static int on_signal(sd_bus_message *signal, void *context, sd_bus_error *error)
{
    struct web_daemon *daemon = context;
    const char *sender = sd_bus_message_get_sender(signal);
    (void)error;
    if (!sender || strcmp(sender, daemon->owner) != 0) {
        return 0;
    }
    for (struct web_daemon_listener *l = daemon->listeners; l; l = l->next) {
        if (l->on_signal && sd_bus_message_rewind(signal, true) >= 0) {
            l->on_signal(l->context, sd_bus_message_get_member(signal), signal);
        }
    }
    return 0;
}

/* ---- the state ---- */

static void on_status(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    struct web_daemon *daemon = context;
    json_t *status = NULL;
    daemon->is_asking = false;
    if (!error && cli_state_read(reply, &status) >= 0) {
        (void)snprintf(daemon->owner, sizeof daemon->owner, "%s", sd_bus_message_get_sender(reply));
    }
    tell_status(daemon, status);
    json_decref(status);
}

static void ask_status(struct web_daemon *daemon)
{
    if (!daemon->is_asking) {
        daemon->is_asking = true;
        web_daemon_send(daemon, web_daemon_message(daemon, ISO_CONTRACT_GET_STATUS), status_us,
                        on_status, daemon);
    }
}

/* The daemon has come to the bus or left it. */
static int on_owner(sd_bus_message *signal, void *context, sd_bus_error *error)
{
    struct web_daemon *daemon = context;
    const char *name, *before, *now, *sender = sd_bus_message_get_sender(signal);
    (void)error;
    if (!sender || strcmp(sender, "org.freedesktop.DBus") != 0 ||
        sd_bus_message_read(signal, "sss", &name, &before, &now) < 0 ||
        strcmp(name, ISO_CONTRACT_NAME) != 0) {
        return 0;
    }
    (void)snprintf(daemon->owner, sizeof daemon->owner, "%s", now);
    if (*before) {
        tell_status(daemon, NULL);
    }
    if (*now) {
        ask_status(daemon);
    }
    return 0;
}

/* ---- the connection ---- */

static void disconnect(struct web_daemon *daemon)
{
    const bool was_there = daemon->is_there;
    daemon->owner[0] = '\0';
    daemon->signals = sd_bus_slot_unref(daemon->signals);
    daemon->owners = sd_bus_slot_unref(daemon->owners);
    for (struct web_call *call = TAILQ_FIRST(&daemon->calls); call; call = TAILQ_NEXT(call, link)) {
        call->slot = sd_bus_slot_unref(call->slot);
        call->message = sd_bus_message_unref(call->message);
    }
    if (daemon->bus) {
        (void)sd_bus_detach_event(daemon->bus);
        daemon->bus = sd_bus_close_unref(daemon->bus);
    }
    (void)on_failing(NULL, daemon);
    if (was_there && daemon->is_there) {
        tell_status(daemon, NULL);
    }
}

static void connect_bus(struct web_daemon *daemon)
{
    int r = iso_bus_connect(daemon->address, &daemon->bus);
    if (r >= 0) {
        r = sd_bus_match_signal_async(daemon->bus, &daemon->signals, ISO_CONTRACT_NAME,
                                      ISO_CONTRACT_PATH, ISO_CONTRACT_INTERFACE, NULL, on_signal,
                                      NULL, daemon);
    }
    if (r >= 0) {
        r = sd_bus_add_match_async(daemon->bus, &daemon->owners,
                                   "type='signal',sender='org.freedesktop.DBus',"
                                   "interface='org.freedesktop.DBus',member='NameOwnerChanged',"
                                   "arg0='" ISO_CONTRACT_NAME "'",
                                   on_owner, NULL, daemon);
    }
    if (r >= 0) {
        r = sd_bus_attach_event(daemon->bus, daemon->event, SD_EVENT_PRIORITY_NORMAL);
    }
    if (r < 0) {
        disconnect(daemon);
    }
}

/* Each second: connects if need be, and asks the daemon how it is. */
static int on_tick(sd_event_source *source, uint64_t usec, void *context)
{
    struct web_daemon *daemon = context;
    (void)usec;
    if (daemon->bus && sd_bus_is_open(daemon->bus) <= 0) {
        disconnect(daemon);
    }
    if (!daemon->bus) {
        connect_bus(daemon);
    }
    ask_status(daemon);
    const int r = sd_event_source_set_time_relative(source, retry_us);
    return r < 0 ? r : sd_event_source_set_enabled(source, SD_EVENT_ONESHOT);
}

int web_daemon_new(sd_event *event, const char *address, struct web_daemon **out)
{
    struct web_daemon *daemon = calloc(1, sizeof *daemon);
    if (!daemon) {
        return -ENOMEM;
    }
    TAILQ_INIT(&daemon->calls);
    daemon->event = sd_event_ref(event);
    daemon->allowance = allowance_most;
    daemon->allowance_ns = web_now_ns();
    daemon->address = strdup(address);
    int r = daemon->address ? 0 : -ENOMEM;
    if (r >= 0) {
        r = sd_event_add_defer(event, &daemon->failing, on_failing, daemon);
    }
    if (r >= 0) {
        r = sd_event_source_set_enabled(daemon->failing, SD_EVENT_OFF);
    }
    if (r >= 0) {
        r = sd_event_add_time_relative(event, &daemon->waiting, CLOCK_MONOTONIC, 0, 1000,
                                       on_waiting, daemon);
    }
    if (r >= 0) {
        r = sd_event_add_time_relative(event, &daemon->tick, CLOCK_MONOTONIC, 0, 0, on_tick,
                                       daemon);
    }
    if (r < 0) {
        web_daemon_free(daemon);
        return r;
    }
    *out = daemon;
    return 0;
}

void web_daemon_close(struct web_daemon *daemon)
{
    daemon->tick = sd_event_source_disable_unref(daemon->tick);
    disconnect(daemon);
    (void)on_failing(NULL, daemon); /* calls that were made because the connection ended */
}

void web_daemon_free(struct web_daemon *daemon)
{
    if (daemon) {
        web_daemon_close(daemon);
        sd_event_source_disable_unref(daemon->failing);
        sd_event_source_disable_unref(daemon->waiting);
        sd_event_unref(daemon->event);
        free(daemon->address);
        free(daemon);
    }
}

bool web_daemon_is_there(const struct web_daemon *daemon)
{
    return daemon->is_there;
}

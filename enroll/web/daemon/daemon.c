#include "enroll/web/daemon/daemon.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/cli/client/state.h"
#include "firmware/contract/bus_connect.h"
#include "firmware/contract/contract.h"

static const uint64_t retry_us = 1000000;
static const uint64_t status_us = 3000000; /* a daemon that does not answer within this is gone */
static const uint64_t call_us = 10000000;

const sd_bus_error web_daemon_is_gone = SD_BUS_ERROR_MAKE_CONST(
    "org.freedesktop.DBus.Error.Disconnected", "The daemon does not answer.");
struct web_daemon {
    sd_event *event;
    sd_event_source *tick;
    struct web_call_queue *calls;
    sd_bus *bus; /* NULL: not connected */
    sd_bus_slot *signals, *owners;
    char *address;
    char owner[64]; /* the daemon's name on the bus; "": not known */
    bool is_asking, is_there;
    struct web_daemon_listener *listeners;
};

/* ---- calls ---- */

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

static void send(const struct web_daemon *daemon, sd_bus_message *message, uint64_t timeout_us,
                 bool urgent, web_daemon_reply_fn on_reply, void *context)
{
    const struct web_call_request request = {.message = message,
                                             .timeout_us = timeout_us ? timeout_us : call_us,
                                             .urgent = urgent,
                                             .on_reply = on_reply,
                                             .context = context};
    web_call_queue_send(daemon->calls, &request);
}

void web_daemon_send(struct web_daemon *daemon, sd_bus_message *message, uint64_t timeout_us,
                     web_daemon_reply_fn on_reply, void *context)
{
    send(daemon, message, timeout_us,
         message && web_call_is_urgent(sd_bus_message_get_member(message)), on_reply, context);
}

size_t web_daemon_waiting(const struct web_daemon *daemon)
{
    return web_call_queue_waiting(daemon->calls);
}

void web_daemon_record(struct web_daemon *daemon, const char *account, const char *act,
                       const char *person, web_daemon_reply_fn on_reply, void *context)
{
    sd_bus_message *call = web_daemon_message(daemon, ISO_CONTRACT_RECORD_ACT);
    if (call && sd_bus_message_append(call, "sss", account, act, person) < 0) {
        call = sd_bus_message_unref(call);
    }
    send(daemon, call, 0, web_act_is_urgent(act), on_reply, context);
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
    web_call_queue_drop(daemon->calls);
    if (daemon->bus) {
        (void)sd_bus_detach_event(daemon->bus);
        daemon->bus = sd_bus_close_unref(daemon->bus);
    }
    web_call_queue_fail(daemon->calls);
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
    daemon->event = sd_event_ref(event);
    daemon->address = strdup(address);
    int r = daemon->address ? web_call_queue_new(event, &web_daemon_is_gone, &daemon->calls)
                            : -ENOMEM;
    if (r >= 0) {
        r = sd_event_add_time_relative(event, &daemon->tick, CLOCK_MONOTONIC, 0, 0, on_tick,
                                       daemon);
    }
    if (r < 0) {
        if (daemon->calls) {
            web_daemon_free(daemon);
        } else {
            sd_event_unref(daemon->event);
            free(daemon->address);
            free(daemon);
        }
        return r;
    }
    *out = daemon;
    return 0;
}

void web_daemon_close(struct web_daemon *daemon)
{
    daemon->tick = sd_event_source_disable_unref(daemon->tick);
    disconnect(daemon);
    web_call_queue_fail(daemon->calls); /* calls that were made because the connection ended */
}

void web_daemon_free(struct web_daemon *daemon)
{
    if (daemon) {
        web_daemon_close(daemon);
        web_call_queue_free(daemon->calls);
        sd_event_unref(daemon->event);
        free(daemon->address);
        free(daemon);
    }
}

bool web_daemon_is_there(const struct web_daemon *daemon)
{
    return daemon->is_there;
}

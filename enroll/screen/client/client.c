#include "enroll/screen/client/client.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <systemd/sd-bus.h>
#include <time.h>
#include <unistd.h>

#include "firmware/contract/bus_connect.h"
#include "firmware/contract/contract.h"

static const uint64_t retry_us = 1000000;
static const uint64_t call_us = 3000000; /* a daemon that does not answer within this is gone */

struct screen_client {
    sd_event *event;
    sd_event_source *tick, *stream;
    sd_bus *bus;          /* NULL: not connected */
    sd_bus_slot *visit;   /* the match of the signal */
    sd_bus_slot *asking;  /* GetStatus is on its way; NULL: not */
    sd_bus_slot *opening; /* Watch is on its way */
    char address[256];
    bool show_names;
    struct screen_state state;
};

static int64_t now_ns(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

/* ---- the stream ---- */

static void close_stream(struct screen_client *client)
{
    client->stream = sd_event_source_disable_unref(client->stream);
    client->state.has_record = false;
}

static void take_record(struct screen_state *state, const struct iso_outline_record *record)
{
    state->record = *record;
    state->has_record = true;
    state->record_ns = now_ns();
    state->lockdown = record->lockdown;
    state->locked_out = record->locked_out;
    (void)snprintf(state->mode, sizeof state->mode, "%s", record->mode);
}

/* Reads all records that wait and keeps the last one. */
static int on_record(sd_event_source *source, int fd, uint32_t events, void *context)
{
    struct screen_client *client = context;
    struct iso_outline_record record;
    uint8_t bytes[ISO_OUTLINE_BYTES + 1];
    (void)source;
    (void)events;
    for (;;) {
        const ssize_t size = recv(fd, bytes, sizeof bytes, MSG_DONTWAIT);
        if (size > 0 && iso_outline_record_read(bytes, (size_t)size, &record) == 0) {
            take_record(&client->state, &record);
        } else if (size == 0 || (size < 0 && errno != EAGAIN && errno != EINTR)) {
            close_stream(client);
            return 0;
        } else if (size < 0 && errno == EAGAIN) {
            return 0;
        }
    }
}

static int on_stream(sd_bus_message *reply, void *context, sd_bus_error *error)
{
    struct screen_client *client = context;
    int fd = -1;
    (void)error;
    client->opening = sd_bus_slot_unref(client->opening);
    if (sd_bus_message_is_method_error(reply, NULL) || sd_bus_message_read(reply, "h", &fd) < 0) {
        return 0;
    }
    close_stream(client);
    /* The descriptor of the reply is closed with the reply. */
    fd = dup(fd);
    if (fd >= 0 &&
        sd_event_add_io(client->event, &client->stream, fd, EPOLLIN, on_record, client) < 0) {
        (void)close(fd);
    } else if (fd >= 0) {
        (void)sd_event_source_set_io_fd_own(client->stream, 1);
    }
    return 0;
}

/* ---- the state ---- */

/* Reads the value of a key, or skips it. */
static int take_entry(struct screen_state *state, sd_bus_message *reply, const char *key)
{
    const char *text = NULL;
    int64_t number = 0;
    int flag = 0;
    int r = 0;
    if (strcmp(key, "sensor-state") == 0) {
        r = sd_bus_message_read(reply, "v", "s", &text);
        state->sees = r > 0 && strcmp(text, "started") == 0;
    } else if (strcmp(key, "mode") == 0) {
        r = sd_bus_message_read(reply, "v", "s", &text);
        (void)snprintf(state->mode, sizeof state->mode, "%s", r > 0 ? text : "");
    } else if (strcmp(key, "panel-text") == 0) {
        r = sd_bus_message_read(reply, "v", "s", &text);
        (void)snprintf(state->panel_text, sizeof state->panel_text, "%s", r > 0 ? text : "");
        for (char *c = state->panel_text; *c; c++) {
            *c = *c == '\n' ? ' ' : *c;
        }
    } else if (strcmp(key, "panel-lamp") == 0) {
        r = sd_bus_message_read(reply, "v", "s", &text);
        (void)snprintf(state->panel_lamp, sizeof state->panel_lamp, "%s", r > 0 ? text : "");
    } else if (strcmp(key, "lockdown") == 0) {
        r = sd_bus_message_read(reply, "v", "b", &flag);
        state->lockdown = flag != 0;
    } else if (strcmp(key, "lockout-ms") == 0) {
        r = sd_bus_message_read(reply, "v", "x", &number);
        state->locked_out = number > 0;
    } else {
        r = sd_bus_message_skip(reply, "v");
    }
    return r;
}

static int read_status(struct screen_state *state, sd_bus_message *reply)
{
    const char *key = NULL;
    int r = sd_bus_message_enter_container(reply, 'a', "{sv}");
    while (r >= 0 && (r = sd_bus_message_enter_container(reply, 'e', "sv")) > 0) {
        r = sd_bus_message_read(reply, "s", &key);
        if (r > 0) {
            r = take_entry(state, reply, key);
        }
        if (r >= 0) {
            r = sd_bus_message_exit_container(reply);
        }
    }
    return r;
}

static void open_stream(struct screen_client *client)
{
    if (client->stream || client->opening) {
        return;
    }
    (void)sd_bus_call_method_async(client->bus, &client->opening, ISO_CONTRACT_NAME,
                                   ISO_CONTRACT_PATH, ISO_CONTRACT_INTERFACE, ISO_CONTRACT_WATCH,
                                   on_stream, client, "s", ISO_CONTRACT_WATCH_OUTLINE);
}

static int on_status(sd_bus_message *reply, void *context, sd_bus_error *error)
{
    struct screen_client *client = context;
    (void)error;
    client->asking = sd_bus_slot_unref(client->asking);
    client->state.connected = !sd_bus_message_is_method_error(reply, NULL) &&
                              read_status(&client->state, reply) >= 0;
    if (client->state.connected) {
        open_stream(client);
    } else {
        close_stream(client);
    }
    return 0;
}

/* ---- visits ---- */

static int on_visit(sd_bus_message *signal, void *context, sd_bus_error *error)
{
    struct screen_client *client = context;
    struct screen_state *state = &client->state;
    const char *verdict, *person, *reason, *door, *door_fault;
    double score, threshold;
    uint32_t frames;
    int64_t latency_us;
    (void)error;
    if (sd_bus_message_read(signal, "ssdduxsss", &verdict, &person, &score, &threshold, &frames,
                            &latency_us, &reason, &door, &door_fault) < 0) {
        return 0;
    }
    if (strcmp(reason, "left") == 0) {
        return 0; /* whoever it was went away before a decision, and nobody is there to read it */
    }
    const bool stuck = strcmp(door, ISO_CONTRACT_DOOR_NOT_UNLOCKED) == 0;
    state->has_visit = true;
    state->allowed = strcmp(verdict, "allow") == 0 && !stuck;
    state->visit_ns = now_ns();
    (void)snprintf(state->person, sizeof state->person, "%s", client->show_names ? person : "");
    (void)snprintf(state->reason, sizeof state->reason, "%s", stuck ? "unlogged" : reason);
    return 0;
}

/* ---- the connection ---- */

static void disconnect(struct screen_client *client)
{
    close_stream(client);
    client->state.connected = false;
    client->asking = sd_bus_slot_unref(client->asking);
    client->opening = sd_bus_slot_unref(client->opening);
    client->visit = sd_bus_slot_unref(client->visit);
    if (client->bus) {
        (void)sd_bus_detach_event(client->bus);
        client->bus = sd_bus_close_unref(client->bus);
    }
}

static void connect_bus(struct screen_client *client)
{
    int r = iso_bus_connect(client->address, &client->bus);
    if (r >= 0) {
        (void)sd_bus_set_method_call_timeout(client->bus, call_us);
        r = sd_bus_match_signal_async(client->bus, &client->visit, ISO_CONTRACT_NAME,
                                      ISO_CONTRACT_PATH, ISO_CONTRACT_INTERFACE, ISO_CONTRACT_VISIT,
                                      on_visit, NULL, client);
    }
    if (r >= 0) {
        r = sd_bus_attach_event(client->bus, client->event, SD_EVENT_PRIORITY_NORMAL);
    }
    if (r < 0) {
        disconnect(client);
    }
}

/* Each second: connects if need be, and asks the daemon how it is. */
static int on_tick(sd_event_source *source, uint64_t usec, void *context)
{
    struct screen_client *client = context;
    (void)usec;
    if (client->bus && sd_bus_is_open(client->bus) <= 0) {
        disconnect(client);
    }
    if (!client->bus) {
        connect_bus(client);
    }
    if (client->bus && !client->asking &&
        sd_bus_call_method_async(client->bus, &client->asking, ISO_CONTRACT_NAME, ISO_CONTRACT_PATH,
                                 ISO_CONTRACT_INTERFACE, ISO_CONTRACT_GET_STATUS, on_status, client,
                                 NULL) < 0) {
        disconnect(client);
    }
    const int r = sd_event_source_set_time_relative(source, retry_us);
    return r < 0 ? r : sd_event_source_set_enabled(source, SD_EVENT_ONESHOT);
}

int screen_client_new(sd_event *event, const char *address, bool show_names,
                      struct screen_client **out)
{
    struct screen_client *client = calloc(1, sizeof *client);
    if (!client) {
        return -ENOMEM;
    }
    client->event = sd_event_ref(event);
    client->show_names = show_names;
    (void)snprintf(client->address, sizeof client->address, "%s", address);
    const int r = sd_event_add_time_relative(event, &client->tick, CLOCK_MONOTONIC, 0, 0, on_tick,
                                             client);
    if (r < 0) {
        screen_client_free(client);
        return r;
    }
    *out = client;
    return 0;
}

void screen_client_free(struct screen_client *client)
{
    if (client) {
        disconnect(client);
        sd_event_source_disable_unref(client->tick);
        sd_event_unref(client->event);
        explicit_bzero(client, sizeof *client);
        free(client);
    }
}

const struct screen_state *screen_client_state(const struct screen_client *client)
{
    return &client->state;
}

#include "firmware/fleet/link/link.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "firmware/fleet/link/link_inner.h"

enum {
    DAEMON_AGAIN_S = 5,
    NO_FLEET_AGAIN_S = 60,
    FETCH_BASE_MS = 1000,
    FETCH_CAP_MS = 60000,
    TIMER_ACCURACY_US = 5000,
};

void link_note(const struct link_door *door, const char *format, ...)
{
    char line[LINK_NOTE_SIZE];
    va_list arguments;

    if (door->note) {
        va_start(arguments, format);
        (void)vsnprintf(line, sizeof line, format, arguments);
        va_end(arguments);
        door->note(door->note_context, line);
    }
}

/* ---- the daemon ---- */

int link_daemon_result(struct link_door *door, int r, const struct iso_fault *fault)
{
    if (r >= 0) {
        return r;
    }
    if (door->has_daemon || door->report.connections == 0) {
        link_note(door, "the daemon: %s", fault->text[0] ? fault->text : strerror(-r));
    }
    door->has_daemon = false;
    door->has_lease = false;
    door->is_asking = false;
    link_never(door, LINK_DUE_QUESTION);
    link_never(door, LINK_DUE_ANSWER);
    link_fetch_cancel(door);
    link_in(door, LINK_DUE_DAEMON, (r == -ENOENT ? NO_FLEET_AGAIN_S : DAEMON_AGAIN_S) * LINK_S_US);
    return r;
}

int link_daemon_minor_result(struct link_door *door, int r, const struct iso_fault *fault)
{
    if (r == -ENOTCONN || r == -ENOENT) {
        return link_daemon_result(door, r, fault);
    }
    if (r < 0) {
        link_note(door, "the daemon: %s", fault->text[0] ? fault->text : strerror(-r));
    }
    return r;
}

/* ---- the broker ---- */

static void on_connected(void *context)
{
    struct link_door *door = context;

    door->report.connections++;
    if (door->has_daemon) {
        link_zones_subscribe(door, true);
    }
}

static void on_lost(void *context, const char *why)
{
    struct link_door *door = context;

    link_note(door, "the broker %s: %s", door->broker.host, why);
    door->is_subscribed = false;
    door->has_lease = false;
    door->is_asking = false;
    door->unanswered = 0;
    link_never(door, LINK_DUE_QUESTION);
    link_never(door, LINK_DUE_ANSWER);
    link_never(door, LINK_DUE_ACK);
    link_never(door, LINK_DUE_EVENTS);
    link_never(door, LINK_DUE_REQUESTS);
}

static void on_subscribed(void *context, int id, bool granted)
{
    struct link_door *door = context;

    if (!granted) {
        link_note(door, "the broker %s refuses a subscription", door->broker.host);
    }
    if (id == door->subscription) {
        door->is_subscribed = true;
        link_ask(door);
    }
}

static void on_message(void *context, const char *topic, const void *bytes, size_t size)
{
    link_receive(context, topic, bytes, size);
}

static void on_unheard(void *context)
{
    link_requests_unheard(context);
}

static void on_published(void *context, int id)
{
    link_requests_published(context, id);
}

static void close_broker(struct link_door *door)
{
    link_mqtt_free(door->mqtt);
    door->mqtt = NULL;
    door->is_subscribed = false;
    door->has_lease = false;
}

static int open_broker(struct link_door *door, struct iso_fault *fault)
{
    const struct link_mqtt_calls calls = {.context = door,
                                          .connected = on_connected,
                                          .lost = on_lost,
                                          .subscribed = on_subscribed,
                                          .message = on_message,
                                          .published = on_published,
                                          .unheard = on_unheard};
    char client[ISO_FLEET_ID_TEXT_SIZE], will[ISO_FLEET_TOPIC_SIZE];
    const struct iso_fleet_id *id = &door->status.door;

    door->connected_as = *id;
    (void)iso_fleet_topic_in(id, door->topic_in);
    (void)iso_fleet_topic_out(id, door->topic_out);
    return link_mqtt_new(door->event, &door->broker, iso_fleet_id_text(id, client),
                         iso_fleet_topic_online(id, will), &calls, &door->mqtt, fault);
}

/* ---- the event loop ---- */

/* Asks the daemon for its state. Nothing of the broker's library is on the stack here, so the
 * connection may be replaced. */
static void ask_daemon(struct link_door *door)
{
    struct iso_fault fault = {.text = ""};
    const int r = link_zones_read(door);

    if (r == -ENOENT) {
        close_broker(door);
    }
    if (r < 0) {
        return;
    }
    const bool was_away = !door->has_daemon;
    door->has_daemon = true;
    if (door->mqtt && !iso_fleet_id_is_same(&door->connected_as, &door->status.door)) {
        close_broker(door);
    }
    if (!door->mqtt) {
        const int opened = open_broker(door, &fault);
        if (opened < 0) {
            (void)link_daemon_result(door, opened, &fault);
        }
        return;
    }
    if (!door->is_subscribed) {
        link_zones_subscribe(door, true);
    } else if (was_away) {
        link_zones_subscribe(door, false);
        link_ask(door);
    }
}

static void act(struct link_door *door, enum link_due due)
{
    switch (due) {
    case LINK_DUE_DAEMON:
        ask_daemon(door);
        break;
    case LINK_DUE_QUESTION:
        link_ask_now(door);
        break;
    case LINK_DUE_ANSWER:
        link_ask_late(door);
        break;
    case LINK_DUE_FETCH:
        link_fetch_next(door);
        break;
    case LINK_DUE_APPLY:
        link_fetch_apply(door);
        break;
    case LINK_DUE_EVENTS:
        link_events_send(door);
        break;
    case LINK_DUE_ACK:
        link_events_late(door);
        break;
    case LINK_DUE_REQUESTS:
        link_requests_send(door);
        break;
    case LINK_DUES:
        break;
    }
}

static int on_time(sd_event_source *source, uint64_t at_us, void *context)
{
    struct link_door *door = context;
    const uint64_t now = link_now_us(door);

    (void)source;
    (void)at_us;
    for (enum link_due due = 0; due < LINK_DUES; due++) {
        if (door->due_us[due] && door->due_us[due] <= now) {
            link_never(door, due);
            act(door, due);
        }
    }
    /* The source is off after it was dispatched, also if nothing of the above has set it. */
    link_rearm(door);
    return 0;
}

/* ---- public ---- */

static char *copy(const char *text)
{
    return text ? strdup(text) : NULL;
}

static bool copy_setup(struct link_door *door, const struct link_setup *setup)
{
    const struct link_broker *from = &setup->broker;

    door->broker = *from;
    door->broker.host = copy(from->host);
    door->broker.ca_file = copy(from->ca_file);
    door->broker.certificate_file = copy(from->certificate_file);
    door->broker.key_file = copy(from->key_file);
    door->hub_url = copy(setup->hub_url);
    door->folder = copy(setup->folder);
    return door->broker.host && door->hub_url && !door->broker.ca_file == !from->ca_file &&
           !door->broker.certificate_file == !from->certificate_file &&
           !door->broker.key_file == !from->key_file && !door->folder == !setup->folder;
}

int link_door_new(const struct link_setup *setup, struct link_door **out, struct iso_fault *fault)
{
    struct link_door *door = NULL;
    int r = iso_fleet_start(fault);

    if (r < 0) {
        return r;
    }
    if (!setup->broker.host || !setup->hub_url) {
        return iso_fault_set(fault, -EINVAL, "the link: the broker or the hub is missing");
    }
    door = calloc(1, sizeof *door);
    if (!door) {
        return iso_fault_set(fault, -ENOMEM, "the link: out of memory");
    }
    door->event = sd_event_ref(setup->event);
    door->daemon = setup->daemon;
    door->http = setup->http;
    door->update_context = setup->update_context;
    door->ordered = setup->ordered;
    door->answered = setup->answered;
    door->note = setup->note;
    door->note_context = setup->note_context;
    door->fetch.fd = -1;
    door->fetch.backoff = (struct link_backoff){.base_ms = FETCH_BASE_MS, .cap_ms = FETCH_CAP_MS};
    r = copy_setup(door, setup) ? 0 : -ENOMEM;
    r = r < 0 ? r
              : sd_event_add_time(door->event, &door->timer, CLOCK_BOOTTIME, 0, TIMER_ACCURACY_US,
                                  on_time, door);
    if (r < 0) {
        link_door_free(door);
        return iso_fault_set(fault, r, "the link: %s", strerror(-r));
    }
    link_in(door, LINK_DUE_DAEMON, 0);
    *out = door;
    return 0;
}

void link_door_free(struct link_door *door)
{
    if (!door) {
        return;
    }
    link_http_cancel(door->fetch.request);
    door->fetch.request = NULL;
    if (door->timer) {
        link_fetch_cancel(door);
    }
    close_broker(door);
    link_requests_free(door);
    (void)sd_event_source_disable_unref(door->timer);
    (void)sd_event_unref(door->event);
    free((char *)(uintptr_t)door->broker.host);
    free((char *)(uintptr_t)door->broker.ca_file);
    free((char *)(uintptr_t)door->broker.certificate_file);
    free((char *)(uintptr_t)door->broker.key_file);
    free(door->hub_url);
    free(door->folder);
    free(door);
}

void link_door_wake(struct link_door *door)
{
    /* A daemon that was restarted does not know the question any more. */
    door->has_daemon = false;
    door->is_asking = false;
    door->has_lease = false;
    link_never(door, LINK_DUE_ANSWER);
    link_in(door, LINK_DUE_DAEMON, 0);
}

void link_door_work(struct link_door *door, const char *what)
{
    if (strcmp(what, ISO_CONTRACT_FLEET_WORK_EVENTS) == 0) {
        link_in(door, LINK_DUE_EVENTS, 0);
    } else if (strcmp(what, ISO_CONTRACT_FLEET_WORK_REQUESTS) == 0) {
        link_requests_start(door);
    } else if (strcmp(what, ISO_CONTRACT_FLEET_WORK_PLACES) == 0) {
        link_ask(door);
    }
}

void link_door_renew(struct link_door *door)
{
    if (door->mqtt) {
        link_mqtt_renew(door->mqtt);
    }
}

struct link_report link_door_report(const struct link_door *door)
{
    struct link_report report = door->report;

    report.phase = !door->has_daemon                                    ? LINK_AWAY
                   : !door->mqtt || !link_mqtt_is_connected(door->mqtt) ? LINK_OFFLINE
                   : !door->is_subscribed                               ? LINK_SUBSCRIBING
                   : !door->has_lease                                   ? LINK_ASKING
                                                                        : LINK_ONLINE;
    for (size_t i = 0; i < door->zone_count; i++) {
        const struct link_zone *zone = &door->zones[i];
        report.missing += zone->target > zone->mine.sequence ? zone->target - zone->mine.sequence
                                                             : 0;
    }
    return report;
}

const char *link_phase_word(enum link_phase phase)
{
    static const char *const words[] = {"away", "offline", "subscribing", "asking", "online"};

    return phase < LINK_PHASES ? words[phase] : "unknown";
}

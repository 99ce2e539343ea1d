#include <errno.h>

#include "firmware/fleet/link/link_inner.h"

enum { ACK_S = 10, ACK_MOST_S = 120 };

static void expect_ack(struct link_door *door)
{
    const uint32_t doublings = door->events.timeouts < 4 ? door->events.timeouts : 4;
    const uint64_t wait_s = (uint64_t)ACK_S << doublings;

    link_never(door, LINK_DUE_ACK);
    if (door->events.n) {
        link_in(door, LINK_DUE_ACK, (wait_s < ACK_MOST_S ? wait_s : ACK_MOST_S) * LINK_S_US);
    }
}

void link_events_start(struct link_door *door)
{
    door->events = (struct link_events){.acked = door->status.acked, .sent = door->status.acked};
    door->report.events_acked = door->events.acked;
    link_never(door, LINK_DUE_ACK);
    link_in(door, LINK_DUE_EVENTS, 0);
}

/* Sends one batch. Returns whether there may be another one. */
static bool send_batch(struct link_door *door)
{
    struct link_events *events = &door->events;
    struct iso_fleet_bytes batch = {.bytes = NULL};
    struct iso_fault fault = {.text = ""};
    uint64_t last = 0;
    int r = door->daemon.events(door->daemon.context, events->sent, LINK_EVENTS_BATCH, &batch,
                                &last, &fault);

    if (link_daemon_minor_result(door, r, &fault) < 0 || last <= events->sent) {
        iso_fleet_bytes_free(&batch);
        return false;
    }
    r = link_mqtt_publish(door->mqtt, door->topic_out, batch.bytes, batch.size, false, NULL);
    iso_fleet_bytes_free(&batch);
    if (r < 0) {
        if (r != -ENOTCONN) {
            link_note(door, "the events after number %llu cannot be sent",
                      (unsigned long long)events->sent);
        }
        return false;
    }
    door->report.events_sent += last - events->sent;
    events->last[events->n++] = last;
    events->sent = last;
    expect_ack(door);
    return true;
}

void link_events_send(struct link_door *door)
{
    while (door->has_daemon && door->has_lease && door->events.n < LINK_EVENTS_WINDOW) {
        if (!send_batch(door)) {
            return;
        }
    }
}

void link_events_acked(struct link_door *door, uint64_t number)
{
    struct link_events *events = &door->events;
    size_t kept = 0;

    if (!door->has_lease || number == events->acked) {
        return;
    }
    if (number < events->acked) {
        /* The hub has lost some; only the daemon knows whether that is so. */
        if (number == door->status.acked) {
            link_events_start(door);
        }
        return;
    }
    events->acked = number;
    events->timeouts = 0;
    door->report.events_acked = number;
    for (size_t i = 0; i < events->n; i++) {
        if (events->last[i] > number) {
            events->last[kept++] = events->last[i];
        }
    }
    events->n = kept;
    if (events->sent < number) {
        events->sent = number;
    }
    expect_ack(door);
    link_in(door, LINK_DUE_EVENTS, 0);
}

void link_events_late(struct link_door *door)
{
    door->events.timeouts++;
    door->events.n = 0;
    door->events.sent = door->events.acked;
    link_in(door, LINK_DUE_EVENTS, 0);
}

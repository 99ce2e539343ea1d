#include <errno.h>
#include <sodium.h>
#include <string.h>

#include "firmware/fleet/link/link_inner.h"
#include "firmware/fleet/message/delta.h"
#include "firmware/fleet/message/head.h"

/* A message of the broker that is signed by the hub and arrived where it belongs. */
struct letter {
    enum iso_fleet_kind kind;
    struct link_zone *zone; /* of DELTA and HEAD */
    uint64_t sequence;      /* of DELTA and HEAD */
    uint64_t acked;         /* of ACK */
    struct iso_fleet_lease lease;
    struct iso_fleet_update update;
};

static int read_zone_letter(struct link_door *door, const char *topic,
                            const struct iso_fleet_place *place, struct letter *out)
{
    char text[ISO_FLEET_TOPIC_SIZE];
    const char *expected = out->kind == ISO_FLEET_DELTA ? iso_fleet_topic_delta(&place->zone, text)
                                                        : iso_fleet_topic_head(&place->zone, text);

    out->zone = link_zone_of(door, &place->zone);
    out->sequence = place->sequence;
    return out->zone && strcmp(topic, expected) == 0 ? 0 : -EBADMSG;
}

/* KEY begins with the id of its door, like all messages for one door. */
static int read_key(const struct link_door *door, const void *bytes, size_t size,
                    struct iso_fleet_id *to)
{
    struct iso_fleet_reader fields;
    const int r = iso_fleet_verify(bytes, size, ISO_FLEET_KEY, door->status.hub_signs, &fields);

    if (r == 0) {
        iso_fleet_take_bytes(&fields, to->bytes, sizeof to->bytes);
    }
    return r;
}

static int read_door_letter(struct link_door *door, const char *topic, const void *bytes,
                            size_t size, struct letter *out)
{
    struct iso_fleet_id to = {.bytes = {0}};
    struct iso_fleet_ack ack = {.number = 0};
    int r = strcmp(topic, door->topic_in) == 0 ? 0 : -EBADMSG;

    if (r < 0) {
        return r;
    }
    switch (out->kind) {
    case ISO_FLEET_KEY:
        r = read_key(door, bytes, size, &to);
        break;
    case ISO_FLEET_LEASE:
        r = iso_fleet_read_lease(bytes, size, door->status.hub_signs, &out->lease);
        to = out->lease.door;
        break;
    case ISO_FLEET_ACK:
        r = iso_fleet_read_ack(bytes, size, door->status.hub_signs, &ack);
        to = ack.door;
        out->acked = ack.number;
        break;
    case ISO_FLEET_UPDATE:
        r = iso_fleet_read_update(bytes, size, door->status.hub_signs, &out->update);
        to = out->update.door;
        break;
    default:
        return -EBADMSG;
    }
    return r < 0 || iso_fleet_id_is_same(&to, &door->status.door) ? r : -EBADMSG;
}

/* Whether the daemon may see a message. -EBADMSG it is none, or in the wrong place; -EKEYREJECTED
 * somebody else has signed it; -EPROTONOSUPPORT the hub has, in a newer version. */
static int read_letter(struct link_door *door, const char *topic, const void *bytes, size_t size,
                       struct letter *out)
{
    struct iso_fleet_delta delta;
    struct iso_fleet_head head;
    int r = size <= ISO_FLEET_MESSAGE_MAX ? iso_fleet_kind_of(bytes, size, &out->kind) : -EBADMSG;

    if (r == -EPROTONOSUPPORT) {
        return iso_fleet_is_newer(bytes, size, door->status.hub_signs) ? r : -EKEYREJECTED;
    }
    if (r < 0) {
        return r;
    }
    switch (out->kind) {
    case ISO_FLEET_DELTA:
        r = iso_fleet_read_delta(bytes, size, door->status.hub_signs, &delta);
        return r < 0 ? r : read_zone_letter(door, topic, &delta.place, out);
    case ISO_FLEET_HEAD:
        r = iso_fleet_read_head(bytes, size, door->status.hub_signs, &head);
        return r < 0 ? r : read_zone_letter(door, topic, &head.place, out);
    default:
        return read_door_letter(door, topic, bytes, size, out);
    }
}

/* ---- what follows ---- */

/* The answer names the places of the hub, which replace what the link has heard before: only the
 * answer is surely not old. */
static void take_lease(struct link_door *door, const struct iso_fleet_lease *lease)
{
    const bool is_first = !door->has_lease;

    link_answered(door);
    memcpy(door->answered_nonce, lease->nonce, sizeof door->answered_nonce);
    if (door->answered) {
        door->answered(door->update_context);
    }
    if (link_zones_read(door) < 0) {
        return;
    }
    for (size_t i = 0; i < lease->n; i++) {
        struct link_zone *zone = link_zone_of(door, &lease->places[i].zone);
        if (zone) {
            link_zone_aim(door, zone, lease->places[i].sequence);
        }
    }
    door->has_lease = true;
    link_zones_subscribe(door, false);
    if (is_first) {
        link_events_start(door);
        link_requests_start(door);
    } else {
        link_events_acked(door, door->status.acked);
    }
}

static void take_applied(struct link_door *door, enum iso_fleet_kind kind)
{
    switch (kind) {
    case ISO_FLEET_KEY:
        /* With the key, what could not be opened before can be. */
        door->fetch.not_before_us = 0;
        if (link_zones_read(door) == 0) {
            link_zones_subscribe(door, false);
        }
        break;
    case ISO_FLEET_SNAPSHOT:
        door->report.snapshots++;
        link_ask(door);
        break;
    case ISO_FLEET_DELTA:
        door->report.deltas++;
        link_ask(door);
        break;
    default:
        break;
    }
}

void link_act(struct link_door *door, enum iso_fleet_kind kind,
              const struct iso_link_outcome *outcome)
{
    struct link_zone *zone = link_zone_of(door, &outcome->zone);

    if (kind == ISO_FLEET_SNAPSHOT && zone &&
        (outcome->outcome == ISO_FLEET_APPLIED || outcome->outcome == ISO_FLEET_KNOWN)) {
        zone->is_whole_due = false;
    }
    switch (outcome->outcome) {
    case ISO_FLEET_APPLIED:
        take_applied(door, kind);
        break;
    case ISO_FLEET_GAP:
        if (zone) {
            const uint64_t next = zone->mine.sequence + 1;
            link_zone_aim(door, zone, zone->target > next ? zone->target : next);
        }
        break;
    case ISO_FLEET_WHOLE:
        if (zone) {
            zone->is_whole_due = true;
            link_in(door, LINK_DUE_FETCH, 0);
        }
        break;
    case ISO_FLEET_NO_KEY:
        link_ask(door);
        break;
    case ISO_FLEET_REFUSED:
        door->report.refused++;
        link_note(door, "the daemon refuses a message of the hub (kind %d)", (int)kind);
        break;
    case ISO_FLEET_KNOWN:
    case ISO_FLEET_OUTCOMES:
        break;
    }
}

static void follow(struct link_door *door, const struct letter *letter,
                   const struct iso_link_outcome *outcome)
{
    const bool is_applied = outcome->outcome == ISO_FLEET_APPLIED;

    switch (letter->kind) {
    case ISO_FLEET_LEASE:
        /* Whatever lacks, the daemon has taken the answer, unless it refuses it: then it belongs to
         * a question that is no longer open. */
        if (outcome->outcome != ISO_FLEET_REFUSED) {
            take_lease(door, &letter->lease);
        }
        return;
    case ISO_FLEET_ACK:
        if (outcome->outcome != ISO_FLEET_REFUSED) {
            link_events_acked(door, letter->acked);
        }
        return;
    case ISO_FLEET_DELTA:
        if (is_applied) {
            letter->zone->mine.sequence = letter->sequence;
        }
        break;
    default:
        break;
    }
    if (letter->zone && outcome->outcome != ISO_FLEET_REFUSED &&
        letter->sequence > letter->zone->target) {
        letter->zone->target = letter->sequence;
    }
    link_act(door, letter->kind, outcome);
}

void link_hand_newer(struct link_door *door, const void *bytes, size_t size)
{
    struct iso_link_outcome outcome = {.outcome = ISO_FLEET_REFUSED};
    struct iso_fault fault = {.text = ""};

    door->report.refused++;
    link_note(door, "the hub sends messages of a newer version; upgrade isotherm on this door");
    (void)link_daemon_result(
        door, door->daemon.receive(door->daemon.context, bytes, size, &outcome, &fault), &fault);
}

void link_receive(struct link_door *door, const char *topic, const void *bytes, size_t size)
{
    struct letter letter = {.zone = NULL};
    struct iso_link_outcome outcome = {.outcome = ISO_FLEET_REFUSED};
    struct iso_fault fault = {.text = ""};

    /* While the daemon is away, nothing can be taken; when it is back, the question tells what was
     * missed. */
    if (!door->has_daemon) {
        return;
    }
    int r = read_letter(door, topic, bytes, size, &letter);
    if (r == -EPROTONOSUPPORT) {
        link_hand_newer(door, bytes, size);
        return;
    }
    if (r < 0) {
        door->report.forged++;
        link_note(door, "%s: a message that the hub has not sent there: %s", topic, strerror(-r));
        return;
    }
    if (letter.kind == ISO_FLEET_UPDATE) {
        /* An order is for the answer that was taken last: nobody can repeat an earlier one. */
        if (door->ordered && door->has_lease &&
            sodium_memcmp(letter.update.nonce, door->answered_nonce, sizeof door->answered_nonce) ==
                0) {
            door->ordered(door->update_context, &letter.update);
        }
        return;
    }
    r = door->daemon.receive(door->daemon.context, bytes, size, &outcome, &fault);
    if (link_daemon_result(door, r, &fault) == 0) {
        follow(door, &letter, &outcome);
    }
}

/* Handles the messages of the hub, one at a time. */
#include <errno.h>
#include <sodium.h>
#include <string.h>

#include "firmware/fleet/door/fleet_state.h"
#include "firmware/fleet/message/delta.h"
#include "firmware/fleet/message/head.h"

/* A message, and what became of it. */
struct handling {
    struct iso_fleet *fleet;
    const void *bytes;
    size_t size;
    enum iso_fleet_outcome outcome;
    struct iso_fleet_id zone;
};

static int end(struct handling *handling, enum iso_fleet_outcome outcome)
{
    handling->outcome = outcome;
    return 0;
}

/* ---- KEY ---- */

/* Which key of a zone a grant is, for a door that has some. */
static enum iso_fleet_outcome judge_key(const struct iso__fleet_zone *zone, uint64_t epoch)
{
    if (epoch < zone->place.epoch || (zone->has_next && epoch < zone->next.base.epoch)) {
        return epoch == zone->place.epoch ? ISO_FLEET_KNOWN : ISO_FLEET_REFUSED;
    }
    return epoch == zone->place.epoch || (zone->has_next && epoch == zone->next.base.epoch)
               ? ISO_FLEET_KNOWN
               : ISO_FLEET_APPLIED;
}

static int take_key(struct handling *handling, struct iso_fault *fault)
{
    struct iso_fleet *fleet = handling->fleet;
    struct iso_fleet_signer signer;
    struct iso_fleet_receiver receiver;
    struct iso_fleet_key_grant grant = {.reset = false};
    fleet->options.host.keys(fleet->options.host.context, &signer, &receiver);
    int error = iso_fleet_read_key(handling->bytes, handling->size, fleet->record.member.hub_signs,
                                   &receiver, &grant);
    sodium_memzero(&signer, sizeof signer);
    sodium_memzero(&receiver, sizeof receiver);
    struct iso__fleet_record draft = fleet->record;
    struct iso__fleet_zone *zone = error ? NULL : iso__fleet_zone_of(&draft, &grant.base.zone);
    if (!zone || !iso_fleet_id_is_same(&grant.door, &draft.member.door)) {
        error = end(handling, ISO_FLEET_REFUSED);
    } else {
        handling->zone = grant.base.zone;
        error = end(handling, judge_key(zone, grant.base.epoch));
        if (handling->outcome == ISO_FLEET_APPLIED) {
            zone->has_next = true;
            zone->next = grant;
            iso__fleet_advance(zone);
            handling->outcome = zone->wants_snapshot ? ISO_FLEET_WHOLE : ISO_FLEET_APPLIED;
            error = iso__fleet_store(fleet, &draft, NULL, 0, fault);
        }
    }
    sodium_memzero(&grant, sizeof grant);
    sodium_memzero(&draft, sizeof draft);
    return error;
}

/* ---- DELTA ---- */

/* Applies a change; `zone` of the draft is at the place after it. */
static int apply(struct iso_fleet *fleet, struct iso__fleet_record *draft,
                 struct iso__fleet_zone *zone, const struct iso_fleet_change *change,
                 struct iso_fault *fault)
{
    struct iso__fleet_batch *batch = NULL;
    if (change->kind == ISO_FLEET_POLICY) {
        return iso__fleet_take_policy(fleet, draft, zone, change->policy, change->policy_length,
                                      fault);
    }
    if (change->kind == ISO_FLEET_LOCKDOWN) {
        return iso__fleet_take_lockdown(fleet, draft, zone, change->lockdown, fault);
    }
    if (iso__fleet_batch_new(fleet, &zone->place.zone, iso__fleet_zone_bit(draft, zone),
                             zone->place.sequence, 0, &batch)) {
        return iso_fault_set(fault, -ENOMEM, "fleet: out of memory");
    }
    int error = change->kind == ISO_FLEET_PUT
                    ? iso__fleet_put(batch, &change->person, fault)
                    : iso__fleet_withdraw(batch, &change->person.id, fault);
    if (!error) {
        error = iso__fleet_batch_end(batch, draft, fault);
    }
    iso__fleet_batch_free(batch);
    return error;
}

static int open_and_apply(struct handling *handling, const struct iso_fleet_delta *delta,
                          struct iso_fault *fault)
{
    struct iso_fleet *fleet = handling->fleet;
    struct iso__fleet_record draft = fleet->record;
    struct iso__fleet_zone *zone = iso__fleet_zone_of(&draft, &delta->place.zone);
    struct iso_fleet_bytes plain = {.bytes = NULL};
    struct iso_fleet_change change;
    int error = iso_fleet_open_delta(handling->bytes, handling->size, &zone->key, &plain);
    if (!error) {
        error = iso_fleet_read_change(plain.bytes, plain.size, &change);
    }
    if (error == -ENOMEM) {
        error = iso_fault_set(fault, error, "fleet: out of memory");
    } else if (error) {
        if (error == -EPROTONOSUPPORT) {
            iso__fleet_complain_of_newer(fleet);
        }
        error = end(handling, ISO_FLEET_REFUSED);
    } else {
        zone->place = delta->place;
        iso__fleet_advance(zone);
        error = apply(fleet, &draft, zone, &change, fault);
        handling->outcome = ISO_FLEET_APPLIED;
    }
    iso_fleet_bytes_free(&plain);
    sodium_memzero(&draft, sizeof draft);
    return error;
}

/* A delta of a later epoch. The key of an epoch in between will never come: the hub sends only the
 * newest. */
static int take_later_epoch(struct handling *handling, const struct iso__fleet_zone *zone,
                            uint64_t epoch, struct iso_fault *fault)
{
    if (!zone->has_next || epoch > zone->next.base.epoch) {
        return end(handling, ISO_FLEET_NO_KEY);
    }
    if (epoch == zone->next.base.epoch) {
        return end(handling, ISO_FLEET_GAP);
    }
    struct iso__fleet_record draft = handling->fleet->record;
    iso__fleet_zone_of(&draft, &zone->place.zone)->wants_snapshot = true;
    const int error = iso__fleet_store(handling->fleet, &draft, NULL, 0, fault);
    sodium_memzero(&draft, sizeof draft);
    handling->outcome = ISO_FLEET_WHOLE;
    return error;
}

/* A delta of the same epoch that comes after another history: the hub has lost a part of what it
 * had and has gone on. It is refused, and the door says so. */
static int take_foreign(struct handling *handling, const struct iso__fleet_zone *zone,
                        const struct iso_fleet_delta *delta, struct iso_fault *fault)
{
    struct iso__fleet_record draft = handling->fleet->record;
    int error = 0;
    if (delta->place.epoch == zone->place.epoch && !zone->behind) {
        iso__fleet_zone_of(&draft, &zone->place.zone)->behind = true;
        iso__fleet_say_behind(handling->fleet, zone, delta->place.sequence);
        error = iso__fleet_store(handling->fleet, &draft, NULL, 0, fault);
    }
    sodium_memzero(&draft, sizeof draft);
    return error ? error : end(handling, ISO_FLEET_REFUSED);
}

static int take_delta(struct handling *handling, struct iso_fault *fault)
{
    struct iso_fleet *fleet = handling->fleet;
    struct iso_fleet_delta delta;
    if (iso_fleet_read_delta(handling->bytes, handling->size, fleet->record.member.hub_signs,
                             &delta)) {
        return end(handling, ISO_FLEET_REFUSED);
    }
    const struct iso__fleet_zone *zone = iso__fleet_zone_of(&fleet->record, &delta.place.zone);
    if (!zone) {
        return end(handling, ISO_FLEET_REFUSED);
    }
    handling->zone = delta.place.zone;
    const enum iso_fleet_step step = iso_fleet_step_of(&zone->place, &delta);
    if (step == ISO_FLEET_STEP_KNOWN) {
        return end(handling, ISO_FLEET_KNOWN);
    }
    if (zone->wants_snapshot && step != ISO_FLEET_STEP_FOREIGN) {
        return end(handling, ISO_FLEET_WHOLE);
    }
    switch (step) {
    case ISO_FLEET_STEP_NEXT:
        return open_and_apply(handling, &delta, fault);
    case ISO_FLEET_STEP_GAP:
        return end(handling, ISO_FLEET_GAP);
    case ISO_FLEET_STEP_EPOCH:
        return take_later_epoch(handling, zone, delta.place.epoch, fault);
    default:
        return take_foreign(handling, zone, &delta, fault);
    }
}

/* ---- HEAD, ACK ---- */

/* A HEAD may be an old one, so it only says what there is to fetch. */
static int take_head(struct handling *handling)
{
    struct iso_fleet *fleet = handling->fleet;
    struct iso_fleet_head head;
    if (iso_fleet_read_head(handling->bytes, handling->size, fleet->record.member.hub_signs,
                            &head)) {
        return end(handling, ISO_FLEET_REFUSED);
    }
    const struct iso__fleet_zone *zone = iso__fleet_zone_of(&fleet->record, &head.place.zone);
    if (!zone) {
        return end(handling, ISO_FLEET_REFUSED);
    }
    handling->zone = head.place.zone;
    if (head.place.epoch < zone->place.epoch || head.place.sequence <= zone->place.sequence) {
        return end(handling, ISO_FLEET_KNOWN);
    }
    if (zone->wants_snapshot) {
        return end(handling, ISO_FLEET_WHOLE);
    }
    const uint64_t newest = zone->has_next ? zone->next.base.epoch : zone->place.epoch;
    return end(handling, head.place.epoch > newest ? ISO_FLEET_NO_KEY : ISO_FLEET_GAP);
}

static int take_ack(struct handling *handling)
{
    struct iso_fleet *fleet = handling->fleet;
    struct iso_fleet_ack ack;
    if (iso_fleet_read_ack(handling->bytes, handling->size, fleet->record.member.hub_signs, &ack) ||
        !iso_fleet_id_is_same(&ack.door, &fleet->record.member.door) ||
        ack.number > fleet->options.host.last_event(fleet->options.host.context)) {
        return end(handling, ISO_FLEET_REFUSED);
    }
    if (ack.number <= fleet->record.acked) {
        return end(handling, ISO_FLEET_KNOWN);
    }
    fleet->record.acked = ack.number; /* stored with the next change */
    return end(handling, ISO_FLEET_APPLIED);
}

static int handle(struct handling *handling, enum iso_fleet_kind kind, struct iso_fault *fault)
{
    switch (kind) {
    case ISO_FLEET_KEY:
        return take_key(handling, fault);
    case ISO_FLEET_DELTA:
        return take_delta(handling, fault);
    case ISO_FLEET_HEAD:
        return take_head(handling);
    case ISO_FLEET_LEASE:
        return iso__fleet_take_lease(handling->fleet, handling->bytes, handling->size,
                                     &handling->outcome, fault);
    case ISO_FLEET_ACK:
        return take_ack(handling);
    default:
        return end(handling, ISO_FLEET_REFUSED);
    }
}

int iso_fleet_receive(struct iso_fleet *fleet, const void *bytes, size_t size,
                      enum iso_fleet_outcome *outcome, struct iso_fleet_id *zone,
                      struct iso_fault *fault)
{
    struct handling handling = {
        .fleet = fleet, .bytes = bytes, .size = size, .outcome = ISO_FLEET_REFUSED};
    enum iso_fleet_kind kind;
    int error = iso__fleet_ready(fleet, fault);
    if (!error && size <= ISO_FLEET_MESSAGE_MAX) {
        if (iso_fleet_kind_of(bytes, size, &kind) == 0) {
            error = handle(&handling, kind, fault);
        } else if (iso_fleet_is_newer(bytes, size, fleet->record.member.hub_signs)) {
            iso__fleet_complain_of_newer(fleet);
        }
    }
    if (!error) {
        *outcome = handling.outcome;
        *zone = handling.zone;
    }
    return error;
}

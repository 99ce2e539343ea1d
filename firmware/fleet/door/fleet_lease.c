/* The answer of the hub to a question: how long the door may act on its own, and which zones it
 * has. */
#include <errno.h>
#include <sodium.h>
#include <string.h>
#include <syslog.h>

#include "drivers/base/times.h"
#include "firmware/fleet/door/fleet_state.h"

static bool has_same_digest(const struct iso_fleet_place *a, const struct iso_fleet_place *b)
{
    return memcmp(a->digest, b->digest, sizeof a->digest) == 0;
}

void iso__fleet_advance(struct iso__fleet_zone *zone)
{
    const struct iso_fleet_place *base = &zone->next.base;
    if (!zone->has_next) {
        return;
    }
    const bool is_there = zone->place.sequence == base->sequence &&
                          has_same_digest(&zone->place, base);
    /* A door without a key has no history, so only a zone without one begins here. */
    const bool may_begin = zone->place.epoch > 0 || base->sequence == 0;
    if (!zone->next.reset && is_there && may_begin) {
        zone->place.epoch = base->epoch;
        zone->key = zone->next.key;
        zone->has_next = false;
        sodium_memzero(&zone->next, sizeof zone->next);
    } else if (zone->next.reset || !may_begin || zone->place.sequence >= base->sequence) {
        zone->wants_snapshot = true;
    }
}

void iso__fleet_say_behind(const struct iso_fleet *fleet, const struct iso__fleet_zone *zone,
                           uint64_t sequence)
{
    char text[ISO_FLEET_ID_TEXT_SIZE];
    iso__fleet_say(fleet, LOG_ERR,
                   "fleet: the hub knows less than this door: it has another change %llu of zone "
                   "%.8s, and this door has %llu; the door keeps what it has",
                   (unsigned long long)sequence, iso_fleet_id_text(&zone->place.zone, text),
                   (unsigned long long)zone->place.sequence);
}

/* The place of a zone that a question has reported: zeros if it was none of the door's. */
static struct iso_fleet_place reported_place(const struct iso__fleet_question *question,
                                             const struct iso_fleet_id *zone)
{
    for (size_t i = 0; i < question->n; i++) {
        if (iso_fleet_id_is_same(&question->places[i].zone, zone)) {
            return question->places[i];
        }
    }
    return (struct iso_fleet_place){.epoch = 0};
}

/* Whether the places are of different histories. */
static bool contradicts(const struct iso_fleet_place *a, const struct iso_fleet_place *b)
{
    return a->epoch == b->epoch && a->sequence == b->sequence && !has_same_digest(a, b);
}

/* Whether the hub has lost something that this door had when it asked: then the place at the hub is
 * an earlier one or one of another history. What has come to the door since then may be newer than
 * the answer. In a later epoch the hub has seen it itself, and KEY tells. */
static bool is_behind(const struct iso__fleet_zone *zone, const struct iso_fleet_place *asked,
                      const struct iso_fleet_place *hub)
{
    if (asked->epoch == 0 || hub->epoch > asked->epoch) {
        return false;
    }
    return hub->epoch < asked->epoch || hub->sequence < asked->sequence ||
           contradicts(hub, asked) || contradicts(hub, &zone->place);
}

static bool is_same_place(const struct iso_fleet_place *a, const struct iso_fleet_place *b)
{
    return a->epoch == b->epoch && a->sequence == b->sequence && has_same_digest(a, b);
}

static bool is_listed(const struct iso_fleet_lease *lease, const struct iso_fleet_id *zone)
{
    for (size_t i = 0; i < lease->n; i++) {
        if (iso_fleet_id_is_same(&lease->places[i].zone, zone)) {
            return true;
        }
    }
    return false;
}

static bool has_repeated_zone(const struct iso_fleet_lease *lease)
{
    for (size_t i = 0; i < lease->n; i++) {
        for (size_t j = 0; j < i; j++) {
            if (iso_fleet_id_is_same(&lease->places[i].zone, &lease->places[j].zone)) {
                return true;
            }
        }
    }
    return false;
}

/* Takes over the list of zones; those that are not in it are gone already. A zone that becomes the
 * home of the door brings its policy with a snapshot. */
static void list_zones(struct iso_fleet *fleet, struct iso__fleet_record *draft,
                       const struct iso__fleet_question *question,
                       const struct iso_fleet_lease *lease)
{
    for (size_t i = 0; i < lease->n; i++) {
        const struct iso_fleet_place *hub = &lease->places[i];
        struct iso__fleet_zone *zone = iso__fleet_zone_of(draft, &hub->zone);
        if (!zone) {
            zone = iso__fleet_zone_free(draft); /* a list is not longer than the record */
            *zone = (struct iso__fleet_zone){.used = true,
                                             .rank = (uint8_t)i,
                                             .place = {.zone = hub->zone},
                                             .wants_snapshot = hub->sequence > 0};
            continue;
        }
        const struct iso_fleet_place asked = reported_place(question, &hub->zone);
        const bool was_behind = zone->behind;
        zone->wants_snapshot |= i == 0 && zone->rank != 0 && hub->sequence > 0;
        zone->rank = (uint8_t)i;
        zone->behind = is_behind(zone, &asked, hub) ||
                       (was_behind && !is_same_place(&zone->place, hub));
        if (zone->behind && !was_behind) {
            iso__fleet_say_behind(fleet, zone, hub->sequence);
        }
    }
}

/* Removes the grants of zones that are not listed, and the zones. */
static int leave_zones(struct iso_fleet *fleet, const struct iso_fleet_lease *lease,
                       struct iso_fault *fault)
{
    int error = 0;
    for (int i = 0; !error && i < ISO_FLEET_ZONES_MAX; i++) {
        struct iso__fleet_zone *zone = &fleet->record.zones[i];
        if (!zone->used || is_listed(lease, &zone->place.zone)) {
            continue;
        }
        const struct iso__fleet_note note = {.reason = "zone-left", .zone = &zone->place.zone};
        struct iso__fleet_batch *batch = NULL;
        struct iso__fleet_record draft = fleet->record;
        sodium_memzero(&draft.zones[i], sizeof draft.zones[i]);
        error = iso__fleet_note(fleet, &note, true, fault);
        if (!error &&
            iso__fleet_batch_new(fleet, &zone->place.zone,
                                 iso__fleet_zone_bit(&fleet->record, zone), 0, 0, &batch)) {
            error = iso_fault_set(fault, -ENOMEM, "fleet: out of memory");
        }
        if (!error) {
            error = iso__fleet_withdraw_all(batch, &draft, fault);
        }
        iso__fleet_batch_free(batch);
        sodium_memzero(&draft, sizeof draft);
    }
    return error;
}

/* Whether the term has to be stored: it is shorter than the stored one, of another boot, or the
 * stored one has lost an eighth. Otherwise a restart only finds a lease that ends a little
 * earlier, and the disk is spared. */
static bool is_worth_storing(const struct iso_fleet_term *stored, const struct iso_fleet_term *term)
{
    if (stored->length_s != term->length_s) {
        return true;
    }
    if (term->length_s <= ISO__FLEET_TERM_KEPT_S) {
        return false;
    }
    const int64_t later_ns = term->begin.boot_ns - stored->begin.boot_ns;
    return memcmp(stored->begin.boot_id, term->begin.boot_id, sizeof term->begin.boot_id) != 0 ||
           later_ns >= term->length_s * ISO_NS_PER_S / 8;
}

static bool has_other_zones(const struct iso__fleet_record *a, const struct iso__fleet_record *b)
{
    for (int i = 0; i < ISO_FLEET_ZONES_MAX; i++) {
        const struct iso__fleet_zone *one = &a->zones[i], *other = &b->zones[i];
        if (one->used != other->used || one->rank != other->rank ||
            one->wants_snapshot != other->wants_snapshot || one->behind != other->behind) {
            return true;
        }
    }
    return false;
}

/* The question that a lease answers, or NULL. */
static const struct iso__fleet_question *question_of(const struct iso_fleet *fleet,
                                                     const struct iso_fleet_lease *lease)
{
    for (size_t i = 0; i < fleet->n_questions; i++) {
        if (sodium_memcmp(lease->nonce, fleet->questions[i].nonce, sizeof lease->nonce) == 0) {
            return &fleet->questions[i];
        }
    }
    return NULL;
}

/* The same answer is accepted once, and none to an earlier question after it. */
static void forget_until(struct iso_fleet *fleet, const struct iso__fleet_question *question)
{
    const size_t n = (size_t)(question - fleet->questions) + 1;
    fleet->n_questions -= n;
    memmove(fleet->questions, fleet->questions + n, fleet->n_questions * sizeof *question);
}

static int take(struct iso_fleet *fleet, const struct iso__fleet_question *question,
                const struct iso_fleet_lease *lease, struct iso_fault *fault)
{
    int error = leave_zones(fleet, lease, fault);
    if (error) {
        return error;
    }
    struct iso__fleet_record draft = fleet->record;
    list_zones(fleet, &draft, question, lease);
    draft.lease_s = lease->lease_s;
    draft.local_people = lease->local_people;
    /* Also a lower number: a hub that was restored has lost events, and gets them again. */
    draft.acked = lease->acked;
    iso__fleet_give_term(fleet, &draft, question, lease);
    if (draft.local_people != fleet->record.local_people ||
        has_other_zones(&draft, &fleet->record) ||
        is_worth_storing(&fleet->stored_term, &draft.term)) {
        error = iso__fleet_store(fleet, &draft, NULL, 0, fault);
    }
    if (!error) {
        fleet->record = draft;
        forget_until(fleet, question);
    }
    sodium_memzero(&draft, sizeof draft);
    return error;
}

int iso__fleet_take_lease(struct iso_fleet *fleet, const void *bytes, size_t size,
                          enum iso_fleet_outcome *outcome, struct iso_fault *fault)
{
    struct iso_fleet_lease lease;
    const bool is_own = iso_fleet_read_lease(bytes, size, fleet->record.member.hub_signs, &lease) ==
                            0 &&
                        iso_fleet_id_is_same(&lease.door, &fleet->record.member.door);
    const struct iso__fleet_question *question = is_own ? question_of(fleet, &lease) : NULL;
    if (!question || has_repeated_zone(&lease)) {
        *outcome = ISO_FLEET_REFUSED;
        return 0;
    }
    const int error = take(fleet, question, &lease, fault);
    *outcome = ISO_FLEET_APPLIED;
    return error;
}

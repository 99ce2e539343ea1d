/* A lease counts only for a door that has all changes that the hub had when it gave the lease.
 * Otherwise someone who holds changes back, and lets answers pass, could keep a door that does not
 * know of a revocation at work for ever. */
#include "drivers/base/times.h"
#include "firmware/fleet/door/fleet_state.h"

/* Whether the door has everything of a zone up to a place of the hub. A hub that has lost something
 * is behind the door. */
static bool has_place(const struct iso__fleet_record *record, const struct iso_fleet_place *hub)
{
    for (int i = 0; i < ISO_FLEET_ZONES_MAX; i++) {
        const struct iso__fleet_zone *zone = &record->zones[i];
        if (zone->used && iso_fleet_id_is_same(&zone->place.zone, &hub->zone)) {
            const bool has_all = zone->place.epoch >= hub->epoch &&
                                 zone->place.sequence >= hub->sequence;
            return hub->sequence == 0 || zone->behind || (has_all && !zone->wants_snapshot);
        }
    }
    return false;
}

static bool is_level(const struct iso__fleet_record *record, const struct iso_fleet_place *places,
                     size_t n)
{
    for (size_t i = 0; i < n; i++) {
        if (!has_place(record, &places[i])) {
            return false;
        }
    }
    return true;
}

void iso__fleet_give_term(struct iso_fleet *fleet, struct iso__fleet_record *draft,
                          const struct iso__fleet_question *question,
                          const struct iso_fleet_lease *lease)
{
    const struct iso_fleet_clocks now = iso__fleet_now(fleet);
    const struct iso_fleet_term term = {
        .begin = question->at,
        .length_s = lease->lease_s ? lease->lease_s : ISO_FLEET_LEASE_ONLINE_S,
    };
    fleet->waiting.length_s = 0;
    if (is_level(draft, lease->places, lease->n) ||
        iso_fleet_term_left_ns(&term, &now) < iso_fleet_term_left_ns(&draft->term, &now)) {
        draft->term = term;
        return;
    }
    fleet->waiting = term;
    fleet->n_waiting = lease->n;
    for (size_t i = 0; i < lease->n; i++) {
        fleet->waiting_for[i] = lease->places[i];
    }
}

void iso__fleet_level(struct iso_fleet *fleet)
{
    if (fleet->waiting.length_s > 0 &&
        is_level(&fleet->record, fleet->waiting_for, fleet->n_waiting)) {
        fleet->record.term = fleet->waiting; /* stored with the next change */
        fleet->waiting.length_s = 0;
    }
}

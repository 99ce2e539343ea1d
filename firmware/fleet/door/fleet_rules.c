/* The policy of the home zone, and the lockdown of any zone. */
#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <syslog.h>

#include "firmware/fleet/door/fleet_state.h"

/* Stores the policy and the draft in one transaction. *stored: the host did; else it has refused
 * the policy. */
static int offer_policy(struct iso_fleet *fleet, const struct iso__fleet_record *draft,
                        const char *json, bool *stored, struct iso_fault *fault)
{
    const struct iso_fleet_store *store = &fleet->options.store;
    const struct iso_fleet_host *host = &fleet->options.host;
    struct iso_fault why = {.text = ""};
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    char who[ISO_FLEET_TITLE_SIZE + 16];
    (void)snprintf(who, sizeof who, "hub %s", draft->member.hub_name);
    iso__fleet_record_put(draft, &bytes);
    int error = bytes.error ? iso_fault_set(fault, -ENOMEM, "fleet: out of memory")
                            : store->stage(store->context, bytes.bytes, bytes.size, fault);
    iso_fleet_bytes_free(&bytes);
    if (error) {
        return error;
    }
    error = host->policy(host->context, json, who, &why);
    store->unstage(store->context);
    *stored = !error;
    if (error == -EINVAL || error == -EFBIG) {
        iso__fleet_complain(fleet, &why);
        iso__fleet_say(fleet, LOG_ERR, "fleet: the policy of the hub does not fit this door: %s",
                       why.text);
        return 0;
    }
    if (error) {
        fleet->reload = true; /* it may be stored all the same */
        return iso_fault_set_code(fault, why.code, error, "%s", why.text);
    }
    return 0;
}

/* What the transaction of the policy has stored is the fleet's from now on. */
static void adopt(struct iso_fleet *fleet, const struct iso__fleet_record *draft)
{
    const struct iso_fleet_store *store = &fleet->options.store;
    fleet->record = *draft;
    fleet->stored_term = draft->term;
    fleet->index.version = store->version(store->context);
    fleet->work |= ISO_FLEET_WORK_PLACES;
}

/* A policy that does not fit this door (the access point is not in it, a time zone is not known)
 * leaves the earlier one in force, as SetPolicy does; the place goes on, because the next changes
 * of people must not wait for it. The refusal is on record and in the health of the door. */
int iso__fleet_take_policy(struct iso_fleet *fleet, struct iso__fleet_record *draft,
                           const struct iso__fleet_zone *zone, const char *text, size_t length,
                           struct iso_fault *fault)
{
    const struct iso__fleet_note refused = {
        .reason = "policy-refused", .zone = &zone->place.zone, .after = fleet->fault.text};
    bool stored = false;
    if (zone->rank != 0 || !fleet->options.host.policy || (length == 0 && !draft->has_policy)) {
        return iso__fleet_store(fleet, draft, NULL, 0, fault);
    }
    char *json = strndup(text, length);
    if (!json) {
        return iso_fault_set(fault, -ENOMEM, "fleet: out of memory");
    }
    const bool had_policy = draft->has_policy;
    draft->has_policy = length > 0;
    int error = offer_policy(fleet, draft, json, &stored, fault);
    free(json);
    if (error) {
        return error;
    }
    if (stored) {
        adopt(fleet, draft);
        return 0;
    }
    draft->has_policy = had_policy;
    error = iso__fleet_note(fleet, &refused, true, fault);
    return error ? error : iso__fleet_store(fleet, draft, NULL, 0, fault);
}

static bool is_locked_down(const struct iso__fleet_record *record)
{
    for (int i = 0; i < ISO_FLEET_ZONES_MAX; i++) {
        if (record->zones[i].used && record->zones[i].lockdown) {
            return true;
        }
    }
    return false;
}

/* The lockdown of the door is begun before the place is stored, so a kill in between repeats it. It
 * ends when the last zone ends it; a zone that the door leaves ends none. */
int iso__fleet_take_lockdown(struct iso_fleet *fleet, struct iso__fleet_record *draft,
                             struct iso__fleet_zone *zone, bool on, struct iso_fault *fault)
{
    const struct iso_fleet_host *host = &fleet->options.host;
    const struct iso__fleet_note note = {.reason = on ? "lockdown-on" : "lockdown-off",
                                         .zone = &zone->place.zone,
                                         .sequence = zone->place.sequence};
    const bool had = zone->lockdown;
    int error = 0;
    zone->lockdown = on;
    if (host->lockdown && (on || (had && !is_locked_down(draft)))) {
        const int unrecorded = iso__fleet_note(fleet, &note, true, on ? NULL : fault);
        error = !on && unrecorded ? unrecorded : host->lockdown(host->context, on, fault);
    }
    return error ? error : iso__fleet_store(fleet, draft, NULL, 0, fault);
}

/* What changes with time alone: the lease; and what waits for the link. */
#include <syslog.h>

#include "drivers/base/times.h"
#include "firmware/fleet/door/fleet_state.h"

static void follow_lease(struct iso_fleet *fleet, int64_t left_ns)
{
    const bool held = left_ns > 0;
    char why[ISO_FLEET_WHY_SIZE];
    if (held == fleet->lease_held) {
        return;
    }
    fleet->lease_held = held;
    const struct iso__fleet_note note = {.reason = held ? "lease-held" : "lease-over",
                                         .after = held ? NULL : iso_fleet_why(fleet, why)};
    (void)iso__fleet_note(fleet, &note, false, NULL);
    iso__fleet_say(fleet, held ? LOG_NOTICE : LOG_WARNING, "fleet: %s",
                   held ? "the hub has answered: its people are let in" : note.after);
}

/* Whether a word may be told now; else *due_ns is when. */
static bool may_tell(struct iso_fleet *fleet, int word, int64_t now_ns, int64_t *due_ns)
{
    const int64_t wait_ns = fleet->told_ns[word] + ISO_NS_PER_S - now_ns;
    if (fleet->told_ns[word] != 0 && wait_ns > 0) {
        *due_ns = wait_ns < *due_ns ? wait_ns : *due_ns;
        return false;
    }
    fleet->told_ns[word] = now_ns;
    return true;
}

/* Records that were written since the last ones that the link has. */
static void look_for_events(struct iso_fleet *fleet)
{
    const struct iso_fleet_host *host = &fleet->options.host;
    const uint64_t last = host->last_event(host->context);
    if (last > fleet->events_told) {
        fleet->events_told = last;
        if (last > fleet->events_given) {
            fleet->work |= ISO_FLEET_WORK_EVENTS;
        }
    }
}

unsigned iso_fleet_time(struct iso_fleet *fleet, int64_t *due_ns)
{
    unsigned told = 0;
    *due_ns = ISO_NEVER_NS;
    if (!iso_fleet_is_member(fleet) || iso__fleet_ready(fleet, NULL)) {
        return 0;
    }
    const struct iso_fleet_clocks now = iso__fleet_now(fleet);
    const int64_t left_ns = iso_fleet_term_left_ns(&fleet->record.term, &now);
    follow_lease(fleet, left_ns);
    if (left_ns > 0) {
        *due_ns = left_ns;
    }
    look_for_events(fleet);
    for (int word = 0; word < ISO__FLEET_WORDS; word++) {
        const unsigned bit = 1u << word;
        if ((fleet->work & bit) && may_tell(fleet, word, now.boot_ns, due_ns)) {
            told |= bit;
        }
    }
    fleet->work &= ~told;
    return told;
}

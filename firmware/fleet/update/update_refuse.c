/* Refusals: which pass by themselves, and when the order is tried again. */
#include <string.h>
#include <unistd.h>

#include "firmware/fleet/update/update_inner.h"

enum {
    BUSY_TRIES = 8,   /* with RETRY_MS: one to two hours in all */
    DAMAGE_TRIES = 3, /* each fetches or writes the whole file again */
    RETRY_MS = 60000,
    RETRY_CAP_MS = 3600000,
};

/* The codes of `isotherm update FILE` (enroll/cli/image/installer.h) and of the link itself. */
static const struct {
    const char *code;
    unsigned tries;
} reasons[] = {
    {"other-board", 1},
    {"not-newer", 1},
    {"foreign-key", 1},
    {"bad-file", 1},
    {"no-image", 1},
    {"access-denied", 1},
    {"busy", BUSY_TRIES},
    {"on-trial", BUSY_TRIES},
    {"no-reply", BUSY_TRIES},
    {"no-bus", BUSY_TRIES},
    {"interrupted", BUSY_TRIES},
    {"update-fault", BUSY_TRIES},
    {"no-room", BUSY_TRIES},
    {"too-small", 1},
    {"damaged", DAMAGE_TRIES},
    {"not-fetched", DAMAGE_TRIES},
    {"not-taken", DAMAGE_TRIES},
    {"no-result", DAMAGE_TRIES},
    {"disk", DAMAGE_TRIES},
    {"not-installed", DAMAGE_TRIES}, /* RAUC has no code for its reasons; also codes of no reason */
};

enum { OTHER = LINK_UPDATE_REASONS - 1 };

_Static_assert(sizeof reasons / sizeof *reasons == LINK_UPDATE_REASONS,
               "LINK_UPDATE_REASONS is the number of reasons");

size_t link_update_reason(const char *code)
{
    size_t i = 0;

    while (i < OTHER && strcmp(code, reasons[i].code) != 0) {
        i++;
    }
    return i;
}

const char *link_update_reason_code(size_t reason)
{
    return reason < LINK_UPDATE_REASONS ? reasons[reason].code : NULL;
}

unsigned link_update_tries(const char *code)
{
    return reasons[link_update_reason(code)].tries;
}

static unsigned tries_in_all(const struct link_update *u)
{
    unsigned n = 0;

    for (size_t i = 0; i < LINK_UPDATE_REASONS; i++) {
        n += u->record.tries[i];
    }
    return n;
}

/* A random time in the second half of a limit that doubles with each refusal, whatever its reason.
 */
static uint64_t wait_us(const struct link_update *u)
{
    struct link_backoff backoff = {.base_ms = u->setup.retry_ms ? u->setup.retry_ms : RETRY_MS,
                                   .cap_ms = RETRY_CAP_MS,
                                   .failures = tries_in_all(u) - 1};
    const uint64_t half_us = link_backoff_limit_ms(&backoff) * 1000 / 2;
    uint64_t random;

    randombytes_buf(&random, sizeof random);
    return half_us + random % (half_us + 1);
}

void link_update_refused(struct link_update *u, const char *code, const char *why)
{
    const size_t reason = link_update_reason(code);

    if (++u->record.tries[reason] >= reasons[reason].tries) {
        link_update_fail(u, why);
        return;
    }
    link_update_fetch_end(u);
    if (strcmp(code, "damaged") == 0 || strcmp(code, "no-room") == 0) {
        (void)unlink(u->file);
    }
    if (!iso_fleet_id_is_same(&u->order.rollout, &u->record.rollout)) {
        link_update_cancel(u, true); /* after a restart of the link the order has to come first */
        return;
    }
    u->step = LINK_UPDATE_WAIT;
    link_update_set(u, ISO_FLEET_UPDATE_FETCHING, why);
    link_update_note(u, u->record.fault);
    link_update_in(u, wait_us(u) + (link_update_has_file(u) ? 0 : link_update_turn_us(u)));
}

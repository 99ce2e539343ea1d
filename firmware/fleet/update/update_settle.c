/* What became of an order, by a look at the slots. */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "firmware/fleet/update/update_inner.h"

enum { CHECKS_S = 15 }; /* between two looks whether the checks of a version have ended */

static bool runs(const struct link_update *u)
{
    return strcmp(u->slots.version, u->record.version) == 0;
}

/* RAUC may not know the version of the other slot. */
static bool starts_next(const struct link_update *u)
{
    return u->slots.waiting && (!*u->slots.other || strcmp(u->slots.other, u->record.version) == 0);
}

/* RAUC calls each slot good that can be started; only one that was marked as good is proven. */
static bool is_healthy(const struct link_update *u)
{
    return runs(u) && u->slots.good && u->slots.proven;
}

bool link_update_is_on_trial(const struct link_update *u)
{
    return u->step == LINK_UPDATE_INSTALLED &&
           (runs(u) || u->record.state != ISO_FLEET_UPDATE_INSTALLED);
}

/* A version waits for the restart, or the running one for the end of its checks. */
static void wait_for_version(struct link_update *u)
{
    u->step = LINK_UPDATE_INSTALLED;
    link_update_in(u, (link_update_is_on_trial(u) ? CHECKS_S : LINK_UPDATE_QUIET_LOOK_S) *
                          LINK_UPDATE_S_US);
}

static void settle_installed(struct link_update *u)
{
    const char *another = u->slots.waiting ? u->slots.other : u->slots.version;
    char why[ISO_FLEET_UPDATE_FAULT_SIZE];

    if (is_healthy(u)) {
        link_update_set(u, ISO_FLEET_UPDATE_HEALTHY, "");
    } else if (runs(u) || starts_next(u)) {
        wait_for_version(u);
    } else if (!u->slots.waiting &&
               (!*u->record.former || strcmp(another, u->record.former) == 0)) {
        link_update_set(u, ISO_FLEET_UPDATE_WENT_BACK, "the new version did not pass its checks");
    } else {
        (void)snprintf(why, sizeof why, "another way has installed version %s instead", another);
        link_update_fail(u, why);
    }
}

/* The version has passed its checks, and another one runs now. */
static void settle_healthy(struct link_update *u)
{
    if (*u->record.former && strcmp(u->slots.version, u->record.former) == 0) {
        link_update_set(u, ISO_FLEET_UPDATE_WENT_BACK,
                        "the former version runs again, although the new one passed its checks");
    } else {
        u->record.state = ISO_FLEET_UPDATE_IDLE; /* another way has brought another version */
    }
}

/* The image has done with the file, or has lost it. */
static void settle_installing(struct link_update *u)
{
    if (link_update_is_handed_over(u)) {
        u->step = LINK_UPDATE_INSTALL;
        link_update_in(u, 0);
    } else if (runs(u) || starts_next(u)) {
        link_update_set(u, ISO_FLEET_UPDATE_INSTALLED, "");
        settle_installed(u);
    } else {
        link_update_take_result(u);
    }
}

void link_update_settle(struct link_update *u)
{
    u->step = LINK_UPDATE_IDLE;
    switch (u->record.state) {
    case ISO_FLEET_UPDATE_INSTALLED:
        settle_installed(u);
        break;
    case ISO_FLEET_UPDATE_FAILED:
    case ISO_FLEET_UPDATE_WENT_BACK:
        if (is_healthy(u)) { /* another way has brought the version */
            link_update_set(u, ISO_FLEET_UPDATE_HEALTHY, "");
        }
        break;
    case ISO_FLEET_UPDATE_HEALTHY:
        if (!runs(u)) {
            settle_healthy(u);
        }
        break;
    case ISO_FLEET_UPDATE_INSTALLING:
        settle_installing(u);
        break;
    case ISO_FLEET_UPDATE_FETCHING:
        link_update_cancel(u, true); /* the order comes again */
        break;
    default:
        link_update_in(u, LINK_UPDATE_KEEPS_S * LINK_UPDATE_S_US);
        break;
    }
    if (u->step == LINK_UPDATE_IDLE && !u->slots.proven) {
        wait_for_version(u);
    }
    if (u->record.state == ISO_FLEET_UPDATE_INSTALLED ||
        u->record.state == ISO_FLEET_UPDATE_HEALTHY ||
        u->record.state == ISO_FLEET_UPDATE_WENT_BACK) {
        (void)unlink(u->file);
    }
    link_update_tell(u);
}

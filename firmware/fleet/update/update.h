/* Updates of the image of a door, as the hub orders them (firmware/fleet/order/update_order.h). The
 * link hands orders over; this room fetches the file in parts, checks it, hands it over to the
 * image, which installs it, lets the machine restart at a quiet moment, and tells the daemon how
 * far it is, so that the next questions tell the hub.
 *
 *   step       goes on to
 *   LOOK       OFF        this machine takes no updates: isotherm update says so
 *              IDLE       the slots are known, and nothing is under way
 *              INSTALLED  an update was installed, and the machine has not restarted, or the checks
 *                         of the new version have not ended
 *   IDLE       WAIT       there is an order
 *   WAIT       FETCH      after a random part of the time that the order names
 *   FETCH      CHECK      all parts are there
 *   CHECK      INSTALL    the digest is that of the order
 *   INSTALL    LOOK       the image has done with the file
 *   INSTALLED  LOOK       from time to time, as long as the running version is on trial, from
 *                         wherever it has come; the link begins no order in that time
 *   WAIT, FETCH, CHECK  IDLE  the order holds no more
 *   FETCH, CHECK, INSTALL, LOOK
 *              WAIT       something has refused it, and it may succeed later (update_refuse.c); if
 *                         it has to be fetched again, for such a part once more
 *              IDLE       it cannot succeed, or was refused too often
 *
 * What became of a file is decided by a look at the slots: which version runs, whether it is proven
 * or on trial, and which starts next. The image says only why it has refused one. A version is
 * healthy when it is proven, and not before: RAUC calls a slot good that is on trial.
 *
 * An order holds until two answers of the hub in a row have come without it, which the third one
 * shows: one of them may have lost it on its way. It also holds no more when the hub orders another
 * version, be it the one that runs already. A machine whose order holds no more does not restart,
 * but a file that is being installed is installed. If no answer comes for 15 minutes, a complete
 * file is installed as well, and the machine does not restart before the order comes again. The
 * file update.record keeps the result of a rollout over restarts of the link. The link does not
 * try a rollout again that has failed at this door.
 *
 * The link has no right to install anything or to restart the machine. Both are wishes in the
 * folder "hub" of the image's folder of updates, which units of root look at
 * (board/image/README.md):
 *
 *   bundle.part    comes just now, or is to be installed
 *   bundle.raucb   complete, the same file; isotherm-update@hub.service takes it away, installs it,
 *                  and says in ../result-hub.json what became of it; meanwhile it is ../hub.raucb
 *   restart        isotherm-restart@hub.service restarts the machine if an update waits
 *
 * bundle.part is removed when its order is done, holds no more, or has not come for a day, and when
 * the door leaves its fleet. After a restart the rest is fetched if the same file is ordered. */
#ifndef ISO_FIRMWARE_FLEET_UPDATE_UPDATE_H
#define ISO_FIRMWARE_FLEET_UPDATE_UPDATE_H

#include <systemd/sd-event.h>

#include "drivers/base/restart_hours.h"
#include "firmware/fleet/link/link_daemon.h"
#include "firmware/fleet/link/link_http.h"

struct link_update;

struct link_update_setup {
    sd_event *event;
    struct iso_link_daemon daemon;
    struct link_http *http;           /* outlives the object */
    const char *hub_url;              /* "https://HOST:PORT" */
    const char *ca_file;              /* its authority; NULL: plain HTTP, for tests */
    const char *folder;               /* of the record */
    const char *updates;              /* the folder of the image in which updates are */
    const char *program;              /* isotherm(1), which shows the slots */
    struct iso_restart_hours restart; /* when the machine may restart, in local time; also the
                                     daemon has to allow it, which calls the door busy otherwise */
    uint32_t quiet_s;                 /* for how long nobody must have been at the door */
    uint32_t retry_ms;                /* before the second try, twice as much before the third... */
    void *note_context;
    void (*note)(void *context, const char *line); /* one line for people; may be NULL */
};

/* Looks at the slots at once. The texts of the setup are copied. The caller frees *out. -ENOMEM,
 * errors of the event loop, -ENAMETOOLONG. */
int link_update_new(const struct link_update_setup *setup, struct link_update **out,
                    struct iso_fault *fault) __attribute__((warn_unused_result));
void link_update_free(struct link_update *update);

/* The hub has ordered this, and signed it for this door. */
void link_update_ordered(struct link_update *update, const struct iso_fleet_update *order);

/* The hub has answered a question. An order that holds comes next. */
void link_update_answered(struct link_update *update);

/* Removes what is left of updates when the door belongs to no fleet any more; the folders are those
 * of the setup. */
void link_update_forget(const char *folder, const char *updates);

/* What the daemon was told last. */
const struct iso_fleet_update_report *link_update_report(const struct link_update *update);

#endif

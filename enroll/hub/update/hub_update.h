/* Updates of doors: the files that the hub keeps, and rollouts, which bring a version to the doors
 * of a zone in stages (rollout_stage.h). The errors of hub_store.h, and as stated.
 *
 * A door that was told counts as failed, so that a stage always ends,
 *
 *   when it says so, or when it runs its former version again, also after it was healthy;
 *   when it has not reported for HUB_UPDATE_SILENT_S; it is told again when it reports;
 *   when it has reported for HUB_UPDATE_SILENT_S, but has said nothing of its updates, or that it
 *   takes none; it is told again when it says more;
 *   when it has been told, fetching or installed for HUB_UPDATE_STILL_S in all; it stays failed
 *   unless it runs the version, because it would begin the same again.
 *
 * A time in which the hub itself did not look, or in which the rollout was stopped, does not count;
 * nor does the time after a silence, until the door reports again. A rollout that is done runs
 * again when a door that was silent comes back, as long as the zone has had no later one and the
 * door belongs to it.
 * The hub looks when a door of the rollout asks, and once a minute (hub_rollouts_look()).
 *
 *   state of a door   what it means
 *   waiting           it was not told yet; doors are told in the order in which they ask
 *   told              it was sent the order
 *   fetching          it fetches the file, or installs it
 *   installed         it waits for a quiet moment to restart, or is being checked
 *   healthy           it runs the version, and has passed its checks
 *   failed            see above
 *   went-back         its former version runs again
 *   unable            it takes no updates, or the hub has no file for its board; it does not count
 */
#ifndef ISO_ENROLL_HUB_UPDATE_HUB_UPDATE_H
#define ISO_ENROLL_HUB_UPDATE_HUB_UPDATE_H

#include "enroll/hub/store/hub_store.h"
#include "enroll/hub/update/rollout_stage.h"
#include "firmware/fleet/order/update_order.h"

enum {
    HUB_UPDATE_SILENT_S = 30 * 60,
    HUB_UPDATE_STILL_S = 48 * 3600, /* two days have twice the hours in which it may restart */
    HUB_UPDATE_PATH_SIZE = 320,
    HUB_UPDATE_FIRST = 5,            /* doors of the first stage, unless it is said */
    HUB_UPDATE_DOORS_MOST = 1000000, /* of a stage, and failures */
};

/* A file, as the hub keeps it. */
struct hub_update_file {
    char version[ISO_FLEET_UPDATE_WORD_SIZE], board[ISO_FLEET_UPDATE_WORD_SIZE];
    uint64_t size;
    uint8_t sha256[32];
    int64_t added_s;
};

/* Where the hub keeps a file: "updates/SHA256.raucb" in the folder of its keys. */
void hub_update_path(const struct hub_store *store, const uint8_t sha256[32],
                     char path[HUB_UPDATE_PATH_SIZE]);

/* Stores the row of a file that is in its place (update_keep.h). -EEXIST there is one of this
 * version for this board. */
int hub_update_add(struct hub_store *store, const struct hub_update_file *file,
                   struct iso_fault *fault) __attribute__((warn_unused_result));

/* Deletes the rows and the files of a version. A stopped rollout of it cannot go on any more.
 * -ENOENT; -EALREADY a rollout of it is running. */
int hub_update_remove(struct hub_store *store, const char *version, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* All files, the oldest first. */
int hub_update_each(struct hub_store *store,
                    int (*each)(void *context, const struct hub_update_file *file), void *context,
                    struct iso_fault *fault) __attribute__((warn_unused_result));

struct hub_rollout_options {
    const char *version, *zone;
    uint32_t first, stop_after, wait_s; /* first: at least 1 */
};

/* Begins a rollout for the doors that the zone has now. A stopped one of the zone is replaced.
 * -ENOENT there is no such version or zone; -EALREADY a rollout of the zone is running, or one of
 * its doors takes part in a running one of another zone; -ENODATA no door of the zone has joined.
 */
int hub_rollout_start(struct hub_store *store, const struct hub_rollout_options *options,
                      struct iso_fault *fault) __attribute__((warn_unused_result));

/* Stops the rollout of a zone: no door is told any more, and the orders of those that were told
 * hold no more. `id` is the rollout that is meant, or NULL for whichever it is. -ENOENT, -EALREADY
 * it does not run; -ESRCH another one of the zone runs. */
int hub_rollout_stop(struct hub_store *store, const char *zone, const struct iso_fleet_id *id,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

/* Lets a stopped one go on. What has failed so far does not count any more. -EALREADY none was
 * stopped, or a door takes part in a running one of another zone; -ENOENT also: its version was
 * removed; -ESRCH another one of the zone was stopped. */
int hub_rollout_resume(struct hub_store *store, const char *zone, const struct iso_fleet_id *id,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

/* Looks at all running rollouts, whose doors may all be silent. The leader calls this once a minute
 * as long as the broker is connected; without it a rollout is looked at when one of its doors asks.
 * A rollout that cannot be looked at keeps no other from it; the first error is returned. */
int hub_rollouts_look(struct hub_store *store, struct iso_fault *fault)
    __attribute__((warn_unused_result));

struct hub_rollout {
    struct iso_fleet_id id;
    char version[ISO_FLEET_UPDATE_WORD_SIZE];
    char zone[HUB_NAME_SIZE];
    const char *why; /* it was stopped; belongs to the call */
    struct hub_rollout_stage stage;
    struct hub_rollout_count count;
    int64_t doors, healthy, unable; /* also those that did not have to be told */
    int64_t started_s;
};

/* All rollouts, the newest last. */
int hub_rollout_each(struct hub_store *store,
                     int (*each)(void *context, const struct hub_rollout *rollout), void *context,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

struct hub_rollout_door {
    const char *name, *state;
    const char *fault; /* why it has failed, is unable, or is not further; "": nothing is known */
    int64_t changed_s, reported_s; /* 0: never */
};

/* The doors of the newest rollout of a zone, by state and name. -ENOENT. */
int hub_rollout_doors(struct hub_store *store, const char *zone,
                      int (*each)(void *context, const struct hub_rollout_door *door),
                      void *context, struct iso_fault *fault) __attribute__((warn_unused_result));

/* "running", "stopped", "done", "replaced". */
const char *hub_rollout_state_word(enum hub_rollout_state state);

#endif

/* What a hub works with: its database, its keys, and in whose name it acts. One store belongs to
 * one thread; several stores, also of several processes, may work on the same database.
 *
 * Each function of the rooms store, people and answer is one transaction, which is done as a whole
 * or not at all. The functions return 0 or a negative errno with a one-line fault: the errors of
 * hub_db.h, and these:
 *
 *   -ENOENT  there is no zone, door, person or request of this name or id
 *   -EEXIST  the name is taken
 *   -EINVAL  a name or value is not allowed
 *   -ESTALE  the zone is behind its doors, because the database was restored from an old copy
 *            (hub_zone_recover)
 *
 * After an error the outputs are untouched. Functions that list rows pass each row to `each`, which
 * may return a value other than 0 to end the list; this value is then returned. `each` must not use
 * the store. */
#ifndef ISO_ENROLL_HUB_STORE_HUB_STORE_H
#define ISO_ENROLL_HUB_STORE_HUB_STORE_H

#include "enroll/hub/store/hub_db.h"
#include "enroll/hub/store/hub_keys.h"
#include "firmware/fleet/message/membership.h"
#include "firmware/fleet/message/place.h"

enum {
    HUB_NAME_SIZE = ISO_FLEET_TITLE_SIZE, /* of a zone, a door or the hub */
    HUB_ACTOR_SIZE = 65,
    HUB_FOLDER_SIZE = 240,
};

struct hub_store {
    struct hub_db *db;
    struct hub_keys keys;
    char hub_name[HUB_NAME_SIZE];
    char actor[HUB_ACTOR_SIZE];    /* who acts, for the table of acts: "anna", "hub" */
    char updates[HUB_FOLDER_SIZE]; /* the folder of files for doors (enroll/hub/update) */
    /* Seconds since 1970. Tests set their own clock. */
    int64_t (*now_s)(void);
    uint64_t leader_generation; /* of the connection that holds the leader's lock; 0: none */
};

struct hub_store_options {
    const char *conninfo, *key_file, *hub_name, *actor;
};

/* Reads the keys, connects and checks the version of the schema. Files for doors are in the folder
 * "updates" next to the keys. -ENAMETOOLONG the path of the keys is too long; the errors of
 * hub_keys_read, hub_db_open and hub_schema_check. The caller closes the store. */
int hub_store_open(const struct hub_store_options *options, struct hub_store *out,
                   struct iso_fault *fault) __attribute__((warn_unused_result));

/* Disconnects and wipes the keys. A store of zeros is accepted. */
void hub_store_close(struct hub_store *store);

/* Checks and copies the name of a zone, a door or a hub: 1 to 64 bytes of UTF-8 by the rules for
 * names of people. -EINVAL; `what` begins the fault: "door". */
int hub_name_take(const char *what, const char *name, char out[HUB_NAME_SIZE],
                  struct iso_fault *fault) __attribute__((warn_unused_result));

/* One of the changes that the hub itself records. */
struct hub_act {
    int64_t number, time_s;
    const char *actor, *what, *object, *before, *after; /* before, after: JSON, or "" */
};

/* The newest `most` acts, oldest first. */
int hub_act_each(struct hub_store *store, uint32_t most,
                 int (*each)(void *context, const struct hub_act *act), void *context,
                 struct iso_fault *fault) __attribute__((warn_unused_result));

#endif

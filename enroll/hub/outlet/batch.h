/* What an outlet hands over at once. Internal to the outlets. */
#ifndef ISO_ENROLL_HUB_OUTLET_BATCH_H
#define ISO_ENROLL_HUB_OUTLET_BATCH_H

#include "enroll/hub/outlet/hub_outlet.h"

enum { HUB__BATCH_EVENTS_MOST = 200, HUB__BATCH_DOORS_MOST = 64 };

/* An outlet with what its thread needs besides. The owner wipes it. */
struct hub__outlet_row {
    struct hub_outlet outlet; /* without `waiting` */
    int64_t next_attempt_ms;
    char secret[HUB_OUTLET_SECRET_SIZE];
    char *ca; /* PEM, or NULL */
};

/* Reads the row of an outlet by its id, or by its name if `id` is NULL. -ENOENT; -EBADMSG the key
 * file does not belong to the database. */
int hub__outlet_load(struct hub_store *store, const struct iso_fleet_id *id, const char *name,
                     struct hub__outlet_row *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));
void hub__outlet_wipe(struct hub__outlet_row *row);

/* An event of a batch. The texts belong to the batch. */
struct hub__batch_event {
    struct iso_fleet_id door;
    const char *door_name;
    uint64_t number;
    const char *time, *event, *record; /* record: JSON */
};

/* n is 0: there is nothing to hand over. The owner clears it. */
struct hub__batch {
    struct iso_fleet_id key;
    size_t n;
    PGresult *rows;
    const struct hub__batch_event *one; /* in place of rows: the test */
};

/* Takes the batch that is in flight, or makes the next one and stores what it is. Doors take turns,
 * so that one that writes much does not keep others waiting. */
int hub__batch_take(struct hub_store *store, const struct hub_outlet *outlet,
                    struct hub__batch *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));
void hub__batch_clear(struct hub__batch *batch);
struct hub__batch_event hub__batch_event(const struct hub__batch *batch, size_t i);

/* The receiver has the batch: the cursors move. A batch that another process has confirmed before
 * counts once. */
int hub__batch_done(struct hub_store *store, const struct iso_fleet_id *outlet,
                    const struct hub__batch *batch, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* It does not have it: what is stored of the failure. */
int hub__batch_failed(struct hub_store *store, const struct iso_fleet_id *outlet, uint64_t failures,
                      int64_t next_attempt_ms, bool stop, const char *trouble,
                      struct iso_fault *fault) __attribute__((warn_unused_result));

#endif

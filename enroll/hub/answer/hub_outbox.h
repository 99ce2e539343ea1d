/* What the leader among the processes of a hub publishes, and how it learns of it. The table of
 * deltas is the queue; a notification of the database is only a hint. Errors as in
 * enroll/hub/store/hub_store.h. */
#ifndef ISO_ENROLL_HUB_ANSWER_HUB_OUTBOX_H
#define ISO_ENROLL_HUB_ANSWER_HUB_OUTBOX_H

#include "enroll/hub/answer/hub_answer.h"

/* How far each zone is in what was emitted. */
struct hub_outbox_zone {
    struct iso_fleet_id zone;
    uint64_t published, published_epoch;
};

/* The progress of a zone's new epoch: the keys of the doors up to `last` were emitted. */
struct hub_outbox_keys {
    struct iso_fleet_id zone;
    uint64_t epoch;
    struct iso_fleet_id last;
};

/* What was emitted and is not confirmed yet. All zero: nothing. It belongs to the caller, who keeps
 * it from call to call and frees it with hub_outbox_free(). */
struct hub_outbox {
    struct hub_outbox_zone *zones;
    size_t n;
    bool more;                    /* a zone has more deltas than were emitted */
    struct hub_outbox_keys *keys; /* new epochs of which not all doors have their keys yet */
    size_t n_keys;
};

/* Keys of a zone in one call; the caller's event loop waits for them. */
enum { HUB_OUTBOX_KEYS = 200 };

/* Emits what the broker does not have: for each zone the KEY of a new epoch for each of its doors,
 * at most HUB_OUTBOX_KEYS at once; if all doors have theirs, the new deltas in their order, at most
 * `most` of each zone; and the HEAD (retained) if all of them were emitted. Call it again, after
 * hub_outbox_confirm(), until outbox->n is 0. What was not confirmed is emitted again; after an
 * error, or if the broker may have lost something, free the outbox. */
int hub_outbox_emit(struct hub_store *store, uint32_t most, const struct hub_emit *emit,
                    struct hub_outbox *outbox, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Stores that the broker has what was emitted, and forgets it but for the keys. */
int hub_outbox_confirm(struct hub_store *store, struct hub_outbox *outbox, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Frees all of it, and makes it empty. */
void hub_outbox_free(struct hub_outbox *outbox);

/* The HEAD of every zone again, for a broker that may have lost what it retained. */
int hub_outbox_heads(struct hub_store *store, const struct hub_emit *emit, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The number of the advisory lock that the leader holds. */
#define HUB_LEADER_LOCK "7311466418"

/* Tries to become the leader, who alone publishes: a lock of this store's session. *is_leader says
 * whether it is one now; also for one who is already. Call it regularly: a lost connection loses
 * the lock, and then another process may have it. */
int hub_leader_try(struct hub_store *store, bool *is_leader, struct iso_fault *fault)
    __attribute__((warn_unused_result));
int hub_leader_leave(struct hub_store *store, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Lets the database notify this store of changes. *fd becomes readable then; it belongs to the
 * store and changes when the connection is made anew, so call this after each -ENOTCONN. */
int hub_listen(struct hub_store *store, int *fd, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Takes all notifications that have arrived; *changed says whether there was one. Does not wait. */
int hub_listen_take(struct hub_store *store, bool *changed, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif

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

/* What was emitted and is not confirmed yet. All zero: nothing. Free it with hub_outbox_free(). */
struct hub_outbox {
    struct hub_outbox_zone *zones;
    size_t n;
    bool more; /* a zone has more deltas than were emitted */
};

/* Emits what the broker does not have: for each zone the KEY of a new epoch for each of its doors,
 * the new deltas in their order, at most `most` of each zone, and the HEAD (retained) if all of
 * them were emitted. *out is written in any case. It counts as published only after
 * hub_outbox_confirm(), so without that the next call emits the same again. */
int hub_outbox_emit(struct hub_store *store, uint32_t most, const struct hub_emit *emit,
                    struct hub_outbox *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Stores that the broker has what was emitted. */
int hub_outbox_confirm(struct hub_store *store, const struct hub_outbox *outbox,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

/* Frees the zones, and makes it empty. */
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

/* The hub's answers to the messages of doors: from bytes to the database and back to bytes. The
 * caller brings the bytes from the broker or an HTTPS request, and sends what is emitted. Errors as
 * in enroll/hub/store/hub_store.h, and for messages of doors
 *   -EACCES       the door is unknown, has not joined, or is expelled
 *   -EKEYREJECTED somebody else has signed it, or it is sealed for another hub
 *   -EBADMSG, -EPROTONOSUPPORT it is no message of this kind, or of a newer version
 * Such a message is dropped; the caller logs the fault. After -ENOTCONN and -EAGAIN the same
 * message may be tried again. */
#ifndef ISO_ENROLL_HUB_ANSWER_HUB_ANSWER_H
#define ISO_ENROLL_HUB_ANSWER_HUB_ANSWER_H

#include "enroll/hub/store/hub_store.h"
#include "firmware/fleet/message/door_mail.h"
#include "firmware/fleet/order/update_order.h"

/* Takes a message for the broker; topic and bytes are valid during the call. An error ends the
 * function that emits, which returns it. */
struct hub_emit {
    int (*emit)(void *context, const char *topic, const void *bytes, size_t size, bool retain);
    void *context;
};

/* A message of any kind from a door's `out` topic: QUESTION, EVENTS or REQUEST, by its kind.
 * -EBADMSG also: another kind, or the door of the message is not `door` of the topic. */
int hub_take(struct hub_store *store, const struct iso_fleet_id *door, const void *bytes,
             size_t size, const struct hub_emit *emit, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Stores the report. Emits the LEASE, then a KEY for each zone of the door of which it has another
 * epoch, then an UPDATE if the door shall install one. A place that is ahead of the zone's own, or
 * of another history, marks the zone as behind its doors (hub_zone.h). */
int hub_take_question(struct hub_store *store, const void *bytes, size_t size,
                      const struct hub_emit *emit, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Stores each record once. Emits an ACK with the highest number up to which no number is missing. A
 * message contains all records that the door still has between its first and its last number. So a
 * number in between without a record was deleted at the door, and counts as stored. */
int hub_take_events(struct hub_store *store, const void *bytes, size_t size,
                    const struct hub_emit *emit, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Stores a request. It is approved at once if the door's home zone says so and no other person has
 * the name. */
int hub_take_request(struct hub_store *store, const void *bytes, size_t size,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

enum {
    HUB_FETCH_BYTES_MAX = 16 << 20, /* of deltas in one answer; the door asks again for the rest */
    HUB_SNAPSHOT_AGE_MAX = 1000,    /* a snapshot that is more deltas old is made anew */
};

enum hub_fetch_answer { HUB_ANSWER_DELTAS, HUB_ANSWER_SNAPSHOT };

/* Answers a FETCH, the body of an HTTPS request. `write` takes the next bytes of the answer, and
 * ends it by an error. DELTAS: messages, each behind its length as u32, at most
 * HUB_FETCH_BYTES_MAX; the answer is empty if there are none, and a snapshot if the hub does not
 * have all of them any more. A door must belong to the zone: -EACCES. */
int hub_answer_fetch(struct hub_store *store, const void *bytes, size_t size,
                     int (*write)(void *context, const void *bytes, size_t size), void *context,
                     enum hub_fetch_answer *what, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Answers a FETCH for a part of the file of an update: *fd (the caller closes it) has the bytes,
 * from *offset on *length of them, ISO_FLEET_UPDATE_PART_BYTES at most and 0 at the end. -EACCES
 * the rollout has not told the door, or does not run any more; -EAGAIN the file is not on this
 * machine. */
int hub_answer_update(struct hub_store *store, const void *bytes, size_t size, int *fd,
                      uint64_t *offset, uint64_t *length, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Whether the bytes say that they are such a FETCH; nothing is verified. */
bool hub_fetch_is_update(const void *bytes, size_t size);

/* Makes a snapshot of a zone and stores it in place of older ones. */
int hub_snapshot_make(struct hub_store *store, const struct iso_fleet_id *zone,
                      struct iso_fault *fault) __attribute__((warn_unused_result));

#endif

/* What a door sends home besides its questions, and the hub's acknowledgement. Pure.
 *
 *   EVENTS   door[16], first u64, last u64, sealed records: lines of the door's log
 * (firmware/audit/ audit.h), each ended by a newline ACK      door[16], number u64 REQUEST
 * door[16], person[16], sealed person (change.h) FETCH    door[16], nonce[16], time i64, zone[16],
 * after u64, what u8
 *
 * Events arrive at least once. The hub stores each once, because its key is the door and the
 * number. A FETCH is the body of an HTTPS request; the hub answers with DELTA messages, each behind
 * its length as u32, with a SNAPSHOT, or with a part of the file of an update
 * (firmware/fleet/order/update_order.h). */
#ifndef ISO_FIRMWARE_FLEET_MESSAGE_DOOR_MAIL_H
#define ISO_FIRMWARE_FLEET_MESSAGE_DOOR_MAIL_H

#include "firmware/fleet/message/change.h"
#include "firmware/fleet/message/lease.h"

struct iso_fleet_events {
    struct iso_fleet_id door;
    uint64_t first, last; /* numbers of the records */
};

/* -ENOMEM. */
int iso_fleet_make_events(const struct iso_fleet_events *events, const char *lines, size_t size,
                          const uint8_t hub[ISO_FLEET_PUBLIC_BYTES],
                          const struct iso_fleet_signer *signer, struct iso_fleet_bytes *out)
    __attribute__((warn_unused_result));

/* The caller frees the lines, which are not terminated. Errors of iso_fleet_verify() and
 * iso_fleet_take_sealed(). */
int iso_fleet_read_events(const void *bytes, size_t size,
                          const uint8_t signer[ISO_FLEET_PUBLIC_BYTES],
                          const struct iso_fleet_receiver *hub, struct iso_fleet_events *out,
                          struct iso_fleet_bytes *lines) __attribute__((warn_unused_result));

struct iso_fleet_ack {
    struct iso_fleet_id door;
    uint64_t number; /* all events up to this one are stored */
};

int iso_fleet_make_ack(const struct iso_fleet_ack *ack, const struct iso_fleet_signer *signer,
                       struct iso_fleet_bytes *out) __attribute__((warn_unused_result));
int iso_fleet_read_ack(const void *bytes, size_t size, const uint8_t signer[ISO_FLEET_PUBLIC_BYTES],
                       struct iso_fleet_ack *out) __attribute__((warn_unused_result));

/* A person who was enrolled at the door. */
int iso_fleet_make_request(const struct iso_fleet_id *door, const struct iso_fleet_person *person,
                           const uint8_t hub[ISO_FLEET_PUBLIC_BYTES],
                           const struct iso_fleet_signer *signer, struct iso_fleet_bytes *out)
    __attribute__((warn_unused_result));

/* The caller frees `body`, in which the texts and templates of the person stay. */
int iso_fleet_read_request(const void *bytes, size_t size,
                           const uint8_t signer[ISO_FLEET_PUBLIC_BYTES],
                           const struct iso_fleet_receiver *hub, struct iso_fleet_id *door,
                           struct iso_fleet_bytes *body, struct iso_fleet_person *person)
    __attribute__((warn_unused_result));

enum iso_fleet_wanted {
    ISO_FLEET_WANT_DELTAS = 1,
    ISO_FLEET_WANT_SNAPSHOT = 2,
    ISO_FLEET_WANT_UPDATE = 3
};

struct iso_fleet_fetch {
    struct iso_fleet_id door, zone; /* UPDATE: the rollout in place of a zone */
    uint8_t nonce[ISO_FLEET_NONCE_BYTES];
    int64_t time_s;
    uint64_t after; /* DELTAS: those with higher numbers, in their order; UPDATE: bytes */
    enum iso_fleet_wanted what;
};

int iso_fleet_make_fetch(const struct iso_fleet_fetch *fetch, const struct iso_fleet_signer *signer,
                         struct iso_fleet_bytes *out) __attribute__((warn_unused_result));
int iso_fleet_read_fetch(const void *bytes, size_t size,
                         const uint8_t signer[ISO_FLEET_PUBLIC_BYTES], struct iso_fleet_fetch *out)
    __attribute__((warn_unused_result));

#endif

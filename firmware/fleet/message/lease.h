/* A door asks, and the hub allows it to act on its own for a while (QUESTION and LEASE of
 * envelope.h). Pure.
 *
 *   QUESTION  door[16], nonce[16], time i64, algorithm u32, last event u64, n places, health text
 *   LEASE     door[16], nonce[16], time i64, lease u32, flags u8, acked event u64, n places
 *
 * The answer repeats the door's random nonce, so nobody can keep an answer and send it later. The
 * lease begins when the door made the question, by a clock of the door that nobody sets, so it
 * needs no common time. The places say how far the zones of this door are at the hub; a zone that
 * is not among them is no longer this door's. */
#ifndef ISO_FIRMWARE_FLEET_MESSAGE_LEASE_H
#define ISO_FIRMWARE_FLEET_MESSAGE_LEASE_H

#include <stdbool.h>

#include "firmware/fleet/message/place.h"

enum {
    ISO_FLEET_NONCE_BYTES = 16,
    ISO_FLEET_HEALTH_MAX = 4096, /* bytes */
    ISO_FLEET_LEASE_DEFAULT_S = 24 * 3600,
    /* A lease of 0 means "never without the hub": the answer then holds for this time. The door
     * asks again after half of it. */
    ISO_FLEET_LEASE_ONLINE_S = 10,
};

/* What a door has, and that it asks for a lease. */
struct iso_fleet_question {
    struct iso_fleet_id door;
    uint8_t nonce[ISO_FLEET_NONCE_BYTES];
    int64_t time_s;      /* of the door; 0: its clock is not set */
    uint32_t algorithm;  /* whose templates it searches */
    uint64_t last_event; /* number of the newest record of its log */
    size_t n;
    struct iso_fleet_place places[ISO_FLEET_ZONES_MAX];
    const char *health; /* a JSON object about the door, for people; not terminated when read */
    size_t health_length;
};

struct iso_fleet_lease {
    struct iso_fleet_id door;
    uint8_t nonce[ISO_FLEET_NONCE_BYTES];
    int64_t time_s;    /* of the hub */
    uint32_t lease_s;  /* 0: ISO_FLEET_LEASE_ONLINE_S */
    bool local_people; /* people who were enrolled at the door and are not approved are admitted */
    uint64_t acked;    /* events up to this number are stored */
    size_t n;
    struct iso_fleet_place places[ISO_FLEET_ZONES_MAX]; /* the first zone has the door's policy */
};

/* -ENOMEM. */
int iso_fleet_make_question(const struct iso_fleet_question *question,
                            const struct iso_fleet_signer *signer, struct iso_fleet_bytes *out)
    __attribute__((warn_unused_result));
int iso_fleet_make_lease(const struct iso_fleet_lease *lease, const struct iso_fleet_signer *signer,
                         struct iso_fleet_bytes *out) __attribute__((warn_unused_result));

/* Errors of iso_fleet_verify(). To find the key of a door, the hub reads the door's id before it
 * verifies: iso_fleet_door_of(). */
int iso_fleet_read_question(const void *bytes, size_t size,
                            const uint8_t signer[ISO_FLEET_PUBLIC_BYTES],
                            struct iso_fleet_question *out) __attribute__((warn_unused_result));
int iso_fleet_read_lease(const void *bytes, size_t size,
                         const uint8_t signer[ISO_FLEET_PUBLIC_BYTES], struct iso_fleet_lease *out)
    __attribute__((warn_unused_result));

/* The door that says it has sent the message; its first field. -EBADMSG it has none. */
int iso_fleet_door_of(const void *bytes, size_t size, struct iso_fleet_id *door)
    __attribute__((warn_unused_result));

#endif

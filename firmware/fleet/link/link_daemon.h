/* What the link asks of the daemon of its door. The link has the network and no secret of the
 * fleet; the daemon has the keys and no network. Each function is one method of the bus
 * (firmware/contract/fleet_words.h); tests and measurements call the daemon's code directly.
 *
 * All functions wait for the answer. They return 0 or a negative errno with a fault: -ENOTCONN the
 * daemon does not answer, -ENOENT the door belongs to no fleet, -EIO the daemon could not store
 * something. After an error the outputs are untouched. */
#ifndef ISO_FIRMWARE_FLEET_LINK_LINK_DAEMON_H
#define ISO_FIRMWARE_FLEET_LINK_LINK_DAEMON_H

#include <stdbool.h>

#include "core/base/fault.h"
#include "firmware/contract/fleet_words.h"
#include "firmware/fleet/message/door_mail.h"
#include "firmware/fleet/message/membership.h"
#include "firmware/fleet/order/update_order.h"

/* What the daemon has of its fleet. */
struct iso_link_status {
    struct iso_fleet_id door;
    uint8_t hub_signs[ISO_FLEET_PUBLIC_BYTES];
    uint64_t last_event, acked; /* of the log */
    uint32_t lease_s;           /* of the last answer; 0: ISO_FLEET_LEASE_ONLINE_S */
    size_t n;
    struct iso_fleet_place places[ISO_FLEET_ZONES_MAX];
    bool wants_snapshot[ISO_FLEET_ZONES_MAX]; /* the zone has to be fetched whole */
};

/* What became of a message. */
struct iso_link_outcome {
    enum iso_fleet_outcome outcome;
    struct iso_fleet_id zone; /* of KEY, DELTA and HEAD; zeros: several, or none */
};

struct iso_link_daemon {
    void *context;
    int (*status)(void *context, struct iso_link_status *out, struct iso_fault *fault);
    /* Makes a QUESTION with a new nonce. The daemon accepts the answers to the last four questions.
     */
    int (*question)(void *context, struct iso_fleet_bytes *out, struct iso_fault *fault);
    /* Hands over a message of the hub. A message that is refused is no error. */
    int (*receive)(void *context, const void *bytes, size_t size, struct iso_link_outcome *out,
                   struct iso_fault *fault);
    /* A signed FETCH for a zone. */
    int (*fetch)(void *context, const struct iso_fleet_id *zone, enum iso_fleet_wanted what,
                 struct iso_fleet_bytes *out, struct iso_fault *fault);
    /* Hands over a SNAPSHOT as a file, which the daemon reads from its beginning. */
    int (*snapshot)(void *context, int fd, struct iso_link_outcome *out, struct iso_fault *fault);
    /* EVENTS with at most `most` records after number `after`. *last is the number of the last one;
     * 0: there are none, and `out` stays empty. */
    int (*events)(void *context, uint64_t after, uint32_t most, struct iso_fleet_bytes *out,
                  uint64_t *last, struct iso_fault *fault);
    /* Calls `each` with a REQUEST for each person who was enrolled at the door and whom the hub
     * does not know. */
    int (*requests)(void *context, void (*each)(void *context, const void *bytes, size_t size),
                    void *each_context, struct iso_fault *fault);
    /* What the next questions tell about the image of the door. *busy: somebody is at the door. */
    int (*update)(void *context, const struct iso_fleet_update_report *report, bool *busy,
                  struct iso_fault *fault);
    /* A signed FETCH for the part of an update that begins after so many bytes. */
    int (*fetch_update)(void *context, const struct iso_fleet_id *rollout, uint64_t after,
                        struct iso_fleet_bytes *out, struct iso_fault *fault);
};

#endif

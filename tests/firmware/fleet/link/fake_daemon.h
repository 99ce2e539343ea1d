/* A daemon for tests of the link: it keeps the places of its zones in memory, opens every delta,
 * and counts what it gets. */
#ifndef TESTS_FLEET_LINK_FAKE_DAEMON_H
#define TESTS_FLEET_LINK_FAKE_DAEMON_H

#include "firmware/fleet/link/link_daemon.h"
#include "firmware/fleet/message/zone_key.h"

struct fake_zone {
    struct iso_fleet_place place;
    struct iso_fleet_zone_key key;
    bool has_key, wants_snapshot;
    uint64_t base; /* where the epoch begins */
};

struct fake_daemon {
    bool is_away; /* it does not answer */
    bool is_full; /* it can store no snapshot, and list no requests */
    struct iso_fleet_id door;
    struct iso_fleet_signer signer;
    struct iso_fleet_receiver receiver;
    uint8_t hub_signs[ISO_FLEET_PUBLIC_BYTES], hub_receives[ISO_FLEET_PUBLIC_BYTES];
    struct fake_zone zones[ISO_FLEET_ZONES_MAX];
    size_t n;
    uint8_t nonce[ISO_FLEET_NONCE_BYTES];
    uint32_t lease_s;
    uint64_t last_event, acked;
    uint32_t requests;    /* people who wait for approval */
    size_t request_bytes; /* of the template of each */
    /* counts */
    uint64_t received, applied, known, refused, snapshots, snapshot_people, leases;
};

void fake_daemon_init(struct fake_daemon *daemon, const uint8_t *hub_signs,
                      const uint8_t *hub_receives);
struct iso_link_daemon fake_daemon_calls(struct fake_daemon *daemon);

#endif

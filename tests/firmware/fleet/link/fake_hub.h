/* A hub for tests of the link: zones in memory, answers over a broker and over HTTPS. It signs and
 * seals as the hub does. */
#ifndef TESTS_FLEET_LINK_FAKE_HUB_H
#define TESTS_FLEET_LINK_FAKE_HUB_H

#include "firmware/fleet/link/link_mqtt.h"
#include "tests/firmware/fleet/link/fake_daemon.h"
#include "tests/firmware/fleet/link/fetch_server.h"

enum { HUB_DELTAS = 2048, HUB_EVENTS = 4096, HUB_ZONES = 4 };

struct hub_zone {
    struct iso_fleet_place place;
    struct iso_fleet_zone_key key;
    struct iso_fleet_bytes deltas[HUB_DELTAS]; /* of sequence 1, 2, ... */
    size_t n;
};

struct fake_hub {
    struct iso_fleet_signer signer;
    struct iso_fleet_receiver receiver;
    struct hub_zone zones[HUB_ZONES];
    size_t zone_count;        /* of which the door has all */
    struct fake_daemon *door; /* its keys */
    struct link_mqtt *mqtt;
    struct fetch_server server;
    uint32_t lease_s;
    bool is_connected;
    int subscriptions; /* that the broker has accepted */
    /* what the test changes */
    bool is_silent;             /* questions are not answered */
    bool loses_acks;            /* events are stored, and no ACK is sent */
    bool publishes_on_question; /* the next question finds a new delta, which is published before
                                 * the answer, which does not name it */
    bool has_no_deltas;         /* deltas are gone: status 410 */
    bool forges_reply;          /* a byte of the next replies is changed */
    unsigned reply_most;        /* deltas in a reply; 0: all */
    /* what it has seen */
    uint64_t questions, requests;
    uint64_t stored[HUB_EVENTS]; /* how often an event arrived; [0] is unused */
    uint64_t highest_event, acked, first_of_last_batch;
    uint64_t told; /* of its last ACK; its answers name this number, too */
    unsigned fetches_of_deltas, fetches_of_snapshots;
    char online[4]; /* of the door's topic */
    struct iso_fleet_place last_question;
};

void fake_hub_start(struct fake_hub *hub, sd_event *event, struct fake_daemon *door);
/* Connects it to the broker. */
void fake_hub_connect(struct fake_hub *hub, sd_event *event, const struct link_broker *broker);
void fake_hub_stop(struct fake_hub *hub);

/* Adds a zone with n changes. */
struct hub_zone *fake_hub_zone(struct fake_hub *hub, size_t n);

/* Makes a change; and publishes delta number `sequence` of the zone, and its HEAD. */
void fake_hub_change(struct fake_hub *hub, struct hub_zone *zone);
void fake_hub_publish(struct fake_hub *hub, const struct hub_zone *zone, uint64_t sequence);
void fake_hub_publish_head(struct fake_hub *hub, const struct hub_zone *zone);
void fake_hub_send(struct fake_hub *hub, const char *topic, const void *bytes, size_t size);

/* The MEMBERSHIP of a door, in base64, in a static buffer. */
char *fake_hub_membership(const struct fake_hub *hub, const struct fake_daemon *daemon);

#endif

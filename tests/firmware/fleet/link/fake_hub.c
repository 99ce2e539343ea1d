#include "tests/firmware/fleet/link/fake_hub.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/fleet/message/delta.h"
#include "firmware/fleet/message/head.h"
#include "firmware/fleet/message/membership.h"
#include "firmware/fleet/message/snapshot.h"
#include "tests/firmware/rigs/cmocka_headers.h"

/* ---- changes ---- */

static void make_change(struct iso_fleet_bytes *out, uint64_t revision)
{
    const struct iso_fleet_change change = {
        .kind = ISO_FLEET_PUT,
        .person = {.id = iso_fleet_id_of(&revision, sizeof revision),
                   .revision = revision,
                   .name = "Ada",
                   .name_length = 3}};
    iso_fleet_put_change(out, &change);
    assert_int_equal(out->error, 0);
}

void fake_hub_change(struct fake_hub *hub, struct hub_zone *zone)
{
    struct iso_fleet_bytes change = {.bytes = NULL};
    struct iso_fleet_delta delta = {.place = zone->place, .time_s = 1};

    assert_true(zone->n < HUB_DELTAS);
    memcpy(delta.before, zone->place.digest, sizeof delta.before);
    delta.place.sequence++;
    make_change(&change, delta.place.sequence);
    assert_int_equal(iso_fleet_make_delta(&delta, change.bytes, change.size, &zone->key,
                                          &hub->signer, &zone->deltas[zone->n]),
                     0);
    iso_fleet_bytes_free(&change);
    zone->n++;
    zone->place = delta.place;
}

struct hub_zone *fake_hub_zone(struct fake_hub *hub, size_t n)
{
    struct hub_zone *zone = &hub->zones[hub->zone_count++];

    zone->place = (struct iso_fleet_place){.zone = iso_fleet_id_random(), .epoch = 1};
    randombytes_buf(&zone->key, sizeof zone->key);
    for (size_t i = 0; i < n; i++) {
        fake_hub_change(hub, zone);
    }
    return zone;
}

void fake_hub_send(struct fake_hub *hub, const char *topic, const void *bytes, size_t size)
{
    assert_int_equal(link_mqtt_publish(hub->mqtt, topic, bytes, size, false, NULL), 0);
}

void fake_hub_publish(struct fake_hub *hub, const struct hub_zone *zone, uint64_t sequence)
{
    char topic[ISO_FLEET_TOPIC_SIZE];
    const struct iso_fleet_bytes *delta = &zone->deltas[sequence - 1];

    fake_hub_send(hub, iso_fleet_topic_delta(&zone->place.zone, topic), delta->bytes, delta->size);
}

void fake_hub_publish_head(struct fake_hub *hub, const struct hub_zone *zone)
{
    char topic[ISO_FLEET_TOPIC_SIZE];
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    const struct iso_fleet_head head = {.place = zone->place};

    assert_int_equal(iso_fleet_make_head(&head, &hub->signer, &bytes), 0);
    assert_int_equal(link_mqtt_publish(hub->mqtt, iso_fleet_topic_head(&zone->place.zone, topic),
                                       bytes.bytes, bytes.size, true, NULL),
                     0);
    iso_fleet_bytes_free(&bytes);
}

/* ---- the answers over the broker ---- */

static void send_in(struct fake_hub *hub, struct iso_fleet_bytes *bytes)
{
    char topic[ISO_FLEET_TOPIC_SIZE];

    fake_hub_send(hub, iso_fleet_topic_in(&hub->door->door, topic), bytes->bytes, bytes->size);
    iso_fleet_bytes_free(bytes);
}

static bool knows(const struct iso_fleet_question *question, const struct hub_zone *zone)
{
    for (size_t i = 0; i < question->n; i++) {
        if (iso_fleet_id_is_same(&question->places[i].zone, &zone->place.zone) &&
            question->places[i].epoch == zone->place.epoch) {
            return true;
        }
    }
    return false;
}

static void send_key(struct fake_hub *hub, const struct hub_zone *zone)
{
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    struct iso_fleet_key_grant grant = {
        .door = hub->door->door, .base = zone->place, .key = zone->key};

    assert_int_equal(iso_fleet_make_key(&grant, hub->door->receiver.public, &hub->signer, &bytes),
                     0);
    send_in(hub, &bytes);
}

static void answer_question(struct fake_hub *hub, const void *message, size_t size)
{
    struct iso_fleet_question question;
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    struct iso_fleet_lease lease = {
        .door = hub->door->door, .lease_s = hub->lease_s, .acked = hub->told, .n = hub->zone_count};

    assert_int_equal(iso_fleet_read_question(message, size, hub->door->signer.public, &question),
                     0);
    hub->questions++;
    hub->last_question = question.n ? question.places[0] : (struct iso_fleet_place){.epoch = 0};
    if (hub->is_silent) {
        return;
    }
    memcpy(lease.nonce, question.nonce, sizeof lease.nonce);
    for (size_t i = 0; i < hub->zone_count; i++) {
        lease.places[i] = hub->zones[i].place;
        if (!knows(&question, &hub->zones[i])) {
            send_key(hub, &hub->zones[i]);
        }
    }
    if (hub->publishes_on_question) {
        hub->publishes_on_question = false;
        fake_hub_change(hub, &hub->zones[0]);
        fake_hub_publish(hub, &hub->zones[0], hub->zones[0].place.sequence);
    }
    assert_int_equal(iso_fleet_make_lease(&lease, &hub->signer, &bytes), 0);
    send_in(hub, &bytes);
}

static void store_events(struct fake_hub *hub, const void *message, size_t size)
{
    struct iso_fleet_events events;
    struct iso_fleet_bytes lines = {.bytes = NULL}, bytes = {.bytes = NULL};
    struct iso_fleet_ack ack = {.door = hub->door->door};

    assert_int_equal(iso_fleet_read_events(message, size, hub->door->signer.public, &hub->receiver,
                                           &events, &lines),
                     0);
    assert_true(events.first > 0 && events.last < HUB_EVENTS);
    iso_fleet_bytes_free(&lines);
    hub->first_of_last_batch = events.first;
    for (uint64_t n = events.first; n <= events.last; n++) {
        hub->stored[n]++;
    }
    if (events.last > hub->highest_event) {
        hub->highest_event = events.last;
    }
    while (hub->stored[hub->acked + 1]) {
        hub->acked++;
    }
    if (!hub->loses_acks) {
        ack.number = hub->acked;
        hub->told = hub->acked;
        assert_int_equal(iso_fleet_make_ack(&ack, &hub->signer, &bytes), 0);
        send_in(hub, &bytes);
    }
}

static void on_message(void *context, const char *topic, const void *bytes, size_t size)
{
    struct fake_hub *hub = context;
    char online[ISO_FLEET_TOPIC_SIZE];
    enum iso_fleet_kind kind = ISO_FLEET_ACK;

    if (strcmp(topic, iso_fleet_topic_online(&hub->door->door, online)) == 0) {
        (void)snprintf(hub->online, sizeof hub->online, "%.*s", (int)size, (const char *)bytes);
        return;
    }
    assert_int_equal(iso_fleet_kind_of(bytes, size, &kind), 0);
    switch (kind) {
    case ISO_FLEET_QUESTION:
        answer_question(hub, bytes, size);
        break;
    case ISO_FLEET_EVENTS:
        store_events(hub, bytes, size);
        break;
    case ISO_FLEET_REQUEST:
        hub->requests++;
        break;
    default:
        fail_msg("the hub got a message of kind %d", (int)kind);
    }
}

static void on_connected(void *context)
{
    struct fake_hub *hub = context;
    static const char *const topics[] = {ISO_FLEET_TOPIC_ALL_OUT, ISO_FLEET_TOPIC_ALL_ONLINE};
    int id = 0;

    hub->is_connected = true;
    assert_int_equal(link_mqtt_subscribe(hub->mqtt, topics, 2, &id), 0);
}

static void on_lost(void *context, const char *why)
{
    struct fake_hub *hub = context;

    (void)why;
    hub->is_connected = false;
    hub->subscriptions = 0;
}

static void on_subscribed(void *context, int id, bool granted)
{
    struct fake_hub *hub = context;

    (void)id;
    assert_true(granted);
    hub->subscriptions++;
}

static void on_published(void *context, int id)
{
    (void)context;
    (void)id;
}

/* ---- the answers over HTTPS ---- */

static void answer_deltas(struct fake_hub *hub, const struct hub_zone *zone, uint64_t after,
                          struct iso_fleet_bytes *out)
{
    hub->fetches_of_deltas++;
    for (uint64_t i = after; i < zone->n && (!hub->reply_most || i < after + hub->reply_most);
         i++) {
        iso_fleet_put_u32(out, (uint32_t)zone->deltas[i].size);
        iso_fleet_put(out, zone->deltas[i].bytes, zone->deltas[i].size);
    }
}

static int put(void *context, const void *bytes, size_t size)
{
    iso_fleet_put(context, bytes, size);
    return 0;
}

static void answer_snapshot(struct fake_hub *hub, const struct hub_zone *zone,
                            struct iso_fleet_bytes *out)
{
    struct iso_fleet_snapshot_writer writer = {.write = put, .context = out};

    hub->fetches_of_snapshots++;
    assert_int_equal(iso_fleet_snapshot_begin(&writer, &zone->place, 1, &zone->key), 0);
    for (uint64_t i = 1; i <= zone->n; i++) {
        struct iso_fleet_bytes change = {.bytes = NULL};
        make_change(&change, i);
        assert_int_equal(iso_fleet_snapshot_add(&writer, change.bytes, change.size), 0);
        iso_fleet_bytes_free(&change);
    }
    assert_int_equal(iso_fleet_snapshot_end(&writer, &hub->signer), 0);
}

static void answer(void *context, const char *path, const void *body, size_t size,
                   struct fetch_answer *out)
{
    struct fake_hub *hub = context;
    struct iso_fleet_fetch fetch;
    struct iso_fleet_bytes bytes = {.bytes = NULL};

    assert_string_equal(path, "/fleet/v1/fetch");
    assert_int_equal(iso_fleet_read_fetch(body, size, hub->door->signer.public, &fetch), 0);
    for (size_t i = 0; i < hub->zone_count; i++) {
        const struct hub_zone *zone = &hub->zones[i];
        if (!iso_fleet_id_is_same(&zone->place.zone, &fetch.zone)) {
            continue;
        }
        if (fetch.what == ISO_FLEET_WANT_DELTAS && hub->has_no_deltas) {
            out->status = 410;
            return;
        }
        if (fetch.what == ISO_FLEET_WANT_DELTAS) {
            answer_deltas(hub, zone, fetch.after, &bytes);
        } else {
            answer_snapshot(hub, zone, &bytes);
        }
    }
    if (hub->forges_reply && bytes.size) {
        bytes.bytes[bytes.size - 1] ^= 1;
    }
    *out = (struct fetch_answer){.status = 200, .bytes = bytes.bytes, .size = bytes.size};
}

/* ---- begin and end ---- */

void fake_hub_start(struct fake_hub *hub, sd_event *event, struct fake_daemon *door)
{
    memset(hub, 0, sizeof *hub);
    hub->door = door;
    hub->lease_s = 24 * 3600;
    assert_int_equal(crypto_sign_keypair(hub->signer.public, hub->signer.secret), 0);
    assert_int_equal(crypto_box_keypair(hub->receiver.public, hub->receiver.secret), 0);
    hub->server.answer = answer;
    hub->server.context = hub;
    (void)event;
}

void fake_hub_connect(struct fake_hub *hub, sd_event *event, const struct link_broker *broker)
{
    const struct link_mqtt_calls calls = {.context = hub,
                                          .connected = on_connected,
                                          .lost = on_lost,
                                          .subscribed = on_subscribed,
                                          .message = on_message,
                                          .published = on_published};
    struct iso_fault fault = {.text = ""};

    assert_int_equal(link_mqtt_new(event, broker, "hub", "", &calls, &hub->mqtt, &fault), 0);
}

void fake_hub_stop(struct fake_hub *hub)
{
    link_mqtt_free(hub->mqtt);
    if (hub->server.mhd) {
        fetch_server_stop(&hub->server);
    }
    for (size_t i = 0; i < hub->zone_count; i++) {
        for (size_t k = 0; k < hub->zones[i].n; k++) {
            iso_fleet_bytes_free(&hub->zones[i].deltas[k]);
        }
    }
}

char *fake_hub_membership(const struct fake_hub *hub, const struct fake_daemon *daemon)
{
    static char text[1024];
    struct iso_fleet_membership membership = {
        .door = daemon->door, .hub_name = "Works", .door_name = "East"};
    struct iso_fleet_bytes bytes = {.bytes = NULL};

    memcpy(membership.hub_signs, hub->signer.public, 32);
    memcpy(membership.hub_receives, hub->receiver.public, 32);
    memcpy(membership.door_signs, daemon->signer.public, 32);
    assert_int_equal(iso_fleet_make_membership(&membership, &hub->signer, &bytes), 0);
    assert_non_null(sodium_bin2base64(text, sizeof text, bytes.bytes, bytes.size,
                                      sodium_base64_VARIANT_ORIGINAL));
    iso_fleet_bytes_free(&bytes);
    return text;
}

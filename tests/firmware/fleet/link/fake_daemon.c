#include "tests/firmware/fleet/link/fake_daemon.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include "firmware/fleet/message/delta.h"
#include "firmware/fleet/message/head.h"
#include "firmware/fleet/message/snapshot.h"
#include "tests/firmware/rigs/cmocka_headers.h"

static int away(const struct fake_daemon *daemon, struct iso_fault *fault)
{
    return daemon->is_away ? iso_fault_set(fault, -ENOTCONN, "the daemon does not answer") : 0;
}

static struct fake_zone *zone_of(struct fake_daemon *daemon, const struct iso_fleet_id *id)
{
    for (size_t i = 0; i < daemon->n; i++) {
        if (iso_fleet_id_is_same(&daemon->zones[i].place.zone, id)) {
            return &daemon->zones[i];
        }
    }
    return NULL;
}

static int status(void *context, struct iso_link_status *out, struct iso_fault *fault)
{
    struct fake_daemon *daemon = context;

    if (away(daemon, fault) < 0) {
        return -ENOTCONN;
    }
    *out = (struct iso_link_status){.door = daemon->door,
                                    .last_event = daemon->last_event,
                                    .acked = daemon->acked,
                                    .lease_s = daemon->lease_s,
                                    .n = daemon->n};
    memcpy(out->hub_signs, daemon->hub_signs, sizeof out->hub_signs);
    for (size_t i = 0; i < daemon->n; i++) {
        out->places[i] = daemon->zones[i].place;
        out->wants_snapshot[i] = daemon->zones[i].wants_snapshot;
    }
    return 0;
}

static int question(void *context, struct iso_fleet_bytes *out, struct iso_fault *fault)
{
    struct fake_daemon *daemon = context;
    struct iso_fleet_question asked = {.door = daemon->door,
                                       .last_event = daemon->last_event,
                                       .n = daemon->n,
                                       .health = "{}",
                                       .health_length = 2};

    if (away(daemon, fault) < 0) {
        return -ENOTCONN;
    }
    randombytes_buf(daemon->nonce, sizeof daemon->nonce);
    memcpy(asked.nonce, daemon->nonce, sizeof asked.nonce);
    for (size_t i = 0; i < daemon->n; i++) {
        asked.places[i] = daemon->zones[i].place;
    }
    return iso_fleet_make_question(&asked, &daemon->signer, out);
}

static enum iso_fleet_outcome take_delta(struct fake_daemon *daemon, const void *bytes, size_t size,
                                         struct iso_fleet_id *id)
{
    struct iso_fleet_delta delta;
    struct iso_fleet_bytes change = {.bytes = NULL};

    assert_int_equal(iso_fleet_read_delta(bytes, size, daemon->hub_signs, &delta), 0);
    *id = delta.place.zone;
    struct fake_zone *zone = zone_of(daemon, id);
    if (!zone) {
        return ISO_FLEET_REFUSED;
    }
    switch (iso_fleet_step_of(&zone->place, &delta)) {
    case ISO_FLEET_STEP_NEXT:
        break;
    case ISO_FLEET_STEP_KNOWN:
        return ISO_FLEET_KNOWN;
    case ISO_FLEET_STEP_GAP:
        return ISO_FLEET_GAP;
    case ISO_FLEET_STEP_EPOCH:
        return ISO_FLEET_NO_KEY;
    default:
        return ISO_FLEET_REFUSED;
    }
    if (!zone->has_key) {
        return ISO_FLEET_NO_KEY;
    }
    assert_int_equal(iso_fleet_open_delta(bytes, size, &zone->key, &change), 0);
    iso_fleet_bytes_free(&change);
    zone->place = delta.place;
    return ISO_FLEET_APPLIED;
}

static enum iso_fleet_outcome take_key(struct fake_daemon *daemon, const void *bytes, size_t size,
                                       struct iso_fleet_id *id)
{
    struct iso_fleet_key_grant grant;

    if (iso_fleet_read_key(bytes, size, daemon->hub_signs, &daemon->receiver, &grant) < 0) {
        return ISO_FLEET_REFUSED;
    }
    *id = grant.base.zone;
    struct fake_zone *zone = zone_of(daemon, id);
    if (!zone) {
        zone = &daemon->zones[daemon->n++];
        zone->place.zone = grant.base.zone;
        zone->wants_snapshot = grant.base.sequence > 0;
    }
    zone->place.epoch = grant.base.epoch;
    zone->key = grant.key;
    zone->has_key = true;
    return ISO_FLEET_APPLIED;
}

/* Forgets the zones that the answer does not name. */
static void keep_zones(struct fake_daemon *daemon, const struct iso_fleet_lease *lease)
{
    size_t kept = 0;

    for (size_t i = 0; i < daemon->n; i++) {
        bool is_named = false;
        for (size_t k = 0; k < lease->n; k++) {
            is_named = is_named ||
                       iso_fleet_id_is_same(&lease->places[k].zone, &daemon->zones[i].place.zone);
        }
        if (is_named) {
            daemon->zones[kept++] = daemon->zones[i];
        }
    }
    daemon->n = kept;
}

static enum iso_fleet_outcome take_lease(struct fake_daemon *daemon, const void *bytes, size_t size)
{
    struct iso_fleet_lease lease;

    assert_int_equal(iso_fleet_read_lease(bytes, size, daemon->hub_signs, &lease), 0);
    if (memcmp(lease.nonce, daemon->nonce, sizeof lease.nonce) != 0) {
        return ISO_FLEET_REFUSED;
    }
    keep_zones(daemon, &lease);
    daemon->lease_s = lease.lease_s;
    daemon->acked = lease.acked;
    daemon->leases++;
    return ISO_FLEET_APPLIED;
}

static enum iso_fleet_outcome take_head(struct fake_daemon *daemon, const void *bytes, size_t size,
                                        struct iso_fleet_id *id)
{
    struct iso_fleet_head head;

    assert_int_equal(iso_fleet_read_head(bytes, size, daemon->hub_signs, &head), 0);
    *id = head.place.zone;
    const struct fake_zone *zone = zone_of(daemon, id);
    return !zone                                        ? ISO_FLEET_REFUSED
           : head.place.sequence > zone->place.sequence ? ISO_FLEET_GAP
                                                        : ISO_FLEET_KNOWN;
}

static enum iso_fleet_outcome take_ack(struct fake_daemon *daemon, const void *bytes, size_t size)
{
    struct iso_fleet_ack ack;

    assert_int_equal(iso_fleet_read_ack(bytes, size, daemon->hub_signs, &ack), 0);
    if (ack.number > daemon->acked) {
        daemon->acked = ack.number;
        return ISO_FLEET_APPLIED;
    }
    return ISO_FLEET_KNOWN;
}

static int receive(void *context, const void *bytes, size_t size, struct iso_link_outcome *out,
                   struct iso_fault *fault)
{
    struct fake_daemon *daemon = context;
    struct iso_link_outcome made = {.outcome = ISO_FLEET_REFUSED};
    enum iso_fleet_kind kind = ISO_FLEET_ACK;

    if (away(daemon, fault) < 0) {
        return -ENOTCONN;
    }
    const int error = iso_fleet_kind_of(bytes, size, &kind);
    daemon->received++;
    if (error == -EPROTONOSUPPORT) {
        daemon->refused++;
        *out = made;
        return 0;
    }
    assert_int_equal(error, 0);
    switch (kind) {
    case ISO_FLEET_DELTA:
        made.outcome = take_delta(daemon, bytes, size, &made.zone);
        daemon->applied += made.outcome == ISO_FLEET_APPLIED;
        daemon->known += made.outcome == ISO_FLEET_KNOWN;
        break;
    case ISO_FLEET_KEY:
        made.outcome = take_key(daemon, bytes, size, &made.zone);
        break;
    case ISO_FLEET_LEASE:
        made.outcome = take_lease(daemon, bytes, size);
        break;
    case ISO_FLEET_HEAD:
        made.outcome = take_head(daemon, bytes, size, &made.zone);
        break;
    case ISO_FLEET_ACK:
        made.outcome = take_ack(daemon, bytes, size);
        break;
    default:
        fail_msg("the daemon got a message of kind %d", (int)kind);
    }
    daemon->refused += made.outcome == ISO_FLEET_REFUSED;
    *out = made;
    return 0;
}

static int fetch(void *context, const struct iso_fleet_id *zone, enum iso_fleet_wanted what,
                 struct iso_fleet_bytes *out, struct iso_fault *fault)
{
    struct fake_daemon *daemon = context;

    if (away(daemon, fault) < 0) {
        return -ENOTCONN;
    }
    const struct fake_zone *found = zone_of(daemon, zone);
    assert_non_null(found);
    struct iso_fleet_fetch wanted = {
        .door = daemon->door, .zone = *zone, .after = found->place.sequence, .what = what};
    randombytes_buf(wanted.nonce, sizeof wanted.nonce);
    return iso_fleet_make_fetch(&wanted, &daemon->signer, out);
}

static int count(void *context, const struct iso_fleet_change *change)
{
    struct fake_daemon *daemon = context;

    daemon->snapshot_people += change->kind == ISO_FLEET_PUT;
    return 0;
}

static int snapshot(void *context, int fd, struct iso_link_outcome *out, struct iso_fault *fault)
{
    struct fake_daemon *daemon = context;
    struct iso_fleet_place place;
    struct stat file;

    if (away(daemon, fault) < 0) {
        return -ENOTCONN;
    }
    if (daemon->is_full) {
        return iso_fault_set(fault, -EIO, "the disk is full");
    }
    assert_int_equal(fstat(fd, &file), 0);
    const size_t size = (size_t)file.st_size;
    uint8_t *bytes = mmap(NULL, size, PROT_READ, MAP_PRIVATE, fd, 0);
    assert_ptr_not_equal(bytes, MAP_FAILED);
    assert_int_equal(iso_fleet_snapshot_verify(bytes, size, daemon->hub_signs, &place), 0);
    struct fake_zone *zone = zone_of(daemon, &place.zone);
    assert_non_null(zone);
    daemon->snapshot_people = 0;
    assert_int_equal(iso_fleet_snapshot_each(bytes, size, &zone->key, count, daemon), 0);
    assert_int_equal(munmap(bytes, size), 0);
    zone->place = place;
    zone->wants_snapshot = false;
    daemon->snapshots++;
    *out = (struct iso_link_outcome){.outcome = ISO_FLEET_APPLIED, .zone = place.zone};
    return 0;
}

static int events(void *context, uint64_t after, uint32_t most, struct iso_fleet_bytes *out,
                  uint64_t *last, struct iso_fault *fault)
{
    struct fake_daemon *daemon = context;
    char lines[64 * 24];
    size_t size = 0;

    if (away(daemon, fault) < 0) {
        return -ENOTCONN;
    }
    *last = 0;
    if (after >= daemon->last_event) {
        return 0;
    }
    assert_true(most <= 64);
    struct iso_fleet_events batch = {.door = daemon->door, .first = after + 1, .last = after};
    while (batch.last < daemon->last_event && batch.last - after < most) {
        size += (size_t)snprintf(lines + size, sizeof lines - size, "{\"n\":%llu}\n",
                                 (unsigned long long)++batch.last);
    }
    *last = batch.last;
    return iso_fleet_make_events(&batch, lines, size, daemon->hub_receives, &daemon->signer, out);
}

static int requests(void *context, void (*each)(void *context, const void *bytes, size_t size),
                    void *each_context, struct iso_fault *fault)
{
    struct fake_daemon *daemon = context;

    if (away(daemon, fault) < 0) {
        return -ENOTCONN;
    }
    if (daemon->is_full) {
        return iso_fault_set(fault, -EIO, "the list is too long");
    }
    uint8_t *template = calloc(1, daemon->request_bytes + 1);
    assert_non_null(template);
    for (uint32_t i = 0; i < daemon->requests; i++) {
        struct iso_fleet_bytes request = {.bytes = NULL};
        const struct iso_fleet_person person = {
            .id = iso_fleet_id_of(&i, sizeof i),
            .name = "Local",
            .name_length = 5,
            .n = 1,
            .templates = {
                {.algorithm = 1, .size = (uint32_t)daemon->request_bytes + 1, .bytes = template}}};
        assert_int_equal(iso_fleet_make_request(&daemon->door, &person, daemon->hub_receives,
                                                &daemon->signer, &request),
                         0);
        each(each_context, request.bytes, request.size);
        iso_fleet_bytes_free(&request);
    }
    free(template);
    return 0;
}

void fake_daemon_init(struct fake_daemon *daemon, const uint8_t *hub_signs,
                      const uint8_t *hub_receives)
{
    *daemon = (struct fake_daemon){.is_away = false, .door = iso_fleet_id_random()};
    assert_int_equal(crypto_sign_keypair(daemon->signer.public, daemon->signer.secret), 0);
    assert_int_equal(crypto_box_keypair(daemon->receiver.public, daemon->receiver.secret), 0);
    memcpy(daemon->hub_signs, hub_signs, sizeof daemon->hub_signs);
    memcpy(daemon->hub_receives, hub_receives, sizeof daemon->hub_receives);
}

struct iso_link_daemon fake_daemon_calls(struct fake_daemon *daemon)
{
    return (struct iso_link_daemon){.context = daemon,
                                    .status = status,
                                    .question = question,
                                    .receive = receive,
                                    .fetch = fetch,
                                    .snapshot = snapshot,
                                    .events = events,
                                    .requests = requests};
}

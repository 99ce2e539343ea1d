#include "tests/enroll/hub/rigs/played_door.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "core/base/bytes.h"
#include "firmware/fleet/message/delta.h"
#include "firmware/fleet/message/snapshot.h"
#include "firmware/fleet/message/zone_key.h"

int played_door_join_with(struct played_door *door, struct hub_store *store, const char *code,
                          struct iso_fault *fault)
{
    uint8_t both[2 * ISO_FLEET_PUBLIC_BYTES];
    char address[HUB_DOOR_ADDRESS_DIGITS + 1];
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    struct iso_fleet_membership membership;
    struct iso_fleet_id id;
    memcpy(both, door->signs.public, 32);
    memcpy(both + 32, door->receives.public, 32);
    (void)sodium_bin2hex(address, sizeof address, both, sizeof both);
    const struct hub_join join = {.code = code, .address = address, .name = "box"};
    const int error = hub_door_join(store, &join, &id, &bytes, fault);
    if (error) {
        return error;
    }
    assert_int_equal(iso_fleet_read_membership(bytes.bytes, bytes.size, &membership), 0);
    assert_memory_equal(membership.door_signs, door->signs.public, 32);
    assert_true(iso_fleet_id_is_same(&membership.door, &id));
    door->id = id;
    memcpy(door->hub_signs, membership.hub_signs, sizeof door->hub_signs);
    memcpy(door->hub_receives, membership.hub_receives, sizeof door->hub_receives);
    iso_fleet_bytes_free(&bytes);
    return 0;
}

void played_door_join(struct played_door *door, struct store_rig *rig, const char *name,
                      const struct iso_fleet_id *zones, size_t n_zones)
{
    struct iso_fault fault = {.text = ""};
    struct iso_fleet_id id;
    char code[HUB_CODE_SIZE];
    *door = (struct played_door){.algorithm = 3};
    (void)crypto_sign_keypair(door->signs.public, door->signs.secret);
    (void)crypto_box_keypair(door->receives.public, door->receives.secret);
    store_rig_fine(hub_door_add(&rig->store, name, zones, n_zones, &id, code, &fault), &fault);
    store_rig_fine(played_door_join_with(door, &rig->store, code, &fault), &fault);
    assert_true(iso_fleet_id_is_same(&door->id, &id));
}

struct played_door_zone *played_door_zone(struct played_door *door, const struct iso_fleet_id *zone)
{
    for (size_t i = 0; i < door->n_zones; i++) {
        if (iso_fleet_id_is_same(&door->zones[i].place.zone, zone)) {
            return &door->zones[i];
        }
    }
    return NULL;
}

struct played_door_person *played_door_person(struct played_door *door,
                                              const struct iso_fleet_id *zone,
                                              const struct iso_fleet_id *person)
{
    for (size_t i = 0; i < door->n_people; i++) {
        if (iso_fleet_id_is_same(&door->people[i].zone, zone) &&
            iso_fleet_id_is_same(&door->people[i].id, person)) {
            return &door->people[i];
        }
    }
    return NULL;
}

size_t played_door_count(const struct played_door *door, const struct iso_fleet_id *zone)
{
    size_t n = 0;
    for (size_t i = 0; i < door->n_people; i++) {
        n += iso_fleet_id_is_same(&door->people[i].zone, zone);
    }
    return n;
}

bool played_door_is_same(const struct played_door *a, const struct played_door *b,
                         const struct iso_fleet_id *zone)
{
    size_t n = 0;
    for (size_t i = 0; i < a->n_people; i++) {
        for (size_t k = 0; k < b->n_people; k++) {
            n += iso_fleet_id_is_same(&a->people[i].zone, zone) &&
                 memcmp(&a->people[i], &b->people[k], sizeof a->people[i]) == 0;
        }
    }
    return n == played_door_count(a, zone) && n == played_door_count(b, zone);
}

static void forget_person(struct played_door *door, struct played_door_person *person)
{
    *person = door->people[--door->n_people];
}

static void apply(struct played_door *door, struct played_door_zone *zone,
                  const struct iso_fleet_change *change)
{
    const struct iso_fleet_person *person = &change->person;
    struct played_door_person *known = played_door_person(door, &zone->place.zone, &person->id);
    if (change->kind == ISO_FLEET_POLICY) {
        (void)snprintf(zone->policy, sizeof zone->policy, "%.*s", (int)change->policy_length,
                       change->policy);
    } else if (change->kind == ISO_FLEET_LOCKDOWN) {
        zone->lockdown = change->lockdown;
    } else if (change->kind == ISO_FLEET_REMOVE) {
        if (known) {
            assert_true(person->revision > known->revision);
            forget_person(door, known);
        }
    } else {
        assert_true(!known || person->revision > known->revision);
        if (!known) {
            assert_true(door->n_people < PLAYED_DOOR_PEOPLE);
            known = &door->people[door->n_people++];
            memset(known, 0, sizeof *known);
        }
        known->id = person->id;
        known->zone = zone->place.zone;
        known->revision = person->revision;
        known->offline_ok = person->offline_ok;
        memset(known->name, 0, sizeof known->name);
        (void)snprintf(known->name, sizeof known->name, "%.*s", (int)person->name_length,
                       person->name);
        iso_fleet_templates_digest(person, known->templates);
    }
}

static void take_key(struct played_door *door, const void *bytes, size_t size)
{
    struct iso_fleet_key_grant grant;
    assert_int_equal(iso_fleet_read_key(bytes, size, door->hub_signs, &door->receives, &grant), 0);
    assert_true(iso_fleet_id_is_same(&grant.door, &door->id));
    door->keys++;
    struct played_door_zone *zone = played_door_zone(door, &grant.base.zone);
    if (!zone) {
        zone = &door->zones[door->n_zones++];
        *zone = (struct played_door_zone){
            .place = {.zone = grant.base.zone, .epoch = grant.base.epoch},
            .wants_snapshot = grant.base.sequence > 0};
    }
    if (memcmp(zone->key.bytes, grant.key.bytes, sizeof grant.key.bytes) == 0) {
        return;
    }
    zone->old_key = zone->key;
    zone->key = grant.key;
    zone->base = grant.base;
    zone->wants_snapshot = zone->wants_snapshot || grant.reset;
    if (!grant.reset && zone->place.sequence == grant.base.sequence &&
        memcmp(zone->place.digest, grant.base.digest, 32) == 0) {
        zone->place.epoch = grant.base.epoch;
    }
}

static void take_delta(struct played_door *door, const void *bytes, size_t size)
{
    struct iso_fleet_delta delta;
    struct iso_fleet_bytes plain = {.bytes = NULL};
    struct iso_fleet_change change;
    assert_int_equal(iso_fleet_read_delta(bytes, size, door->hub_signs, &delta), 0);
    struct played_door_zone *zone = played_door_zone(door, &delta.place.zone);
    if (!zone) {
        door->refused++;
        return;
    }
    switch (iso_fleet_step_of(&zone->place, &delta)) {
    case ISO_FLEET_STEP_KNOWN:
        door->known++;
        return;
    case ISO_FLEET_STEP_NEXT:
        break;
    default:
        door->refused++;
        return;
    }
    const bool old = delta.place.epoch < zone->base.epoch;
    assert_int_equal(iso_fleet_open_delta(bytes, size, old ? &zone->old_key : &zone->key, &plain),
                     0);
    assert_int_equal(iso_fleet_read_change(plain.bytes, plain.size, &change), 0);
    apply(door, zone, &change);
    zone->place = delta.place;
    if (zone->place.sequence == zone->base.sequence && zone->base.epoch > zone->place.epoch) {
        zone->place.epoch = zone->base.epoch;
    }
    door->applied++;
    iso_fleet_bytes_free(&plain);
}

static int take_message(void *context, const char *topic, const void *bytes, size_t size,
                        bool retain)
{
    struct played_door *door = context;
    enum iso_fleet_kind kind;
    char own[ISO_FLEET_TOPIC_SIZE];
    struct iso_fleet_ack ack;
    assert_int_equal(iso_fleet_kind_of(bytes, size, &kind), 0);
    const bool is_own = strcmp(topic, iso_fleet_topic_in(&door->id, own)) == 0;
    assert_true(retain == (kind == ISO_FLEET_HEAD));
    door->is_ordered = kind == ISO_FLEET_UPDATE;
    assert_true(is_own || kind <= ISO_FLEET_HEAD); /* KEY, DELTA and HEAD may be of others */
    switch (kind) {
    case ISO_FLEET_DELTA:
        take_delta(door, bytes, size);
        return 0;
    case ISO_FLEET_HEAD:
        return 0;
    case ISO_FLEET_KEY:
        if (is_own) {
            take_key(door, bytes, size);
        }
        return 0;
    case ISO_FLEET_LEASE:
        assert_int_equal(iso_fleet_read_lease(bytes, size, door->hub_signs, &door->lease), 0);
        assert_memory_equal(door->lease.nonce, door->nonce, sizeof door->nonce);
        door->leases++;
        return 0;
    case ISO_FLEET_UPDATE:
        return iso_fleet_read_update(bytes, size, door->hub_signs, &door->update);
    case ISO_FLEET_ACK:
        assert_int_equal(iso_fleet_read_ack(bytes, size, door->hub_signs, &ack), 0);
        door->acked = ack.number;
        door->acks++;
        return 0;
    default:
        fail_msg("a message of kind %d on %s", (int)kind, topic);
        return -EBADMSG;
    }
}

struct hub_emit played_door_emit(struct played_door *door)
{
    return (struct hub_emit){.emit = take_message, .context = door};
}

int played_door_ask(struct played_door *door, struct hub_store *store, struct iso_fault *fault)
{
    const char *health = door->health ? door->health : "{\"version\": \"1.0\"}";
    const struct hub_emit emit = played_door_emit(door);
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    struct iso_fleet_question question = {.door = door->id,
                                          .time_s = 5,
                                          .algorithm = door->algorithm,
                                          .last_event = door->last_event,
                                          .n = door->n_zones,
                                          .health = health,
                                          .health_length = strlen(health)};
    randombytes_buf(door->nonce, sizeof door->nonce);
    memcpy(question.nonce, door->nonce, sizeof question.nonce);
    for (size_t i = 0; i < door->n_zones; i++) {
        question.places[i] = door->zones[i].place;
    }
    assert_int_equal(iso_fleet_make_question(&question, &door->signs, &bytes), 0);
    const int error = hub_take(store, &door->id, bytes.bytes, bytes.size, &emit, fault);
    iso_fleet_bytes_free(&bytes);
    return error;
}

static int keep(void *context, const void *bytes, size_t size)
{
    struct iso_fleet_bytes *out = context;
    iso_fleet_put(out, bytes, size);
    return out->error;
}

int played_door_fetch_raw(struct played_door *door, struct hub_store *store,
                          const struct iso_fleet_id *zone, uint64_t after,
                          enum iso_fleet_wanted what, struct iso_fleet_bytes *out,
                          enum hub_fetch_answer *answer, struct iso_fault *fault)
{
    struct iso_fleet_fetch fetch = {.door = door->id, .zone = *zone, .after = after, .what = what};
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    randombytes_buf(fetch.nonce, sizeof fetch.nonce);
    assert_int_equal(iso_fleet_make_fetch(&fetch, &door->signs, &bytes), 0);
    const int error = hub_answer_fetch(store, bytes.bytes, bytes.size, keep, out, answer, fault);
    iso_fleet_bytes_free(&bytes);
    return error;
}

struct target {
    struct played_door *door;
    struct played_door_zone *zone;
};

static int take_part(void *context, const struct iso_fleet_change *change)
{
    const struct target *target = context;
    apply(target->door, target->zone, change);
    return 0;
}

static void take_snapshot(struct played_door *door, struct played_door_zone *zone,
                          const struct iso_fleet_bytes *file)
{
    struct target target = {.door = door, .zone = zone};
    struct iso_fleet_place place;
    assert_int_equal(iso_fleet_snapshot_verify(file->bytes, file->size, door->hub_signs, &place),
                     0);
    assert_true(iso_fleet_id_is_same(&place.zone, &zone->place.zone));
    for (size_t i = door->n_people; i-- > 0;) {
        if (iso_fleet_id_is_same(&door->people[i].zone, &place.zone)) {
            forget_person(door, &door->people[i]);
        }
    }
    assert_int_equal(
        iso_fleet_snapshot_each(file->bytes, file->size, &zone->key, take_part, &target), 0);
    zone->place = place;
    zone->wants_snapshot = false;
}

static void take_deltas(struct played_door *door, const struct iso_fleet_bytes *answer)
{
    for (size_t at = 0; at < answer->size;) {
        const uint32_t size = iso_get_u32(answer->bytes + at);
        assert_true(at + 4 + size <= answer->size);
        take_delta(door, answer->bytes + at + 4, size);
        at += 4 + size;
    }
}

/* One round for a zone. Returns whether something has come. */
static bool fetch_once(struct played_door *door, struct hub_store *store,
                       struct played_door_zone *zone)
{
    struct iso_fault fault = {.text = ""};
    struct iso_fleet_bytes answer = {.bytes = NULL};
    enum hub_fetch_answer what;
    const uint64_t before = zone->place.sequence;
    const bool whole = zone->wants_snapshot;
    store_rig_fine(played_door_fetch_raw(door, store, &zone->place.zone, before,
                                         whole ? ISO_FLEET_WANT_SNAPSHOT : ISO_FLEET_WANT_DELTAS,
                                         &answer, &what, &fault),
                   &fault);
    if (what == HUB_ANSWER_SNAPSHOT) {
        take_snapshot(door, zone, &answer);
    } else {
        take_deltas(door, &answer);
    }
    iso_fleet_bytes_free(&answer);
    return whole || zone->place.sequence > before;
}

void played_door_fetch(struct played_door *door, struct hub_store *store)
{
    for (size_t i = 0; i < door->n_zones; i++) {
        for (unsigned n = 0; fetch_once(door, store, &door->zones[i]); n++) {
            assert_true(n < 1000);
        }
    }
}

int played_door_send_events(struct played_door *door, struct hub_store *store, uint64_t first,
                            uint64_t last, struct iso_fault *fault)
{
    const struct hub_emit emit = played_door_emit(door);
    const struct iso_fleet_events events = {.door = door->id, .first = first, .last = last};
    struct iso_fleet_bytes lines = {.bytes = NULL}, bytes = {.bytes = NULL};
    for (uint64_t n = first; n <= last; n++) {
        char line[200];
        const int length = snprintf(
            line, sizeof line,
            "{\"sequence\":%llu,\"time\":\"2026-11-21T08:%02llu:%02llu.250Z\","
            "\"event\":\"visit\",\"person\":\"p\\u00e9ter %llu\",\"verdict\":\"allow\"}\n",
            (unsigned long long)n, (unsigned long long)(n / 60 % 60), (unsigned long long)(n % 60),
            (unsigned long long)(n % 3));
        iso_fleet_put(&lines, line, (size_t)length);
    }
    assert_int_equal(iso_fleet_make_events(&events, (const char *)lines.bytes, lines.size,
                                           door->hub_receives, &door->signs, &bytes),
                     0);
    const int error = hub_take(store, &door->id, bytes.bytes, bytes.size, &emit, fault);
    iso_fleet_bytes_free(&bytes);
    iso_fleet_bytes_free(&lines);
    return error;
}

int played_door_request(struct played_door *door, struct hub_store *store,
                        const struct iso_fleet_person *person, struct iso_fault *fault)
{
    const struct hub_emit emit = played_door_emit(door);
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    assert_int_equal(
        iso_fleet_make_request(&door->id, person, door->hub_receives, &door->signs, &bytes), 0);
    const int error = hub_take(store, &door->id, bytes.bytes, bytes.size, &emit, fault);
    iso_fleet_bytes_free(&bytes);
    return error;
}

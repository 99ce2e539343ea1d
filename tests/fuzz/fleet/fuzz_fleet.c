/* Messages of a fleet: whatever arrives is read without harm. The first byte of the input chooses
 * the reader, and whether the rest is signed first, so that the fields behind the signature are
 * reached, too. */
#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/fleet/message/delta.h"
#include "firmware/fleet/message/door_mail.h"
#include "firmware/fleet/message/head.h"
#include "firmware/fleet/message/membership.h"
#include "firmware/fleet/message/snapshot.h"
#include "firmware/fleet/message/zone_key.h"
#include "firmware/fleet/order/update_order.h"
#include "tests/fuzz/fuzz.h"

static struct iso_fleet_signer signer;
static struct iso_fleet_receiver receiver;
static const struct iso_fleet_zone_key key = {.bytes = {1, 2, 3}};

static void start(void)
{
    static const uint8_t seed[32] = {7};
    fuzz_check(iso_fleet_start(NULL) == 0, "the library starts");
    (void)crypto_sign_seed_keypair(signer.public, signer.secret, seed);
    (void)crypto_box_seed_keypair(receiver.public, receiver.secret, seed);
}

/* A change that can be read is written as the same bytes again. */
static void check_change(const void *bytes, size_t size)
{
    struct iso_fleet_change change;
    struct iso_fleet_bytes again = {.bytes = NULL};
    if (iso_fleet_read_change(bytes, size, &change)) {
        return;
    }
    iso_fleet_put_change(&again, &change);
    fuzz_check(again.size == size && memcmp(again.bytes, bytes, size) == 0,
               "a change has one form");
    iso_fleet_bytes_free(&again);
}

static int each_change(void *context, const struct iso_fleet_change *change)
{
    (void)context;
    fuzz_check(change->person.n <= ISO_FLEET_TEMPLATES_MAX, "a bounded list");
    return 0;
}

static void read_for_door(const uint8_t *bytes, size_t size)
{
    struct iso_fleet_delta delta;
    struct iso_fleet_head head;
    struct iso_fleet_key_grant grant;
    struct iso_fleet_lease lease;
    struct iso_fleet_ack ack;
    struct iso_fleet_update update;
    struct iso_fleet_membership membership;
    struct iso_fleet_place place;
    struct iso_fleet_bytes plain = {.bytes = NULL};
    if (iso_fleet_read_delta(bytes, size, signer.public, &delta) == 0 &&
        iso_fleet_open_delta(bytes, size, &key, &plain) == 0) {
        check_change(plain.bytes, plain.size);
    }
    iso_fleet_bytes_free(&plain);
    (void)iso_fleet_read_head(bytes, size, signer.public, &head);
    (void)iso_fleet_read_key(bytes, size, signer.public, &receiver, &grant);
    if (iso_fleet_read_lease(bytes, size, signer.public, &lease) == 0) {
        fuzz_check(lease.n <= ISO_FLEET_ZONES_MAX, "a bounded list");
    }
    (void)iso_fleet_read_ack(bytes, size, signer.public, &ack);
    if (iso_fleet_read_update(bytes, size, signer.public, &update) == 0) {
        fuzz_check(update.size > 0 && update.size <= ISO_FLEET_UPDATE_BYTES_MAX, "a bounded file");
        fuzz_check(iso_fleet_update_word_is_good(update.version) &&
                       iso_fleet_update_word_is_good(update.board),
                   "words");
    }
    if (iso_fleet_read_membership(bytes, size, &membership) == 0) {
        fuzz_check(memchr(membership.hub_name, 0, sizeof membership.hub_name) != NULL, "a text");
    }
    (void)iso_fleet_snapshot_verify(bytes, size, signer.public, &place);
    (void)iso_fleet_snapshot_each(bytes, size, &key, each_change, NULL);
}

static void read_for_hub(const uint8_t *bytes, size_t size)
{
    struct iso_fleet_question question;
    struct iso_fleet_events events;
    struct iso_fleet_fetch fetch;
    struct iso_fleet_id door;
    struct iso_fleet_person person;
    struct iso_fleet_bytes plain = {.bytes = NULL};
    (void)iso_fleet_door_of(bytes, size, &door);
    if (iso_fleet_read_question(bytes, size, signer.public, &question) == 0) {
        fuzz_check(question.n <= ISO_FLEET_ZONES_MAX, "a bounded list");
    }
    (void)iso_fleet_read_events(bytes, size, signer.public, &receiver, &events, &plain);
    iso_fleet_bytes_free(&plain);
    (void)iso_fleet_read_request(bytes, size, signer.public, &receiver, &door, &plain, &person);
    iso_fleet_bytes_free(&plain);
    (void)iso_fleet_read_fetch(bytes, size, signer.public, &fetch);
}

/* Gives the fields to the readers as a message that is signed. */
static void read_signed(uint8_t kind, const uint8_t *fields, size_t size)
{
    struct iso_fleet_bytes message = {.bytes = NULL};
    iso_fleet_begin(&message, (enum iso_fleet_kind)kind);
    iso_fleet_put(&message, fields, size);
    fuzz_check(iso_fleet_sign(&message, &signer) == 0, "memory");
    read_for_door(message.bytes, message.size);
    read_for_hub(message.bytes, message.size);
    iso_fleet_bytes_free(&message);
}

/* Gives a plain text to the readers as the sealed part of a message. */
static void read_sealed(uint8_t what, const uint8_t *plain, size_t size)
{
    struct iso_fleet_bytes message = {.bytes = NULL};
    struct iso_fleet_delta delta = {.place = {.epoch = 1, .sequence = 1}};
    if (what % 2 == 0) {
        fuzz_check(iso_fleet_make_delta(&delta, plain, size, &key, &signer, &message) == 0,
                   "memory");
        read_for_door(message.bytes, message.size);
    } else {
        const struct iso_fleet_id door = {{1}};
        iso_fleet_begin(&message, ISO_FLEET_REQUEST);
        iso_fleet_put(&message, door.bytes, sizeof door.bytes);
        iso_fleet_put(&message, plain, size < sizeof door.bytes ? size : sizeof door.bytes);
        iso_fleet_put_sealed(&message, receiver.public, plain, size);
        fuzz_check(iso_fleet_sign(&message, &signer) == 0, "memory");
        read_for_hub(message.bytes, message.size);
    }
    iso_fleet_bytes_free(&message);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (!signer.public[0] && !signer.public[1]) {
        start();
    }
    if (size < 2) {
        return 0;
    }
    uint8_t *copy = fuzz_copy(data + 2, size - 2);
    switch (data[0] % 4) {
    case 0:
        read_for_door(copy, size - 2);
        read_for_hub(copy, size - 2);
        break;
    case 1:
        check_change(copy, size - 2);
        break;
    case 2:
        read_sealed(data[1], copy, size - 2);
        break;
    default:
        read_signed(data[1], copy, size - 2);
        break;
    }
    free(copy);
    return 0;
}

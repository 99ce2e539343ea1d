#include "tests/firmware/fleet/message/message_rig.h"

#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

void message_rig_start(struct message_rig *rig)
{
    memset(rig, 0, sizeof *rig);
    assert_int_equal(iso_fleet_start(NULL), 0);
    (void)crypto_sign_keypair(rig->hub.public, rig->hub.secret);
    (void)crypto_sign_keypair(rig->other.public, rig->other.secret);
    (void)crypto_sign_keypair(rig->door.public, rig->door.secret);
    (void)crypto_box_keypair(rig->hub_box.public, rig->hub_box.secret);
    (void)crypto_box_keypair(rig->door_box.public, rig->door_box.secret);
    randombytes_buf(rig->key.bytes, sizeof rig->key.bytes);
    rig->here.zone = iso_fleet_id_random();
    rig->here.epoch = 1;
}

struct iso_fleet_person message_rig_person(void)
{
    static uint8_t first[700], second[1300];
    struct iso_fleet_person person = {.revision = 17,
                                      .offline_ok = true,
                                      .valid_from_s = 1700000000,
                                      .enrolled_s = 1690000000,
                                      .name = "Ada Lovelace",
                                      .name_length = 12,
                                      .credential = "{\"enabled\":true}",
                                      .credential_length = 16,
                                      .n = 2};
    memset(first, 0x11, sizeof first);
    memset(second, 0x22, sizeof second);
    person.id = iso_fleet_id_of("ada", 3);
    person.templates[0] = (struct iso_fleet_template){7, sizeof first, first};
    person.templates[1] = (struct iso_fleet_template){8, sizeof second, second};
    return person;
}

struct iso_fleet_bytes message_rig_next(struct message_rig *rig)
{
    struct iso_fleet_change change = {.kind = ISO_FLEET_PUT, .person = message_rig_person()};
    struct iso_fleet_bytes plain = {.bytes = NULL}, out = {.bytes = NULL};
    struct iso_fleet_delta delta = {.place = rig->here, .time_s = 1764140000};
    memcpy(delta.before, rig->here.digest, sizeof delta.before);
    delta.place.sequence++;
    iso_fleet_put_change(&plain, &change);
    assert_int_equal(plain.error, 0);
    assert_int_equal(
        iso_fleet_make_delta(&delta, plain.bytes, plain.size, &rig->key, &rig->hub, &out), 0);
    iso_fleet_bytes_free(&plain);
    rig->here = delta.place;
    return out;
}

/* Copies the bytes to memory of exactly this size, so that a sanitizer finds reads beyond it. */
static int read_copy(const uint8_t *bytes, size_t size,
                     int (*read)(void *context, const uint8_t *bytes, size_t size), void *context)
{
    uint8_t *copy = malloc(size ? size : 1);
    assert_non_null(copy);
    memcpy(copy, bytes, size);
    const int result = read(context, copy, size);
    free(copy);
    return result;
}

void message_rig_damage(const struct iso_fleet_bytes *message,
                        int (*read)(void *context, const uint8_t *bytes, size_t size),
                        void *context)
{
    uint8_t *copy = malloc(message->size + 1);
    assert_non_null(copy);
    memcpy(copy, message->bytes, message->size);
    copy[message->size] = 0;
    assert_int_equal(read_copy(copy, message->size, read, context), 0);
    assert_true(read_copy(copy, message->size + 1, read, context) < 0);
    for (size_t i = 0; i < message->size; i++) {
        copy[i] ^= (uint8_t)(1U << i % 8);
        assert_true(read_copy(copy, message->size, read, context) < 0);
        copy[i] ^= (uint8_t)(1U << i % 8);
        assert_true(read_copy(copy, i, read, context) < 0);
    }
    free(copy);
}

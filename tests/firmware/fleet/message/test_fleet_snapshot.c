/* Snapshots of a zone: what is written is read in order; a file that was changed, cut short, put
 * together from parts, or sealed with another key is refused. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "core/base/bytes.h"
#include "firmware/fleet/message/snapshot.h"
#include "tests/firmware/fleet/message/message_rig.h"

enum { CHANGES = 5 };

static int keep(void *context, const void *bytes, size_t size)
{
    struct iso_fleet_bytes *file = context;
    iso_fleet_put(file, bytes, size);
    return file->error;
}

/* Change number i: people with rising revisions, and a policy at the end. */
static struct iso_fleet_change change_of(uint64_t i)
{
    struct iso_fleet_change change = {.kind = ISO_FLEET_PUT, .person = message_rig_person()};
    change.person.revision = 100 + i;
    if (i == CHANGES - 1) {
        change = (struct iso_fleet_change){
            .kind = ISO_FLEET_POLICY, .policy = "{}", .policy_length = 2};
    }
    return change;
}

static struct iso_fleet_bytes make_file(struct message_rig *rig)
{
    struct iso_fleet_bytes file = {.bytes = NULL};
    struct iso_fleet_snapshot_writer writer = {.write = keep, .context = &file};
    rig->here.sequence = 12;
    assert_int_equal(iso_fleet_snapshot_begin(&writer, &rig->here, 1764140000, &rig->key), 0);
    for (uint64_t i = 0; i < CHANGES; i++) {
        struct iso_fleet_bytes plain = {.bytes = NULL};
        const struct iso_fleet_change change = change_of(i);
        iso_fleet_put_change(&plain, &change);
        assert_int_equal(iso_fleet_snapshot_add(&writer, plain.bytes, plain.size), 0);
        iso_fleet_bytes_free(&plain);
    }
    assert_int_equal(iso_fleet_snapshot_end(&writer, &rig->hub), 0);
    return file;
}

static int count(void *context, const struct iso_fleet_change *change)
{
    uint64_t *n = context;
    const struct iso_fleet_change expected = change_of(*n);
    assert_int_equal(change->kind, expected.kind);
    if (change->kind == ISO_FLEET_PUT) {
        assert_int_equal(change->person.revision, expected.person.revision);
        assert_memory_equal(change->person.templates[1].bytes, expected.person.templates[1].bytes,
                            expected.person.templates[1].size);
    }
    ++*n;
    return 0;
}

static void a_snapshot_is_read_as_written(void **state)
{
    struct message_rig rig;
    struct iso_fleet_place place;
    uint64_t n = 0;
    (void)state;
    message_rig_start(&rig);
    struct iso_fleet_bytes file = make_file(&rig);
    assert_int_equal(iso_fleet_snapshot_verify(file.bytes, file.size, rig.hub.public, &place), 0);
    assert_memory_equal(&place, &rig.here, sizeof place);
    assert_int_equal(iso_fleet_snapshot_each(file.bytes, file.size, &rig.key, count, &n), 0);
    assert_int_equal(n, CHANGES);
    assert_null(memmem(file.bytes, file.size, "Ada", 3));
    iso_fleet_bytes_free(&file);
}

static int read_file(void *context, const uint8_t *bytes, size_t size)
{
    const struct message_rig *rig = context;
    struct iso_fleet_place place;
    return iso_fleet_snapshot_verify(bytes, size, rig->hub.public, &place);
}

static int no_change(void *context, const struct iso_fleet_change *change)
{
    (void)change;
    ++*(uint64_t *)context;
    return 0;
}

/* Signs a changed file with the hub's key, as somebody could who has stolen that key. The signature
 * is valid then, but the chunks are still refused. */
static void refused_though_signed(struct message_rig *rig, struct iso_fleet_bytes *file)
{
    crypto_sign_state state;
    uint64_t n = 0;
    struct iso_fleet_place place;
    file->size -= ISO_FLEET_SIGNATURE_BYTES;
    (void)crypto_sign_init(&state);
    (void)crypto_sign_update(&state, file->bytes, file->size);
    (void)crypto_sign_final_create(&state, file->bytes + file->size, NULL, rig->hub.secret);
    file->size += ISO_FLEET_SIGNATURE_BYTES;
    assert_int_equal(iso_fleet_snapshot_verify(file->bytes, file->size, rig->hub.public, &place),
                     0);
    assert_true(iso_fleet_snapshot_each(file->bytes, file->size, &rig->key, no_change, &n) < 0);
    assert_true(n < CHANGES);
}

static void a_changed_snapshot_is_refused(void **state)
{
    enum { CHUNKS_AT = ISO_FLEET_HEADER_BYTES + 64 + 8 + 24 };
    struct message_rig rig;
    uint64_t n = 0;
    (void)state;
    message_rig_start(&rig);
    struct iso_fleet_bytes file = make_file(&rig);
    message_rig_damage(&file, read_file, &rig);
    struct iso_fleet_zone_key key = rig.key;
    key.bytes[31] ^= 0x80;
    assert_int_equal(iso_fleet_snapshot_each(file.bytes, file.size, &key, no_change, &n),
                     -EKEYREJECTED);
    assert_int_equal(n, 0);

    /* Exchange the first two chunks, which have the same size. */
    const size_t size = 4 + iso_get_u32(file.bytes + CHUNKS_AT);
    uint8_t *chunk = malloc(size);
    assert_non_null(chunk);
    memcpy(chunk, file.bytes + CHUNKS_AT, size);
    memmove(file.bytes + CHUNKS_AT, file.bytes + CHUNKS_AT + size, size);
    memcpy(file.bytes + CHUNKS_AT + size, chunk, size);
    free(chunk);
    refused_though_signed(&rig, &file);
    iso_fleet_bytes_free(&file);

    /* Leave the end out. */
    file = make_file(&rig);
    file.size -= 4 + crypto_secretstream_xchacha20poly1305_ABYTES;
    n = 0;
    crypto_sign_state again;
    (void)crypto_sign_init(&again);
    (void)crypto_sign_update(&again, file.bytes, file.size - ISO_FLEET_SIGNATURE_BYTES);
    (void)crypto_sign_final_create(&again, file.bytes + file.size - ISO_FLEET_SIGNATURE_BYTES, NULL,
                                   rig.hub.secret);
    assert_int_equal(iso_fleet_snapshot_each(file.bytes, file.size, &rig.key, no_change, &n),
                     -EBADMSG);
    iso_fleet_bytes_free(&file);
}

static int full(void *context, const void *bytes, size_t size)
{
    size_t *left = context;
    (void)bytes;
    if (size > *left) {
        return -ENOSPC;
    }
    *left -= size;
    return 0;
}

static void an_error_of_the_file_is_reported(void **state)
{
    struct message_rig rig;
    size_t left = 20;
    struct iso_fleet_snapshot_writer writer = {.write = full, .context = &left};
    (void)state;
    message_rig_start(&rig);
    assert_int_equal(iso_fleet_snapshot_begin(&writer, &rig.here, 0, &rig.key), -ENOSPC);
    left = 1000;
    assert_int_equal(iso_fleet_snapshot_begin(&writer, &rig.here, 0, &rig.key), 0);
    left = 0;
    assert_int_equal(iso_fleet_snapshot_add(&writer, "x", 1), -ENOSPC);
    assert_int_equal(iso_fleet_snapshot_add(&writer, "", 0), -EFBIG);
    assert_int_equal(iso_fleet_snapshot_end(&writer, &rig.hub), -ENOSPC);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_snapshot_is_read_as_written),
        cmocka_unit_test(a_changed_snapshot_is_refused),
        cmocka_unit_test(an_error_of_the_file_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

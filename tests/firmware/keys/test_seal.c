/* Seals, the key ring, and anchors. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/audit/anchor.h"
#include "firmware/keys/key_ring.h"
#include "firmware/keys/seal.h"
#include "tests/support/scratch.h"

/* ---- sealing ---- */

static void opens_unchanged_seals_only(void **state)
{
    static const char plain[] = "twelve isotherms";
    uint8_t sealed[sizeof plain + ISO_SEAL_OVERHEAD];
    char out[sizeof plain];
    (void)state;
    assert_int_equal(iso_seal_start(NULL), 0);
    const struct iso_seal_key key = iso_seal_key_random(), other = iso_seal_key_random();
    struct iso_seal_label label = iso_seal_label_of("test"), label2 = iso_seal_label_of("test");
    iso_seal_label_number(&label, 7);
    iso_seal_label_number(&label2, 8);
    iso_seal_close(&key, &label, plain, sizeof plain, sealed);
    assert_null(memmem(sealed, sizeof sealed, plain, 6));
    assert_int_equal(iso_seal_open(&key, &label, sealed, sizeof sealed, out), 0);
    assert_memory_equal(out, plain, sizeof plain);
    assert_int_equal(iso_seal_open(&other, &label, sealed, sizeof sealed, out), -EBADMSG);
    assert_int_equal(iso_seal_open(&key, &label2, sealed, sizeof sealed, out), -EBADMSG);
    for (size_t at = 0; at < sizeof sealed; at++) {
        assert_int_equal(iso_seal_open(&key, &label, sealed, at, out), -EBADMSG); /* cut short */
        sealed[at] ^= 1;
        assert_int_equal(iso_seal_open(&key, &label, sealed, sizeof sealed, out), -EBADMSG);
        sealed[at] ^= 1;
    }
    assert_int_equal(iso_seal_open(&key, &label, sealed, sizeof sealed, out), 0);
}

/* Appendix A.3.1 of draft-irtf-cfrg-xchacha-03. */
static void is_xchacha20_poly1305_as_published(void **state)
{
    static const char plain[] = "Ladies and Gentlemen of the class of '99: If I could offer you "
                                "only one tip for the future, sunscreen would be it.";
    static const char published[] =
        "404142434445464748494a4b4c4d4e4f5051525354555657"
        "bd6d179d3e83d43b9576579493c0e939572a1700252bfaccbed2902c21396cbb731c7f1b0b4aa6440bf3a82f4e"
        "da7e39ae64c6708c54c216cb96b72e1213b4522f8c9ba40db5d945b11b69b982c1bb9e3f3fac2bc369488f76b2"
        "383565d3fff921f9664c97637da9768812f615c68b13b52e"
        "c0875924c1c7987947deafd8780acf49";
    static const uint8_t data[] = {0x50, 0x51, 0x52, 0x53, 0xc0, 0xc1,
                                   0xc2, 0xc3, 0xc4, 0xc5, 0xc6, 0xc7};
    struct iso_seal_key key;
    struct iso_seal_label label = {.size = sizeof data};
    uint8_t sealed[sizeof plain - 1 + ISO_SEAL_OVERHEAD];
    char out[sizeof plain - 1];
    (void)state;
    memcpy(label.bytes, data, sizeof data);
    for (size_t i = 0; i < sizeof key.bytes; i++) {
        key.bytes[i] = (uint8_t)(0x80 + i);
    }
    assert_int_equal(strlen(published), 2 * sizeof sealed);
    for (size_t i = 0; i < sizeof sealed; i++) {
        unsigned byte = 0;
        assert_int_equal(sscanf(published + 2 * i, "%2x", &byte), 1);
        sealed[i] = (uint8_t)byte;
    }
    assert_int_equal(iso_seal_open(&key, &label, sealed, sizeof sealed, out), 0);
    assert_memory_equal(out, plain, sizeof out);
}

static void two_seals_of_one_thing_differ(void **state)
{
    uint8_t a[4 + ISO_SEAL_OVERHEAD], b[4 + ISO_SEAL_OVERHEAD];
    const struct iso_seal_key key = iso_seal_key_random();
    const struct iso_seal_label label = iso_seal_label_of("test");
    (void)state;
    iso_seal_close(&key, &label, "same", 4, a);
    iso_seal_close(&key, &label, "same", 4, b);
    assert_memory_not_equal(a, b, 24);
    assert_memory_not_equal(a + 24, b + 24, 4);
}

/* ---- the key ring ---- */

static int open_ring(const char *directory, const char *credentials, struct iso_key_ring **out,
                     struct iso_fault *fault)
{
    const struct iso_key_place place = {.ring = scratch_path(directory, "ring"),
                                        .file = scratch_path(directory, "key"),
                                        .credentials = credentials};
    return iso_key_ring_open(&place, out, fault);
}

static struct iso_key_ring *ring_of(const char *directory, const char *credentials)
{
    struct iso_key_ring *ring = NULL;
    struct iso_fault fault = {.text = ""};
    if (open_ring(directory, credentials, &ring, &fault)) {
        fail_msg("%s", fault.text);
    }
    return ring;
}

static void expect_ring(const char *directory, const char *credentials, int error, const char *text)
{
    struct iso_key_ring *ring = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(open_ring(directory, credentials, &ring, &fault), error);
    assert_null(ring);
    if (!strstr(fault.text, text)) {
        fail_msg("'%s' does not say '%s'", fault.text, text);
    }
}

/* Returns a copy of the ring's newest key for this use. */
static struct iso_seal_key key_of(const struct iso_key_ring *ring, enum iso_key_use use)
{
    const struct iso_seal_key *key = iso_key_ring_find(ring, use, iso_key_ring_newest(ring, use));
    assert_non_null(key);
    return *key;
}

static void keeps_its_keys(void **state)
{
    uint32_t first = 0, second = 0;
    struct stat status;
    struct iso_key_ring *ring = ring_of(*state, NULL);
    assert_int_equal(stat(scratch_path(*state, "key"), &status), 0);
    assert_int_equal(status.st_mode & 0777, 0600);
    assert_int_equal(iso_key_ring_newest(ring, ISO_KEY_GALLERY), 0);
    assert_int_equal(iso_key_ring_add(ring, ISO_KEY_GALLERY, &first, NULL), 0);
    assert_int_equal(iso_key_ring_add(ring, ISO_KEY_GALLERY, &second, NULL), 0);
    const struct iso_seal_key old = *iso_key_ring_find(ring, ISO_KEY_GALLERY, first);
    const struct iso_seal_key new = key_of(ring, ISO_KEY_GALLERY);
    assert_true(second > first);
    assert_memory_not_equal(&old, &new, sizeof old);
    assert_null(iso_key_ring_find(ring, ISO_KEY_LOG, first));
    iso_key_ring_close(ring);
    ring = ring_of(*state, NULL);
    assert_memory_equal(iso_key_ring_find(ring, ISO_KEY_GALLERY, first), &old, sizeof old);
    assert_int_equal(iso_key_ring_drop(ring, ISO_KEY_GALLERY, second, NULL), 0);
    assert_null(iso_key_ring_find(ring, ISO_KEY_GALLERY, first));
    iso_key_ring_close(ring);
    ring = ring_of(*state, NULL);
    assert_null(iso_key_ring_find(ring, ISO_KEY_GALLERY, first));
    assert_memory_equal(iso_key_ring_find(ring, ISO_KEY_GALLERY, second), &new, sizeof new);
    iso_key_ring_close(ring);
    iso_key_ring_close(NULL);
}

static void the_ring_has_no_key_in_plain_text(void **state)
{
    struct iso_key_ring *ring = ring_of(*state, NULL);
    size_t size = 0;
    const struct iso_seal_key key = key_of(ring, ISO_KEY_ANCHOR);
    char *file = scratch_read(scratch_path(*state, "ring"), &size);
    assert_null(memmem(file, size, key.bytes, 8));
    free(file);
    iso_key_ring_close(ring);
}

static void holds_at_most_64_keys(void **state)
{
    struct iso_key_ring *ring = ring_of(*state, NULL);
    struct iso_fault fault = {.text = ""};
    uint32_t number;
    int added = 0, error;
    while ((error = iso_key_ring_add(ring, ISO_KEY_LOG, &number, &fault)) == 0) {
        added++;
    }
    assert_int_equal(error, -ENOSPC);
    assert_non_null(strstr(fault.text, "holds 64 keys"));
    assert_int_equal(added, ISO_KEY_RING_MOST - 3);
    iso_key_ring_close(ring);
}

static void refuses_wrong_keys(void **state)
{
    iso_key_ring_close(ring_of(*state, NULL));
    const char *file = scratch_path(*state, "key"), *ring = scratch_path(*state, "ring");
    size_t size = 0;
    uint8_t *key = scratch_read(file, &size), *whole;
    assert_int_equal(size, 32);
    key[31] ^= 1;
    scratch_write(file, key, 32);
    expect_ring(*state, NULL, -EKEYREJECTED, "/ring: damaged, or sealed with another key");
    scratch_write(file, key, 31);
    expect_ring(*state, NULL, -EINVAL, "/key: a key has 32 bytes, this has 31");
    (void)unlink(file);
    expect_ring(*state, NULL, -ENOKEY, "without it nothing sealed can be read");
    key[31] ^= 1;
    scratch_write(file, key, 32);
    assert_int_equal(chmod(file, 0640), 0);
    expect_ring(*state, NULL, -EACCES, "others can read this key");
    assert_int_equal(chmod(file, 0600), 0);
    whole = scratch_read(ring, &size);
    for (size_t at = 0; at < size; at += 11) {
        whole[at] ^= 0x10;
        scratch_write(ring, whole, size);
        expect_ring(*state, NULL, -EKEYREJECTED, "damaged");
        whole[at] ^= 0x10;
    }
    scratch_write(ring, whole, size);
    iso_key_ring_close(ring_of(*state, NULL));
    free(whole);
    free(key);
}

/* The states after a kill: the new key is beside the old one, before or after the ring was sealed
 * with it. */
static void a_change_of_key_survives_kills(void **state)
{
    struct iso_key_ring *ring = ring_of(*state, NULL);
    const struct iso_seal_key anchor = key_of(ring, ISO_KEY_ANCHOR);
    size_t size = 0;
    void *old = scratch_read(scratch_path(*state, "key"), &size);
    assert_int_equal(iso_key_ring_change_key(ring, NULL), 0);
    iso_key_ring_close(ring);
    void *new = scratch_read(scratch_path(*state, "key"), &size);
    assert_memory_not_equal(old, new, size);

    /* After: the ring is sealed with the new key, which is not in its place yet. */
    scratch_write(scratch_path(*state, "key"), old, size);
    scratch_write(scratch_path(*state, "key.new"), new, size);
    assert_int_equal(chmod(scratch_path(*state, "key.new"), 0600), 0);
    ring = ring_of(*state, NULL);
    assert_memory_equal(iso_key_ring_find(ring, ISO_KEY_ANCHOR, 1), &anchor, sizeof anchor);
    iso_key_ring_close(ring);
    assert_false(scratch_exists(scratch_path(*state, "key.new")));

    /* Before: a new key that seals nothing, complete or not, is removed. */
    scratch_write(scratch_path(*state, "key.new"), old, size);
    iso_key_ring_close(ring_of(*state, NULL));
    assert_false(scratch_exists(scratch_path(*state, "key.new")));
    scratch_write(scratch_path(*state, "key.new"), old, 5);
    iso_key_ring_close(ring_of(*state, NULL));
    assert_false(scratch_exists(scratch_path(*state, "key.new")));
    free(old);
    free(new);
}

static void takes_its_key_from_the_service_manager(void **state)
{
    const char *given = scratch_path(*state, "isotherm.key");
    const char *before = scratch_path(*state, "isotherm.key.old");
    char a[32], b[32];
    memset(a, 'a', sizeof a);
    memset(b, 'b', sizeof b);
    scratch_write(given, a, sizeof a);
    struct iso_key_ring *ring = ring_of(*state, *state);
    const struct iso_seal_key anchor = key_of(ring, ISO_KEY_ANCHOR);
    assert_true(iso_key_ring_has_credential(ring));
    assert_false(scratch_exists(scratch_path(*state, "key")));
    assert_int_equal(iso_key_ring_change_key(ring, NULL), -EPERM);
    iso_key_ring_close(ring);
    /* Another key, with the old one beside it for one start. */
    scratch_write(given, b, sizeof b);
    expect_ring(*state, *state, -EKEYREJECTED, "sealed with another key");
    scratch_write(before, a, sizeof a);
    iso_key_ring_close(ring_of(*state, *state));
    (void)unlink(before);
    ring = ring_of(*state, *state);
    assert_memory_equal(iso_key_ring_find(ring, ISO_KEY_ANCHOR, 1), &anchor, sizeof anchor);
    iso_key_ring_close(ring);
}

/* ---- anchors ---- */

static struct iso_anchor_state state_of(uint64_t value)
{
    struct iso_anchor_state state = {.value = value};
    memset(state.extra, (int)value, sizeof state.extra);
    return state;
}

static void expect_anchor(const char *directory, const struct iso_key_ring *ring, uint64_t value)
{
    struct iso_anchor *anchor = NULL;
    struct iso_fault fault = {.text = ""};
    const struct iso_anchor_state wanted = state_of(value);
    if (iso_anchor_open(scratch_path(directory, "anchor"), "test", ring, true, &anchor, &fault)) {
        fail_msg("%s", fault.text);
    }
    assert_memory_equal(iso_anchor_state(anchor), &wanted, sizeof wanted);
    iso_anchor_close(anchor);
}

static void an_anchor_holds_its_value(void **state)
{
    struct iso_key_ring *ring = ring_of(*state, NULL);
    const char *path = scratch_path(*state, "anchor");
    struct iso_anchor *anchor = NULL;
    struct iso_anchor_state value = state_of(0);
    assert_int_equal(iso_anchor_open(path, "test", ring, true, &anchor, NULL), -ENOENT);
    assert_int_equal(iso_anchor_make(path, "test", ring, true, &value, &anchor, NULL), 0);
    for (uint64_t i = 1; i < 6; i++) {
        value = state_of(i);
        assert_int_equal(iso_anchor_set(anchor, &value, NULL), 0);
        expect_anchor(*state, ring, i);
    }
    iso_anchor_close(anchor);
    assert_int_equal(iso_anchor_open(path, "other", ring, true, &anchor, NULL), -EBADMSG);
    iso_key_ring_close(ring);
}

/* If one slot is damaged, the anchor has the value of the other one, and never a third value. */
static void an_anchor_with_a_damaged_slot_is_at_most_one_behind(void **state)
{
    struct iso_key_ring *ring = ring_of(*state, NULL);
    const char *path = scratch_path(*state, "anchor");
    struct iso_anchor *anchor = NULL;
    size_t size = 0;
    struct iso_anchor_state value = state_of(6);
    assert_int_equal(iso_anchor_make(path, "test", ring, true, &value, &anchor, NULL), 0);
    for (uint64_t i = 7; i < 9; i++) {
        value = state_of(i);
        assert_int_equal(iso_anchor_set(anchor, &value, NULL), 0);
    }
    iso_anchor_close(anchor);
    uint8_t *whole = scratch_read(path, &size);
    for (size_t slot = 0; slot < 2; slot++) {
        for (size_t at = 0; at < 100; at += 9) {
            whole[slot * 4096 + at] ^= 2;
            scratch_write(path, whole, size);
            expect_anchor(*state, ring, slot == 0 ? 8 : 7); /* the second slot has 8 */
            whole[slot * 4096 + at] ^= 2;
        }
    }
    memset(whole, 0, size);
    scratch_write(path, whole, size);
    assert_int_equal(iso_anchor_open(path, "test", ring, true, &anchor, NULL), -EBADMSG);
    free(whole);
    iso_key_ring_close(ring);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, scratch_setup, scratch_teardown)
    const struct CMUnitTest tests[] = {
        TEST(opens_unchanged_seals_only),
        TEST(is_xchacha20_poly1305_as_published),
        TEST(two_seals_of_one_thing_differ),
        TEST(keeps_its_keys),
        TEST(the_ring_has_no_key_in_plain_text),
        TEST(holds_at_most_64_keys),
        TEST(refuses_wrong_keys),
        TEST(a_change_of_key_survives_kills),
        TEST(takes_its_key_from_the_service_manager),
        TEST(an_anchor_holds_its_value),
        TEST(an_anchor_with_a_damaged_slot_is_at_most_one_behind),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* A door of an earlier version than its hub: it refuses what it cannot read, says so, keeps what it
 * has, and its lease ends; a newer program then reads the same, and nothing is lost. */
#include <errno.h>
#include <string.h>

#include "drivers/base/times.h"
#include "tests/firmware/fleet/door/door_rig.h"

/* The same message in the next version, by this signer. */
static struct iso_fleet_bytes newer(const struct iso_fleet_bytes *message,
                                    const struct iso_fleet_signer *signer)
{
    struct iso_fleet_bytes out = {.bytes = NULL};
    iso_fleet_put(&out, message->bytes, message->size - ISO_FLEET_SIGNATURE_BYTES);
    out.bytes[4] = ISO_FLEET_VERSION + 1;
    assert_int_equal(iso_fleet_sign(&out, signer), 0);
    return out;
}

static void begin_with_ada(struct door_rig *rig)
{
    door_rig_begin(rig, 1);
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 0, 1, 1, "ada", 20, false)),
                     ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_answer(rig, 1), ISO_FLEET_APPLIED);
}

static void expect_unchanged(struct door_rig *rig, uint64_t changes)
{
    assert_int_equal(door_rig_status(rig).places[0].sequence, 1);
    assert_int_equal(door_rig_status(rig).people, 1);
    assert_true(door_rig_person(rig, "ada") > 0);
    assert_true(iso_gallery_version(rig->gallery).changes == changes);
}

static void a_newer_message_is_refused_and_read_later(void **state)
{
    struct door_rig *rig = *state;
    struct iso_fleet_signer stranger;
    (void)crypto_sign_keypair(stranger.public, stranger.secret);
    begin_with_ada(rig);
    const uint64_t changes = iso_gallery_version(rig->gallery).changes;
    struct iso_fleet_bytes delta = door_rig_remove(rig, 0, 1, 2);
    assert_int_equal(door_rig_give(rig, newer(&delta, &stranger)), ISO_FLEET_REFUSED);
    assert_string_equal(door_rig_status(rig).fault, ""); /* nobody else makes the door look old */
    assert_int_equal(door_rig_give(rig, newer(&delta, &rig->hub)), ISO_FLEET_REFUSED);
    assert_non_null(strstr(door_rig_status(rig).fault, "upgrade isotherm on this door"));
    expect_unchanged(rig, changes);
    door_rig_restart(rig);
    expect_unchanged(rig, changes);
    /* What comes after it does not pass it by. */
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 0, 2, 3, "ben", 40, false)),
                     ISO_FLEET_GAP);
    expect_unchanged(rig, changes);
    assert_int_equal(door_rig_give(rig, delta), ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_person(rig, "ada"), 0);
}

/* The unread message may be a revocation, so the lease is not renewed. */
static void a_door_that_cannot_read_loses_its_lease(void **state)
{
    struct door_rig *rig = *state;
    begin_with_ada(rig);
    struct iso_fleet_bytes delta = door_rig_put(rig, 0, 2, 2, "ben", 40, false);
    assert_int_equal(door_rig_give(rig, newer(&delta, &rig->hub)), ISO_FLEET_REFUSED);
    const int64_t half_ns = (int64_t)rig->lease_s * ISO_NS_PER_S / 2;
    for (int i = 0; i < 3; i++) { /* the hub goes on to answer */
        assert_int_equal(door_rig_admission(rig, "ada"),
                         i < 2 ? ISO_FLEET_MAY_ENTER : ISO_FLEET_NO_LEASE);
        rig->now.boot_ns += half_ns;
        assert_int_equal(door_rig_answer(rig, 1), ISO_FLEET_APPLIED);
    }
    assert_int_equal(door_rig_admission(rig, "ada"), ISO_FLEET_NO_LEASE);
    assert_int_equal(door_rig_give(rig, delta), ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_answer(rig, 1), ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_admission(rig, "ada"), ISO_FLEET_MAY_ENTER);
    assert_int_equal(door_rig_admission(rig, "ben"), ISO_FLEET_MAY_ENTER);
}

/* The next delta, whose change has a byte more, another flag or an unknown kind. */
static struct iso_fleet_bytes odd_delta(struct door_rig *rig, int which)
{
    const struct rig_zone before = rig->zone[0];
    struct iso_fleet_bytes change = door_rig_change(2, 2, "ben", 40), out = {.bytes = NULL};
    struct iso_fleet_delta delta = {.place = before.place};
    switch (which) {
    case 0:
        iso_fleet_put_u8(&change, 0); /* a further field */
        break;
    case 1:
        change.bytes[1 + 16 + 8] |= 2; /* an unknown flag */
        break;
    default:
        change.bytes[0] = 99; /* an unknown kind */
        break;
    }
    memcpy(delta.before, before.place.digest, sizeof delta.before);
    delta.place.sequence++;
    assert_int_equal(
        iso_fleet_make_delta(&delta, change.bytes, change.size, &before.key, &rig->hub, &out), 0);
    iso_fleet_bytes_free(&change);
    return out;
}

static void an_unknown_field_is_refused_as_a_whole(void **state)
{
    struct door_rig *rig = *state;
    begin_with_ada(rig);
    const uint64_t changes = iso_gallery_version(rig->gallery).changes;
    for (int which = 0; which < 3; which++) {
        assert_int_equal(door_rig_give(rig, odd_delta(rig, which)), ISO_FLEET_REFUSED);
        expect_unchanged(rig, changes);
        assert_true((strstr(door_rig_status(rig).fault, "upgrade isotherm") != NULL) ==
                    (which == 2));
    }
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 0, 2, 2, "ben", 40, false)),
                     ISO_FLEET_APPLIED);
}

/* A SNAPSHOT is signed in another way, and begins a zone that the door does not have. */
static void a_newer_snapshot_is_refused_and_read_later(void **state)
{
    struct door_rig *rig = *state;
    struct iso_fleet_bytes later = door_rig_put(rig, 0, 1, 1, "ada", 20, false);
    iso_fleet_bytes_free(&later);
    assert_int_equal(door_rig_answer(rig, 1), ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_give(rig, door_rig_key(rig, 0)), ISO_FLEET_WHOLE);
    struct iso_fleet_bytes changes = door_rig_change(1, 1, "ada", 20);
    struct iso_fleet_bytes file = door_rig_snapshot(rig, 0, &changes, 1);
    struct iso_fleet_bytes next = {.bytes = NULL};
    iso_fleet_put(&next, file.bytes, file.size);
    next.bytes[4] = ISO_FLEET_VERSION + 1;
    const size_t signed_size = next.size - ISO_FLEET_SIGNATURE_BYTES;
    struct iso_fleet_bytes changed = {.bytes = NULL};
    iso_fleet_put(&changed, next.bytes, next.size);
    assert_int_equal(door_rig_give_snapshot(rig, changed), ISO_FLEET_REFUSED);
    assert_string_equal(door_rig_status(rig).fault,
                        ""); /* the signature is that of another version */
    crypto_sign_state state_of_file;
    (void)crypto_sign_init(&state_of_file);
    (void)crypto_sign_update(&state_of_file, next.bytes, signed_size);
    (void)crypto_sign_final_create(&state_of_file, next.bytes + signed_size, NULL, rig->hub.secret);
    assert_int_equal(door_rig_give_snapshot(rig, next), ISO_FLEET_REFUSED);
    assert_non_null(strstr(door_rig_status(rig).fault, "upgrade isotherm on this door"));
    assert_true(door_rig_status(rig).wants_snapshot[0]);
    assert_int_equal(door_rig_status(rig).people, 0);
    assert_int_equal(door_rig_give_snapshot(rig, file), ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_status(rig).people, 1);
}

static void a_door_tells_which_version_it_reads(void **state)
{
    struct door_rig *rig = *state;
    struct iso_fleet_bytes asked = {.bytes = NULL};
    struct iso_fleet_question question;
    door_rig_begin(rig, 1);
    assert_int_equal(iso_fleet_question(rig->fleet, &asked, NULL), 0);
    assert_int_equal(
        iso_fleet_read_question(asked.bytes, asked.size, rig->door_signs.public, &question), 0);
    assert_non_null(memmem(question.health, question.health_length, "\"message-version\":1,", 20));
    iso_fleet_bytes_free(&asked);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, door_rig_setup, door_rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_newer_message_is_refused_and_read_later),
        TEST(a_door_that_cannot_read_loses_its_lease),
        TEST(an_unknown_field_is_refused_as_a_whole),
        TEST(a_newer_snapshot_is_refused_and_read_later),
        TEST(a_door_tells_which_version_it_reads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

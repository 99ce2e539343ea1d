/* What deltas do to the people of a door: put, replaced, removed, by one zone and by several; and
 * that nothing else than the next change of the right hub, zone and epoch does anything. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/fleet/door/door_rig.h"
#include "tests/firmware/rigs/gallery_rig.h"
#include "tests/firmware/rigs/puppets.h"

static void expect_place(struct door_rig *rig, int zone)
{
    const struct iso_fleet_status now = door_rig_status(rig);
    for (size_t i = 0; i < now.n; i++) {
        if (iso_fleet_id_is_same(&now.places[i].zone, &rig->zone[zone].place.zone)) {
            assert_memory_equal(&now.places[i], &rig->zone[zone].place, sizeof now.places[i]);
            return;
        }
    }
    fail_msg("the door does not have zone %d", zone);
}

static void a_person_comes_changes_and_leaves(void **state)
{
    struct door_rig *rig = *state;
    door_rig_begin(rig, 1);
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 0, 1, 1, "ada", 20, false)),
                     ISO_FLEET_APPLIED);
    const int64_t number = door_rig_person(rig, "ada");
    assert_true(number > 0);
    assert_true(door_rig_noted(rig, "put ada - -> ada; no limits"));
    assert_int_equal(door_rig_admission(rig, "ada"), ISO_FLEET_MAY_ENTER);
    /* The same templates: the number stays. */
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 0, 1, 2, "ada lovelace", 20, true)),
                     ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_person(rig, "ada lovelace"), number);
    assert_int_equal(door_rig_person(rig, "ada"), 0);
    assert_true(door_rig_credential(rig, "ada lovelace").fleet.offline_ok);
    assert_true(door_rig_noted(rig, "put ada ada; no limits"));
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 0, 1, 3, "ada lovelace", 21, true)),
                     ISO_FLEET_APPLIED);
    assert_true(door_rig_person(rig, "ada lovelace") > number);
    door_rig_restart(rig);
    expect_place(rig, 0);
    assert_true(door_rig_person(rig, "ada lovelace") > number);
    assert_int_equal(door_rig_give(rig, door_rig_remove(rig, 0, 1, 4)), ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_person(rig, "ada lovelace"), 0);
    assert_true(door_rig_noted(rig, "removed ada lovelace"));
    assert_int_equal(door_rig_status(rig).people, 0);
    expect_place(rig, 0);
}

/* A copy of a message in which one byte is another. */
static struct iso_fleet_bytes spoiled(const struct iso_fleet_bytes *message, size_t at)
{
    struct iso_fleet_bytes copy = {.bytes = NULL};
    iso_fleet_put(&copy, message->bytes, message->size);
    copy.bytes[at] ^= 0x10;
    return copy;
}

static struct iso_fleet_bytes copy_of(const struct iso_fleet_bytes *message)
{
    struct iso_fleet_bytes copy = {.bytes = NULL};
    iso_fleet_put(&copy, message->bytes, message->size);
    return copy;
}

static void a_changed_delta_is_refused(void **state)
{
    struct door_rig *rig = *state;
    door_rig_begin(rig, 1);
    struct iso_fleet_bytes delta = door_rig_put(rig, 0, 1, 1, "ada", 20, false);
    const uint64_t changes = iso_gallery_version(rig->gallery).changes;
    for (size_t at = 0; at < delta.size; at += at < 200 ? 1 : 61) {
        assert_int_equal(door_rig_give(rig, spoiled(&delta, at)), ISO_FLEET_REFUSED);
    }
    for (size_t size = 0; size < delta.size; size += 97) {
        struct iso_fleet_bytes cut = copy_of(&delta);
        cut.size = size;
        assert_int_equal(door_rig_give(rig, cut), ISO_FLEET_REFUSED);
    }
    assert_int_equal(iso_gallery_version(rig->gallery).changes, changes);
    assert_int_equal(door_rig_give(rig, delta), ISO_FLEET_APPLIED);
}

static void only_the_next_delta_is_applied(void **state)
{
    struct door_rig *rig = *state;
    door_rig_begin(rig, 2);
    struct iso_fleet_bytes first = door_rig_put(rig, 0, 1, 1, "ada", 20, false),
                           second = door_rig_remove(rig, 0, 1, 2),
                           third = door_rig_put(rig, 0, 2, 3, "ben", 40, false);
    assert_int_equal(door_rig_give(rig, copy_of(&third)), ISO_FLEET_GAP);
    assert_int_equal(door_rig_give(rig, copy_of(&second)), ISO_FLEET_GAP);
    assert_int_equal(door_rig_give(rig, copy_of(&first)), ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_give(rig, copy_of(&first)), ISO_FLEET_KNOWN);
    assert_int_equal(door_rig_give(rig, copy_of(&third)), ISO_FLEET_GAP);
    assert_int_equal(door_rig_give(rig, copy_of(&second)), ISO_FLEET_APPLIED);
    /* A PUT that is sent again does not bring back who was removed. */
    assert_int_equal(door_rig_give(rig, copy_of(&first)), ISO_FLEET_KNOWN);
    assert_int_equal(door_rig_person(rig, "ada"), 0);
    door_rig_restart(rig);
    assert_int_equal(door_rig_give(rig, first), ISO_FLEET_KNOWN);
    assert_int_equal(door_rig_give(rig, second), ISO_FLEET_KNOWN);
    assert_int_equal(door_rig_person(rig, "ada"), 0);
    assert_int_equal(door_rig_give(rig, third), ISO_FLEET_APPLIED);
    expect_place(rig, 0);
}

/* Another hub, a zone that is not the door's, and a key of another zone. */
static void what_is_not_for_the_door_is_refused(void **state)
{
    struct door_rig *rig = *state;
    door_rig_begin(rig, 1);
    const uint64_t changes = iso_gallery_version(rig->gallery).changes;
    const struct door_rig before = *rig;
    (void)crypto_sign_keypair(rig->hub.public, rig->hub.secret);
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 0, 1, 1, "ada", 20, false)),
                     ISO_FLEET_REFUSED);
    assert_int_equal(door_rig_give(rig, door_rig_key(rig, 0)), ISO_FLEET_REFUSED);
    assert_int_equal(door_rig_answer(rig, 1), ISO_FLEET_REFUSED);
    rig->hub = before.hub;
    rig->zone[0].place = before.zone[0].place;
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 1, 1, 1, "ada", 20, false)),
                     ISO_FLEET_REFUSED);
    assert_int_equal(door_rig_give(rig, door_rig_key(rig, 1)), ISO_FLEET_REFUSED);
    randombytes_buf(&rig->zone[0].key, sizeof rig->zone[0].key);
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 0, 1, 1, "ada", 20, false)),
                     ISO_FLEET_REFUSED);
    rig->zone[0] = before.zone[0];
    rig->door = iso_fleet_id_random();
    rig->zone[0].base.epoch = 2;
    assert_int_equal(door_rig_give(rig, door_rig_key(rig, 0)), ISO_FLEET_REFUSED);
    assert_int_equal(door_rig_answer(rig, 1), ISO_FLEET_REFUSED);
    assert_int_equal(iso_gallery_version(rig->gallery).changes, changes);
    assert_int_equal(door_rig_person(rig, "ada"), 0);
}

static void a_key_for_another_receiver_is_refused(void **state)
{
    struct door_rig *rig = *state;
    assert_int_equal(door_rig_answer(rig, 1), ISO_FLEET_APPLIED);
    const struct iso_fleet_receiver own = rig->door_receives;
    (void)crypto_box_keypair(rig->door_receives.public, rig->door_receives.secret);
    struct iso_fleet_bytes key = door_rig_key(rig, 0);
    rig->door_receives = own;
    assert_int_equal(door_rig_give(rig, key), ISO_FLEET_REFUSED);
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 0, 1, 1, "ada", 20, false)),
                     ISO_FLEET_NO_KEY);
}

static void begin_epoch(struct rig_zone *zone, bool reset)
{
    zone->base = zone->place;
    zone->base.epoch = ++zone->place.epoch;
    zone->reset = reset;
    randombytes_buf(&zone->key, sizeof zone->key);
}

static void a_new_epoch_goes_on_from_its_base(void **state)
{
    struct door_rig *rig = *state;
    struct iso_fleet_bytes late, old_key;
    door_rig_begin(rig, 1);
    old_key = door_rig_key(rig, 0);
    late = door_rig_put(rig, 0, 1, 1, "ada", 20, false);
    begin_epoch(&rig->zone[0], false);
    struct iso_fleet_bytes next = door_rig_put(rig, 0, 2, 2, "ben", 40, false);
    assert_int_equal(door_rig_give(rig, copy_of(&next)), ISO_FLEET_NO_KEY);
    assert_int_equal(door_rig_give(rig, door_rig_key(rig, 0)), ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_give(rig, door_rig_key(rig, 0)), ISO_FLEET_KNOWN);
    assert_int_equal(door_rig_give(rig, copy_of(&next)), ISO_FLEET_GAP);
    door_rig_restart(rig); /* both keys are kept */
    assert_int_equal(door_rig_give(rig, late), ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_give(rig, old_key), ISO_FLEET_REFUSED);
    assert_int_equal(door_rig_give(rig, next), ISO_FLEET_APPLIED);
    assert_true(door_rig_person(rig, "ada") && door_rig_person(rig, "ben"));
    expect_place(rig, 0);
    /* The old epoch has ended: its key signs nothing any more. */
    const struct rig_zone now = rig->zone[0];
    rig->zone[0].place.epoch = 1;
    assert_int_equal(door_rig_give(rig, door_rig_remove(rig, 0, 1, 9)), ISO_FLEET_REFUSED);
    rig->zone[0] = now;
    assert_true(door_rig_person(rig, "ada"));
}

/* The key of the epoch in between never comes. */
static void two_epochs_at_once_need_a_snapshot(void **state)
{
    struct door_rig *rig = *state;
    door_rig_begin(rig, 1);
    struct iso_fleet_bytes first = door_rig_put(rig, 0, 1, 1, "ada", 20, false);
    begin_epoch(&rig->zone[0], false);
    struct iso_fleet_bytes second = door_rig_put(rig, 0, 2, 2, "ben", 40, false);
    begin_epoch(&rig->zone[0], false);
    assert_int_equal(door_rig_give(rig, door_rig_key(rig, 0)), ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_give(rig, first), ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_give(rig, second), ISO_FLEET_WHOLE);
    assert_true(door_rig_status(rig).wants_snapshot[0]);
    struct iso_fleet_bytes changes[2] = {door_rig_change(1, 1, "ada", 20),
                                         door_rig_change(2, 2, "ben", 40)};
    assert_int_equal(door_rig_give_snapshot(rig, door_rig_snapshot(rig, 0, changes, 2)),
                     ISO_FLEET_APPLIED);
    expect_place(rig, 0);
    assert_int_equal(door_rig_give(rig, door_rig_remove(rig, 0, 1, 3)), ISO_FLEET_APPLIED);
}

/* ---- several zones ---- */

static void a_person_stays_as_long_as_a_zone_grants(void **state)
{
    struct door_rig *rig = *state;
    door_rig_begin(rig, 3);
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 0, 1, 5, "ada", 20, false)),
                     ISO_FLEET_APPLIED);
    const int64_t number = door_rig_person(rig, "ada");
    /* An older content, by a zone that was slower: only its grant counts. */
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 1, 1, 4, "ada old", 30, true)),
                     ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_person(rig, "ada"), number);
    assert_int_equal(door_rig_credential(rig, "ada").fleet.zones, 3);
    assert_false(door_rig_credential(rig, "ada").fleet.offline_ok);
    assert_int_equal(door_rig_give(rig, door_rig_remove(rig, 0, 1, 6)), ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_person(rig, "ada"), number);
    assert_int_equal(door_rig_give(rig, door_rig_remove(rig, 2, 1, 6)), ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_person(rig, "ada"), number);
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 1, 1, 6, "ada", 20, true)),
                     ISO_FLEET_APPLIED);
    assert_true(door_rig_credential(rig, "ada").fleet.offline_ok);
    door_rig_restart(rig);
    assert_int_equal(door_rig_give(rig, door_rig_remove(rig, 1, 1, 7)), ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_person(rig, "ada"), 0);
}

static void a_zone_that_is_not_listed_is_gone(void **state)
{
    struct door_rig *rig = *state;
    door_rig_begin(rig, 2);
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 0, 1, 1, "ada", 20, false)),
                     ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 1, 1, 1, "ada", 20, false)),
                     ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 1, 2, 2, "ben", 40, false)),
                     ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_answer(rig, 1), ISO_FLEET_APPLIED);
    assert_true(door_rig_person(rig, "ada"));
    assert_int_equal(door_rig_person(rig, "ben"), 0);
    assert_int_equal(door_rig_status(rig).n, 1);
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 1, 2, 3, "ben", 40, false)),
                     ISO_FLEET_REFUSED);
    door_rig_restart(rig);
    /* It comes back: the door has nothing of it any more. */
    assert_int_equal(door_rig_answer(rig, 2), ISO_FLEET_APPLIED);
    assert_true(door_rig_status(rig).wants_snapshot[1]);
    assert_int_equal(door_rig_answer(rig, 0), ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_person(rig, "ada"), 0);
    assert_int_equal(door_rig_status(rig).people, 0);
}

/* Of two zones, the faster one brings the name that the slower one still gives to somebody else. */
static void a_name_goes_to_who_has_it_now(void **state)
{
    struct door_rig *rig = *state;
    char text[ISO_FLEET_ID_TEXT_SIZE];
    const struct iso_fleet_id ada = door_rig_id(1);
    door_rig_begin(rig, 2);
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 0, 1, 1, "ada", 20, false)),
                     ISO_FLEET_APPLIED);
    const int64_t number = door_rig_person(rig, "ada");
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 1, 2, 3, "Ada", 40, false)),
                     ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_person(rig, iso_fleet_id_text(&ada, text)), number);
    assert_true(door_rig_person(rig, "ada") != number);
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 0, 1, 2, "ada b", 20, false)),
                     ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_person(rig, "ada b"), number);
}

/* ---- what the door cannot do ---- */

static void a_person_who_does_not_fit_is_not_left_as_before(void **state)
{
    struct door_rig *rig = *state;
    door_rig_begin(rig, 1);
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 0, 1, 1, "ada", 20, false)),
                     ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 0, 1, 2, " ada", 20, false)),
                     ISO_FLEET_APPLIED); /* a name that the door refuses */
    assert_int_equal(door_rig_person(rig, "ada"), 0);
    assert_true(door_rig_noted(rig, "refused"));
    assert_true(*door_rig_status(rig).fault);
    expect_place(rig, 0);
    for (int i = 0; i < 101; i++) { /* more than the gallery takes */
        char name[32];
        (void)snprintf(name, sizeof name, "person %d", i);
        assert_int_equal(door_rig_give(rig, door_rig_put(rig, 0, 10 + i, 3, name, i + 1, false)),
                         ISO_FLEET_APPLIED);
    }
    assert_int_equal(door_rig_person(rig, "person 100"), 0);
    assert_non_null(strstr(door_rig_status(rig).fault, "full"));
    expect_place(rig, 0);
}

static void without_a_record_nothing_happens(void **state)
{
    struct door_rig *rig = *state;
    door_rig_begin(rig, 1);
    struct iso_fleet_bytes delta = door_rig_put(rig, 0, 1, 1, "ada", 20, false);
    rig->fails_notes = true;
    assert_int_equal(door_rig_give(rig, copy_of(&delta)), ISO_FLEET_OUTCOMES);
    assert_string_equal(rig->fault.text, "the log is full");
    assert_int_equal(door_rig_person(rig, "ada"), 0);
    rig->fails_notes = false;
    rig->fail_applies = rig->applies + 1;
    assert_int_equal(door_rig_give(rig, copy_of(&delta)), ISO_FLEET_OUTCOMES);
    assert_int_equal(door_rig_person(rig, "ada"), 0);
    door_rig_restart(rig);
    assert_int_equal(door_rig_give(rig, delta), ISO_FLEET_APPLIED);
    assert_true(door_rig_person(rig, "ada"));
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, door_rig_setup, door_rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_person_comes_changes_and_leaves),
        TEST(a_changed_delta_is_refused),
        TEST(only_the_next_delta_is_applied),
        TEST(what_is_not_for_the_door_is_refused),
        TEST(a_key_for_another_receiver_is_refused),
        TEST(a_new_epoch_goes_on_from_its_base),
        TEST(two_epochs_at_once_need_a_snapshot),
        TEST(a_person_stays_as_long_as_a_zone_grants),
        TEST(a_zone_that_is_not_listed_is_gone),
        TEST(a_name_goes_to_who_has_it_now),
        TEST(a_person_who_does_not_fit_is_not_left_as_before),
        TEST(without_a_record_nothing_happens),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

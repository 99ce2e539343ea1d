/* A hub that has lost a part of what it had, or has gone on in another way, and how its door
 * notices that. */
#include "tests/firmware/fleet/door/door_rig.h"
#include "tests/firmware/rigs/gallery_rig.h"

static void a_restored_hub_is_noticed(void **state)
{
    struct door_rig *rig = *state;
    door_rig_begin(rig, 1);
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 0, 1, 1, "ada", 20, false)),
                     ISO_FLEET_APPLIED);
    const struct rig_zone backup = rig->zone[0];
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 0, 2, 2, "ben", 40, false)),
                     ISO_FLEET_APPLIED);
    rig->zone[0] = backup;
    assert_int_equal(door_rig_answer(rig, 1), ISO_FLEET_APPLIED);
    assert_true(door_rig_status(rig).behind);
    assert_int_equal(door_rig_admission(rig, "ben"), ISO_FLEET_MAY_ENTER);
    /* It goes on with another change 2, and a change 3. */
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 0, 3, 3, "eve", 60, false)),
                     ISO_FLEET_REFUSED);
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 0, 3, 4, "eve", 60, false)),
                     ISO_FLEET_REFUSED);
    assert_int_equal(door_rig_answer(rig, 1), ISO_FLEET_APPLIED);
    assert_true(door_rig_status(rig).behind);
    door_rig_restart(rig);
    assert_true(door_rig_status(rig).behind);
    assert_true(door_rig_person(rig, "ben") && !door_rig_person(rig, "eve"));
    /* A new epoch with `reset`, and a snapshot. */
    struct iso_fleet_bytes old = {.bytes = NULL};
    struct iso_fleet_bytes changes[2] = {door_rig_change(1, 1, "ada", 20),
                                         door_rig_change(3, 4, "eve", 60)};
    old = door_rig_snapshot(rig, 0, (struct iso_fleet_bytes[1]){door_rig_change(3, 4, "eve", 60)},
                            1);
    rig->zone[0].base = rig->zone[0].place;
    rig->zone[0].base.epoch = rig->zone[0].place.epoch = 2;
    rig->zone[0].reset = true;
    randombytes_buf(&rig->zone[0].key, sizeof rig->zone[0].key);
    assert_int_equal(door_rig_give(rig, door_rig_key(rig, 0)), ISO_FLEET_WHOLE);
    assert_true(door_rig_status(rig).wants_snapshot[0]);
    assert_int_equal(door_rig_give_snapshot(rig, old), ISO_FLEET_REFUSED);
    assert_true(door_rig_person(rig, "ben"));
    assert_int_equal(door_rig_give_snapshot(rig, door_rig_snapshot(rig, 0, changes, 2)),
                     ISO_FLEET_APPLIED);
    assert_true(door_rig_person(rig, "eve") && door_rig_person(rig, "ada"));
    assert_int_equal(door_rig_person(rig, "ben"), 0);
    assert_int_equal(door_rig_answer(rig, 1), ISO_FLEET_APPLIED);
    assert_false(door_rig_status(rig).behind);
    assert_int_equal(door_rig_give(rig, door_rig_remove(rig, 0, 3, 5)), ISO_FLEET_APPLIED);
}

/* A change that has come after the question may be newer than the answer. */
static void a_late_answer_does_not_make_the_hub_behind(void **state)
{
    struct door_rig *rig = *state;
    door_rig_begin(rig, 1);
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 0, 1, 1, "ada", 20, false)),
                     ISO_FLEET_APPLIED);
    struct iso_fleet_bytes late = door_rig_lease(rig, 1);
    const struct rig_zone then = rig->zone[0];
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 0, 2, 2, "ben", 40, false)),
                     ISO_FLEET_APPLIED);
    const struct rig_zone now = rig->zone[0];
    assert_int_equal(door_rig_give(rig, late), ISO_FLEET_APPLIED);
    assert_false(door_rig_status(rig).behind);
    /* The same place is too old for a question that has reported the change. */
    rig->zone[0] = then;
    assert_int_equal(door_rig_answer(rig, 1), ISO_FLEET_APPLIED);
    assert_true(door_rig_status(rig).behind);
    rig->zone[0] = now;
    assert_int_equal(door_rig_answer(rig, 1), ISO_FLEET_APPLIED);
    assert_false(door_rig_status(rig).behind);
}

/* The hub has gone on in another way before it was asked, and is ahead of the door. */
static void another_history_is_noticed_by_its_next_change(void **state)
{
    struct door_rig *rig = *state;
    door_rig_begin(rig, 1);
    const struct rig_zone backup = rig->zone[0];
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 0, 1, 1, "ada", 20, false)),
                     ISO_FLEET_APPLIED);
    rig->zone[0] = backup;
    struct iso_fleet_bytes other = door_rig_put(rig, 0, 2, 1, "ben", 40, false);
    iso_fleet_bytes_free(&other);
    other = door_rig_put(rig, 0, 3, 2, "eve", 60, false);
    assert_int_equal(door_rig_answer(rig, 1), ISO_FLEET_APPLIED);
    assert_false(door_rig_status(rig).behind);
    assert_int_equal(door_rig_give(rig, other), ISO_FLEET_REFUSED);
    assert_true(door_rig_status(rig).behind);
    assert_int_equal(door_rig_answer(rig, 1), ISO_FLEET_APPLIED);
    assert_true(door_rig_status(rig).behind);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, door_rig_setup, door_rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_restored_hub_is_noticed),
        TEST(a_late_answer_does_not_make_the_hub_behind),
        TEST(another_history_is_noticed_by_its_next_change),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* What the hub deletes, and doors that come back behind it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "enroll/hub/answer/hub_prune.h"
#include "tests/enroll/hub/rigs/played_door.h"

enum { PEOPLE = 6 };

static struct iso_fault fault;
static struct iso_fleet_id zone;
static struct played_door level, away;

static void run(struct store_rig *rig, const char *sql)
{
    store_rig_fine(hub_db_script(rig->store.db, sql, &fault), &fault);
}

static struct hub_pruned prune(struct store_rig *rig, uint32_t deltas, uint32_t events,
                               uint32_t acts)
{
    const struct hub_prune_days days = {deltas, events, acts};
    struct hub_pruned pruned = {.deltas = 0};
    store_rig_fine(hub_prune(&rig->store, &days, &pruned, &fault), &fault);
    return pruned;
}

static void come(struct played_door *door, struct store_rig *rig)
{
    store_rig_fine(played_door_ask(door, &rig->store, &fault), &fault);
    played_door_fetch(door, &rig->store);
    store_rig_fine(played_door_ask(door, &rig->store, &fault), &fault);
}

static void put(struct store_rig *rig, char first)
{
    char name[3] = {first, '0', '\0'};
    for (int i = 0; i < PEOPLE; i++, name[1]++) {
        (void)store_rig_put(rig, name, &zone, 1);
    }
}

/* Two doors that have the first six changes; then one is away, and a snapshot has all twelve. */
static void begin(struct store_rig *rig)
{
    zone = store_rig_zone(rig, "office");
    played_door_join(&level, rig, "front", &zone, 1);
    played_door_join(&away, rig, "back", &zone, 1);
    put(rig, 'a');
    come(&level, rig);
    come(&away, rig);
    put(rig, 'b');
    come(&level, rig);
    run(rig, "UPDATE zone SET published = sequence");
    store_rig_fine(hub_snapshot_make(&rig->store, &zone, &fault), &fault);
}

static void what_every_door_has_goes(void **state)
{
    struct store_rig *rig = *state;
    begin(rig);
    assert_int_equal(prune(rig, 30, 0, 0).deltas, PEOPLE); /* those that both have */
    assert_int_equal(store_rig_number(rig, "SELECT min(sequence) FROM delta"), PEOPLE + 1);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM delta_digest"), PEOPLE);
    assert_int_equal(prune(rig, 30, 0, 0).deltas, 0);
    /* The door that was away still gets the changes that it lacks. */
    const unsigned applied = away.applied;
    come(&away, rig);
    assert_int_equal(away.applied, applied + PEOPLE);
    assert_true(played_door_is_same(&level, &away, &zone));
    assert_int_equal(prune(rig, 30, 0, 0).deltas, PEOPLE);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM delta"), 0);
    /* The stream goes on. */
    put(rig, 'c');
    come(&away, rig);
    come(&level, rig);
    assert_int_equal(played_door_count(&away, &zone), 3 * PEOPLE);
    assert_true(played_door_is_same(&level, &away, &zone));
}

static void a_door_below_the_deltas_takes_the_snapshot(void **state)
{
    struct store_rig *rig = *state;
    begin(rig);
    run(rig, "UPDATE delta SET made_s = made_s - 31 * 86400 WHERE sequence <= 9");
    assert_int_equal(prune(rig, 30, 0, 0).deltas, 9);
    const struct played_door_zone *at = played_door_zone(&away, &zone);
    assert_int_equal(at->place.sequence, PEOPLE);
    come(&away, rig);
    assert_int_equal(at->place.sequence, 2 * PEOPLE);
    assert_true(played_door_is_same(&level, &away, &zone));
    assert_int_equal(store_rig_zone_now(rig, &zone).behind, false);
}

/* What a snapshot does not contain, or the broker does not have, stays whatever its age is. */
static void nothing_goes_that_is_wanted(void **state)
{
    struct store_rig *rig = *state;
    begin(rig);
    put(rig, 'c');
    run(rig, "UPDATE delta SET made_s = 0");
    run(rig, "UPDATE zone SET published = 3");
    assert_int_equal(prune(rig, 30, 0, 0).deltas, 3);
    run(rig, "UPDATE zone SET published = sequence");
    assert_int_equal(prune(rig, 30, 0, 0).deltas, 2 * PEOPLE - 3);
    run(rig, "DELETE FROM snapshot");
    assert_int_equal(prune(rig, 30, 0, 0).deltas, 0);
    run(rig, "UPDATE zone SET behind = true");
    store_rig_fine(hub_snapshot_make(&rig->store, &zone, &fault), &fault);
    assert_int_equal(prune(rig, 30, 0, 0).deltas, 0);
    run(rig, "UPDATE zone SET behind = false");
    assert_int_equal(prune(rig, 0, 0, 0).deltas, 0); /* for ever */
    come(&away, rig);
    come(&level, rig);
    assert_true(played_door_is_same(&level, &away, &zone));
}

/* The digests of deltas that are gone still tell a door of another history. */
static void another_history_is_still_noticed(void **state)
{
    struct store_rig *rig = *state;
    begin(rig);
    run(rig, "UPDATE delta SET made_s = 0");
    assert_int_equal(prune(rig, 30, 0, 0).deltas, 2 * PEOPLE);
    store_rig_fine(played_door_ask(&away, &rig->store, &fault), &fault);
    assert_false(store_rig_zone_now(rig, &zone).behind);
    played_door_zone(&away, &zone)->place.digest[3] ^= 1;
    (void)!played_door_ask(&away, &rig->store, &fault);
    assert_true(store_rig_zone_now(rig, &zone).behind);
}

static void old_events_and_acts_go(void **state)
{
    struct store_rig *rig = *state;
    begin(rig);
    store_rig_fine(played_door_send_events(&level, &rig->store, 1, 40, &fault), &fault);
    assert_int_equal(prune(rig, 0, 365, 0).events, 0);
    run(rig, "UPDATE event SET stored_s = stored_s - 366 * 86400 WHERE number <= 30");
    assert_int_equal(prune(rig, 0, 0, 0).events, 0);
    assert_int_equal(prune(rig, 0, 365, 0).events, 30);
    assert_int_equal(store_rig_number(rig, "SELECT min(number) FROM event"), 31);
    /* The door says some of them again, and none comes back. */
    store_rig_fine(played_door_send_events(&level, &rig->store, 21, 45, &fault), &fault);
    assert_int_equal(store_rig_number(rig, "SELECT min(number) FROM event"), 31);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM event"), 15);
    assert_int_equal(store_rig_number(rig, "SELECT acked FROM door WHERE name = 'front'"), 45);
    /* Beyond a gap nothing is acknowledged, and so nothing goes. */
    store_rig_fine(played_door_send_events(&level, &rig->store, 50, 52, &fault), &fault);
    run(rig, "UPDATE event SET stored_s = 0");
    assert_int_equal(prune(rig, 0, 365, 0).events, 15);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM event"), 3);

    const int64_t acts = store_rig_number(rig, "SELECT count(*) FROM act");
    run(rig, "UPDATE act SET time_s = 1");
    assert_int_equal(prune(rig, 0, 0, 730).acts, (uint64_t)acts - 1);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM act"), 1);
}

static void a_call_deletes_a_bounded_number(void **state)
{
    struct store_rig *rig = *state;
    begin(rig);
    run(rig, "INSERT INTO act (time_s, actor, what, object) SELECT 1, 'a', 'b', 'c' "
             "FROM generate_series(1, 1500)");
    assert_int_equal(prune(rig, 0, 0, 730).acts, HUB_PRUNE_AT_ONCE);
    assert_true(prune(rig, 0, 0, 730).acts < HUB_PRUNE_AT_ONCE);
}

#define TEST(NAME) cmocka_unit_test_setup_teardown(NAME, store_rig_setup, store_rig_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(what_every_door_has_goes),    TEST(a_door_below_the_deltas_takes_the_snapshot),
        TEST(nothing_goes_that_is_wanted), TEST(another_history_is_still_noticed),
        TEST(old_events_and_acts_go),      TEST(a_call_deletes_a_bounded_number),
    };
    return cmocka_run_group_tests(tests, store_rig_start, store_rig_stop);
}

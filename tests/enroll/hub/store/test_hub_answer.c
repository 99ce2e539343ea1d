/* The hub's answers to its doors, whose side is played. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/hub/answer/hub_outbox.h"
#include "tests/enroll/hub/rigs/played_door.h"

static struct iso_fault fault;

static void ask(struct played_door *door, struct store_rig *rig)
{
    store_rig_fine(played_door_ask(door, &rig->store, &fault), &fault);
}

/* Publishes everything to some doors. */
struct doors {
    struct hub_emit emit[4];
    size_t n;
};

static int to_all(void *context, const char *topic, const void *bytes, size_t size, bool retain)
{
    const struct doors *doors = context;
    for (size_t i = 0; i < doors->n; i++) {
        assert_int_equal(doors->emit[i].emit(doors->emit[i].context, topic, bytes, size, retain),
                         0);
    }
    return 0;
}

/* Emits at most `most` deltas of each zone, which a broker then acknowledges. Returns whether there
 * are more. */
static bool publish_some(struct store_rig *rig, struct doors *doors, uint32_t most)
{
    const struct hub_emit emit = {.emit = to_all, .context = doors};
    struct hub_outbox outbox = {.n = 0};
    store_rig_fine(hub_outbox_emit(&rig->store, most, &emit, &outbox, &fault), &fault);
    const bool more = outbox.more;
    store_rig_fine(hub_outbox_confirm(&rig->store, &outbox, &fault), &fault);
    hub_outbox_free(&outbox);
    return more;
}

static void publish(struct store_rig *rig, struct doors *doors)
{
    while (publish_some(rig, doors, 7)) {
    }
}

static void a_door_gets_keys_lease_and_people(void **state)
{
    struct store_rig *rig = *state;
    const struct iso_fleet_id zones[2] = {store_rig_zone(rig, "office"),
                                          store_rig_zone(rig, "lab")};
    const struct hub_zone_settings settings = {.lease_s = 900, .local_people = true};
    struct played_door door;
    struct hub_door known;
    store_rig_fine(hub_zone_set(&rig->store, &zones[0], &settings, &fault), &fault);
    const struct iso_fleet_id anna = store_rig_put(rig, "anna", zones, 2);
    const struct iso_fleet_id ben = store_rig_put(rig, "ben", &zones[1], 1);
    played_door_join(&door, rig, "front", zones, 2);
    ask(&door, rig);
    assert_int_equal(door.keys, 2);
    assert_int_equal(door.leases, 1);
    assert_int_equal(door.lease.lease_s, 900);
    assert_true(door.lease.local_people);
    assert_int_equal(door.lease.n, 2);
    assert_true(iso_fleet_id_is_same(&door.lease.places[0].zone, &zones[0]));
    assert_int_equal(door.lease.places[1].sequence, 2);
    played_door_fetch(&door, &rig->store);
    assert_int_equal(door.n_people, 3);
    assert_non_null(played_door_person(&door, &zones[0], &anna));
    assert_non_null(played_door_person(&door, &zones[1], &ben));
    ask(&door, rig);
    assert_int_equal(door.keys, 2); /* it has them */
    store_rig_fine(hub_door_find(&rig->store, "front", &known, &fault), &fault);
    assert_int_equal(known.reported_s, store_rig_now_s);
    assert_int_equal(known.door_time_s, 5);
    assert_int_equal(known.algorithm, 3);
    assert_string_equal(known.health, "{\"version\":\"1.0\"}");
    assert_true(known.online);
}

static void a_door_applies_each_change(void **state)
{
    struct store_rig *rig = *state;
    const struct iso_fleet_id zones[2] = {store_rig_zone(rig, "office"),
                                          store_rig_zone(rig, "lab")};
    struct played_door door;
    const struct iso_fleet_id anna = store_rig_put(rig, "anna", zones, 2);
    const struct iso_fleet_id ben = store_rig_put(rig, "ben", &zones[1], 1);
    played_door_join(&door, rig, "front", zones, 2);
    ask(&door, rig);
    played_door_fetch(&door, &rig->store);
    store_rig_fine(hub_person_set_offline(&rig->store, &anna, true, &fault), &fault);
    store_rig_fine(hub_person_rename(&rig->store, &anna, "Anna B.", &fault), &fault);
    store_rig_fine(hub_person_set_zones(&rig->store, &ben, &zones[0], 1, &fault), &fault);
    store_rig_fine(
        hub_zone_set_policy(&rig->store, &zones[0], "{\"areas\":[{\"token\":\"hall\"}]}", &fault),
        &fault);
    store_rig_fine(hub_zone_lockdown(&rig->store, NULL, true, &fault), &fault);
    store_rig_fine(hub_zone_lockdown(&rig->store, NULL, true, &fault), &fault); /* no change */
    struct doors doors = {.emit = {played_door_emit(&door)}, .n = 1};
    publish(rig, &doors);
    assert_string_equal(played_door_person(&door, &zones[0], &anna)->name, "Anna B.");
    assert_true(played_door_person(&door, &zones[1], &anna)->offline_ok);
    assert_null(played_door_person(&door, &zones[1], &ben));
    assert_non_null(played_door_person(&door, &zones[0], &ben));
    assert_true(door.zones[0].lockdown);
    assert_true(door.zones[1].lockdown);
    assert_string_equal(door.zones[0].policy, "{\"areas\":[{\"token\":\"hall\"}]}");
    assert_int_equal(door.zones[0].place.sequence,
                     store_rig_zone_now(rig, &zones[0]).place.sequence);
    store_rig_fine(hub_person_revoke(&rig->store, &anna, &fault), &fault);
    publish(rig, &doors);
    assert_int_equal(door.n_people, 1);
    assert_int_equal(door.refused, 0);
}

static int count_behind(void *context, const struct hub_behind *door)
{
    assert_string_equal(door->name, "front");
    (*(int *)context)++;
    return 0;
}

static int behind(struct store_rig *rig, const struct iso_fleet_id *zone)
{
    int n = 0;
    store_rig_fine(hub_doors_behind(&rig->store, zone, count_behind, &n, &fault), &fault);
    return n;
}

static void doors_confirm_a_change(void **state)
{
    struct store_rig *rig = *state;
    const struct iso_fleet_id zone = store_rig_zone(rig, "office");
    struct played_door door;
    played_door_join(&door, rig, "front", &zone, 1);
    assert_int_equal(behind(rig, &zone), 1);
    ask(&door, rig);
    ask(&door, rig);
    assert_int_equal(behind(rig, &zone), 0);
    store_rig_fine(hub_zone_lockdown(&rig->store, &zone, true, &fault), &fault);
    assert_int_equal(behind(rig, &zone), 1);
    played_door_fetch(&door, &rig->store);
    assert_int_equal(behind(rig, &zone), 1);
    ask(&door, rig);
    assert_int_equal(behind(rig, &zone), 0);
}

static void what_is_published_twice_is_known(void **state)
{
    struct store_rig *rig = *state;
    const struct iso_fleet_id zone = store_rig_zone(rig, "office");
    struct played_door door;
    struct doors doors = {.emit = {played_door_emit(&door)}, .n = 1};
    const struct hub_emit emit = {.emit = to_all, .context = &doors};
    struct hub_outbox outbox = {.n = 0};
    played_door_join(&door, rig, "front", &zone, 1);
    ask(&door, rig);
    for (char name[3] = "a0"; name[1] <= '9'; name[1]++) {
        (void)store_rig_put(rig, name, &zone, 1);
    }
    assert_true(publish_some(rig, &doors, 4));
    assert_int_equal(door.applied, 4);
    assert_int_equal(store_rig_zone_now(rig, &zone).published, 4);
    /* Nobody confirms it, so it is emitted again. */
    store_rig_fine(hub_outbox_emit(&rig->store, 4, &emit, &outbox, &fault), &fault);
    hub_outbox_free(&outbox);
    assert_int_equal(door.applied, 8);
    assert_int_equal(store_rig_zone_now(rig, &zone).published, 4);
    publish(rig, &doors);
    assert_int_equal(door.applied, 10);
    assert_int_equal(door.known, 4);
    /* A leader that ended before it had stored the cursor. */
    store_rig_fine(hub_db_script(rig->store.db, "UPDATE zone SET published = 3", &fault), &fault);
    publish(rig, &doors);
    assert_int_equal(door.applied, 10);
    assert_int_equal(door.known, 4 + 7);
    assert_int_equal(played_door_count(&door, &zone), 10);
}

static void an_expelled_door_gets_no_key(void **state)
{
    struct store_rig *rig = *state;
    const struct iso_fleet_id zone = store_rig_zone(rig, "office");
    struct played_door stays, leaves;
    struct doors doors = {.emit = {played_door_emit(&stays), played_door_emit(&leaves)}, .n = 2};
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    enum hub_fetch_answer what;
    (void)store_rig_put(rig, "anna", &zone, 1);
    played_door_join(&stays, rig, "front", &zone, 1);
    played_door_join(&leaves, rig, "back", &zone, 1);
    ask(&stays, rig);
    ask(&leaves, rig);
    played_door_fetch(&stays, &rig->store);
    played_door_fetch(&leaves, &rig->store);
    ask(&stays, rig);
    ask(&leaves, rig);
    publish(rig, &doors);

    store_rig_fine(hub_door_expel(&rig->store, &leaves.id, &fault), &fault);
    assert_int_equal(hub_door_expel(&rig->store, &leaves.id, &fault), -EALREADY);
    const struct iso_fleet_id ben = store_rig_put(rig, "ben", &zone, 1);
    publish(rig, &doors);
    assert_int_equal(store_rig_zone_now(rig, &zone).place.epoch, 2);
    assert_int_equal(stays.keys, 2);
    assert_int_equal(leaves.keys, 1);
    assert_non_null(played_door_person(&stays, &zone, &ben));
    assert_null(played_door_person(&leaves, &zone, &ben));
    assert_int_equal(leaves.refused, 1);
    assert_int_equal(stays.zones[0].place.epoch, 2);

    /* It may not ask for anything any more. */
    assert_int_equal(played_door_ask(&leaves, &rig->store, &fault), -EACCES);
    assert_int_equal(played_door_send_events(&leaves, &rig->store, 1, 2, &fault), -EACCES);
    assert_int_equal(played_door_fetch_raw(&leaves, &rig->store, &zone, 0, ISO_FLEET_WANT_SNAPSHOT,
                                           &bytes, &what, &fault),
                     -EACCES);
    assert_int_equal(bytes.size, 0);
    /* A door that was away goes through the old epoch into the new one. */
    ask(&stays, rig);
    assert_int_equal(stays.keys, 2);
}

static void a_door_that_moves_leaves_the_old_zone(void **state)
{
    struct store_rig *rig = *state;
    const struct iso_fleet_id zones[2] = {store_rig_zone(rig, "office"),
                                          store_rig_zone(rig, "lab")};
    struct played_door door;
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    enum hub_fetch_answer what;
    played_door_join(&door, rig, "front", &zones[0], 1);
    ask(&door, rig);
    store_rig_fine(hub_door_move(&rig->store, &door.id, &zones[1], 1, &fault), &fault);
    ask(&door, rig);
    assert_int_equal(door.lease.n, 1);
    assert_true(iso_fleet_id_is_same(&door.lease.places[0].zone, &zones[1]));
    assert_int_equal(door.keys, 2); /* that of the new zone came along */
    assert_int_equal(store_rig_zone_now(rig, &zones[0]).place.epoch, 2);
    assert_int_equal(store_rig_zone_now(rig, &zones[1]).place.epoch, 1);
    assert_int_equal(played_door_fetch_raw(&door, &rig->store, &zones[0], 0, ISO_FLEET_WANT_DELTAS,
                                           &bytes, &what, &fault),
                     -EACCES);
}

/* 60 people, of whom 20 are revoked and 20 are changed, and a lockdown: 101 deltas. */
static struct iso_fleet_id busy_zone(struct store_rig *rig)
{
    const struct iso_fleet_id zone = store_rig_zone(rig, "office");
    char name[16];
    struct iso_fleet_id ids[60];
    for (int i = 0; i < 60; i++) {
        (void)snprintf(name, sizeof name, "person %d", i);
        ids[i] = store_rig_put(rig, name, &zone, 1);
    }
    for (int i = 0; i < 60; i += 3) {
        store_rig_fine(hub_person_revoke(&rig->store, &ids[i], &fault), &fault);
    }
    for (int i = 1; i < 60; i += 3) {
        store_rig_fine(hub_person_set_offline(&rig->store, &ids[i], true, &fault), &fault);
    }
    store_rig_fine(hub_zone_lockdown(&rig->store, &zone, true, &fault), &fault);
    return zone;
}

static void a_snapshot_is_the_sum_of_the_deltas(void **state)
{
    struct store_rig *rig = *state;
    const struct iso_fleet_id zone = busy_zone(rig);
    struct played_door one, two;
    played_door_join(&one, rig, "front", &zone, 1);
    played_door_join(&two, rig, "back", &zone, 1);
    ask(&one, rig);
    ask(&two, rig);
    played_door_fetch(&one, &rig->store);
    two.zones[0].wants_snapshot = true;
    played_door_fetch(&two, &rig->store);
    assert_int_equal(played_door_count(&one, &zone), 40);
    assert_int_equal(one.applied, 101);
    assert_int_equal(two.applied, 0);
    assert_true(played_door_is_same(&one, &two, &zone));
    assert_true(two.zones[0].lockdown);
    assert_memory_equal(&one.zones[0].place, &two.zones[0].place, sizeof one.zones[0].place);

    /* The stored snapshot is used again, and the deltas after it follow. */
    (void)store_rig_put(rig, "late", &zone, 1);
    struct played_door three;
    played_door_join(&three, rig, "side", &zone, 1);
    ask(&three, rig);
    three.zones[0].wants_snapshot = true;
    played_door_fetch(&three, &rig->store);
    played_door_fetch(&one, &rig->store);
    assert_int_equal(three.applied, 1);
    assert_true(played_door_is_same(&one, &three, &zone));
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM snapshot"), 1);

    /* A delta that is gone: the answer to "deltas" is a snapshot. */
    store_rig_fine(hub_db_script(rig->store.db, "DELETE FROM delta WHERE sequence < 50", &fault),
                   &fault);
    struct played_door four;
    played_door_join(&four, rig, "roof", &zone, 1);
    ask(&four, rig);
    played_door_fetch(&four, &rig->store);
    assert_true(played_door_is_same(&one, &four, &zone));
}

static void one_of_two_is_the_leader(void **state)
{
    struct store_rig *rig = *state;
    struct hub_store other;
    const struct iso_fleet_id zone = store_rig_zone(rig, "office");
    bool is_leader = false, changed = true;
    int fd = -1;
    store_rig_open(rig, &other);
    store_rig_fine(hub_leader_try(&rig->store, &is_leader, &fault), &fault);
    assert_true(is_leader);
    store_rig_fine(hub_leader_try(&other, &is_leader, &fault), &fault);
    assert_false(is_leader);
    store_rig_fine(hub_leader_try(&rig->store, &is_leader, &fault), &fault);
    assert_true(is_leader);
    store_rig_fine(hub_leader_leave(&rig->store, &fault), &fault);
    store_rig_fine(hub_leader_try(&other, &is_leader, &fault), &fault);
    assert_true(is_leader);
    store_rig_fine(hub_leader_try(&rig->store, &is_leader, &fault), &fault);
    assert_false(is_leader);

    store_rig_fine(hub_listen(&other, &fd, &fault), &fault);
    store_rig_fine(hub_listen_take(&other, &changed, &fault), &fault);
    assert_false(changed);
    (void)store_rig_put(rig, "anna", &zone, 1);
    struct pollfd wait = {.fd = fd, .events = POLLIN};
    assert_int_equal(poll(&wait, 1, 10000), 1);
    store_rig_fine(hub_listen_take(&other, &changed, &fault), &fault);
    assert_true(changed);
    hub_store_close(&other);
}

#define TEST(NAME) cmocka_unit_test_setup_teardown(NAME, store_rig_setup, store_rig_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(a_door_gets_keys_lease_and_people),
        TEST(a_door_applies_each_change),
        TEST(doors_confirm_a_change),
        TEST(what_is_published_twice_is_known),
        TEST(an_expelled_door_gets_no_key),
        TEST(a_door_that_moves_leaves_the_old_zone),
        TEST(a_snapshot_is_the_sum_of_the_deltas),
        TEST(one_of_two_is_the_leader),
    };
    return cmocka_run_group_tests(tests, store_rig_start, store_rig_stop);
}

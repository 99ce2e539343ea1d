/* Several hubs at once on one database, a database that goes away, and one that is restored from an
 * old copy. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <pthread.h>
#include <semaphore.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "enroll/hub/answer/hub_outbox.h"
#include "tests/enroll/hub/rigs/played_door.h"

enum { THREADS = 4, CHANGES = 40, WAIT_S = 30 };

static struct iso_fault fault;

/* ---- two at once ---- */

struct worker {
    struct hub_store store;
    struct iso_fleet_id zones[2];
    int number, failed;
    struct iso_fault fault;
};

/* Puts people into one or both zones, in either order, renames some and revokes some. */
static void *work(void *context)
{
    struct worker *w = context;
    for (int i = 0; i < CHANGES && !w->failed; i++) {
        char name[32], other[48];
        (void)snprintf(name, sizeof name, "w%d p%d", w->number, i);
        (void)snprintf(other, sizeof other, "%s again", name);
        const struct iso_fleet_person person = store_rig_person(name, 3, 1, (uint8_t)i);
        const struct iso_fleet_id zones[2] = {w->zones[w->number % 2], w->zones[1 - w->number % 2]};
        w->failed = hub_person_put(&w->store, &person, zones, i % 3 ? 2 : 1, &w->fault);
        if (!w->failed && i % 4 == 1) {
            w->failed = hub_person_rename(&w->store, &person.id, other, &w->fault);
        }
        if (!w->failed && i % 4 == 2) {
            w->failed = hub_person_revoke(&w->store, &person.id, &w->fault);
        }
        /* All change the same person, too. */
        const struct iso_fleet_id shared = iso_fleet_id_of("shared", 6);
        w->failed = w->failed ? w->failed
                              : hub_person_set_offline(&w->store, &shared, i % 2, &w->fault);
    }
    return NULL;
}

static void changes_at_once_are_one_chain(void **state)
{
    struct store_rig *rig = *state;
    static struct worker workers[THREADS];
    pthread_t threads[THREADS];
    const struct iso_fleet_id zones[2] = {store_rig_zone(rig, "office"),
                                          store_rig_zone(rig, "lab")};
    static struct played_door door, late;
    (void)store_rig_put(rig, "shared", zones, 2);
    for (int i = 0; i < THREADS; i++) {
        workers[i] = (struct worker){.zones = {zones[0], zones[1]}, .number = i};
        store_rig_open(rig, &workers[i].store);
    }
    for (int i = 0; i < THREADS; i++) {
        assert_int_equal(pthread_create(&threads[i], NULL, work, &workers[i]), 0);
    }
    for (int i = 0; i < THREADS; i++) {
        assert_int_equal(pthread_join(threads[i], NULL), 0);
        store_rig_fine(workers[i].failed, &workers[i].fault);
        hub_store_close(&workers[i].store);
    }
    /* None lost or doubled: each change of a person is one delta in each zone of the person. Of 40
     * puts 14 are in one zone and 26 in both; of the renames (i % 4 == 1) 3 are in one and 7 in
     * both; of the revocations (i % 4 == 2) 3 are in one and 7 in both. */
    const int64_t each = (14 + 2 * 26) + (3 + 2 * 7) + (3 + 2 * 7) + 2 * 40;
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM delta"), 2 + THREADS * each);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM person"), 1 + THREADS * 30);
    assert_int_equal(store_rig_number(rig, "SELECT sum(sequence)::bigint FROM zone"),
                     2 + THREADS * each);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM act"),
                     2 + 1 + THREADS * (40 + 10 + 10 + 40));

    /* A door that follows the deltas checks that each adjoins the one before, and has in the end
     * the same people as one with a snapshot. */
    played_door_join(&door, rig, "front", zones, 2);
    played_door_join(&late, rig, "back", zones, 2);
    store_rig_fine(played_door_ask(&door, &rig->store, &fault), &fault);
    store_rig_fine(played_door_ask(&late, &rig->store, &fault), &fault);
    door.zones[0].wants_snapshot = door.zones[1].wants_snapshot = false;
    late.zones[0].wants_snapshot = late.zones[1].wants_snapshot = true;
    played_door_fetch(&door, &rig->store);
    played_door_fetch(&late, &rig->store);
    assert_int_equal(door.refused, 0);
    assert_int_equal(door.applied, 2 + THREADS * each);
    assert_true(played_door_is_same(&door, &late, &zones[0]));
    assert_true(played_door_is_same(&door, &late, &zones[1]));
}

/* Two transactions that lock two zones in opposite order by hand: one is a deadlock's victim, and
 * runs again. It waits until the other one has ended: otherwise it can lock its first zone again
 * before the other one wakes, and there is one more deadlock. */
struct locker {
    struct hub_store store;
    const char *first, *second;
    pthread_barrier_t *barrier;
    sem_t *ended, *other_ended; /* posted when the own transaction, or the other one, has ended */
    int runs, error;
    struct iso_fault fault;
};

static int lock_both(void *context, struct iso_fault *why)
{
    struct locker *l = context;
    if (l->runs > 0) {
        struct timespec until;
        (void)clock_gettime(CLOCK_REALTIME, &until);
        until.tv_sec += WAIT_S;
        (void)sem_timedwait(l->other_ended, &until);
    }
    int error = hub_db_script(l->store.db, l->first, why);
    if (l->runs++ == 0) {
        (void)pthread_barrier_wait(l->barrier);
    }
    error = error ? error : hub_db_script(l->store.db, l->second, why);
    return error;
}

static void *run_locker(void *context)
{
    struct locker *l = context;
    l->error = hub_db_transaction(l->store.db, HUB_READ_COMMITTED, lock_both, l, &l->fault);
    (void)sem_post(l->ended);
    return NULL;
}

static void a_deadlock_is_tried_again(void **state)
{
    struct store_rig *rig = *state;
    static const char office[] = "UPDATE zone SET lease_s = lease_s + 1 WHERE name = 'office'";
    static const char lab[] = "UPDATE zone SET lease_s = lease_s + 1 WHERE name = 'lab'";
    pthread_barrier_t barrier;
    sem_t ended[2];
    pthread_t thread;
    const struct iso_fleet_id zone = store_rig_zone(rig, "office");
    (void)store_rig_zone(rig, "lab");
    assert_int_equal(pthread_barrier_init(&barrier, NULL, 2), 0);
    assert_int_equal(sem_init(&ended[0], 0, 0), 0);
    assert_int_equal(sem_init(&ended[1], 0, 0), 0);
    struct locker a = {.first = office,
                       .second = lab,
                       .barrier = &barrier,
                       .ended = &ended[0],
                       .other_ended = &ended[1]};
    struct locker b = {.first = lab,
                       .second = office,
                       .barrier = &barrier,
                       .ended = &ended[1],
                       .other_ended = &ended[0]};
    store_rig_open(rig, &a.store);
    store_rig_open(rig, &b.store);
    assert_int_equal(pthread_create(&thread, NULL, run_locker, &a), 0);
    (void)run_locker(&b);
    assert_int_equal(pthread_join(thread, NULL), 0);
    store_rig_fine(a.error, &a.fault);
    store_rig_fine(b.error, &b.fault);
    assert_int_equal(a.runs + b.runs, 3);
    assert_int_equal(store_rig_zone_now(rig, &zone).settings.lease_s,
                     ISO_FLEET_LEASE_DEFAULT_S + 2);
    hub_store_close(&a.store);
    hub_store_close(&b.store);
    (void)pthread_barrier_destroy(&barrier);
    (void)sem_destroy(&ended[0]);
    (void)sem_destroy(&ended[1]);
}

/* ---- a database that goes away ---- */

static void the_connection_comes_back(void **state)
{
    struct store_rig *rig = *state;
    const struct iso_fleet_id zone = store_rig_zone(rig, "office");
    const struct iso_fleet_person person = store_rig_person("anna", 3, 1, 1);
    bool is_leader = false;
    store_rig_fine(hub_leader_try(&rig->store, &is_leader, &fault), &fault);
    assert_true(is_leader);
    rig_postgres_down(&rig->postgres);
    assert_int_equal(hub_person_put(&rig->store, &person, &zone, 1, &fault), -ENOTCONN);
    assert_null(strchr(fault.text, '\n'));
    rig_postgres_up(&rig->postgres);
    store_rig_fine(hub_person_put(&rig->store, &person, &zone, 1, &fault), &fault);
    assert_int_equal(store_rig_zone_now(rig, &zone).place.sequence, 1);
    /* The lock is lost with the session, so another may be the leader now. */
    struct hub_store other;
    store_rig_open(rig, &other);
    store_rig_fine(hub_leader_try(&other, &is_leader, &fault), &fault);
    assert_true(is_leader);
    store_rig_fine(hub_leader_try(&rig->store, &is_leader, &fault), &fault);
    assert_false(is_leader);
    hub_store_close(&other);
}

/* ---- yesterday's database ---- */

/* After the recovery the door has what this database knows, and the stream goes on. */
static void recover_and_go_on(struct store_rig *rig, struct played_door *door,
                              const struct iso_fleet_id *zone, const struct iso_fleet_id *anna)
{
    struct hub_store *store = &rig->store;
    const unsigned keys = door->keys;
    store_rig_fine(hub_zone_recover(store, zone, &fault), &fault);
    struct hub_zone now = store_rig_zone_now(rig, zone);
    assert_int_equal(now.place.epoch, 2);
    assert_int_equal(now.place.sequence, 9);
    store_rig_fine(played_door_ask(door, store, &fault), &fault);
    assert_int_equal(door->keys, keys + 1);
    assert_true(door->zones[0].wants_snapshot);
    assert_false(store_rig_zone_now(rig, zone).behind); /* an old place of before the reset */
    const uint64_t revision = played_door_person(door, zone, anna)->revision;
    played_door_fetch(door, store);
    assert_int_equal(played_door_count(door, zone), 1);
    assert_true(played_door_person(door, zone, anna)->revision > revision);
    /* The stream goes on. */
    store_rig_fine(hub_zone_lockdown(store, zone, true, &fault), &fault);
    played_door_fetch(door, store);
    assert_true(door->zones[0].lockdown);
    store_rig_fine(played_door_ask(door, store, &fault), &fault);
    assert_false(store_rig_zone_now(rig, zone).behind);
}

static void a_restored_database_is_noticed(void **state)
{
    struct store_rig *rig = *state;
    struct hub_store *store = &rig->store;
    const struct iso_fleet_id zone = store_rig_zone(rig, "office");
    static struct played_door door;
    char name[16];
    played_door_join(&door, rig, "front", &zone, 1);
    store_rig_fine(played_door_ask(&door, store, &fault), &fault);
    const struct iso_fleet_id anna = store_rig_put(rig, "anna", &zone, 1);
    const struct iso_fleet_id ben = store_rig_put(rig, "ben", &zone, 1);
    rig_postgres_backup(&rig->postgres);
    for (int i = 0; i < 5; i++) {
        (void)snprintf(name, sizeof name, "lost %d", i);
        (void)store_rig_put(rig, name, &zone, 1);
    }
    store_rig_fine(hub_person_set_offline(store, &anna, true, &fault), &fault);
    played_door_fetch(&door, store);
    store_rig_fine(played_door_ask(&door, store, &fault), &fault);
    assert_int_equal(door.zones[0].place.sequence, 8);
    rig_postgres_restore(&rig->postgres);

    /* Even if the hub has changed something before it hears of the door. */
    store_rig_fine(hub_person_revoke(store, &ben, &fault), &fault);
    assert_false(store_rig_zone_now(rig, &zone).behind);
    assert_int_equal(hub_zone_recover(store, &zone, &fault), -EALREADY);
    store_rig_fine(played_door_ask(&door, store, &fault), &fault);
    assert_true(store_rig_zone_now(rig, &zone).behind);
    assert_int_equal(door.lease.places[0].sequence, 3); /* the door sees it, too */
    assert_int_equal(hub_person_set_offline(store, &anna, false, &fault), -ESTALE);
    assert_non_null(strstr(fault.text, "isotherm-hub recover"));
    assert_int_equal(hub_zone_lockdown(store, &zone, true, &fault), -ESTALE);

    recover_and_go_on(rig, &door, &zone, &anna);
}

static void another_history_is_noticed(void **state)
{
    struct store_rig *rig = *state;
    struct hub_store *store = &rig->store;
    const struct iso_fleet_id zone = store_rig_zone(rig, "office");
    static struct played_door door, late;
    played_door_join(&door, rig, "front", &zone, 1);
    played_door_join(&late, rig, "back", &zone, 1);
    store_rig_fine(played_door_ask(&door, store, &fault), &fault);
    rig_postgres_backup(&rig->postgres);
    (void)store_rig_put(rig, "anna", &zone, 1);
    played_door_fetch(&door, store);
    rig_postgres_restore(&rig->postgres);
    /* The hub overtakes the door with other changes. */
    (void)store_rig_put(rig, "ben", &zone, 1);
    (void)store_rig_put(rig, "carla", &zone, 1);
    store_rig_fine(played_door_ask(&late, store, &fault), &fault);
    assert_false(store_rig_zone_now(rig, &zone).behind);
    store_rig_fine(played_door_ask(&door, store, &fault), &fault);
    assert_true(store_rig_zone_now(rig, &zone).behind);
    store_rig_fine(hub_zone_recover(store, &zone, &fault), &fault);
    /* A later epoch, too, resets a door that has missed the reset. */
    store_rig_fine(hub_zone_new_epoch(store, &zone, &fault), &fault);
    store_rig_fine(played_door_ask(&door, store, &fault), &fault);
    assert_true(door.zones[0].wants_snapshot);
    played_door_fetch(&door, store);
    assert_int_equal(played_door_count(&door, &zone), 2);
    store_rig_fine(played_door_ask(&door, store, &fault), &fault);
    assert_false(store_rig_zone_now(rig, &zone).behind);
    assert_int_equal(door.zones[0].place.epoch, 3);
}

/* A door that says it is far ahead stops the changes of its zone, is named, and can be expelled. */
static void a_door_that_lies_can_be_expelled(void **state)
{
    struct store_rig *rig = *state;
    struct hub_store *store = &rig->store;
    const struct iso_fleet_id zone = store_rig_zone(rig, "office");
    static struct played_door liar, honest;
    played_door_join(&liar, rig, "liar", &zone, 1);
    played_door_join(&honest, rig, "honest", &zone, 1);
    store_rig_fine(played_door_ask(&liar, store, &fault), &fault);
    store_rig_fine(played_door_ask(&honest, store, &fault), &fault);
    liar.zones[0].place.sequence = UINT64_C(1) << 60;
    assert_int_equal(played_door_ask(&liar, store, &fault), -EBADMSG);
    assert_false(store_rig_zone_now(rig, &zone).behind);
    liar.zones[0].place.sequence = 1000;
    store_rig_fine(played_door_ask(&liar, store, &fault), &fault);
    assert_true(store_rig_zone_now(rig, &zone).behind);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM act WHERE what = 'zone-behind' "
                                           "AND after ->> 'door' = 'liar'"),
                     1);
    store_rig_fine(hub_door_expel(store, &liar.id, &fault), &fault);
    assert_int_equal(played_door_ask(&liar, store, &fault), -EACCES);
    store_rig_fine(hub_zone_recover(store, &zone, &fault), &fault);
    assert_int_equal(store_rig_zone_now(rig, &zone).place.sequence, 1);
    (void)store_rig_put(rig, "anna", &zone, 1);
    store_rig_fine(played_door_ask(&honest, store, &fault), &fault);
    played_door_fetch(&honest, store);
    assert_int_equal(played_door_count(&honest, &zone), 1);
}

#define TEST(NAME) cmocka_unit_test_setup_teardown(NAME, store_rig_setup, store_rig_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(changes_at_once_are_one_chain), TEST(a_deadlock_is_tried_again),
        TEST(the_connection_comes_back),     TEST(a_restored_database_is_noticed),
        TEST(another_history_is_noticed),    TEST(a_door_that_lies_can_be_expelled),
    };
    return cmocka_run_group_tests(tests, store_rig_start, store_rig_stop);
}

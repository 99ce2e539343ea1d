/* The keys of a new epoch for many doors, which are emitted some at a time. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/hub/answer/hub_outbox.h"
#include "tests/enroll/hub/rigs/store_rig.h"

static struct iso_fault fault;

enum { DOORS = 2 * HUB_OUTBOX_KEYS + 50 };

/* What was emitted, in its order. */
struct emitted {
    struct iso_fleet_id keyed[2 * DOORS]; /* the doors that were sent a key */
    size_t n, deltas, heads;
    size_t keys_before_delta; /* keys before the first delta */
};

/* Reads the door of a topic isotherm/door/ID/in. */
static bool is_for_door(const char *topic, struct iso_fleet_id *door)
{
    char id[ISO_FLEET_ID_TEXT_SIZE] = "";
    return sscanf(topic, "isotherm/door/%36[^/]/in", id) == 1 && iso_fleet_id_read(id, door) == 0;
}

static int take(void *context, const char *topic, const void *bytes, size_t size, bool retain)
{
    struct emitted *emitted = context;
    enum iso_fleet_kind kind;
    struct iso_fleet_id door;
    assert_int_equal(iso_fleet_kind_of(bytes, size, &kind), 0);
    switch (kind) {
    case ISO_FLEET_KEY:
        assert_true(is_for_door(topic, &door));
        assert_true(emitted->n < 2 * DOORS);
        emitted->keyed[emitted->n++] = door;
        break;
    case ISO_FLEET_DELTA:
        emitted->keys_before_delta = emitted->deltas++ ? emitted->keys_before_delta : emitted->n;
        break;
    default:
        assert_int_equal(kind, ISO_FLEET_HEAD);
        assert_true(retain);
        emitted->heads++;
    }
    return 0;
}

static bool emit(struct store_rig *rig, struct hub_outbox *outbox, struct emitted *emitted)
{
    const struct hub_emit with = {.emit = take, .context = emitted};
    store_rig_fine(hub_outbox_emit(&rig->store, 50, &with, outbox, &fault), &fault);
    return outbox->n > 0;
}

static void confirm(struct store_rig *rig, struct hub_outbox *outbox)
{
    store_rig_fine(hub_outbox_confirm(&rig->store, outbox, &fault), &fault);
}

/* A zone of DOORS doors that have joined and report its first epoch, one that is expelled and one
 * that has not joined. */
static struct iso_fleet_id full_zone(struct store_rig *rig)
{
    const struct iso_fleet_id zone = store_rig_zone(rig, "office");
    char sql[900];
    const int n = snprintf(
        sql, sizeof sql,
        "INSERT INTO door (id, name, signs, receives, added_s, joined_s, expelled_s) "
        "SELECT gen_random_uuid(), 'door ' || n, sha256(('s' || n)::bytea), "
        "sha256(('r' || n)::bytea), 1, CASE n WHEN 1 THEN 0 ELSE 1 END, "
        "CASE n WHEN 2 THEN 5 ELSE 0 END FROM generate_series(1, %d) n;"
        "INSERT INTO door_zone (door, zone, position) SELECT d.id, z.id, 0 FROM door d, zone z;"
        "INSERT INTO door_place (door, zone, epoch, sequence, digest) "
        "SELECT d.id, z.id, 1, 0, z.digest FROM door d, zone z;",
        DOORS + 2);
    assert_true(n > 0 && (size_t)n < sizeof sql);
    store_rig_fine(hub_db_script(rig->store.db, sql, &fault), &fault);
    return zone;
}

static int compare(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(struct iso_fleet_id));
}

/* That the keys from `first` on are for n doors, each once. */
static void expect_each_once(struct emitted *emitted, size_t first, size_t n)
{
    assert_int_equal(emitted->n, first + n);
    qsort(emitted->keyed + first, n, sizeof *emitted->keyed, compare);
    for (size_t i = 1; i < n; i++) {
        assert_true(compare(&emitted->keyed[first + i - 1], &emitted->keyed[first + i]) < 0);
    }
}

static void the_keys_of_an_epoch_come_some_at_a_time(void **state)
{
    struct store_rig *rig = *state;
    struct hub_outbox outbox = {.n = 0};
    struct emitted *emitted = calloc(1, sizeof *emitted);
    const struct iso_fleet_id zone = full_zone(rig);
    assert_non_null(emitted);
    (void)emit(rig, &outbox, emitted); /* what the making of the zone has left */
    confirm(rig, &outbox);
    *emitted = (struct emitted){.n = 0};

    store_rig_fine(hub_zone_new_epoch(&rig->store, &zone, &fault), &fault);
    (void)store_rig_put(rig, "anna", &zone, 1);
    assert_true(emit(rig, &outbox, emitted));
    assert_int_equal(emitted->n, HUB_OUTBOX_KEYS);
    assert_int_equal(emitted->deltas, 0);
    assert_int_equal(emitted->heads, 0);
    confirm(rig, &outbox);
    assert_int_equal(store_rig_number(rig, "SELECT published_epoch FROM zone"), 1);
    while (emit(rig, &outbox, emitted)) {
        confirm(rig, &outbox);
    }
    expect_each_once(emitted, 0, DOORS);
    assert_int_equal(emitted->deltas, 1);
    assert_int_equal(emitted->keys_before_delta, DOORS);
    assert_int_equal(emitted->heads, 1);
    assert_int_equal(outbox.n_keys, 0);
    assert_int_equal(store_rig_number(rig, "SELECT published_epoch FROM zone"), 2);
    hub_outbox_free(&outbox);
    free(emitted);
}

static void another_epoch_begins_with_the_first_door(void **state)
{
    struct store_rig *rig = *state;
    struct hub_outbox outbox = {.n = 0};
    struct emitted *emitted = calloc(1, sizeof *emitted);
    const struct iso_fleet_id zone = full_zone(rig);
    assert_non_null(emitted);
    store_rig_fine(hub_zone_new_epoch(&rig->store, &zone, &fault), &fault);
    assert_true(emit(rig, &outbox, emitted));
    confirm(rig, &outbox);
    store_rig_fine(hub_zone_new_epoch(&rig->store, &zone, &fault), &fault);
    while (emit(rig, &outbox, emitted)) {
        confirm(rig, &outbox);
    }
    expect_each_once(emitted, HUB_OUTBOX_KEYS, DOORS);
    assert_int_equal(store_rig_number(rig, "SELECT published_epoch FROM zone"), 3);

    /* A door that has reported the epoch needs no key, also after the loss of the broker. */
    hub_outbox_free(&outbox);
    *emitted = (struct emitted){.n = 0};
    store_rig_fine(hub_db_script(rig->store.db,
                                 "UPDATE zone SET published_epoch = 2; "
                                 "UPDATE door_place SET epoch = 3 WHERE door IN "
                                 "(SELECT id FROM door WHERE name LIKE '%7')",
                                 &fault),
                   &fault);
    while (emit(rig, &outbox, emitted)) {
        confirm(rig, &outbox);
    }
    expect_each_once(emitted, 0,
                     (size_t)store_rig_number(rig, "SELECT count(*) FROM door WHERE joined_s > 0 "
                                                   "AND expelled_s = 0 AND name NOT LIKE '%7'"));
    hub_outbox_free(&outbox);
    free(emitted);
}

#define TEST(NAME) cmocka_unit_test_setup_teardown(NAME, store_rig_setup, store_rig_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(the_keys_of_an_epoch_come_some_at_a_time),
        TEST(another_epoch_begins_with_the_first_door),
    };
    return cmocka_run_group_tests(tests, store_rig_start, store_rig_stop);
}

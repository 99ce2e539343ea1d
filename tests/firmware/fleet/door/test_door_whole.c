/* A zone that comes whole, as a snapshot; the policy and the lockdown; events and acknowledgements;
 * what waits for the link; and the same by the table of the link. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "drivers/base/times.h"
#include "firmware/fleet/door/fleet_direct.h"
#include "tests/firmware/fleet/door/door_rig.h"
#include "tests/firmware/rigs/gallery_rig.h"

/* A zone with a history of 40 changes that the door does not have. */
static void begin_late(struct door_rig *rig)
{
    for (int i = 0; i < 40; i++) {
        struct iso_fleet_bytes delta = door_rig_put(rig, 0, i, 1, "x", 1, false);
        iso_fleet_bytes_free(&delta);
    }
    assert_int_equal(door_rig_answer(rig, 1), ISO_FLEET_APPLIED);
    assert_true(door_rig_status(rig).wants_snapshot[0]);
    assert_int_equal(door_rig_give(rig, door_rig_key(rig, 0)), ISO_FLEET_WHOLE);
}

enum { MANY = 70 };

/* A snapshot with people `first` to MANY - 1, whose names end with the revision. */
static struct iso_fleet_bytes snapshot_of(struct door_rig *rig, int first, uint64_t revision)
{
    struct iso_fleet_bytes changes[MANY];
    int n = 0;
    for (int i = first; i < MANY; i++) {
        char name[32];
        (void)snprintf(name, sizeof name, "person %d of %d", i, (int)revision);
        changes[n++] = door_rig_change(i, revision, name, i + 1);
    }
    return door_rig_snapshot(rig, 0, changes, (size_t)n);
}

static void a_snapshot_brings_and_removes(void **state)
{
    struct door_rig *rig = *state;
    begin_late(rig);
    assert_int_equal(gallery_rig_add(rig->gallery, "visitor", 90, NULL), 0);
    assert_int_equal(door_rig_give_snapshot(rig, snapshot_of(rig, 0, 1)), ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_status(rig).people, MANY);
    assert_memory_equal(&door_rig_status(rig).places[0], &rig->zone[0].place,
                        sizeof rig->zone[0].place);
    const int64_t number = door_rig_person(rig, "person 5 of 1");
    assert_int_equal(door_rig_give_snapshot(rig, snapshot_of(rig, 0, 1)), ISO_FLEET_KNOWN);
    struct iso_fleet_bytes later = door_rig_remove(rig, 0, 0, 1); /* the door misses it */
    iso_fleet_bytes_free(&later);
    assert_int_equal(door_rig_give_snapshot(rig, snapshot_of(rig, 3, 2)), ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_status(rig).people, MANY - 3);
    assert_int_equal(door_rig_status(rig).pending, 1);
    assert_int_equal(door_rig_person(rig, "person 5 of 2"), number);
    assert_int_equal(door_rig_person(rig, "person 2 of 1"), 0);
    door_rig_restart(rig);
    assert_int_equal(door_rig_status(rig).people, MANY - 3);
    assert_int_equal(door_rig_give(rig, door_rig_remove(rig, 0, 5, 3)), ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_person(rig, "person 5 of 2"), 0);
}

/* Grants of another zone stay. */
static void a_snapshot_speaks_for_its_zone_alone(void **state)
{
    struct door_rig *rig = *state;
    door_rig_begin(rig, 2);
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 0, 1, 1, "ada", 20, false)),
                     ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 1, 1, 1, "ada", 20, false)),
                     ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 0, 2, 1, "ben", 40, false)),
                     ISO_FLEET_APPLIED);
    struct iso_fleet_bytes missed = door_rig_remove(rig, 0, 2, 2);
    iso_fleet_bytes_free(&missed);
    assert_int_equal(door_rig_give_snapshot(rig, door_rig_snapshot(rig, 0, NULL, 0)),
                     ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_person(rig, "ben"), 0);
    assert_int_equal(door_rig_credential(rig, "ada").fleet.zones, 2);
}

/* The store fails after each transaction in turn, as a kill does: the same file makes it whole. */
static void a_snapshot_that_was_cut_off_is_repeated(void **state)
{
    struct door_rig *rig = *state;
    int cut = 0;
    begin_late(rig);
    for (bool done = false; !done;) {
        rig->fail_applies = rig->applies + ++cut;
        struct iso_fleet_bytes file = snapshot_of(rig, 0, 1);
        const enum iso_fleet_outcome outcome = door_rig_give_snapshot(rig, file);
        done = outcome == ISO_FLEET_APPLIED;
        if (!done) {
            assert_int_equal(outcome, ISO_FLEET_OUTCOMES);
            door_rig_restart(rig);
            assert_true(door_rig_status(rig).wants_snapshot[0]);
            assert_int_equal(door_rig_status(rig).places[0].sequence, 0);
        }
        rig->n_notes = 0;
    }
    assert_true(cut > 2);
    assert_int_equal(door_rig_status(rig).people, MANY);
    door_rig_restart(rig);
    assert_int_equal(door_rig_status(rig).people, MANY);
    assert_false(door_rig_status(rig).wants_snapshot[0]);
}

static void a_changed_snapshot_is_refused(void **state)
{
    struct door_rig *rig = *state;
    begin_late(rig);
    struct iso_fleet_bytes file = snapshot_of(rig, MANY - 1, 1);
    const uint64_t changes = iso_gallery_version(rig->gallery).changes;
    for (size_t at = 0; at < file.size; at += 53) {
        struct iso_fleet_bytes copy = {.bytes = NULL};
        iso_fleet_put(&copy, file.bytes, file.size);
        copy.bytes[at] ^= 1;
        assert_int_equal(door_rig_give_snapshot(rig, copy), ISO_FLEET_REFUSED);
    }
    assert_int_equal(iso_gallery_version(rig->gallery).changes, changes);
    assert_int_equal(door_rig_give_snapshot(rig, (struct iso_fleet_bytes){.bytes = NULL}),
                     ISO_FLEET_REFUSED);
    assert_int_equal(door_rig_give_snapshot(rig, file), ISO_FLEET_APPLIED);
}

/* ---- policy and lockdown ---- */

static void the_home_zone_has_the_policy(void **state)
{
    struct door_rig *rig = *state;
    size_t size = 0;
    door_rig_begin(rig, 2);
    assert_int_equal(door_rig_give(rig, door_rig_policy(rig, 1, "{\"other\":1}")),
                     ISO_FLEET_APPLIED);
    assert_string_equal(rig->policy, "");
    assert_int_equal(door_rig_give(rig, door_rig_policy(rig, 0, "{\"home\":1}")),
                     ISO_FLEET_APPLIED);
    assert_string_equal(rig->policy, "{\"home\":1}");
    door_rig_restart(rig); /* policy and place came together */
    assert_non_null(iso_gallery_access(rig->gallery, ISO_GALLERY_SITE, &size));
    assert_int_equal(door_rig_status(rig).places[0].sequence, 1);
    /* One that does not fit: the earlier one stays, the place goes on, and it is known. */
    rig->policy_error = -EINVAL;
    assert_int_equal(door_rig_give(rig, door_rig_policy(rig, 0, "{\"bad\":1}")), ISO_FLEET_APPLIED);
    assert_string_equal(rig->policy, "{\"home\":1}");
    assert_int_equal(door_rig_status(rig).places[0].sequence, 2);
    assert_non_null(strstr(door_rig_status(rig).fault, "access point"));
    assert_true(door_rig_noted(rig, "policy-refused - - -> the policy has no access point"));
    /* The disk: nothing has changed. */
    rig->policy_error = -EIO;
    struct iso_fleet_bytes later = door_rig_policy(rig, 0, ""), again = {.bytes = NULL};
    iso_fleet_put(&again, later.bytes, later.size);
    assert_int_equal(door_rig_give(rig, later), ISO_FLEET_OUTCOMES);
    assert_int_equal(door_rig_status(rig).places[0].sequence, 2);
    rig->policy_error = 0;
    assert_int_equal(door_rig_give(rig, again), ISO_FLEET_APPLIED);
    assert_string_equal(rig->policy, "");
}

/* A zone that becomes the home brings its policy with a snapshot. */
static void another_home_brings_its_policy(void **state)
{
    struct door_rig *rig = *state;
    door_rig_begin(rig, 2);
    assert_int_equal(door_rig_give(rig, door_rig_policy(rig, 1, "{\"other\":1}")),
                     ISO_FLEET_APPLIED);
    const struct rig_zone first = rig->zone[0];
    rig->zone[0] = rig->zone[1];
    rig->zone[1] = first;
    assert_int_equal(door_rig_answer(rig, 2), ISO_FLEET_APPLIED);
    assert_true(door_rig_status(rig).wants_snapshot[0]);
    const struct iso_fleet_change change = {
        .kind = ISO_FLEET_POLICY, .policy = "{\"other\":1}", .policy_length = 11};
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    iso_fleet_put_change(&bytes, &change);
    assert_int_equal(door_rig_give_snapshot(rig, door_rig_snapshot(rig, 0, &bytes, 1)),
                     ISO_FLEET_APPLIED);
    assert_string_equal(rig->policy, "{\"other\":1}");
    assert_false(door_rig_status(rig).wants_snapshot[0]);
}

static void a_lockdown_holds_until_the_last_zone_ends_it(void **state)
{
    struct door_rig *rig = *state;
    door_rig_begin(rig, 2);
    assert_int_equal(door_rig_give(rig, door_rig_lock(rig, 0, true)), ISO_FLEET_APPLIED);
    assert_true(rig->lockdown);
    assert_int_equal(door_rig_give(rig, door_rig_lock(rig, 1, true)), ISO_FLEET_APPLIED);
    door_rig_restart(rig);
    assert_int_equal(door_rig_give(rig, door_rig_lock(rig, 0, false)), ISO_FLEET_APPLIED);
    assert_true(rig->lockdown);
    assert_int_equal(door_rig_give(rig, door_rig_lock(rig, 1, false)), ISO_FLEET_APPLIED);
    assert_false(rig->lockdown);
    /* One that somebody at the door began is not the hub's to end. */
    rig->lockdown = true;
    assert_int_equal(door_rig_give(rig, door_rig_lock(rig, 1, false)), ISO_FLEET_APPLIED);
    assert_true(rig->lockdown);
}

/* ---- events, and what waits ---- */

static void events_are_sealed_for_the_hub(void **state)
{
    struct door_rig *rig = *state;
    struct iso_fleet_bytes out = {.bytes = NULL}, lines = {.bytes = NULL};
    struct iso_fleet_events events;
    uint64_t last = 99;
    door_rig_begin(rig, 1);
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 0, 1, 1, "ada", 20, false)),
                     ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_give(rig, door_rig_remove(rig, 0, 1, 2)), ISO_FLEET_APPLIED);
    const uint64_t all = (uint64_t)rig->n_notes;
    assert_true(all >= 3);
    assert_int_equal(iso_fleet_events(rig->fleet, 1, 2, &out, &last, NULL), 0);
    assert_int_equal(last, 3);
    assert_int_equal(iso_fleet_read_events(out.bytes, out.size, rig->door_signs.public,
                                           &rig->hub_receives, &events, &lines),
                     0);
    assert_int_equal(events.first, 2);
    assert_int_equal(events.last, 3);
    assert_memory_equal(lines.bytes, "{\"sequence\":2,\"event\":\"fleet\"}\n{\"sequence\":3", 44);
    iso_fleet_bytes_free(&out);
    iso_fleet_bytes_free(&lines);
    assert_int_equal(iso_fleet_events(rig->fleet, all, 10, &out, &last, NULL), 0);
    assert_int_equal(last, 0);
    assert_null(out.bytes);
}

static enum iso_fleet_outcome give_ack(struct door_rig *rig, uint64_t number, bool other_door)
{
    struct iso_fleet_bytes out = {.bytes = NULL};
    const struct iso_fleet_ack ack = {.door = other_door ? iso_fleet_id_random() : rig->door,
                                      .number = number};
    assert_int_equal(iso_fleet_make_ack(&ack, &rig->hub, &out), 0);
    return door_rig_give(rig, out);
}

static void acknowledgements_only_rise(void **state)
{
    struct door_rig *rig = *state;
    door_rig_begin(rig, 1);
    rig->n_notes = 7;
    assert_int_equal(give_ack(rig, 5, true), ISO_FLEET_REFUSED);
    assert_int_equal(give_ack(rig, 5, false), ISO_FLEET_APPLIED);
    assert_int_equal(give_ack(rig, 4, false), ISO_FLEET_KNOWN);
    assert_int_equal(give_ack(rig, 8, false), ISO_FLEET_REFUSED);
    assert_int_equal(door_rig_status(rig).acked, 5);
    assert_int_equal(door_rig_status(rig).last_event, 7);
    /* An old ACK may come late, but the answer to the last question is what the hub has now: one
     * that was restored from a backup has fewer. */
    rig->acked = 2;
    assert_int_equal(door_rig_answer(rig, 1), ISO_FLEET_APPLIED);
    assert_int_equal(door_rig_status(rig).acked, 2);
}

static void each_kind_of_work_is_told_once_a_second(void **state)
{
    struct door_rig *rig = *state;
    int64_t due_ns;
    door_rig_begin(rig, 1);
    assert_int_equal(iso_fleet_time(rig->fleet, &due_ns),
                     ISO_FLEET_WORK_EVENTS | ISO_FLEET_WORK_REQUESTS | ISO_FLEET_WORK_PLACES);
    assert_int_equal(iso_fleet_time(rig->fleet, &due_ns) & ISO_FLEET_WORK_PLACES, 0);
    assert_int_equal(door_rig_give(rig, door_rig_put(rig, 0, 1, 1, "ada", 20, false)),
                     ISO_FLEET_APPLIED);
    rig->now.boot_ns += ISO_NS_PER_S / 2;
    assert_int_equal(iso_fleet_time(rig->fleet, &due_ns), 0);
    assert_int_equal(due_ns, ISO_NS_PER_S / 2);
    rig->now.boot_ns += ISO_NS_PER_S / 2;
    assert_int_equal(iso_fleet_time(rig->fleet, &due_ns),
                     ISO_FLEET_WORK_EVENTS | ISO_FLEET_WORK_PLACES);
    rig->now.boot_ns += 10 * ISO_NS_PER_S;
    assert_int_equal(iso_fleet_time(rig->fleet, &due_ns), 0);
    assert_int_equal(gallery_rig_add(rig->gallery, "visitor", 60, NULL), 0);
    assert_int_equal(iso_fleet_time(rig->fleet, &due_ns), ISO_FLEET_WORK_REQUESTS);
}

static void a_head_says_what_to_fetch(void **state)
{
    struct door_rig *rig = *state;
    struct iso_fleet_bytes out = {.bytes = NULL}, missed;
    struct iso_fleet_fetch fetch;
    door_rig_begin(rig, 1);
    for (int round = 0; round < 2; round++) {
        struct iso_fleet_bytes message = {.bytes = NULL};
        const struct iso_fleet_head head = {.place = rig->zone[0].place};
        assert_int_equal(iso_fleet_make_head(&head, &rig->hub, &message), 0);
        assert_int_equal(door_rig_give(rig, message), round ? ISO_FLEET_GAP : ISO_FLEET_KNOWN);
        missed = door_rig_put(rig, 0, 1, 1, "ada", 20, false);
        iso_fleet_bytes_free(&missed);
    }
    assert_int_equal(
        iso_fleet_fetch(rig->fleet, &rig->zone[0].place.zone, ISO_FLEET_WANT_DELTAS, &out, NULL),
        0);
    assert_int_equal(iso_fleet_read_fetch(out.bytes, out.size, rig->door_signs.public, &fetch), 0);
    assert_int_equal(fetch.after, 0);
    assert_int_equal(fetch.what, ISO_FLEET_WANT_DELTAS);
    iso_fleet_bytes_free(&out);
    assert_int_equal(
        iso_fleet_fetch(rig->fleet, &rig->zone[1].place.zone, ISO_FLEET_WANT_DELTAS, &out, NULL),
        -ENXIO);
}

static void the_table_of_the_link_reaches_the_door(void **state)
{
    struct door_rig *rig = *state;
    const struct iso_link_daemon daemon = iso_fleet_direct(rig->fleet);
    struct iso_link_status now;
    struct iso_link_outcome outcome;
    door_rig_begin(rig, 2);
    assert_int_equal(daemon.status(daemon.context, &now, NULL), 0);
    assert_int_equal(now.n, 2);
    assert_memory_equal(now.hub_signs, rig->hub.public, sizeof now.hub_signs);
    assert_int_equal(now.lease_s, 3600);
    struct iso_fleet_bytes delta = door_rig_put(rig, 1, 1, 1, "ada", 20, false);
    assert_int_equal(daemon.receive(daemon.context, delta.bytes, delta.size, &outcome, NULL), 0);
    assert_int_equal(outcome.outcome, ISO_FLEET_APPLIED);
    assert_true(iso_fleet_id_is_same(&outcome.zone, &rig->zone[1].place.zone));
    iso_fleet_bytes_free(&delta);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, door_rig_setup, door_rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_snapshot_brings_and_removes),
        TEST(a_snapshot_speaks_for_its_zone_alone),
        TEST(a_snapshot_that_was_cut_off_is_repeated),
        TEST(a_changed_snapshot_is_refused),
        TEST(the_home_zone_has_the_policy),
        TEST(another_home_brings_its_policy),
        TEST(a_lockdown_holds_until_the_last_zone_ends_it),
        TEST(events_are_sealed_for_the_hub),
        TEST(acknowledgements_only_rise),
        TEST(each_kind_of_work_is_told_once_a_second),
        TEST(a_head_says_what_to_fetch),
        TEST(the_table_of_the_link_reaches_the_door),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

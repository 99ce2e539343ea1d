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

#include "enroll/hub/answer/hub_event.h"
#include "enroll/hub/answer/hub_outbox.h"
#include "enroll/hub/people/hub_request.h"
#include "tests/enroll/hub/rigs/door_rig.h"

static struct iso_fault fault;

static void ask(struct door_rig *door, struct hub_rig *rig)
{
    hub_rig_fine(door_rig_ask(door, &rig->store, &fault), &fault);
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

static void publish(struct hub_rig *rig, struct doors *doors)
{
    const struct hub_emit emit = {.emit = to_all, .context = doors};
    bool done = false;
    while (!done) {
        hub_rig_fine(hub_outbox_each(&rig->store, 7, &emit, &done, &fault), &fault);
    }
}

static void a_door_gets_keys_lease_and_people(void **state)
{
    struct hub_rig *rig = *state;
    const struct iso_fleet_id zones[2] = {hub_rig_zone(rig, "office"), hub_rig_zone(rig, "lab")};
    const struct hub_zone_settings settings = {.lease_s = 900, .local_people = true};
    struct door_rig door;
    struct hub_door known;
    hub_rig_fine(hub_zone_set(&rig->store, &zones[0], &settings, &fault), &fault);
    const struct iso_fleet_id anna = hub_rig_put(rig, "anna", zones, 2);
    const struct iso_fleet_id ben = hub_rig_put(rig, "ben", &zones[1], 1);
    door_rig_join(&door, rig, "front", zones, 2);
    ask(&door, rig);
    assert_int_equal(door.keys, 2);
    assert_int_equal(door.leases, 1);
    assert_int_equal(door.lease.lease_s, 900);
    assert_true(door.lease.local_people);
    assert_int_equal(door.lease.n, 2);
    assert_true(iso_fleet_id_is_same(&door.lease.places[0].zone, &zones[0]));
    assert_int_equal(door.lease.places[1].sequence, 2);
    door_rig_fetch(&door, &rig->store);
    assert_int_equal(door.n_people, 3);
    assert_non_null(door_rig_person(&door, &zones[0], &anna));
    assert_non_null(door_rig_person(&door, &zones[1], &ben));
    ask(&door, rig);
    assert_int_equal(door.keys, 2); /* it has them */
    hub_rig_fine(hub_door_find(&rig->store, "front", &known, &fault), &fault);
    assert_int_equal(known.reported_s, hub_rig_now_s);
    assert_int_equal(known.door_time_s, 5);
    assert_int_equal(known.algorithm, 3);
    assert_string_equal(known.health, "{\"version\":\"1.0\"}");
    assert_true(known.online);

    /* Each change is applied. */
    hub_rig_fine(hub_person_set_offline(&rig->store, &anna, true, &fault), &fault);
    hub_rig_fine(hub_person_rename(&rig->store, &anna, "Anna B.", &fault), &fault);
    hub_rig_fine(hub_person_set_zones(&rig->store, &ben, &zones[0], 1, &fault), &fault);
    hub_rig_fine(
        hub_zone_set_policy(&rig->store, &zones[0], "{\"areas\":[{\"token\":\"hall\"}]}", &fault),
        &fault);
    hub_rig_fine(hub_zone_lockdown(&rig->store, NULL, true, &fault), &fault);
    hub_rig_fine(hub_zone_lockdown(&rig->store, NULL, true, &fault), &fault); /* no change */
    struct doors doors = {.emit = {door_rig_emit(&door)}, .n = 1};
    publish(rig, &doors);
    assert_string_equal(door_rig_person(&door, &zones[0], &anna)->name, "Anna B.");
    assert_true(door_rig_person(&door, &zones[1], &anna)->offline_ok);
    assert_null(door_rig_person(&door, &zones[1], &ben));
    assert_non_null(door_rig_person(&door, &zones[0], &ben));
    assert_true(door.zones[0].lockdown);
    assert_true(door.zones[1].lockdown);
    assert_string_equal(door.zones[0].policy, "{\"areas\":[{\"token\":\"hall\"}]}");
    assert_int_equal(door.zones[0].place.sequence, hub_rig_zone_now(rig, &zones[0]).place.sequence);
    hub_rig_fine(hub_person_revoke(&rig->store, &anna, &fault), &fault);
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

static int behind(struct hub_rig *rig, const struct iso_fleet_id *zone)
{
    int n = 0;
    hub_rig_fine(hub_doors_behind(&rig->store, zone, count_behind, &n, &fault), &fault);
    return n;
}

static void doors_confirm_a_change(void **state)
{
    struct hub_rig *rig = *state;
    const struct iso_fleet_id zone = hub_rig_zone(rig, "office");
    struct door_rig door;
    door_rig_join(&door, rig, "front", &zone, 1);
    assert_int_equal(behind(rig, &zone), 1);
    ask(&door, rig);
    ask(&door, rig);
    assert_int_equal(behind(rig, &zone), 0);
    hub_rig_fine(hub_zone_lockdown(&rig->store, &zone, true, &fault), &fault);
    assert_int_equal(behind(rig, &zone), 1);
    door_rig_fetch(&door, &rig->store);
    assert_int_equal(behind(rig, &zone), 1);
    ask(&door, rig);
    assert_int_equal(behind(rig, &zone), 0);
}

static void what_is_published_twice_is_known(void **state)
{
    struct hub_rig *rig = *state;
    const struct iso_fleet_id zone = hub_rig_zone(rig, "office");
    struct door_rig door;
    struct doors doors = {.emit = {door_rig_emit(&door)}, .n = 1};
    bool done = false;
    const struct hub_emit emit = {.emit = to_all, .context = &doors};
    door_rig_join(&door, rig, "front", &zone, 1);
    ask(&door, rig);
    for (char name[3] = "a0"; name[1] <= '9'; name[1]++) {
        (void)hub_rig_put(rig, name, &zone, 1);
    }
    hub_rig_fine(hub_outbox_each(&rig->store, 4, &emit, &done, &fault), &fault);
    assert_false(done);
    assert_int_equal(door.applied, 4);
    assert_int_equal(hub_rig_zone_now(rig, &zone).published, 4);
    publish(rig, &doors);
    assert_int_equal(door.applied, 10);
    /* A leader that ended before it had stored the cursor. */
    hub_rig_fine(hub_db_script(rig->store.db, "UPDATE zone SET published = 3", &fault), &fault);
    publish(rig, &doors);
    assert_int_equal(door.applied, 10);
    assert_int_equal(door.known, 7);
    assert_int_equal(door_rig_count(&door, &zone), 10);
}

static void an_expelled_door_gets_no_key(void **state)
{
    struct hub_rig *rig = *state;
    const struct iso_fleet_id zone = hub_rig_zone(rig, "office");
    struct door_rig stays, leaves;
    struct doors doors = {.emit = {door_rig_emit(&stays), door_rig_emit(&leaves)}, .n = 2};
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    enum hub_fetch_answer what;
    (void)hub_rig_put(rig, "anna", &zone, 1);
    door_rig_join(&stays, rig, "front", &zone, 1);
    door_rig_join(&leaves, rig, "back", &zone, 1);
    ask(&stays, rig);
    ask(&leaves, rig);
    door_rig_fetch(&stays, &rig->store);
    door_rig_fetch(&leaves, &rig->store);
    ask(&stays, rig);
    ask(&leaves, rig);
    publish(rig, &doors);

    hub_rig_fine(hub_door_expel(&rig->store, &leaves.id, &fault), &fault);
    assert_int_equal(hub_door_expel(&rig->store, &leaves.id, &fault), -EALREADY);
    const struct iso_fleet_id ben = hub_rig_put(rig, "ben", &zone, 1);
    publish(rig, &doors);
    assert_int_equal(hub_rig_zone_now(rig, &zone).place.epoch, 2);
    assert_int_equal(stays.keys, 2);
    assert_int_equal(leaves.keys, 1);
    assert_non_null(door_rig_person(&stays, &zone, &ben));
    assert_null(door_rig_person(&leaves, &zone, &ben));
    assert_int_equal(leaves.refused, 1);
    assert_int_equal(stays.zones[0].place.epoch, 2);

    /* It may not ask for anything any more. */
    assert_int_equal(door_rig_ask(&leaves, &rig->store, &fault), -EACCES);
    assert_int_equal(door_rig_send_events(&leaves, &rig->store, 1, 2, &fault), -EACCES);
    assert_int_equal(door_rig_fetch_raw(&leaves, &rig->store, &zone, 0, ISO_FLEET_WANT_SNAPSHOT,
                                        &bytes, &what, &fault),
                     -EACCES);
    assert_int_equal(bytes.size, 0);
    /* A door that was away goes through the old epoch into the new one. */
    ask(&stays, rig);
    assert_int_equal(stays.keys, 2);
}

static void a_door_that_moves_leaves_the_old_zone(void **state)
{
    struct hub_rig *rig = *state;
    const struct iso_fleet_id zones[2] = {hub_rig_zone(rig, "office"), hub_rig_zone(rig, "lab")};
    struct door_rig door;
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    enum hub_fetch_answer what;
    door_rig_join(&door, rig, "front", &zones[0], 1);
    ask(&door, rig);
    hub_rig_fine(hub_door_move(&rig->store, &door.id, &zones[1], 1, &fault), &fault);
    ask(&door, rig);
    assert_int_equal(door.lease.n, 1);
    assert_true(iso_fleet_id_is_same(&door.lease.places[0].zone, &zones[1]));
    assert_int_equal(door.keys, 2); /* that of the new zone came along */
    assert_int_equal(hub_rig_zone_now(rig, &zones[0]).place.epoch, 2);
    assert_int_equal(hub_rig_zone_now(rig, &zones[1]).place.epoch, 1);
    assert_int_equal(door_rig_fetch_raw(&door, &rig->store, &zones[0], 0, ISO_FLEET_WANT_DELTAS,
                                        &bytes, &what, &fault),
                     -EACCES);
}

static void a_snapshot_is_the_sum_of_the_deltas(void **state)
{
    struct hub_rig *rig = *state;
    const struct iso_fleet_id zone = hub_rig_zone(rig, "office");
    struct door_rig one, two;
    char name[16];
    struct iso_fleet_id ids[60];
    for (int i = 0; i < 60; i++) {
        (void)snprintf(name, sizeof name, "person %d", i);
        ids[i] = hub_rig_put(rig, name, &zone, 1);
    }
    for (int i = 0; i < 60; i += 3) {
        hub_rig_fine(hub_person_revoke(&rig->store, &ids[i], &fault), &fault);
    }
    for (int i = 1; i < 60; i += 3) {
        hub_rig_fine(hub_person_set_offline(&rig->store, &ids[i], true, &fault), &fault);
    }
    hub_rig_fine(hub_zone_lockdown(&rig->store, &zone, true, &fault), &fault);
    door_rig_join(&one, rig, "front", &zone, 1);
    door_rig_join(&two, rig, "back", &zone, 1);
    ask(&one, rig);
    ask(&two, rig);
    door_rig_fetch(&one, &rig->store);
    two.zones[0].wants_snapshot = true;
    door_rig_fetch(&two, &rig->store);
    assert_int_equal(door_rig_count(&one, &zone), 40);
    assert_int_equal(one.applied, 101);
    assert_int_equal(two.applied, 0);
    assert_true(door_rig_is_same(&one, &two, &zone));
    assert_true(two.zones[0].lockdown);
    assert_memory_equal(&one.zones[0].place, &two.zones[0].place, sizeof one.zones[0].place);

    /* The stored snapshot is used again, and the deltas after it follow. */
    (void)hub_rig_put(rig, "late", &zone, 1);
    struct door_rig three;
    door_rig_join(&three, rig, "side", &zone, 1);
    ask(&three, rig);
    three.zones[0].wants_snapshot = true;
    door_rig_fetch(&three, &rig->store);
    door_rig_fetch(&one, &rig->store);
    assert_int_equal(three.applied, 1);
    assert_true(door_rig_is_same(&one, &three, &zone));
    assert_int_equal(hub_rig_number(rig, "SELECT count(*) FROM snapshot"), 1);

    /* A delta that is gone: the answer to "deltas" is a snapshot. */
    hub_rig_fine(hub_db_script(rig->store.db, "DELETE FROM delta WHERE sequence < 50", &fault),
                 &fault);
    struct door_rig four;
    door_rig_join(&four, rig, "roof", &zone, 1);
    ask(&four, rig);
    door_rig_fetch(&four, &rig->store);
    assert_true(door_rig_is_same(&one, &four, &zone));
}

static void events_are_stored_once(void **state)
{
    struct hub_rig *rig = *state;
    const struct iso_fleet_id zone = hub_rig_zone(rig, "office");
    struct door_rig door, other;
    door_rig_join(&door, rig, "front", &zone, 1);
    door_rig_join(&other, rig, "back", &zone, 1);
    hub_rig_fine(door_rig_send_events(&door, &rig->store, 1, 10, &fault), &fault);
    assert_int_equal(door.acked, 10);
    hub_rig_fine(door_rig_send_events(&door, &rig->store, 1, 10, &fault), &fault);
    hub_rig_fine(door_rig_send_events(&door, &rig->store, 5, 15, &fault), &fault);
    assert_int_equal(door.acked, 15);
    assert_int_equal(hub_rig_number(rig, "SELECT count(*) FROM event"), 15);
    /* A gap is not acknowledged until it is filled. */
    hub_rig_fine(door_rig_send_events(&door, &rig->store, 21, 30, &fault), &fault);
    assert_int_equal(door.acked, 15);
    hub_rig_fine(door_rig_send_events(&other, &rig->store, 1, 3, &fault), &fault);
    assert_int_equal(other.acked, 3);
    hub_rig_fine(door_rig_send_events(&door, &rig->store, 16, 20, &fault), &fault);
    assert_int_equal(door.acked, 30);
    assert_int_equal(hub_rig_number(rig, "SELECT count(*) FROM event"), 33);
    assert_int_equal(hub_rig_number(rig, "SELECT count(DISTINCT number) FROM event"), 30);
    ask(&door, rig);
    assert_int_equal(door.lease.acked, 30);
}

static int keep_event(void *context, const struct hub_event *event)
{
    uint64_t *last = context;
    assert_true(event->number > *last);
    assert_string_equal(event->door_name, "front");
    assert_non_null(strstr(event->record, "péter 1"));
    *last = event->number;
    return 0;
}

static void events_are_found(void **state)
{
    struct hub_rig *rig = *state;
    const struct iso_fleet_id zone = hub_rig_zone(rig, "office");
    const struct hub_event_filter filter = {
        .person = "péter 1", .since = "2026-11-21T08:00:02", .most = 2};
    struct door_rig door;
    uint64_t last = 0;
    door_rig_join(&door, rig, "front", &zone, 1);
    hub_rig_fine(door_rig_send_events(&door, &rig->store, 1, 20, &fault), &fault);
    hub_rig_fine(hub_event_each(&rig->store, &filter, keep_event, &last, &fault), &fault);
    assert_int_equal(last, 19);
}

/* Messages of a door that is none, or that says what is not true. */
static void bad_messages_are_refused(void **state)
{
    struct hub_rig *rig = *state;
    const struct iso_fleet_id zone = hub_rig_zone(rig, "office");
    struct door_rig door, other;
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    const struct iso_fleet_events wrong = {.first = 5, .last = 6};
    static const char *const lines[] = {"{\"sequence\":4}\n",
                                        "{\"sequence\":7}\n",
                                        "{\"sequence\":6}\n{\"sequence\":5}\n",
                                        "{\"sequence\":5}\n{\"sequence\":5}\n",
                                        "{\"sequence\":\"5\"}\n",
                                        "[5]\n",
                                        "{\"sequence\":5,\"time\":7}\n",
                                        "{\"sequence\":5}",
                                        "nonsense\n"};
    door_rig_join(&door, rig, "front", &zone, 1);
    door_rig_join(&other, rig, "back", &zone, 1);
    const struct hub_emit emit = door_rig_emit(&door);
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        struct iso_fleet_events events = wrong;
        events.door = door.id;
        assert_int_equal(iso_fleet_make_events(&events, lines[i], strlen(lines[i]),
                                               door.hub_receives, &door.signs, &bytes),
                         0);
        assert_int_equal(hub_take(&rig->store, &door.id, bytes.bytes, bytes.size, &emit, &fault),
                         -EBADMSG);
        iso_fleet_bytes_free(&bytes);
    }
    /* Another door's key, another door's topic, an unknown door, a cut message. */
    struct door_rig forged = door;
    forged.signs = other.signs;
    assert_int_equal(door_rig_ask(&forged, &rig->store, &fault), -EKEYREJECTED);
    forged = door;
    forged.id = iso_fleet_id_random();
    assert_int_equal(door_rig_ask(&forged, &rig->store, &fault), -EACCES);
    const struct iso_fleet_question question = {.door = door.id, .health = ""};
    assert_int_equal(iso_fleet_make_question(&question, &door.signs, &bytes), 0);
    assert_int_equal(hub_take(&rig->store, &other.id, bytes.bytes, bytes.size, &emit, &fault),
                     -EBADMSG);
    for (size_t size = 0; size < bytes.size; size++) {
        assert_true(hub_take(&rig->store, &door.id, bytes.bytes, size, &emit, &fault) < 0);
    }
    bytes.bytes[bytes.size / 2] ^= 1;
    assert_true(hub_take(&rig->store, &door.id, bytes.bytes, bytes.size, &emit, &fault) < 0);
    iso_fleet_bytes_free(&bytes);
    assert_int_equal(door.leases + door.acks, 0);
    assert_int_equal(hub_rig_number(rig, "SELECT count(*) FROM event"), 0);
    assert_int_equal(hub_rig_number(rig, "SELECT max(reported_s) FROM door"), 0);
}

static int keep_request(void *context, const struct hub_request *request)
{
    *(struct hub_request *)context = *request;
    return 0;
}

static void requests_wait_for_a_person(void **state)
{
    struct hub_rig *rig = *state;
    struct hub_store *store = &rig->store;
    const struct iso_fleet_id zone = hub_rig_zone(rig, "office");
    struct door_rig door;
    struct hub_request request = {.state = HUB_REQUEST_REJECTED};
    struct iso_fleet_person anna = hub_rig_person("anna", 3, 2, 1);
    door_rig_join(&door, rig, "front", &zone, 1);
    ask(&door, rig);
    hub_rig_fine(door_rig_request(&door, store, &anna, &fault), &fault);
    hub_rig_fine(door_rig_request(&door, store, &anna, &fault), &fault);
    assert_int_equal(hub_rig_number(rig, "SELECT count(*) FROM request"), 1);
    assert_int_equal(hub_rig_number(rig, "SELECT count(*) FROM person"), 0);
    hub_rig_fine(hub_request_each(store, false, keep_request, &request, &fault), &fault);
    assert_string_equal(request.name, "anna");
    assert_string_equal(request.door_name, "front");
    hub_rig_fine(hub_request_find(store, "anna", &request, &fault), &fault);
    hub_rig_fine(hub_request_approve(store, &request.person, NULL, 0, &fault), &fault);
    assert_int_equal(hub_request_approve(store, &request.person, NULL, 0, &fault), -EALREADY);
    door_rig_fetch(&door, store);
    assert_non_null(door_rig_person(&door, &zone, &anna.id));
    /* The same message comes late: nothing happens. */
    hub_rig_fine(door_rig_request(&door, store, &anna, &fault), &fault);
    assert_int_equal(hub_rig_zone_now(rig, &zone).place.sequence, 1);
    /* After a revocation the door that still has the person is told again. */
    hub_rig_fine(hub_person_revoke(store, &anna.id, &fault), &fault);
    hub_rig_fine(door_rig_request(&door, store, &anna, &fault), &fault);
    door_rig_fetch(&door, store);
    assert_int_equal(hub_rig_zone_now(rig, &zone).place.sequence, 3);
    assert_int_equal(hub_rig_number(rig, "SELECT count(*) FROM person"), 0);

    const struct iso_fleet_person ben = hub_rig_person("ben", 3, 2, 1);
    hub_rig_fine(door_rig_request(&door, store, &ben, &fault), &fault);
    hub_rig_fine(hub_request_reject(store, &ben.id, &fault), &fault);
    assert_int_equal(hub_rig_zone_now(rig, &zone).place.sequence, 4); /* REMOVE */
    assert_int_equal(hub_rig_number(rig, "SELECT count(*) FROM request WHERE sealed IS NOT NULL"),
                     0);
}

static void a_zone_may_approve_at_once(void **state)
{
    struct hub_rig *rig = *state;
    struct hub_store *store = &rig->store;
    const struct iso_fleet_id zone = hub_rig_zone(rig, "office");
    const struct hub_zone_settings settings = {.lease_s = 60, .approve_auto = true};
    struct iso_fleet_person anna = hub_rig_person("anna", 3, 2, 1);
    struct iso_fleet_person same = hub_rig_person("anna", 3, 2, 2);
    struct door_rig door;
    hub_rig_fine(hub_zone_set(store, &zone, &settings, &fault), &fault);
    door_rig_join(&door, rig, "front", &zone, 1);
    ask(&door, rig);
    hub_rig_fine(door_rig_request(&door, store, &anna, &fault), &fault);
    door_rig_fetch(&door, store);
    assert_non_null(door_rig_person(&door, &zone, &anna.id));
    /* Another person with a taken name waits. */
    same.id = iso_fleet_id_of("another", 7);
    hub_rig_fine(door_rig_request(&door, store, &same, &fault), &fault);
    assert_int_equal(hub_rig_number(rig, "SELECT count(*) FROM request WHERE state = 0"), 1);
    assert_int_equal(hub_rig_number(rig, "SELECT count(*) FROM person"), 1);
}

static void one_of_two_is_the_leader(void **state)
{
    struct hub_rig *rig = *state;
    struct hub_store other;
    const struct iso_fleet_id zone = hub_rig_zone(rig, "office");
    bool is_leader = false, changed = true;
    int fd = -1;
    hub_rig_open(rig, &other);
    hub_rig_fine(hub_leader_try(&rig->store, &is_leader, &fault), &fault);
    assert_true(is_leader);
    hub_rig_fine(hub_leader_try(&other, &is_leader, &fault), &fault);
    assert_false(is_leader);
    hub_rig_fine(hub_leader_try(&rig->store, &is_leader, &fault), &fault);
    assert_true(is_leader);
    hub_rig_fine(hub_leader_leave(&rig->store, &fault), &fault);
    hub_rig_fine(hub_leader_try(&other, &is_leader, &fault), &fault);
    assert_true(is_leader);
    hub_rig_fine(hub_leader_try(&rig->store, &is_leader, &fault), &fault);
    assert_false(is_leader);

    hub_rig_fine(hub_listen(&other, &fd, &fault), &fault);
    hub_rig_fine(hub_listen_take(&other, &changed, &fault), &fault);
    assert_false(changed);
    (void)hub_rig_put(rig, "anna", &zone, 1);
    struct pollfd wait = {.fd = fd, .events = POLLIN};
    assert_int_equal(poll(&wait, 1, 10000), 1);
    hub_rig_fine(hub_listen_take(&other, &changed, &fault), &fault);
    assert_true(changed);
    hub_store_close(&other);
}

#define TEST(NAME) cmocka_unit_test_setup_teardown(NAME, hub_rig_setup, hub_rig_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(a_door_gets_keys_lease_and_people),
        TEST(doors_confirm_a_change),
        TEST(what_is_published_twice_is_known),
        TEST(an_expelled_door_gets_no_key),
        TEST(a_door_that_moves_leaves_the_old_zone),
        TEST(a_snapshot_is_the_sum_of_the_deltas),
        TEST(events_are_stored_once),
        TEST(events_are_found),
        TEST(bad_messages_are_refused),
        TEST(requests_wait_for_a_person),
        TEST(a_zone_may_approve_at_once),
        TEST(one_of_two_is_the_leader),
    };
    return cmocka_run_group_tests(tests, hub_rig_start, hub_rig_stop);
}

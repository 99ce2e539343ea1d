/* What doors send to the hub: events and requests, and messages that are none. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <string.h>

#include "enroll/hub/answer/hub_event.h"
#include "enroll/hub/people/hub_request.h"
#include "tests/enroll/hub/rigs/played_door.h"

static struct iso_fault fault;

static void ask(struct played_door *door, struct store_rig *rig)
{
    store_rig_fine(played_door_ask(door, &rig->store, &fault), &fault);
}

static void events_are_stored_once(void **state)
{
    struct store_rig *rig = *state;
    const struct iso_fleet_id zone = store_rig_zone(rig, "office");
    struct played_door door, other;
    played_door_join(&door, rig, "front", &zone, 1);
    played_door_join(&other, rig, "back", &zone, 1);
    store_rig_fine(played_door_send_events(&door, &rig->store, 1, 10, &fault), &fault);
    assert_int_equal(door.acked, 10);
    store_rig_fine(played_door_send_events(&door, &rig->store, 1, 10, &fault), &fault);
    store_rig_fine(played_door_send_events(&door, &rig->store, 5, 15, &fault), &fault);
    assert_int_equal(door.acked, 15);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM event"), 15);
    /* A gap is not acknowledged until it is filled. */
    store_rig_fine(played_door_send_events(&door, &rig->store, 21, 30, &fault), &fault);
    assert_int_equal(door.acked, 15);
    store_rig_fine(played_door_send_events(&other, &rig->store, 1, 3, &fault), &fault);
    assert_int_equal(other.acked, 3);
    store_rig_fine(played_door_send_events(&door, &rig->store, 16, 20, &fault), &fault);
    assert_int_equal(door.acked, 30);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM event"), 33);
    assert_int_equal(store_rig_number(rig, "SELECT count(DISTINCT number) FROM event"), 30);
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
    struct store_rig *rig = *state;
    const struct iso_fleet_id zone = store_rig_zone(rig, "office");
    const struct hub_event_filter filter = {
        .person = "péter 1", .since = "2026-11-21T08:00:02", .most = 2};
    struct played_door door;
    uint64_t last = 0;
    played_door_join(&door, rig, "front", &zone, 1);
    store_rig_fine(played_door_send_events(&door, &rig->store, 1, 20, &fault), &fault);
    store_rig_fine(hub_event_each(&rig->store, &filter, keep_event, &last, &fault), &fault);
    assert_int_equal(last, 19);
}

/* A door that was upgraded before its hub; the hub stays as it is. */
static void a_message_of_a_newer_door_is_named(void **state)
{
    struct store_rig *rig = *state;
    const struct iso_fleet_id zone = store_rig_zone(rig, "office");
    const struct iso_fleet_question question = {.health = ""};
    struct iso_fleet_bytes bytes = {.bytes = NULL};
    struct played_door door;
    played_door_join(&door, rig, "front", &zone, 1);
    const struct hub_emit emit = played_door_emit(&door);
    assert_int_equal(iso_fleet_make_question(&question, &door.signs, &bytes), 0);
    bytes.bytes[4] = ISO_FLEET_VERSION + 1;
    assert_int_equal(hub_take(&rig->store, &door.id, bytes.bytes, bytes.size, &emit, &fault),
                     -EPROTONOSUPPORT);
    assert_non_null(strstr(fault.text, "of a newer version; upgrade the hub"));
    assert_int_equal(door.leases, 0);
    iso_fleet_bytes_free(&bytes);
}

/* Messages of a door that is none, or that says what is not true. */
static void bad_messages_are_refused(void **state)
{
    struct store_rig *rig = *state;
    const struct iso_fleet_id zone = store_rig_zone(rig, "office");
    struct played_door door, other;
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
    played_door_join(&door, rig, "front", &zone, 1);
    played_door_join(&other, rig, "back", &zone, 1);
    const struct hub_emit emit = played_door_emit(&door);
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
    struct played_door forged = door;
    forged.signs = other.signs;
    assert_int_equal(played_door_ask(&forged, &rig->store, &fault), -EKEYREJECTED);
    forged = door;
    forged.id = iso_fleet_id_random();
    assert_int_equal(played_door_ask(&forged, &rig->store, &fault), -EACCES);
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
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM event"), 0);
    assert_int_equal(store_rig_number(rig, "SELECT max(reported_s) FROM door"), 0);
}

static int keep_request(void *context, const struct hub_request *request)
{
    *(struct hub_request *)context = *request;
    return 0;
}

static void requests_wait_for_a_person(void **state)
{
    struct store_rig *rig = *state;
    struct hub_store *store = &rig->store;
    const struct iso_fleet_id zone = store_rig_zone(rig, "office");
    struct played_door door;
    struct hub_request request = {.state = HUB_REQUEST_REJECTED};
    struct iso_fleet_person anna = store_rig_person("anna", 3, 2, 1);
    played_door_join(&door, rig, "front", &zone, 1);
    ask(&door, rig);
    store_rig_fine(played_door_request(&door, store, &anna, &fault), &fault);
    store_rig_fine(played_door_request(&door, store, &anna, &fault), &fault);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM request"), 1);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM person"), 0);
    store_rig_fine(hub_request_each(store, false, keep_request, &request, &fault), &fault);
    assert_string_equal(request.name, "anna");
    assert_string_equal(request.door_name, "front");
    store_rig_fine(hub_request_find(store, "anna", &request, &fault), &fault);
    store_rig_fine(hub_request_approve(store, &request.person, NULL, 0, &fault), &fault);
    assert_int_equal(hub_request_approve(store, &request.person, NULL, 0, &fault), -EALREADY);
    played_door_fetch(&door, store);
    assert_non_null(played_door_person(&door, &zone, &anna.id));
    /* The same message comes late: nothing happens. */
    store_rig_fine(played_door_request(&door, store, &anna, &fault), &fault);
    assert_int_equal(store_rig_zone_now(rig, &zone).place.sequence, 1);
    /* After a revocation the door that still has the person is told again. */
    store_rig_fine(hub_person_revoke(store, &anna.id, &fault), &fault);
    store_rig_fine(played_door_request(&door, store, &anna, &fault), &fault);
    played_door_fetch(&door, store);
    assert_int_equal(store_rig_zone_now(rig, &zone).place.sequence, 3);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM person"), 0);

    const struct iso_fleet_person ben = store_rig_person("ben", 3, 2, 1);
    store_rig_fine(played_door_request(&door, store, &ben, &fault), &fault);
    store_rig_fine(hub_request_reject(store, &ben.id, &fault), &fault);
    assert_int_equal(store_rig_zone_now(rig, &zone).place.sequence, 4); /* REMOVE */
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM request WHERE sealed IS NOT NULL"),
                     0);
}

static void a_zone_may_approve_at_once(void **state)
{
    struct store_rig *rig = *state;
    struct hub_store *store = &rig->store;
    const struct iso_fleet_id zone = store_rig_zone(rig, "office");
    const struct hub_zone_settings settings = {.lease_s = 60, .approve_auto = true};
    struct iso_fleet_person anna = store_rig_person("anna", 3, 2, 1);
    struct iso_fleet_person same = store_rig_person("anna", 3, 2, 2);
    struct played_door door;
    store_rig_fine(hub_zone_set(store, &zone, &settings, &fault), &fault);
    played_door_join(&door, rig, "front", &zone, 1);
    ask(&door, rig);
    store_rig_fine(played_door_request(&door, store, &anna, &fault), &fault);
    played_door_fetch(&door, store);
    assert_non_null(played_door_person(&door, &zone, &anna.id));
    /* Another person with a taken name waits. */
    same.id = iso_fleet_id_of("another", 7);
    store_rig_fine(played_door_request(&door, store, &same, &fault), &fault);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM request WHERE state = 0"), 1);
    assert_int_equal(store_rig_number(rig, "SELECT count(*) FROM person"), 1);
}

#define TEST(NAME) cmocka_unit_test_setup_teardown(NAME, store_rig_setup, store_rig_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(events_are_stored_once),
        TEST(events_are_found),
        TEST(a_message_of_a_newer_door_is_named),
        TEST(bad_messages_are_refused),
        TEST(requests_wait_for_a_person),
        TEST(a_zone_may_approve_at_once),
    };
    return cmocka_run_group_tests(tests, store_rig_start, store_rig_stop);
}

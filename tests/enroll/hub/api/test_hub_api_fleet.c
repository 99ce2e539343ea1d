/* The routes of the hub's API that need doors, which are played: lockdown, people, requests,
 * events, updates. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "enroll/hub/update/hub_update.h"
#include "tests/enroll/hub/rigs/api_rig.h"

#define ADMIN WEB_ROLE_ADMINISTRATOR

static json_t *get(const char *path)
{
    return api_rig_ask(ADMIN, "GET", path, NULL, 200);
}

static void a_lockdown_names_the_doors_that_have_not_confirmed_it(void **state)
{
    static struct played_door near, far;
    (void)state;

    api_rig_do("POST", "/zones", "{'name': 'house'}", 201);
    api_rig_join(&near, "near");
    api_rig_join(&far, "far");
    api_rig_ask_hub(&near);
    api_rig_ask_hub(&far);
    json_t *doors = get("/doors");
    assert_int_equal(json_array_size(api_rig_at(doors, "doors")), 2);
    assert_string_equal(api_rig_text(doors, "doors.0.name"), "far");
    assert_string_equal(api_rig_text(doors, "doors.0.state"), "joined");
    assert_true(json_is_true(api_rig_at(doors, "doors.0.zones.0.confirmed")));
    json_decref(doors);

    json_t *answer = api_rig_ask(ADMIN, "PUT", "/lockdown", "{'on': true, 'zone': 'house'}", 200);
    assert_true(json_is_true(api_rig_at(answer, "zones.0.lockdown")));
    assert_int_equal(json_array_size(api_rig_at(answer, "zones.0.unconfirmed")), 2);
    json_decref(answer);
    api_rig_expect_act("administrator lockdown house");
    api_rig_ask_hub(&near);
    answer = get("/lockdown");
    assert_int_equal(json_array_size(api_rig_at(answer, "zones.0.unconfirmed")), 1);
    assert_string_equal(api_rig_text(answer, "zones.0.unconfirmed.0.name"), "far");
    json_decref(answer);
    json_t *door = get("/doors/far");
    assert_true(json_is_false(api_rig_at(door, "zones.0.confirmed")));
    assert_string_equal(api_rig_text(door, "attention.0"), "unconfirmed");
    json_decref(door);
    api_rig_refused(ADMIN, "PUT", "/lockdown", "{}", 400, "invalid-member");
    api_rig_refused(ADMIN, "PUT", "/lockdown", "{'on': true, 'zone': 'garden'}", 404,
                    "no-such-zone");
    answer = api_rig_ask(ADMIN, "DELETE", "/doors/far", NULL, 200);
    assert_int_equal(json_array_size(api_rig_at(answer, "zones.0.unconfirmed")), 1);
    json_decref(answer);
    api_rig_refused(ADMIN, "POST", "/doors/far/code", "{}", 409, "door-expelled");
    api_rig_refused(ADMIN, "GET", "/doors/nowhere", NULL, 404, "no-such-door");
    json_t *status = get("/status");
    assert_int_equal(api_rig_number(status, "doors.all"), 1);
    assert_int_equal(api_rig_number(status, "zones.lockdown"), 1);
    json_decref(status);
}

static void people_come_in_pages_and_are_found_and_changed(void **state)
{
    (void)state;
    const struct iso_fleet_id house = store_rig_zone(api_rig.hub, "house");
    (void)store_rig_zone(api_rig.hub, "garden");
    (void)store_rig_put(api_rig.hub, "Ada", &house, 1);
    (void)store_rig_put(api_rig.hub, "ben", &house, 1);
    (void)store_rig_put(api_rig.hub, "Cem", &house, 1);

    json_t *page = get("/people?max=2");
    assert_string_equal(api_rig_text(page, "people.0.name"), "Ada");
    assert_string_equal(api_rig_text(page, "people.1.name"), "ben");
    assert_string_equal(api_rig_text(page, "next"), "ben");
    json_decref(page);
    page = get("/people?max=2&after=ben");
    assert_string_equal(api_rig_text(page, "people.0.name"), "Cem");
    assert_int_equal(json_array_size(api_rig_at(page, "people")), 1);
    assert_true(json_is_null(api_rig_at(page, "next")));
    json_decref(page);
    page = get("/people?search=DA&zone=house");
    assert_int_equal(json_array_size(api_rig_at(page, "people")), 1);
    json_decref(page);
    page = get("/people?zone=garden");
    assert_int_equal(json_array_size(api_rig_at(page, "people")), 0);
    json_decref(page);
    api_rig_refused(ADMIN, "GET", "/people?max=0", NULL, 400, "invalid-parameter");

    json_t *ada = api_rig_ask(ADMIN, "PATCH", "/people/ada",
                              "{'name': 'Ada Lovelace', 'valid_from_s': 10, 'valid_until_s': 20, "
                              "'offline_ok': true, 'zones': ['garden', 'house']}",
                              200);
    assert_string_equal(api_rig_text(ada, "name"), "Ada Lovelace");
    assert_int_equal(api_rig_number(ada, "valid_until_s"), 20);
    assert_int_equal(json_array_size(api_rig_at(ada, "zones")), 2);
    json_decref(ada);
    /* All of it or nothing. */
    api_rig_refused(ADMIN, "PATCH", "/people/ben",
                    "{'name': 'Benno', 'valid_from_s': 9, "
                    "'valid_until_s': 8}",
                    400, "invalid-limits");
    json_decref(get("/people/ben"));
    api_rig_refused(ADMIN, "PATCH", "/people/ben", "{'name': 'CEM'}", 409, "name-in-use");
    api_rig_refused(ADMIN, "PATCH", "/people/ben", "{'zones': []}", 400, "invalid-member");
    api_rig_refused(ADMIN, "PATCH", "/people/nobody", "{}", 404, "no-such-person");
}

static void a_revoked_person_is_gone_and_the_answer_names_the_doors(void **state)
{
    static struct played_door door;
    (void)state;
    api_rig_do("POST", "/zones", "{'name': 'house'}", 201);
    const struct hub_zone *zone = NULL;
    struct hub_zone found;
    struct iso_fault fault = {.text = ""};
    store_rig_fine(hub_zone_find(&api_rig.hub->store, "house", &found, &fault), &fault);
    zone = &found;
    api_rig_join(&door, "near");
    const struct iso_fleet_id ada = store_rig_put(api_rig.hub, "Ada", &zone->place.zone, 1);
    api_rig_ask_hub(&door);
    assert_non_null(played_door_person(&door, &zone->place.zone, &ada));
    json_t *answer = api_rig_ask(ADMIN, "DELETE", "/people/Ada", NULL, 200);
    assert_string_equal(api_rig_text(answer, "zones.0.unconfirmed.0.name"), "near");
    json_decref(answer);
    api_rig_expect_act("administrator person-revoke Ada");
    api_rig_ask_hub(&door);
    assert_null(played_door_person(&door, &zone->place.zone, &ada));
    api_rig_refused(ADMIN, "GET", "/people/Ada", NULL, 404, "no-such-person");
    json_t *now = get("/zones/house");
    assert_int_equal(json_array_size(api_rig_at(now, "unconfirmed")), 0);
    json_decref(now);
}

static void requests_are_approved_and_rejected(void **state)
{
    static struct played_door door;
    struct iso_fault fault = {.text = ""};
    (void)state;
    api_rig_do("POST", "/zones", "{'name': 'house'}", 201);
    api_rig_do("POST", "/zones", "{'name': 'garden'}", 201);
    api_rig_join(&door, "near");
    static const char *const names[] = {"Dora", "Emil"};
    for (int i = 0; i < 2; i++) {
        const struct iso_fleet_person person = store_rig_person(names[i], 3, 1, 7);
        store_rig_fine(played_door_request(&door, &api_rig.hub->store, &person, &fault), &fault);
    }
    json_t *list = api_rig_ask(WEB_ROLE_ENROLLER, "GET", "/requests", NULL, 200);
    assert_int_equal(json_array_size(api_rig_at(list, "requests")), 2);
    assert_string_equal(api_rig_text(list, "requests.0.door.name"), "near");
    json_decref(list);
    json_t *dora = api_rig_ask(ADMIN, "POST", "/requests/Dora/approval", "{'zones': ['garden']}",
                               200);
    assert_string_equal(api_rig_text(dora, "zones.0.name"), "garden");
    json_decref(dora);
    api_rig_expect_act("administrator request-approve Dora");
    json_decref(api_rig_ask(WEB_ROLE_ENROLLER, "DELETE", "/requests/Emil", NULL, 204));
    list = get("/requests");
    assert_int_equal(json_array_size(api_rig_at(list, "requests")), 0);
    json_decref(list);
    list = get("/requests?all=1");
    assert_int_equal(json_array_size(api_rig_at(list, "requests")), 2);
    json_decref(list);
    api_rig_refused(ADMIN, "DELETE", "/requests/Franz", NULL, 404, "no-such-request");
    list = get("/people?unseen=1");
    assert_int_equal(json_array_size(api_rig_at(list, "people")), 0);
    json_decref(list);
}

/* An enroller decides who is one of the fleet, and an administrator decides where. */
static void an_enroller_chooses_no_zones(void **state)
{
    static const char *const others[] = {"{'zones': ['garden']}", "{'zones': ['house', 'garden']}",
                                         "{'zones': ['garden', 'house']}"};
    static const char *const names[] = {"Dora", "Emil"};
    static struct played_door door;
    struct iso_fault fault = {.text = ""};
    (void)state;
    api_rig_do("POST", "/zones", "{'name': 'house'}", 201);
    api_rig_do("POST", "/zones", "{'name': 'garden'}", 201);
    api_rig_join(&door, "near");
    for (int i = 0; i < 2; i++) {
        const struct iso_fleet_person person = store_rig_person(names[i], 3, 1, 7);
        store_rig_fine(played_door_request(&door, &api_rig.hub->store, &person, &fault), &fault);
    }
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        api_rig_refused(WEB_ROLE_ENROLLER, "POST", "/requests/Dora/approval", others[i], 403,
                        "not-allowed");
        api_rig_refused(ADMIN, "GET", "/people/Dora", NULL, 404, "no-such-person");
    }
    json_t *dora = api_rig_ask(WEB_ROLE_ENROLLER, "POST", "/requests/Dora/approval",
                               "{'zones': ['house']}", 200);
    assert_int_equal(json_array_size(api_rig_at(dora, "zones")), 1);
    assert_string_equal(api_rig_text(dora, "zones.0.name"), "house");
    json_decref(dora);
    api_rig_expect_act("enroller request-approve Dora");
    json_t *emil = api_rig_ask(WEB_ROLE_ENROLLER, "POST", "/requests/Emil/approval", "{}", 200);
    assert_int_equal(json_array_size(api_rig_at(emil, "zones")), 1);
    assert_string_equal(api_rig_text(emil, "zones.0.name"), "house");
    json_decref(emil);
}

static void events_are_filtered_and_come_in_pages(void **state)
{
    static struct played_door door;
    struct iso_fault fault = {.text = ""};
    char path[256];
    (void)state;
    api_rig_do("POST", "/zones", "{'name': 'house'}", 201);
    api_rig_join(&door, "near");
    store_rig_fine(played_door_send_events(&door, &api_rig.hub->store, 1, 5, &fault), &fault);
    json_t *page = get("/events?max=3");
    assert_int_equal(json_array_size(api_rig_at(page, "events")), 3);
    assert_int_equal(api_rig_number(page, "events.0.number"), 5);
    assert_string_equal(api_rig_text(page, "events.0.door.name"), "near");
    assert_int_equal(api_rig_number(page, "events.0.record.sequence"), 5);
    (void)snprintf(path, sizeof path, "/events?max=3&door=near&before=%s",
                   api_rig_text(page, "next"));
    for (char *at = path; *at; at++) {
        *at = *at == ' ' ? '+' : *at;
    }
    json_decref(page);
    page = get(path);
    assert_int_equal(json_array_size(api_rig_at(page, "events")), 2);
    assert_int_equal(api_rig_number(page, "events.1.number"), 1);
    assert_true(json_is_null(api_rig_at(page, "next")));
    json_decref(page);
    page = get("/events?person=nobody");
    assert_int_equal(json_array_size(api_rig_at(page, "events")), 0);
    json_decref(page);
    api_rig_refused(ADMIN, "GET", "/events?before=here", NULL, 400, "invalid-parameter");
    api_rig_refused(ADMIN, "GET", "/events?door=far", NULL, 404, "no-such-door");
}

/* One door is told, one takes no updates, and one waits. */
static void begin_rollout(struct played_door doors[3])
{
    static const char *const names[] = {"near", "old", "far"};
    const struct hub_rollout_options options = {.version = "1.2", .zone = "house", .first = 1};
    const struct hub_update_file file = {
        .version = "1.2", .board = "pc", .size = 1000, .sha256 = {0xab}, .added_s = 77};
    struct iso_fault fault = {.text = ""};
    for (size_t i = 0; i < 3; i++) {
        api_rig_join(&doors[i], names[i]);
        doors[i].health = i == 1 ? "{}"
                                 : "{\"update-state\":\"idle\",\"image-version\":\"1.1\","
                                   "\"image-board\":\"pc\"}";
    }
    store_rig_fine(hub_update_add(&api_rig.hub->store, &file, &fault), &fault);
    store_rig_fine(hub_rollout_start(&api_rig.hub->store, &options, &fault), &fault);
    for (size_t i = 0; i < 3; i++) {
        store_rig_fine(played_door_ask(&doors[i], &api_rig.hub->store, &fault), &fault);
    }
}

static void updates_and_their_rollouts_are_shown(void **state)
{
    static struct played_door doors[3];
    (void)state;
    json_t *list = get("/updates");
    assert_int_equal(json_array_size(api_rig_at(list, "files")), 0);
    assert_int_equal(json_array_size(api_rig_at(list, "rollouts")), 0);
    json_decref(list);
    api_rig_do("POST", "/zones", "{'name': 'house'}", 201);
    list = get("/zones/house/rollout");
    assert_int_equal(json_array_size(api_rig_at(list, "doors")), 0);
    json_decref(list);
    api_rig_refused(ADMIN, "GET", "/zones/garden/rollout", NULL, 404, "no-such-zone");
    begin_rollout(doors);
    list = api_rig_ask(WEB_ROLE_OBSERVER, "GET", "/updates", NULL, 200);
    assert_string_equal(api_rig_text(list, "files.0.board"), "pc");
    assert_int_equal(api_rig_number(list, "files.0.bytes"), 1000);
    assert_memory_equal(api_rig_text(list, "files.0.sha256"), "ab00", 4);
    assert_int_equal(strlen(api_rig_text(list, "files.0.sha256")), 64);
    assert_string_equal(api_rig_text(list, "rollouts.0.version"), "1.2");
    assert_string_equal(api_rig_text(list, "rollouts.0.zone"), "house");
    assert_string_equal(api_rig_text(list, "rollouts.0.state"), "running");
    assert_int_equal(api_rig_number(list, "rollouts.0.doors"), 3);
    assert_int_equal(api_rig_number(list, "rollouts.0.at_work"), 1);
    assert_int_equal(api_rig_number(list, "rollouts.0.waiting"), 1);
    assert_int_equal(api_rig_number(list, "rollouts.0.unable"), 1);
    json_decref(list);
    list = get("/zones/house/rollout");
    assert_string_equal(api_rig_text(list, "doors.0.name"), "near");
    assert_string_equal(api_rig_text(list, "doors.0.state"), "told");
    assert_string_equal(api_rig_text(list, "doors.1.state"), "waiting");
    assert_string_equal(api_rig_text(list, "doors.2.name"), "old");
    assert_string_equal(api_rig_text(list, "doors.2.state"), "unable");
    assert_true(*api_rig_text(list, "doors.2.fault"));
    json_decref(list);
    api_rig_refused(WEB_ROLE_NONE, "GET", "/updates", NULL, 401, "login-required");
}

/* Writes the body of a request about the only rollout. */
static void name_rollout(const char *running, char *out, size_t size)
{
    json_t *list = get("/updates");
    (void)snprintf(out, size, "{'id': '%s', 'running': %s}", api_rig_text(list, "rollouts.0.id"),
                   running);
    json_decref(list);
}

static void administrators_stop_a_rollout_and_let_it_go_on(void **state)
{
    static const char path[] = "/zones/house/rollout";
    static const char other[] = "{'id': '0190b3f2-0000-7000-8000-000000000000', 'running': false}";
    static struct played_door doors[3];
    struct iso_fault fault = {.text = ""};
    char stop[96], go_on[96];
    (void)state;
    api_rig_do("POST", "/zones", "{'name': 'house'}", 201);
    api_rig_refused(ADMIN, "PATCH", path, other, 409, "done-before");
    begin_rollout(doors);
    name_rollout("false", stop, sizeof stop);
    name_rollout("true", go_on, sizeof go_on);
    api_rig_refused(WEB_ROLE_ENROLLER, "PATCH", path, stop, 403, "not-allowed");
    api_rig_refused(ADMIN, "PATCH", path, "{}", 400, "invalid-member");
    api_rig_refused(ADMIN, "PATCH", path, "{'running': false}", 400, "invalid-member");
    api_rig_refused(ADMIN, "PATCH", path, "{'id': 'x', 'running': false}", 400, "invalid-member");
    api_rig_refused(ADMIN, "PATCH", path, "{'running': 'no'}", 400, "invalid-member");
    api_rig_refused(ADMIN, "PATCH", "/zones/garden/rollout", go_on, 404, "no-such-zone");
    /* The zone has another one than its sender has seen. */
    api_rig_refused(ADMIN, "PATCH", path, other, 409, "other-rollout");
    api_rig_refused(ADMIN, "PATCH", path, go_on, 409, "done-before");
    assert_int_equal(store_rig_number(api_rig.hub, "SELECT count(*) FROM act WHERE what IN "
                                                   "('update-stop', 'update-resume')"),
                     0);
    json_t *list = api_rig_ask(ADMIN, "PATCH", path, stop, 200);
    assert_string_equal(api_rig_text(list, "doors.0.name"), "near");
    json_decref(list);
    list = get("/updates");
    assert_string_equal(api_rig_text(list, "rollouts.0.state"), "stopped");
    assert_string_equal(api_rig_text(list, "rollouts.0.why"), "by administrator");
    json_decref(list);
    store_rig_fine(played_door_ask(&doors[0], &api_rig.hub->store, &fault), &fault);
    assert_false(doors[0].is_ordered);
    json_decref(api_rig_ask(ADMIN, "PATCH", path, go_on, 200));
    store_rig_fine(played_door_ask(&doors[0], &api_rig.hub->store, &fault), &fault);
    assert_true(doors[0].is_ordered);
    /* Both are on record, with who did it. */
    assert_int_equal(store_rig_number(api_rig.hub,
                                      "SELECT count(*) FROM act WHERE actor = 'administrator' "
                                      "AND what IN ('update-stop', 'update-resume')"),
                     2);
    /* The version of a stopped one is removed. */
    json_decref(api_rig_ask(ADMIN, "PATCH", path, stop, 200));
    store_rig_fine(hub_update_remove(&api_rig.hub->store, "1.2", &fault), &fault);
    api_rig_refused(ADMIN, "PATCH", path, go_on, 404, "no-such-update");
}

#define TEST(NAME) cmocka_unit_test_setup_teardown(NAME, api_rig_setup, api_rig_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(a_lockdown_names_the_doors_that_have_not_confirmed_it),
        TEST(people_come_in_pages_and_are_found_and_changed),
        TEST(a_revoked_person_is_gone_and_the_answer_names_the_doors),
        TEST(requests_are_approved_and_rejected),
        TEST(an_enroller_chooses_no_zones),
        TEST(events_are_filtered_and_come_in_pages),
        TEST(updates_and_their_rollouts_are_shown),
        TEST(administrators_stop_a_rollout_and_let_it_go_on),
    };
    return cmocka_run_group_tests(tests, store_rig_start, store_rig_stop);
}

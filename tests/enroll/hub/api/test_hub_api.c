/* The routes of the hub's API with a real database: zones, doors, people, requests, events. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "enroll/hub/people/hub_request.h"
#include "enroll/web/account/setup_code.h"
#include "tests/enroll/hub/rigs/api_rig.h"
#include "tests/enroll/hub/rigs/played_door.h"

#define ADMIN WEB_ROLE_ADMINISTRATOR

static json_t *get(const char *path)
{
    return api_rig_ask(ADMIN, "GET", path, NULL, 200);
}

/* The newest act; the caller frees it. */
static char *last_act(void)
{
    json_t *acts = get("/acts?max=1");
    char *text = NULL;

    assert_true(asprintf(&text, "%s %s %s", api_rig_text(acts, "acts.0.actor"),
                         api_rig_text(acts, "acts.0.act"),
                         api_rig_text(acts, "acts.0.object")) > 0);
    json_decref(acts);
    return text;
}

/* Nobody waits for the record of a login, so it may come a little later. */
static void expect_act(const char *wanted)
{
    char *found = last_act();

    for (int i = 0; i < 100 && strcmp(found, wanted) != 0; i++) {
        free(found);
        found = last_act();
    }
    assert_string_equal(found, wanted);
    free(found);
}

static void the_first_account_is_made_by_a_code_and_is_on_record(void **state)
{
    struct iso_fault fault = {.text = ""};
    char code[WEB_SETUP_CODE_SIZE], body[256];
    (void)state;

    api_rig_refused(WEB_ROLE_NONE, "GET", "/status", NULL, 401, "login-required");
    store_rig_fine(web_setup_code_make(api_rig.setup_code, time(NULL), code, &fault), &fault);
    (void)snprintf(body, sizeof body,
                   "{'code': '%s', 'account': 'anna', 'password': '" API_RIG_PASSWORD "'}", code);
    json_decref(api_rig_ask(WEB_ROLE_NONE, "POST", "/setup", body, 201));
    api_rig_refused(WEB_ROLE_NONE, "POST", "/setup", body, 401, "wrong-code");
    expect_act("anna setup ");
    json_decref(api_rig_ask(WEB_ROLE_NONE, "POST", "/session",
                            "{'account': 'anna', 'password': '" API_RIG_PASSWORD "'}", 201));
    expect_act("anna login ");
    api_rig_refused(WEB_ROLE_NONE, "POST", "/session",
                    "{'account': 'anna', 'password': 'a wrong password'}", 401, "wrong-password");
    api_rig_do("POST", "/accounts",
               "{'name': 'bob', 'password': '" API_RIG_PASSWORD "', 'role': 'observer'}", 201);
    expect_act("administrator account-add bob");
}

static void each_role_may_do_what_the_table_says(void **state)
{
    (void)state;

    for (const struct web_route *route = hub_api_routes; route->method; route++) {
        char path[128];
        const char *brace = strchr(route->path, '{');
        (void)snprintf(path, sizeof path, "%.*s%s%s",
                       brace ? (int)(brace - route->path) : (int)strlen(route->path), route->path,
                       brace ? "nobody" : "", brace ? strchr(brace, '}') + 1 : "");
        for (int role = WEB_ROLE_NONE; role < (int)route->least; role++) {
            api_rig_refused((enum web_role)role, route->method, path,
                            strcmp(route->method, "GET") == 0 ? NULL : "{}",
                            role == WEB_ROLE_NONE ? 401 : 403,
                            role == WEB_ROLE_NONE ? "login-required" : "not-allowed");
        }
    }
}

static void a_zone_is_added_and_changed(void **state)
{
    (void)state;

    json_t *zone = api_rig_ask(ADMIN, "POST", "/zones", "{'name': 'house'}", 201);
    assert_string_equal(api_rig_text(zone, "name"), "house");
    assert_int_equal(api_rig_number(zone, "lease_s"), ISO_FLEET_LEASE_DEFAULT_S);
    json_decref(zone);
    expect_act("administrator zone-add house");
    api_rig_refused(ADMIN, "POST", "/zones", "{'name': 'house'}", 409, "name-in-use");
    api_rig_refused(ADMIN, "POST", "/zones", "{'name': 7}", 400, "invalid-member");
    api_rig_refused(ADMIN, "POST", "/zones", "{'name': ' x '}", 400, "invalid-value");
    zone = api_rig_ask(ADMIN, "PATCH", "/zones/house", "{'lease_s': 0, 'approve_auto': true}", 200);
    assert_int_equal(api_rig_number(zone, "lease_s"), 0);
    assert_true(json_is_true(api_rig_at(zone, "approve_auto")));
    assert_true(json_is_false(api_rig_at(zone, "local_people")));
    json_decref(zone);
    api_rig_refused(ADMIN, "PATCH", "/zones/house", "{'lease_s': -1}", 400, "invalid-member");
    api_rig_refused(ADMIN, "PATCH", "/zones/garden", "{}", 404, "no-such-zone");
    api_rig_refused(ADMIN, "POST", "/zones/house/recovery", "{}", 409, "done-before");
    api_rig_refused(ADMIN, "PUT", "/zones/house/policy", "{'document': {'doors': 3}}", 400,
                    "invalid-policy");
    json_t *policy = get("/zones/house/policy");
    assert_true(json_is_null(api_rig_at(policy, "document")));
    json_decref(policy);
    zone = api_rig_ask(ADMIN, "POST", "/zones/house/epoch", "{}", 200);
    assert_int_equal(api_rig_number(zone, "epoch"), 2);
    json_decref(zone);
}

/* Adds a door by the API, and lets the rig join with the code of its address. */
static void join(struct played_door *door, const char *name)
{
    struct iso_fault fault = {.text = ""};
    char body[160];

    *door = (struct played_door){.algorithm = 3};
    (void)crypto_sign_keypair(door->signs.public, door->signs.secret);
    (void)crypto_box_keypair(door->receives.public, door->receives.secret);
    (void)snprintf(body, sizeof body, "{'name': '%s', 'zones': ['house']}", name);
    json_t *added = api_rig_ask(ADMIN, "POST", "/doors", body, 201);
    const char *address = api_rig_text(added, "join.address");
    const char *code = strstr(address, "&code=");
    assert_int_equal(strncmp(address, "isotherm://hub.example:8444/?ca=abcd", 36), 0);
    assert_int_equal(strncmp(api_rig_text(added, "join.qr_svg"), "<svg ", 5), 0);
    assert_string_equal(api_rig_text(added, "state"), "waiting");
    assert_non_null(code);
    store_rig_fine(played_door_join_with(door, &api_rig.hub->store, code + 6, &fault), &fault);
    json_decref(added);
}

static void ask_hub(struct played_door *door)
{
    struct iso_fault fault = {.text = ""};

    store_rig_fine(played_door_ask(door, &api_rig.hub->store, &fault), &fault);
    played_door_fetch(door, &api_rig.hub->store);
    store_rig_fine(played_door_ask(door, &api_rig.hub->store, &fault), &fault);
}

static void a_lockdown_names_the_doors_that_have_not_confirmed_it(void **state)
{
    static struct played_door near, far;
    (void)state;

    api_rig_do("POST", "/zones", "{'name': 'house'}", 201);
    join(&near, "near");
    join(&far, "far");
    ask_hub(&near);
    ask_hub(&far);
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
    expect_act("administrator lockdown house");
    ask_hub(&near);
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
    join(&door, "near");
    const struct iso_fleet_id ada = store_rig_put(api_rig.hub, "Ada", &zone->place.zone, 1);
    ask_hub(&door);
    assert_non_null(played_door_person(&door, &zone->place.zone, &ada));
    json_t *answer = api_rig_ask(ADMIN, "DELETE", "/people/Ada", NULL, 200);
    assert_string_equal(api_rig_text(answer, "zones.0.unconfirmed.0.name"), "near");
    json_decref(answer);
    expect_act("administrator person-revoke Ada");
    ask_hub(&door);
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
    join(&door, "near");
    static const char *const names[] = {"Dora", "Emil"};
    for (int i = 0; i < 2; i++) {
        const struct iso_fleet_person person = store_rig_person(names[i], 3, 1, 7);
        store_rig_fine(played_door_request(&door, &api_rig.hub->store, &person, &fault), &fault);
    }
    json_t *list = api_rig_ask(WEB_ROLE_ENROLLER, "GET", "/requests", NULL, 200);
    assert_int_equal(json_array_size(api_rig_at(list, "requests")), 2);
    assert_string_equal(api_rig_text(list, "requests.0.door.name"), "near");
    json_decref(list);
    json_t *dora = api_rig_ask(WEB_ROLE_ENROLLER, "POST", "/requests/Dora/approval",
                               "{'zones': ['garden']}", 200);
    assert_string_equal(api_rig_text(dora, "zones.0.name"), "garden");
    json_decref(dora);
    expect_act("enroller request-approve Dora");
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

static void events_are_filtered_and_come_in_pages(void **state)
{
    static struct played_door door;
    struct iso_fault fault = {.text = ""};
    char path[256];
    (void)state;
    api_rig_do("POST", "/zones", "{'name': 'house'}", 201);
    join(&door, "near");
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

static void without_a_database_the_api_says_so_and_goes_on_with_it(void **state)
{
    (void)state;

    rig_postgres_down(&api_rig.hub->postgres);
    api_rig_refused(ADMIN, "GET", "/zones", NULL, 503, "no-database");
    api_rig_refused(ADMIN, "POST", "/accounts",
                    "{'name': 'bob', 'password': '" API_RIG_PASSWORD "', 'role': 'observer'}", 503,
                    "no-database");
    rig_postgres_up(&api_rig.hub->postgres);
    json_decref(get("/zones"));
}

static void send_change(struct https *client, const char *headers, const char *name)
{
    char text[1024], body[64];

    (void)snprintf(body, sizeof body, "{\"name\": \"%s\"}", name);
    (void)snprintf(
        text, sizeof text,
        "POST /api/v1/zones HTTP/1.1\r\nHost: door.test\r\nContent-Length: %zu\r\n%s\r\n%s",
        strlen(body), headers, body);
    https_send(client, text);
}

static bool is_held_up(void)
{
    return store_rig_number(api_rig.hub, "SELECT count(*) FROM pg_locks WHERE NOT granted") == 1;
}

static bool is_waiting(void)
{
    return hub_worker_waiting(api_rig.api.worker, HUB_LANE_CHANGES) == 1;
}

static void pump_until(bool (*holds)(void))
{
    const time_t end = time(NULL) + 10;

    while (!holds()) {
        assert_true(time(NULL) < end);
        https_pump(api_rig.web.event, -1);
    }
}

/* The first change is in the database already, where another transaction holds it up; the second
 * one waits behind it while its session ends. */
static void a_session_that_ends_while_its_change_waits_changes_nothing(void **state)
{
    struct https second;
    struct https_answer answer;
    struct iso_fault fault = {.text = ""};
    uint64_t id = 0;
    char headers[512];
    (void)state;

    web_rig_connect(&api_rig.web, &second);
    (void)strcpy(headers, web_rig_login(&api_rig.web, "carl", ADMIN, &id));
    store_rig_fine(hub_db_script(api_rig.hub->store.db, "BEGIN; LOCK TABLE zone", &fault), &fault);
    send_change(&api_rig.client, headers, "one");
    pump_until(is_held_up);
    send_change(&second, headers, "two");
    pump_until(is_waiting);
    web_session_end(&api_rig.web.sessions, id);
    store_rig_fine(hub_db_script(api_rig.hub->store.db, "COMMIT", &fault), &fault);
    https_read(&api_rig.client, &answer);
    assert_int_equal(answer.status, 201);
    https_answer_free(&answer);
    https_read(&second, &answer);
    assert_int_equal(answer.status, 401);
    https_answer_free(&answer);
    https_close(&second);
    assert_int_equal(store_rig_number(api_rig.hub, "SELECT count(*) FROM zone"), 1);
}

/* A look that takes long does not let a change wait. */
static void a_change_does_not_wait_for_a_look(void **state)
{
    struct iso_fault fault = {.text = ""};
    (void)state;
    const struct iso_fleet_id house = store_rig_zone(api_rig.hub, "house");
    struct https looking;
    struct https_answer answer;
    char text[768];
    (void)store_rig_put(api_rig.hub, "Ada", &house, 1);

    web_rig_connect(&api_rig.web, &looking);
    store_rig_fine(hub_db_script(api_rig.hub->store.db, "BEGIN; LOCK TABLE event", &fault), &fault);
    (void)snprintf(text, sizeof text, "GET /api/v1/events HTTP/1.1\r\nHost: door.test\r\n%s\r\n",
                   api_rig.headers[ADMIN]);
    https_send(&looking, text);
    json_decref(api_rig_ask(ADMIN, "PUT", "/lockdown", "{'on': true}", 200));
    store_rig_fine(hub_db_script(api_rig.hub->store.db, "COMMIT", &fault), &fault);
    https_read(&looking, &answer);
    assert_int_equal(answer.status, 200);
    https_answer_free(&answer);
    https_close(&looking);
}

#define TEST(NAME) cmocka_unit_test_setup_teardown(NAME, api_rig_setup, api_rig_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(the_first_account_is_made_by_a_code_and_is_on_record),
        TEST(each_role_may_do_what_the_table_says),
        TEST(a_zone_is_added_and_changed),
        TEST(a_lockdown_names_the_doors_that_have_not_confirmed_it),
        TEST(people_come_in_pages_and_are_found_and_changed),
        TEST(a_revoked_person_is_gone_and_the_answer_names_the_doors),
        TEST(requests_are_approved_and_rejected),
        TEST(events_are_filtered_and_come_in_pages),
        TEST(without_a_database_the_api_says_so_and_goes_on_with_it),
        TEST(a_session_that_ends_while_its_change_waits_changes_nothing),
        TEST(a_change_does_not_wait_for_a_look),
    };
    return cmocka_run_group_tests(tests, store_rig_start, store_rig_stop);
}

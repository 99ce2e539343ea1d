/* The routes of the hub's API with a real database: zones, doors, people, requests, events. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "enroll/web/account/setup_code.h"
#include "tests/enroll/hub/rigs/api_rig.h"

#define ADMIN WEB_ROLE_ADMINISTRATOR

static json_t *get(const char *path)
{
    return api_rig_ask(ADMIN, "GET", path, NULL, 200);
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
    api_rig_expect_act("anna setup ");
    json_decref(api_rig_ask(WEB_ROLE_NONE, "POST", "/session",
                            "{'account': 'anna', 'password': '" API_RIG_PASSWORD "'}", 201));
    api_rig_expect_act("anna login ");
    api_rig_refused(WEB_ROLE_NONE, "POST", "/session",
                    "{'account': 'anna', 'password': 'a wrong password'}", 401, "wrong-password");
    api_rig_do("POST", "/accounts",
               "{'name': 'bob', 'password': '" API_RIG_PASSWORD "', 'role': 'observer'}", 201);
    api_rig_expect_act("administrator account-add bob");
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
    api_rig_expect_act("administrator zone-add house");
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
        TEST(without_a_database_the_api_says_so_and_goes_on_with_it),
        TEST(a_session_that_ends_while_its_change_waits_changes_nothing),
        TEST(a_change_does_not_wait_for_a_look),
    };
    return cmocka_run_group_tests(tests, store_rig_start, store_rig_stop);
}

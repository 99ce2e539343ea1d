/* The API of administrators, over HTTPS: logging in, roles, and what can be seen and changed. */
#include <curl/curl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "enroll/hub/store/hub_zone.h"
#include "enroll/web/account/setup_code.h"
#include "tests/enroll/hub/rigs/served_door.h"
#include "tests/support/programs/prometheus_text.h"
#include "tests/support/scratch.h"

static CURL *curl;

/* Asks as the pages of the hub would. Returns the status; *json (NULL: not wanted) is the answer,
 * which the caller gives back. */
static long ask(const char *method, const char *path, const char *body, json_t **json)
{
    struct door_reply reply = {.bytes = calloc(1, 1)};
    struct curl_slist *headers = NULL;
    char url[256], origin[64];
    long status = 0;

    (void)snprintf(url, sizeof url, "https://127.0.0.1:%u/api/v1%s", rig.hubs[0].port, path);
    (void)snprintf(origin, sizeof origin, "Origin: https://127.0.0.1:%u", rig.hubs[0].port);
    headers = curl_slist_append(headers, "Content-Type: application/json");
    headers = curl_slist_append(headers, origin);
    (void)curl_easy_setopt(curl, CURLOPT_URL, url);
    (void)curl_easy_setopt(curl, CURLOPT_CAINFO, scratch_path(rig.folder, "ca.pem"));
    (void)curl_easy_setopt(curl, CURLOPT_COOKIEFILE, "");
    (void)curl_easy_setopt(curl, CURLOPT_HTTPHEADER, headers);
    (void)curl_easy_setopt(curl, CURLOPT_CUSTOMREQUEST, method);
    (void)curl_easy_setopt(curl, CURLOPT_POSTFIELDS, body);
    (void)curl_easy_setopt(curl, CURLOPT_HTTPGET, body ? 0L : 1L);
    (void)curl_easy_setopt(curl, CURLOPT_POST, body ? 1L : 0L);
    (void)curl_easy_setopt(curl, CURLOPT_CUSTOMREQUEST, method);
    (void)curl_easy_setopt(curl, CURLOPT_WRITEFUNCTION, door_reply_add);
    (void)curl_easy_setopt(curl, CURLOPT_WRITEDATA, &reply);
    (void)curl_easy_setopt(curl, CURLOPT_NOPROXY, "*");
    assert_int_equal(curl_easy_perform(curl), CURLE_OK);
    (void)curl_easy_getinfo(curl, CURLINFO_RESPONSE_CODE, &status);
    if (json) {
        *json = json_loads(reply.bytes, 0, NULL);
    }
    curl_slist_free_all(headers);
    free(reply.bytes);
    return status;
}

static int setup(void **state)
{
    curl = curl_easy_init();
    return served_door_setup(state);
}

static int teardown(void **state)
{
    curl_easy_cleanup(curl);
    return served_door_teardown(state);
}

/* Makes the first account and is logged in then. */
static void log_in(void)
{
    struct iso_fault fault = {.text = ""};
    char code[WEB_SETUP_CODE_SIZE], body[256];

    served_ok(web_setup_code_make(scratch_path(rig.folder, "setup.code"), time(NULL), code, &fault),
              &fault);
    (void)snprintf(body, sizeof body,
                   "{\"code\":\"%s\",\"account\":\"eva\",\"password\":\"correct horse battery\"}",
                   code);
    assert_int_equal(ask("POST", "/setup", body, NULL), 201);
    assert_int_equal(ask("POST", "/setup", body, NULL), 401); /* the code is used up */
}

static const char *text_at(const json_t *json, const char *list, size_t i, const char *member)
{
    return json_string_value(
        json_object_get(json_array_get(json_object_get(json, list), i), member));
}

/* Whether the door has confirmed its first zone. */
static const json_t *confirmed_of(const json_t *shown)
{
    return json_object_get(json_array_get(json_object_get(shown, "zones"), 0), "confirmed");
}

static void nothing_is_shown_without_a_login(void **state)
{
    static const char *const paths[] = {"/zones",    "/doors",  "/people",
                                        "/requests", "/events", "/acts"};
    (void)state;

    served_door_begin();
    assert_int_equal(ask("GET", "/session", NULL, NULL), 401);
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
        assert_int_equal(ask("GET", paths[i], NULL, NULL), 401);
    }
    assert_int_equal(ask("PUT", "/lockdown", "{\"on\":true}", NULL), 401);
    assert_int_equal(ask("POST", "/session",
                         "{\"account\":\"eva\",\"password\":\"correct horse battery\"}", NULL),
                     401);
    log_in();
    assert_int_equal(ask("GET", "/session", NULL, NULL), 200);
    assert_int_equal(ask("DELETE", "/session", NULL, NULL), 204);
    assert_int_equal(ask("GET", "/zones", NULL, NULL), 401);
    assert_int_equal(
        ask("POST", "/session", "{\"account\":\"eva\",\"password\":\"wrong horse battery\"}", NULL),
        401);
    (void)sleep(2);
    assert_int_equal(ask("POST", "/session",
                         "{\"account\":\"eva\",\"password\":\"correct horse battery\"}", NULL),
                     201);
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
        assert_int_equal(ask("GET", paths[i], NULL, NULL), 200);
    }
}

static void an_administrator_sees_doors_and_closes_them(void **state)
{
    struct iso_fleet_lease lease;
    struct iso_fault fault = {.text = ""};
    struct hub_zone zone;
    json_t *json = NULL;
    (void)state;

    served_door_begin();
    served_door_connect(&lease);
    assert_true(door_rig_ask(&door, "{\"door-state\":\"locked\"}", 7, &lease, 10));
    log_in();
    assert_int_equal(ask("GET", "/doors", NULL, &json), 200);
    assert_string_equal(text_at(json, "doors", 0, "name"), "Gate");
    const json_t *shown = json_array_get(json_object_get(json, "doors"), 0);
    assert_true(json_is_true(confirmed_of(shown)));
    assert_int_equal(json_integer_value(json_object_get(shown, "last_event")), 7);
    assert_string_equal(
        json_string_value(json_object_get(json_object_get(shown, "health"), "door-state")),
        "locked");
    json_decref(json);
    assert_int_equal(ask("PUT", "/lockdown", "{\"on\":true,\"zone\":\"Office\"}", NULL), 200);
    served_ok(hub_zone_find(&rig.store, "Office", &zone, &fault), &fault);
    assert_true(zone.lockdown);
    /* The door has not said yet that it has the change. */
    assert_int_equal(ask("GET", "/doors", NULL, &json), 200);
    shown = json_array_get(json_object_get(json, "doors"), 0);
    assert_true(json_is_false(confirmed_of(shown)));
    json_decref(json);
    assert_int_equal(ask("PUT", "/lockdown", "{\"on\":false}", NULL), 200);
    assert_int_equal(ask("PUT", "/lockdown", "{\"on\":1}", NULL), 400);
    assert_int_equal(ask("PUT", "/lockdown", "{\"on\":true,\"zone\":\"Nowhere\"}", NULL), 404);
    assert_int_equal(ask("DELETE", "/people/nobody", NULL, NULL), 404);
    assert_int_equal(ask("POST", "/requests/nobody/approval", "{}", NULL), 404);
    assert_int_equal(ask("GET", "/people?max=0", NULL, NULL), 400);
    /* What was done is recorded under the name of the account. */
    assert_int_equal(ask("GET", "/acts?max=1", NULL, &json), 200);
    assert_string_equal(text_at(json, "acts", 0, "actor"), "eva");
    json_decref(json);
}

static void home_assistant_sees_the_door_and_can_command_nothing(void **state)
{
    struct broker_client *home = calloc(1, sizeof *home);
    struct iso_fleet_lease lease;
    char topic[128], in[ISO_FLEET_TOPIC_SIZE];
    (void)state;

    served_door_begin();
    served_door_connect(&lease);
    assert_true(door_rig_ask(&door, "{\"door-state\":\"opened\"}", 0, &lease, 10));
    broker_client_begin(home, "home", rig.broker_port, scratch_path(rig.folder, "ca.pem"),
                        scratch_path(rig.broker_folder, "home-assistant.pem"),
                        scratch_path(rig.broker_folder, "home-assistant-key.pem"));
    assert_true(broker_client_connects(home));
    broker_client_subscribe(home, "homeassistant/#");
    broker_client_subscribe(home, "isotherm/#");
    (void)snprintf(topic, sizeof topic, "homeassistant/binary_sensor/isotherm-%s/contact/config",
                   door.id);
    assert_true(broker_client_wait(home, topic, 0, 20) >= 0);
    (void)snprintf(topic, sizeof topic, "isotherm/door/%s/state", door.id);
    bool is_open = false;
    for (int at = 0; !is_open; at++) {
        at = broker_client_wait(home, topic, (size_t)at, 20);
        assert_true(at >= 0);
        is_open = strstr(home->messages[at].bytes, "\"contact\":\"ON\"") != NULL;
    }
    /* It reads neither deltas nor mail of doors, and writes to no door. */
    const size_t from = door.client.n;
    broker_client_publish(home, iso_fleet_topic_in(&door.membership.door, in), "open", 4, false);
    assert_int_equal(broker_client_wait(&door.client, in, from, 1), -1);
    for (size_t i = 0; i < home->n; i++) {
        assert_null(strstr(home->messages[i].topic, "/in"));
        assert_null(strstr(home->messages[i].topic, "/out"));
        assert_null(strstr(home->messages[i].topic, "/zone/"));
    }
    broker_client_end(home);
    free(home);
}

/* Asks for the figures; returns the status, and the text, which the caller frees. */
static long scrape(const char *header, char **text)
{
    struct door_reply reply = {.bytes = calloc(1, 1)};
    struct curl_slist *headers = header ? curl_slist_append(NULL, header) : NULL;
    char url[128];
    long status = 0;

    (void)snprintf(url, sizeof url, "https://127.0.0.1:%u/metrics", rig.hubs[0].port);
    curl_easy_reset(curl);
    (void)curl_easy_setopt(curl, CURLOPT_URL, url);
    (void)curl_easy_setopt(curl, CURLOPT_CAINFO, scratch_path(rig.folder, "ca.pem"));
    (void)curl_easy_setopt(curl, CURLOPT_HTTPHEADER, headers);
    (void)curl_easy_setopt(curl, CURLOPT_WRITEFUNCTION, door_reply_add);
    (void)curl_easy_setopt(curl, CURLOPT_WRITEDATA, &reply);
    (void)curl_easy_setopt(curl, CURLOPT_NOPROXY, "*");
    assert_int_equal(curl_easy_perform(curl), CURLE_OK);
    (void)curl_easy_getinfo(curl, CURLINFO_RESPONSE_CODE, &status);
    curl_slist_free_all(headers);
    *text = reply.bytes;
    return status;
}

static void figures_are_for_programs_of_the_machine(void **state)
{
    struct iso_fleet_lease lease;
    const char *type = NULL;
    char *text = NULL;
    (void)state;

    served_door_begin();
    served_door_connect(&lease);
    assert_int_equal(scrape(NULL, &text), 200);
    (void)curl_easy_getinfo(curl, CURLINFO_CONTENT_TYPE, &type);
    assert_string_equal(type, "text/plain; version=0.0.4; charset=utf-8");
    prometheus_text_check(text);
    assert_true(prometheus_text_value(text, "isotherm_hub_leader") == 1);
    assert_true(prometheus_text_value(text, "isotherm_hub_broker_connected") == 1);
    assert_true(prometheus_text_value(text, "isotherm_hub_joins_total") == 1);
    assert_true(prometheus_text_value(text, "isotherm_hub_messages_total{kind=\"question\"}") >= 1);
    assert_true(prometheus_text_value(text, "isotherm_fleet_doors_joined") == 1);
    assert_true(prometheus_text_value(text, "isotherm_fleet_leader") == 1);
    free(text);
    /* What a proxy of the machine passes on is not from the machine. */
    assert_int_equal(scrape("X-Forwarded-For: 192.0.2.1", &text), 403);
    free(text);
    /* The file for the textfile collector has the same form. */
    for (int i = 0; !scratch_exists(rig.hubs[0].metrics); i++) {
        assert_true(i < 200);
        (void)usleep(100000);
    }
    text = scratch_read_text(rig.hubs[0].metrics);
    prometheus_text_check(text);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(nothing_is_shown_without_a_login, setup, teardown),
        cmocka_unit_test_setup_teardown(home_assistant_sees_the_door_and_can_command_nothing, setup,
                                        teardown),
        cmocka_unit_test_setup_teardown(figures_are_for_programs_of_the_machine, setup, teardown),
        cmocka_unit_test_setup_teardown(an_administrator_sees_doors_and_closes_them, setup,
                                        teardown),
    };
    return cmocka_run_group_tests(tests, NULL, hub_rig_end);
}

/* The handlers of the web server beside a real daemon: an enrolment, streams, people, the log, and
 * a daemon that is killed. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "tests/e2e/appliance.h"
#include "tests/enroll/web/rigs/handler_rig.h"

static struct rig rig;
static struct appliance *appliance;
static uint64_t session;
static struct web_exchange events; /* of that session */

typedef void handler(void *api, struct web_exchange *exchange);

/* Makes a request, expects this answer, and returns its JSON, which the caller releases. */
static json_t *ask(handler *handle, const char *part, const char *body, unsigned status)
{
    struct web_exchange exchange = rig_exchange(WEB_ROLE_ADMINISTRATOR, session, body);
    exchange.part = part;
    handle(&rig.api, &exchange);
    rig_expect(rig.event, &exchange, status, NULL);
    json_t *json = json_incref(exchange.json);
    rig_exchange_done(&exchange);
    return json;
}

static void open_events(void)
{
    events = rig_exchange(WEB_ROLE_ENROLLER, session, NULL);
    web_api_get_events(&rig.api, &events);
    assert_non_null(events.stream);
}

static void close_events(void)
{
    rig_close(&events);
    rig_exchange_done(&events);
}

static bool is_idle(void *context)
{
    (void)context;
    return !web_enrolment_is_busy(rig.api.enrolment);
}

/* Waits for the end of the enrolment, and returns it if it has this result. */
static json_t *end_of_enrolment(const char *result)
{
    rig_wait(rig.event, is_idle, NULL, "the end of the enrolment");
    json_t *enrolment = ask(web_api_get_enrolment, NULL, NULL, 200);
    assert_string_equal(json_string_value(json_object_get(enrolment, "result")), result);
    return enrolment;
}

static bool has_received(void *context)
{
    return ((const struct web_stream *)context)->n_received > 2;
}

static int setup(void **state)
{
    if (appliance_setup(state)) {
        return -1;
    }
    appliance = *state;
    if (appliance) {
        assert_true(sd_event_new(&rig.event) >= 0);
        rig_begin(&rig, appliance->bus.address);
        session = rig_session(&rig);
    }
    return 0;
}

static int teardown(void **state)
{
    if (appliance) {
        rig_end(&rig);
        sd_event_unref(rig.event);
    }
    return appliance_teardown(state);
}

static void a_person_is_enrolled_and_seen_meanwhile(void **state)
{
    (void)state;
    struct web_exchange outline = rig_exchange(WEB_ROLE_OBSERVER, session, NULL);
    struct web_exchange relief = rig_exchange(WEB_ROLE_ENROLLER, session, NULL);
    open_events();
    web_api_get_outline(&rig.api, &outline);
    json_decref(ask(web_api_begin_enrolment, NULL,
                    "{'person': 'p01', 'consent': true, 'poses': false}", 201));
    web_api_get_relief(&rig.api, &relief);
    rig_expect(rig.event, &relief, 200, NULL);
    appliance_show(appliance, "p01-enrol");
    json_t *enrolment = end_of_enrolment("completed");
    appliance_show(appliance, NULL);
    assert_true(json_array_size(json_object_get(enrolment, "captures")) > 0);
    assert_int_equal(json_integer_value(json_object_get(enrolment, "stage")),
                     json_integer_value(json_object_get(enrolment, "stages")));
    json_decref(enrolment);
    assert_true(has_received(relief.stream));
    assert_true(has_received(outline.stream));
    assert_true(relief.stream->ended);
    rig_expect_text(rig.event, events.stream, "\"state\":\"ended\"");
    rig_close(&relief);
    rig_close(&outline);
    rig_exchange_done(&relief);
    rig_exchange_done(&outline);
    close_events();
}

static void a_known_face_is_a_duplicate(void **state)
{
    (void)state;
    open_events();
    json_decref(ask(web_api_begin_enrolment, NULL,
                    "{'person': 'double', 'consent': true, 'poses': false}", 201));
    appliance_show(appliance, "p01-enrol");
    json_t *enrolment = end_of_enrolment("duplicate");
    appliance_show(appliance, NULL);
    assert_string_equal(json_string_value(json_object_get(enrolment, "known_as")), "p01");
    json_decref(enrolment);
    close_events();
}

static const char *mode(void)
{
    return json_string_value(json_object_get(web_feed_status(rig.api.feed), "mode"));
}

static bool is_watching(void *context)
{
    (void)context;
    return mode() && strcmp(mode(), "watch") == 0;
}

static void the_door_is_watched_again_after_each_end(void **state)
{
    static const char body[] = "{'person': 'p02', 'consent': true}";
    (void)state;
    open_events();
    json_decref(ask(web_api_begin_enrolment, NULL, body, 201));
    json_decref(ask(web_api_end_enrolment, NULL, NULL, 204));
    json_decref(end_of_enrolment("stopped"));
    rig_wait(rig.event, is_watching, NULL, "the daemon watches the door");
    json_decref(ask(web_api_begin_enrolment, NULL, body, 201));
    close_events();
    json_decref(end_of_enrolment("left"));
    rig_run(rig.event, 1500);
    assert_string_equal(mode(), "watch");
    /* Another client has the camera. */
    open_events();
    json_decref(ask(web_api_begin_enrolment, NULL, body, 201));
    appliance_expect(appliance_run(appliance, "enroll p02", NULL), 4);
    json_decref(ask(web_api_end_enrolment, NULL, NULL, 204));
    close_events();
}

/* ---- people ---- */

/* When a person was seen last; -1: there is no such person. */
static int64_t seen(const char *name)
{
    json_t *list = ask(web_api_list_people, NULL, NULL, 200);
    const json_t *person;
    int64_t found = -1;
    size_t i;
    json_array_foreach(json_object_get(list, "people"), i, person)
    {
        if (strcmp(json_string_value(json_object_get(person, "name")), name) == 0) {
            found = json_integer_value(json_object_get(person, "last_seen_s"));
        }
    }
    json_decref(list);
    return found;
}

static bool is_seen(void *name)
{
    return seen(name) > 0;
}

static void last_seen_follows_a_person_through_the_log(void **state)
{
    const int64_t before_s = (int64_t)time(NULL);
    (void)state;
    assert_int_equal(seen("p01"), 0);
    appliance_expect(appliance_visit(appliance, (const char *const[]){"p01-v1", NULL}), 0);
    rig_wait(rig.event, is_seen, (void *)"p01", "the visit");
    const int64_t seen_s = seen("p01");
    assert_true(seen_s >= before_s);
    json_t *person = ask(web_api_change_person, "p01", "{'name': 'Ada', 'valid_from_s': 1000}",
                         200);
    assert_string_equal(json_string_value(json_object_get(person, "name")), "Ada");
    assert_int_equal(json_integer_value(json_object_get(person, "valid_from_s")), 1000);
    assert_int_equal(json_integer_value(json_object_get(person, "last_seen_s")), seen_s);
    json_decref(person);
    appliance_expect(appliance_run(appliance, "rename Ada eve", NULL), 0); /* another client */
    rig_wait(rig.event, is_seen, (void *)"eve", "the renaming by another client");
    assert_in_range(seen("eve"), seen_s - 1, seen_s + 1); /* by the log, or by the signal */
    json_decref(ask(web_api_change_person, "nobody", "{'name': 'x'}", 404));
    json_decref(ask(web_api_remove_person, "nobody", NULL, 404));
    json_decref(ask(web_api_remove_person, "EVE", NULL, 204));
    assert_int_equal(seen("eve"), -1);
}

/* ---- the log ---- */

/* The number of the first record "act" whose note begins with a word; 0: there is none. */
static int64_t act(const json_t *records, const char *word)
{
    const json_t *record;
    size_t i;
    json_array_foreach(records, i, record)
    {
        const char *note = json_string_value(json_object_get(record, "note"));
        if (strcmp(json_string_value(json_object_get(record, "event")), "act") == 0 && note &&
            strncmp(note, word, strlen(word)) == 0) {
            assert_non_null(strstr(note, "asked by ada of user "));
            return json_integer_value(json_object_get(record, "sequence"));
        }
    }
    return 0;
}

static void the_log_has_every_act_in_its_order(void **state)
{
    (void)state;
    json_t *log = ask(web_api_read_log, NULL, NULL, 200);
    const json_t *records = json_object_get(log, "records");
    assert_true(act(records, "consent,") > 0);
    assert_int_equal(act(records, "enroll,"), act(records, "consent,") + 1);
    assert_true(act(records, "rename,") > 0);
    assert_true(act(records, "validity,") > act(records, "rename,"));
    assert_true(act(records, "remove,") > act(records, "validity,"));
    json_decref(log);
    json_t *result = ask(web_api_verify_log, NULL, NULL, 200);
    assert_true(json_is_true(json_object_get(result, "sound")));
    assert_int_equal(json_integer_value(json_object_get(result, "first")), 1);
    json_decref(result);
}

static void lockdown_is_seen_by_all(void **state)
{
    (void)state;
    open_events();
    json_decref(ask(web_api_set_lockdown, NULL, "{'on': true}", 204));
    rig_expect_text(rig.event, events.stream, "\"lockdown\":true");
    json_decref(ask(web_api_set_lockdown, NULL, "{'on': false}", 204));
    json_decref(ask(web_api_clear_lockout, NULL, NULL, 204));
    close_events();
}

static void an_enrolment_ends_with_a_daemon_that_is_killed(void **state)
{
    static const char body[] = "{'person': 'p02', 'consent': true, 'poses': false}";
    (void)state;
    open_events();
    json_decref(ask(web_api_begin_enrolment, NULL, body, 201));
    appliance_end_daemon(appliance, SIGKILL);
    json_decref(end_of_enrolment("no-daemon"));
    json_decref(ask(web_api_begin_enrolment, NULL, body, 503));
    appliance_start_daemon(appliance);
    rig_wait_daemon(&rig, true);
    json_decref(ask(web_api_begin_enrolment, NULL, body, 201));
    appliance_show(appliance, "p02-enrol");
    json_decref(end_of_enrolment("completed"));
    appliance_show(appliance, NULL);
    close_events();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_person_is_enrolled_and_seen_meanwhile),
        cmocka_unit_test(a_known_face_is_a_duplicate),
        cmocka_unit_test(the_door_is_watched_again_after_each_end),
        cmocka_unit_test(last_seen_follows_a_person_through_the_log),
        cmocka_unit_test(the_log_has_every_act_in_its_order),
        cmocka_unit_test(lockdown_is_seen_by_all),
        cmocka_unit_test(an_enrolment_ends_with_a_daemon_that_is_killed),
    };
    if (!appliance_find()) {
        return TEST_SKIPPED;
    }
    return cmocka_run_group_tests(tests, setup, teardown);
}

/* The enrolment of a person. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <string.h>

#include "firmware/contract/contract.h"
#include "tests/enroll/web/rigs/story_rig.h"

/* ---- stories ---- */

static void an_enrolment_is_followed_to_its_end(void **state)
{
    struct rig *rig = *state;
    struct rig_story story;
    if (!rig) {
        skip();
    }
    rig_story_begin(&story, rig);
    struct web_exchange observer = rig_exchange(WEB_ROLE_OBSERVER, 99, NULL);
    web_api_get_events(&rig->api, &observer);
    rig_send_step(rig, "frontal", "begun", 1, 0.0);
    rig_send_status(rig, "enroll-retry-too-far", false, 0, 0.0, "");
    rig_expect_text(rig->event, story.events.stream, "\"hint\":\"too-far\"");
    rig_send_status(rig, "enroll-stage-passed", false, 1, 0.75, "");
    rig_send_status(rig, "enroll-stage-misfit", false, 1, 0.5, "");
    rig_send_step(rig, "frontal", "passed", 1, 0.0);
    rig_send_step(rig, "left", "turn", 2, -7.5);
    rig_send_status(rig, "enroll-completed", true, 12, 0.9, "");
    json_t *enrolment = rig_story_end(&story, "completed");
    json_t *wanted = json_pack(
        "{s:s, s:s, s:s, s:b, s:b, s:s, s:s, s:i, s:i, s:[f], s:[{s:s, s:s, s:f}, {s:s, s:s, "
        "s:f}]}",
        "state", "ended", "person", "Bo", "account", "ada", "own", 1, "poses", 1, "hint", "",
        "result", "completed", "stage", 12, "stages", 12, "captures", 0.75, "steps", "pose",
        "frontal", "state", "passed", "turn_deg", 0.0, "pose", "left", "state", "turn", "turn_deg",
        -7.5);
    assert_non_null(wanted);
    assert_true(json_equal(enrolment, wanted));
    assert_true(rig_has_released(rig));
    assert_null(strstr(observer.stream->text, "enrolment"));
    json_decref(wanted);
    json_decref(enrolment);
    rig_close(&observer);
    rig_exchange_done(&observer);
}

/* Who opens the events during an enrolment need not wait for the next change of it. */
static void events_that_begin_later_begin_with_the_enrolment(void **state)
{
    struct rig *rig = *state;
    struct rig_story story;
    if (!rig) {
        skip();
    }
    struct web_exchange before = rig_exchange(WEB_ROLE_ENROLLER, rig_session(rig), NULL);
    web_api_get_events(&rig->api, &before);
    assert_non_null(strstr(before.stream->text, "event: status"));
    assert_null(strstr(before.stream->text, "event: enrolment"));
    rig_close(&before);
    rig_exchange_done(&before);

    rig_story_begin(&story, rig);
    struct web_exchange later = rig_exchange(WEB_ROLE_ENROLLER, rig_session(rig), NULL);
    web_api_get_events(&rig->api, &later);
    assert_non_null(strstr(later.stream->text, "event: enrolment\ndata: {\"state\":\"running\","
                                               "\"person\":\"Bo\""));
    rig_close(&later);
    rig_exchange_done(&later);
    struct web_exchange observer = rig_exchange(WEB_ROLE_OBSERVER, rig_session(rig), NULL);
    web_api_get_events(&rig->api, &observer);
    assert_non_null(strstr(observer.stream->text, "event: status"));
    assert_null(strstr(observer.stream->text, "event: enrolment"));
    rig_close(&observer);
    rig_exchange_done(&observer);
    rig_send_status(rig, "enroll-completed", true, 4, 1.0, "");
    json_decref(rig_story_end(&story, "completed"));
}

static void a_duplicate_and_a_full_disk_are_explained(void **state)
{
    struct rig *rig = *state;
    struct rig_story story;
    if (!rig) {
        skip();
    }
    rig_story_begin(&story, rig);
    rig_strange_signal(rig->bus.address, rig->service.claimant, ISO_CONTRACT_ENROLL_STATUS,
                       "sbuuds", "enroll-completed", 1, 12U, 12U, 0.9, "");
    rig_send_status(rig, "enroll-duplicate", true, 4, 0.9, "Boris");
    json_t *enrolment = rig_story_end(&story, "duplicate"); /* not what the stranger said */
    assert_string_equal(json_string_value(json_object_get(enrolment, "known_as")), "Boris");
    json_decref(enrolment);
    rig->service.trace[0] = '\0';
    rig_story_begin(&story, rig);
    rig_send_status(rig, "enroll-not-stored", true, 4, 0.9, "the disk is full");
    enrolment = rig_story_end(&story, "not-stored");
    assert_string_equal(json_string_value(json_object_get(enrolment, "detail")),
                        "the disk is full");
    json_decref(enrolment);
}

static void only_the_session_that_began_it_stops_it(void **state)
{
    struct rig *rig = *state;
    struct rig_story story;
    if (!rig) {
        skip();
    }
    rig_story_begin(&story, rig);
    struct web_exchange other = rig_exchange(WEB_ROLE_ADMINISTRATOR, story.session + 1, NULL);
    web_api_end_enrolment(&rig->api, &other);
    rig_expect(rig->event, &other, 409, "no-enrolment");
    rig_exchange_done(&other);
    other = rig_exchange(WEB_ROLE_ADMINISTRATOR, story.session + 1, RIG_REQUEST);
    web_api_begin_enrolment(&rig->api, &other);
    rig_expect(rig->event, &other, 409, "enrolment-running");
    rig_exchange_done(&other);
    struct web_exchange own = rig_exchange(WEB_ROLE_ENROLLER, story.session, NULL);
    web_api_end_enrolment(&rig->api, &own);
    rig_expect(rig->event, &own, 204, NULL);
    assert_true(rig_has_released(rig)); /* before the answer */
    rig_exchange_done(&own);
    json_decref(rig_story_end(&story, "stopped"));
    own = rig_exchange(WEB_ROLE_ENROLLER, story.session, NULL);
    web_api_end_enrolment(&rig->api, &own);
    rig_expect(rig->event, &own, 409, "no-enrolment");
    rig_exchange_done(&own);
}

static void an_enrolment_that_nobody_watches_ends(void **state)
{
    struct rig *rig = *state;
    struct rig_story story;
    if (!rig) {
        skip();
    }
    rig_story_begin(&story, rig);
    rig_run(rig->event, 2 * RIG_LEFT_MS);
    assert_true(web_enrolment_is_busy(rig->api.enrolment)); /* it is watched by its events */
    struct web_exchange relief = rig_exchange(WEB_ROLE_ENROLLER, story.session, NULL);
    web_api_get_relief(&rig->api, &relief);
    rig_expect(rig->event, &relief, 200, NULL);
    rig_close(&story.events);
    rig_run(rig->event, 2 * RIG_LEFT_MS);
    assert_true(web_enrolment_is_busy(rig->api.enrolment)); /* and by its relief */
    rig_close(&relief);
    rig_exchange_done(&relief);
    json_decref(rig_story_end(&story, "left"));
    assert_true(rig_has_released(rig));
}

static void an_enrolment_ends_with_its_session(void **state)
{
    struct rig *rig = *state;
    struct rig_story story;
    if (!rig) {
        skip();
    }
    rig_story_begin(&story, rig);
    web_session_end(&rig->sessions, story.session);
    json_decref(rig_story_end(&story, "left"));
    assert_true(rig_has_released(rig));
}

static void an_enrolment_ends_with_the_daemon(void **state)
{
    struct rig *rig = *state;
    struct rig_story story;
    if (!rig) {
        skip();
    }
    rig_story_begin(&story, rig);
    rig_service_stop(&rig->service);
    json_decref(rig_story_end(&story, "no-daemon"));
    rig_service_start(&rig->service, rig->event, rig->bus.address);
    rig_wait_daemon(rig, true);
    rig->service.trace[0] = '\0';
    rig_story_begin(&story, rig);
    rig->service.mode = "watch"; /* it has lost the claim without a word */
    json_decref(rig_story_end(&story, "failed"));
}

/* Release that fails is tried again: otherwise nobody would watch the door. */
static void the_camera_is_given_back_even_if_that_fails_at_first(void **state)
{
    struct rig *rig = *state;
    struct rig_story story;
    if (!rig) {
        skip();
    }
    rig_story_begin(&story, rig);
    rig->service.fail_method = ISO_CONTRACT_RELEASE;
    rig->service.fail_error = ISO_CONTRACT_ERROR_TOO_MANY_CALLS;
    rig->service.fail_times = 2;
    rig_send_status(rig, "enroll-timed-out", true, 4, 0.9, "");
    json_decref(rig_story_end(&story, "timed-out"));
    assert_string_equal(rig->service.trace + sizeof RIG_CALLS - 1, "Release;Release;Release;");
    assert_string_equal(rig->service.claimant, "");
}

/* ---- the beginning ---- */

static void each_step_that_is_refused_ends_the_beginning(void **state)
{
    static const struct {
        const char *method, *error;
        unsigned status;
        const char *code, *calls;
    } steps[] = {
        {"RecordAct", ISO_CONTRACT_ERROR_STORAGE, 507, "storage", "RecordAct ada consent Bo;"},
        {"Claim", ISO_CONTRACT_ERROR_ALREADY_IN_USE, 409, "camera-in-use",
         "RecordAct ada consent Bo;RecordAct ada enroll Bo;Claim;"},
        {"WatchRelief", ISO_CONTRACT_ERROR_STORAGE, 507, "storage",
         "RecordAct ada consent Bo;RecordAct ada enroll Bo;Claim;WatchRelief;Release;"},
        {"EnrollStart", ISO_CONTRACT_ERROR_GALLERY_FULL, 409, "gallery-full", NULL},
        {"EnrollStart", ISO_CONTRACT_ERROR_LOCKED_OUT, 423, "locked-out", NULL},
        {"EnrollStart", ISO_CONTRACT_ERROR_INVALID_ARGUMENT, 400, "invalid-limits", NULL},
    };
    struct rig *rig = *state;
    char usual[512];
    if (!rig) {
        skip();
    }
    (void)snprintf(usual, sizeof usual, "%sRelease;", RIG_CALLS);
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
        struct web_exchange exchange = rig_exchange(WEB_ROLE_ENROLLER, 1, RIG_REQUEST);
        rig->service.trace[0] = '\0';
        rig->service.fail_method = steps[i].method;
        rig->service.fail_error = steps[i].error;
        web_api_begin_enrolment(&rig->api, &exchange);
        rig_expect(rig->event, &exchange, steps[i].status, steps[i].code);
        assert_string_equal(rig->service.trace, steps[i].calls ? steps[i].calls : usual);
        assert_true(rig_is_idle(rig));
        assert_string_equal(rig->service.claimant, "");
        rig_exchange_done(&exchange);
    }
}

static void nobody_is_enrolled_without_consent_and_name(void **state)
{
    static const struct {
        const char *body, *code;
    } wrong[] = {
        {"{'person': 'Bo'}", "consent-required"},
        {"{'person': 'Bo', 'consent': false}", "consent-required"},
        {"{'person': 'Bo', 'consent': 'yes'}", "invalid-member"},
        {"{'consent': true}", "invalid-name"},
        {"{'person': '', 'consent': true}", "invalid-name"},
        {"{'person': 7, 'consent': true}", "invalid-name"},
        {"{'person': 'Bo', 'consent': true, 'valid_until_s': 5}", "invalid-limits"},
        {"{'person': 'Bo', 'consent': true, 'valid_from_s': 1.5}", "invalid-limits"},
        {"{'person': 'Bo', 'consent': true, 'poses': 1}", "invalid-member"},
    };
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        struct web_exchange exchange = rig_exchange(WEB_ROLE_ENROLLER, 1, wrong[i].body);
        web_api_begin_enrolment(&rig->api, &exchange);
        rig_expect(rig->event, &exchange, 400, wrong[i].code);
        rig_exchange_done(&exchange);
    }
    rig_run(rig->event, 50);
    assert_string_equal(rig->service.trace, "");
}

static void the_options_reach_the_daemon(void **state)
{
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    struct web_exchange exchange = rig_exchange(
        WEB_ROLE_ENROLLER, 1,
        "{'person': 'Bo', 'consent': true, 'poses': false, 'allow_duplicate': true, "
        "'valid_from_s': 0, 'valid_until_s': 9000000000}");
    web_api_begin_enrolment(&rig->api, &exchange);
    rig_expect(rig->event, &exchange, 201, NULL);
    assert_non_null(strstr(rig->service.trace, "EnrollStart Bo poses=0 allow-duplicate=1 "
                                               "valid-from=0 valid-until=9000000000;"));
    rig_exchange_done(&exchange);
}

#define RIG_TEST(name) cmocka_unit_test_setup_teardown(name, rig_setup, rig_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        RIG_TEST(an_enrolment_is_followed_to_its_end),
        RIG_TEST(events_that_begin_later_begin_with_the_enrolment),
        RIG_TEST(a_duplicate_and_a_full_disk_are_explained),
        RIG_TEST(only_the_session_that_began_it_stops_it),
        RIG_TEST(an_enrolment_that_nobody_watches_ends),
        RIG_TEST(an_enrolment_ends_with_its_session),
        RIG_TEST(an_enrolment_ends_with_the_daemon),
        RIG_TEST(the_camera_is_given_back_even_if_that_fails_at_first),
        RIG_TEST(each_step_that_is_refused_ends_the_beginning),
        RIG_TEST(nobody_is_enrolled_without_consent_and_name),
        RIG_TEST(the_options_reach_the_daemon),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* The enrolment of a person, and its relief. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <zlib.h>

#include "enroll/web/daemon/relief.h"
#include "firmware/contract/contract.h"
#include "firmware/contract/stream_record.h"
#include "tests/enroll/web/rig_api.h"

static const char request[] = "{'person': 'Bo', 'consent': true}";
static const char calls[] = "RecordAct ada consent Bo;RecordAct ada enroll Bo;Claim;WatchRelief;"
                            "EnrollStart Bo poses=1 allow-duplicate=0;";

/* ---- helpers ---- */

/* An enrolment that runs, and the session that began it with its stream of events. */
struct story {
    struct rig *rig;
    uint64_t session;
    struct web_exchange events;
};

static void begin(struct story *story, struct rig *rig)
{
    *story = (struct story){.rig = rig, .session = rig_session(rig)};
    story->events = rig_exchange(WEB_ROLE_ENROLLER, story->session, NULL);
    web_api_get_events(&rig->api, &story->events);
    struct web_exchange exchange = rig_exchange(WEB_ROLE_ENROLLER, story->session, request);
    web_api_begin_enrolment(&rig->api, &exchange);
    rig_expect(rig->event, &exchange, 201, NULL);
    assert_string_equal(json_string_value(json_object_get(exchange.json, "state")), "running");
    assert_true(json_is_true(json_object_get(exchange.json, "own")));
    rig_exchange_done(&exchange);
    assert_string_equal(rig->service.trace, calls);
}

static bool is_idle(void *context)
{
    return !web_enrolment_is_busy(((struct rig *)context)->api.enrolment);
}

/* Waits until the enrolment has ended with this result. */
static json_t *end(struct story *story, const char *result)
{
    struct rig *rig = story->rig;
    struct web_exchange exchange = rig_exchange(WEB_ROLE_ENROLLER, story->session, NULL);
    rig_wait(rig->event, is_idle, rig, "the end of the enrolment");
    web_api_get_enrolment(&rig->api, &exchange);
    rig_expect(rig->event, &exchange, 200, NULL);
    json_t *enrolment = json_incref(exchange.json);
    rig_exchange_done(&exchange);
    assert_string_equal(json_string_value(json_object_get(enrolment, "state")), "ended");
    assert_string_equal(json_string_value(json_object_get(enrolment, "result")), result);
    if (story->events.stream) {
        rig_expect_text(rig->event, story->events.stream, "\"state\":\"ended\"");
        rig_close(&story->events);
    }
    rig_exchange_done(&story->events);
    return enrolment;
}

/* Whether the last call of the daemon was Release. */
static bool has_released(const struct rig *rig)
{
    const char *trace = rig->service.trace;
    return strlen(trace) >= 8 && strcmp(trace + strlen(trace) - 8, "Release;") == 0;
}

static void send_status(struct rig *rig, const char *result, bool done, unsigned stage,
                        double quality, const char *person)
{
    rig_service_signal(&rig->service, true, ISO_CONTRACT_ENROLL_STATUS, "sbuuds", result, (int)done,
                       stage, 12U, quality, person);
}

static void send_step(struct rig *rig, const char *pose, const char *state, unsigned step,
                      double turn_deg)
{
    rig_service_signal(&rig->service, true, ISO_CONTRACT_ENROLL_STEP, "ssuud", pose, state, step,
                       5U, turn_deg);
}

/* ---- stories ---- */

static void an_enrolment_is_followed_to_its_end(void **state)
{
    struct rig *rig = *state;
    struct story story;
    if (!rig) {
        skip();
    }
    begin(&story, rig);
    struct web_exchange observer = rig_exchange(WEB_ROLE_OBSERVER, 99, NULL);
    web_api_get_events(&rig->api, &observer);
    send_step(rig, "frontal", "begun", 1, 0.0);
    send_status(rig, "enroll-retry-too-far", false, 0, 0.0, "");
    rig_expect_text(rig->event, story.events.stream, "\"hint\":\"too-far\"");
    send_status(rig, "enroll-stage-passed", false, 1, 0.75, "");
    send_status(rig, "enroll-stage-misfit", false, 1, 0.5, "");
    send_step(rig, "frontal", "passed", 1, 0.0);
    send_step(rig, "left", "turn", 2, -7.5);
    send_status(rig, "enroll-completed", true, 12, 0.9, "");
    json_t *enrolment = end(&story, "completed");
    json_t *wanted = json_pack(
        "{s:s, s:s, s:s, s:b, s:b, s:s, s:s, s:i, s:i, s:[f], s:[{s:s, s:s, s:f}, {s:s, s:s, "
        "s:f}]}",
        "state", "ended", "person", "Bo", "account", "ada", "own", 1, "poses", 1, "hint", "",
        "result", "completed", "stage", 12, "stages", 12, "captures", 0.75, "steps", "pose",
        "frontal", "state", "passed", "turn_deg", 0.0, "pose", "left", "state", "turn", "turn_deg",
        -7.5);
    assert_non_null(wanted);
    assert_true(json_equal(enrolment, wanted));
    assert_true(has_released(rig));
    assert_null(strstr(observer.stream->text, "enrolment"));
    json_decref(wanted);
    json_decref(enrolment);
    rig_close(&observer);
    rig_exchange_done(&observer);
}

static void a_duplicate_and_a_full_disk_are_explained(void **state)
{
    struct rig *rig = *state;
    struct story story;
    if (!rig) {
        skip();
    }
    begin(&story, rig);
    rig_strange_signal(rig->bus.address, rig->service.claimant, ISO_CONTRACT_ENROLL_STATUS,
                       "sbuuds", "enroll-completed", 1, 12U, 12U, 0.9, "");
    send_status(rig, "enroll-duplicate", true, 4, 0.9, "Boris");
    json_t *enrolment = end(&story, "duplicate"); /* not what the stranger said */
    assert_string_equal(json_string_value(json_object_get(enrolment, "known_as")), "Boris");
    json_decref(enrolment);
    rig->service.trace[0] = '\0';
    begin(&story, rig);
    send_status(rig, "enroll-not-stored", true, 4, 0.9, "the disk is full");
    enrolment = end(&story, "not-stored");
    assert_string_equal(json_string_value(json_object_get(enrolment, "detail")),
                        "the disk is full");
    json_decref(enrolment);
}

static void only_the_session_that_began_it_stops_it(void **state)
{
    struct rig *rig = *state;
    struct story story;
    if (!rig) {
        skip();
    }
    begin(&story, rig);
    struct web_exchange other = rig_exchange(WEB_ROLE_ADMINISTRATOR, story.session + 1, NULL);
    web_api_end_enrolment(&rig->api, &other);
    rig_expect(rig->event, &other, 409, "no-enrolment");
    rig_exchange_done(&other);
    other = rig_exchange(WEB_ROLE_ADMINISTRATOR, story.session + 1, request);
    web_api_begin_enrolment(&rig->api, &other);
    rig_expect(rig->event, &other, 409, "enrolment-running");
    rig_exchange_done(&other);
    struct web_exchange own = rig_exchange(WEB_ROLE_ENROLLER, story.session, NULL);
    web_api_end_enrolment(&rig->api, &own);
    rig_expect(rig->event, &own, 204, NULL);
    assert_true(has_released(rig)); /* before the answer */
    rig_exchange_done(&own);
    json_decref(end(&story, "stopped"));
    own = rig_exchange(WEB_ROLE_ENROLLER, story.session, NULL);
    web_api_end_enrolment(&rig->api, &own);
    rig_expect(rig->event, &own, 409, "no-enrolment");
    rig_exchange_done(&own);
}

static void an_enrolment_that_nobody_watches_ends(void **state)
{
    struct rig *rig = *state;
    struct story story;
    if (!rig) {
        skip();
    }
    begin(&story, rig);
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
    json_decref(end(&story, "left"));
    assert_true(has_released(rig));
}

static void an_enrolment_ends_with_its_session(void **state)
{
    struct rig *rig = *state;
    struct story story;
    if (!rig) {
        skip();
    }
    begin(&story, rig);
    web_session_end(&rig->sessions, story.session);
    json_decref(end(&story, "left"));
    assert_true(has_released(rig));
}

static void an_enrolment_ends_with_the_daemon(void **state)
{
    struct rig *rig = *state;
    struct story story;
    if (!rig) {
        skip();
    }
    begin(&story, rig);
    rig_service_stop(&rig->service);
    json_decref(end(&story, "no-daemon"));
    rig_service_start(&rig->service, rig->event, rig->bus.address);
    rig_wait_daemon(rig, true);
    rig->service.trace[0] = '\0';
    begin(&story, rig);
    rig->service.mode = "watch"; /* it has lost the claim without a word */
    json_decref(end(&story, "failed"));
}

/* Release that fails is tried again: otherwise nobody would watch the door. */
static void the_camera_is_given_back_even_if_that_fails_at_first(void **state)
{
    struct rig *rig = *state;
    struct story story;
    if (!rig) {
        skip();
    }
    begin(&story, rig);
    rig->service.fail_method = ISO_CONTRACT_RELEASE;
    rig->service.fail_error = ISO_CONTRACT_ERROR_TOO_MANY_CALLS;
    rig->service.fail_times = 2;
    send_status(rig, "enroll-timed-out", true, 4, 0.9, "");
    json_decref(end(&story, "timed-out"));
    assert_string_equal(rig->service.trace + sizeof calls - 1, "Release;Release;Release;");
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
    (void)snprintf(usual, sizeof usual, "%sRelease;", calls);
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
        struct web_exchange exchange = rig_exchange(WEB_ROLE_ENROLLER, 1, request);
        rig->service.trace[0] = '\0';
        rig->service.fail_method = steps[i].method;
        rig->service.fail_error = steps[i].error;
        web_api_begin_enrolment(&rig->api, &exchange);
        rig_expect(rig->event, &exchange, steps[i].status, steps[i].code);
        assert_string_equal(rig->service.trace, steps[i].calls ? steps[i].calls : usual);
        assert_true(is_idle(rig));
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

/* ---- the relief ---- */

enum { COLUMNS = 5, ROWS = 3, DATA_AT = 4 + 20 };

static size_t write_relief(uint8_t *bytes)
{
    static struct iso_relief_record record;
    record = (struct iso_relief_record){
        .head = {.sequence = 9, .t_ns = 77}, .columns = COLUMNS, .rows = ROWS};
    for (int i = 0; i < COLUMNS * ROWS; i++) {
        record.depth_mm[i] = (uint16_t)(i % 4 == 3 ? 0 : 600 + 31 * i);
    }
    return iso_relief_record_write(&record, bytes);
}

/* Undoes what openapi.json describes, and compares with the record. */
static void expect_relief(const struct web_chunk *chunk, const uint8_t *record, size_t size)
{
    uint8_t deltas[2 * COLUMNS * ROWS + 8];
    uLongf n = sizeof deltas;
    const size_t length = chunk->bytes[0] | (size_t)chunk->bytes[1] << 8;
    assert_int_equal(length + 4, chunk->size);
    assert_memory_equal(chunk->bytes + 4, record, 20);
    assert_int_equal(uncompress(deltas, &n, chunk->bytes + DATA_AT, chunk->size - DATA_AT), Z_OK);
    assert_int_equal(n, size - 20);
    for (size_t i = 0; i < n / 2; i++) {
        const unsigned left = i % COLUMNS ? (unsigned)(record[18 + 2 * i] | record[19 + 2 * i] << 8)
                                          : 0;
        const unsigned depth = left + (unsigned)(deltas[2 * i] | deltas[2 * i + 1] << 8);
        assert_int_equal(depth & 0xffff, record[20 + 2 * i] | record[20 + 2 * i + 1] << 8);
    }
}

static bool has_received(void *context)
{
    return ((const struct web_stream *)context)->n_received > 0;
}

static void the_relief_is_for_the_session_that_began_it(void **state)
{
    static uint8_t bytes[ISO_STREAM_BYTES_MAX];
    const size_t size = write_relief(bytes);
    struct rig *rig = *state;
    struct story story;
    if (!rig) {
        skip();
    }
    struct web_exchange early = rig_exchange(WEB_ROLE_ENROLLER, 1, NULL);
    web_api_get_relief(&rig->api, &early);
    rig_expect(rig->event, &early, 409, "no-enrolment");
    rig_exchange_done(&early);
    begin(&story, rig);
    struct web_exchange own = rig_exchange(WEB_ROLE_ENROLLER, story.session, NULL);
    struct web_exchange other = rig_exchange(WEB_ROLE_ADMINISTRATOR, story.session + 1, NULL);
    web_api_get_relief(&rig->api, &own);
    web_api_get_relief(&rig->api, &other);
    rig_expect(rig->event, &other, 409, "no-enrolment");
    rig_exchange_done(&other);
    assert_int_equal(send(rig->service.relief_fd, bytes, size - 1, 0), size - 1); /* damaged */
    assert_int_equal(send(rig->service.relief_fd, bytes, size, 0), size);
    rig_wait(rig->event, has_received, own.stream, "a relief");
    assert_int_equal(own.stream->n_received, 1);
    expect_relief(own.stream->last, bytes, size);

    send_status(rig, "enroll-completed", true, 12, 0.9, "");
    json_decref(end(&story, "completed"));
    assert_true(own.stream->ended); /* it ends with the enrolment */
    rig_close(&own);
    rig_exchange_done(&own);
}

/* A stream that ends late sees nothing of the next person. */
static void a_relief_of_before_sees_nothing_of_the_next_person(void **state)
{
    static uint8_t bytes[ISO_STREAM_BYTES_MAX];
    const size_t size = write_relief(bytes);
    struct rig *rig = *state;
    struct story story;
    if (!rig) {
        skip();
    }
    begin(&story, rig);
    struct web_exchange before = rig_exchange(WEB_ROLE_ENROLLER, story.session, NULL);
    web_api_get_relief(&rig->api, &before);
    rig_expect(rig->event, &before, 200, NULL);
    send_status(rig, "enroll-completed", true, 12, 0.9, "");
    json_decref(end(&story, "completed"));
    before.stream->ended = false; /* as if the server had not noticed yet */
    rig->service.trace[0] = '\0';
    begin(&story, rig);
    struct web_exchange own = rig_exchange(WEB_ROLE_ENROLLER, story.session, NULL);
    web_api_get_relief(&rig->api, &own);
    assert_int_equal(send(rig->service.relief_fd, bytes, size, 0), size);
    rig_wait(rig->event, has_received, own.stream, "a relief");
    assert_int_equal(before.stream->n_received, 0);
    rig_close(&before);
    rig_close(&own);
    rig_exchange_done(&before);
    rig_exchange_done(&own);
    rig_close(&story.events);
    rig_exchange_done(&story.events);
}

#define RIG_TEST(name) cmocka_unit_test_setup_teardown(name, rig_setup, rig_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        RIG_TEST(an_enrolment_is_followed_to_its_end),
        RIG_TEST(a_duplicate_and_a_full_disk_are_explained),
        RIG_TEST(only_the_session_that_began_it_stops_it),
        RIG_TEST(an_enrolment_that_nobody_watches_ends),
        RIG_TEST(an_enrolment_ends_with_its_session),
        RIG_TEST(an_enrolment_ends_with_the_daemon),
        RIG_TEST(the_camera_is_given_back_even_if_that_fails_at_first),
        RIG_TEST(each_step_that_is_refused_ends_the_beginning),
        RIG_TEST(nobody_is_enrolled_without_consent_and_name),
        RIG_TEST(the_options_reach_the_daemon),
        RIG_TEST(the_relief_is_for_the_session_that_began_it),
        RIG_TEST(a_relief_of_before_sees_nothing_of_the_next_person),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#include "tests/enroll/web/rigs/handler_rig.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdlib.h>
#include <string.h>
#include <time.h>

void rig_begin(struct rig *rig, const char *address)
{
    struct web_api *api = &rig->api;
    const struct web_enrolment_setup setup = {.left_ms = RIG_LEFT_MS};
    struct web_enrolment_setup enrolment = setup;
    strcpy(rig->certificate.fingerprint, "AB:CD");
    rig->certificate.ends_s = (int64_t)time(NULL) + INT64_C(400) * 86400;
    api->login.sessions = &rig->sessions;
    api->certificate = &rig->certificate;
    assert_int_equal(web_daemon_new(rig->event, address, &api->daemon), 0);
    assert_int_equal(web_feed_new(rig->event, api->daemon, &api->feed), 0);
    assert_int_equal(web_last_seen_new(rig->event, api->daemon, &api->last_seen), 0);
    enrolment.event = rig->event;
    enrolment.daemon = api->daemon;
    enrolment.feed = api->feed;
    enrolment.sessions = api->login.sessions;
    assert_int_equal(web_enrolment_new(&enrolment, &api->enrolment), 0);
    if (rig->sessions.last_id == 0) {
        assert_int_equal(rig_session(rig), RIG_SESSION);
    }
    rig_wait_daemon(rig, true);
}

void rig_end(struct rig *rig)
{
    web_daemon_close(rig->api.daemon);
    web_enrolment_free(rig->api.enrolment);
    web_last_seen_free(rig->api.last_seen);
    web_feed_free(rig->api.feed);
    web_daemon_free(rig->api.daemon);
}

int rig_setup(void **state)
{
    struct rig *rig = calloc(1, sizeof *rig);
    *state = NULL;
    if (!rig || !private_bus_start(&rig->bus)) {
        free(rig);
        return 0;
    }
    assert_true(sd_event_new(&rig->event) >= 0);
    rig_service_start(&rig->service, rig->event, rig->bus.address);
    rig_begin(rig, rig->bus.address);
    *state = rig;
    return 0;
}

int rig_teardown(void **state)
{
    struct rig *rig = *state;
    if (rig) {
        rig_end(rig);
        rig_service_stop(&rig->service);
        sd_event_unref(rig->event);
        private_bus_stop(&rig->bus);
        free(rig);
    }
    return 0;
}

uint64_t rig_session(struct rig *rig)
{
    struct web_account account = {.name = "ada", .role = WEB_ROLE_ADMINISTRATOR};
    char token[WEB_SESSION_TOKEN_SIZE];
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return web_session_begin(&rig->sessions, &account,
                             (int64_t)now.tv_sec * 1000000000 + now.tv_nsec, token);
}

static bool is_there(void *context)
{
    return web_daemon_is_there(context);
}

static bool is_gone(void *context)
{
    return !web_daemon_is_there(context);
}

void rig_wait_daemon(struct rig *rig, bool there)
{
    rig_wait(rig->event, there ? is_there : is_gone, rig->api.daemon,
             there ? "the daemon" : "the end of the daemon");
}

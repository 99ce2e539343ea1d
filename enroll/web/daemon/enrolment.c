#include "enroll/web/daemon/enrolment.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/cli/client/state.h"
#include "enroll/web/daemon/enrolment_call.h"
#include "enroll/web/daemon/enrolment_report.h"
#include "enroll/web/daemon/relief.h"
#include "enroll/web/daemon/stream_set.h"
#include "enroll/web/http/now.h"
#include "firmware/contract/contract.h"

static const uint64_t look_us = 250000; /* how often it is looked whether somebody watches */
static const int64_t release_again_ns = 1000000000;

enum step { IDLE, CONSENT, ACT, CLAIM, WATCH, START, RUNNING, RELEASE };

struct web_enrolment {
    sd_event *event;
    struct web_daemon *daemon;
    struct web_feed *feed;
    const struct web_sessions *sessions;
    struct web_daemon_listener listener;
    sd_event_source *tick;
    int64_t left_ns;

    enum step step;
    struct web_enrolment_request request;
    struct web_enrolment_report report;
    struct web_relief *relief;
    struct web_stream_set viewers;
    int64_t watched_ns;  /* when somebody watched it last */
    int64_t released_ns; /* when Release was sent last */
    bool is_releasing;   /* its answer is awaited */

    void (*on_begun)(void *context, const sd_bus_error *error); /* NULL: not owed */
    void *begun_context;
    sd_bus_error refusal;            /* with which on_begun will be called */
    void (*on_ended)(void *context); /* NULL: not owed */
    void *ended_context;
};

static void tell(const struct web_enrolment *enrolment)
{
    web_feed_send(enrolment->feed, "enrolment", web__enrolment_report_json(&enrolment->report),
                  WEB_ROLE_ENROLLER);
}

static void call_begun(struct web_enrolment *enrolment, const sd_bus_error *error)
{
    void (*on_begun)(void *context, const sd_bus_error *error) = enrolment->on_begun;
    enrolment->on_begun = NULL;
    if (on_begun) {
        on_begun(enrolment->begun_context, error);
    }
}

static void call_ended(struct web_enrolment *enrolment)
{
    void (*on_ended)(void *context) = enrolment->on_ended;
    enrolment->on_ended = NULL;
    if (on_ended) {
        on_ended(enrolment->ended_context);
    }
}

/* ---- the end ---- */

static void become_idle(struct web_enrolment *enrolment)
{
    sd_bus_error refusal = enrolment->refusal;
    enrolment->refusal = SD_BUS_ERROR_NULL;
    enrolment->step = IDLE;
    (void)sd_event_source_set_enabled(enrolment->tick, SD_EVENT_OFF);
    call_begun(enrolment, &refusal);
    call_ended(enrolment);
    sd_bus_error_free(&refusal);
}

static void on_released(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    struct web_enrolment *enrolment = context;
    (void)reply;
    enrolment->is_releasing = false;
    if (!error || web__enrolment_is_released(error)) {
        become_idle(enrolment);
    }
}

static void look_again(struct web_enrolment *enrolment)
{
    (void)sd_event_source_set_time_relative(enrolment->tick, look_us);
    (void)sd_event_source_set_enabled(enrolment->tick, SD_EVENT_ONESHOT);
}

static void send_release(struct web_enrolment *enrolment)
{
    enrolment->step = RELEASE;
    look_again(enrolment);
    enrolment->is_releasing = true;
    enrolment->released_ns = web_now_ns();
    web_daemon_send(enrolment->daemon, web_daemon_message(enrolment->daemon, ISO_CONTRACT_RELEASE),
                    0, on_released, enrolment);
}

static void close_relief(struct web_enrolment *enrolment)
{
    web_relief_free(enrolment->relief);
    enrolment->relief = NULL;
    web_stream_set_end(&enrolment->viewers);
}

/* Ends an enrolment that runs. `result` is NULL if the daemon has reported it. */
static void end_run(struct web_enrolment *enrolment, const char *result)
{
    struct web_enrolment_report *report = &enrolment->report;
    if (result) {
        report->hint[0] = '\0';
        (void)snprintf(report->result, sizeof report->result, "%s", result);
    }
    report->state = WEB_ENROLMENT_ENDED;
    close_relief(enrolment);
    send_release(enrolment);
    tell(enrolment);
}

/* ---- the beginning ---- */

/* The daemon has refused a step. */
static void refuse(struct web_enrolment *enrolment, const sd_bus_error *error)
{
    const bool in_use = sd_bus_error_has_name(error, ISO_CONTRACT_ERROR_ALREADY_IN_USE);
    const bool may_have_claim = enrolment->step > CLAIM || (enrolment->step == CLAIM && !in_use);
    (void)sd_bus_error_copy(&enrolment->refusal, error);
    enrolment->report = (struct web_enrolment_report){.state = WEB_ENROLMENT_NONE};
    close_relief(enrolment);
    if (may_have_claim) {
        send_release(enrolment);
    } else {
        become_idle(enrolment);
    }
}

static void on_step(void *context, sd_bus_message *reply, const sd_bus_error *error);

static void send_step(struct web_enrolment *enrolment, enum step step, const char *method)
{
    enrolment->step = step;
    web_daemon_send(enrolment->daemon, web_daemon_message(enrolment->daemon, method), 0, on_step,
                    enrolment);
}

static void start(struct web_enrolment *enrolment)
{
    const struct web_enrolment_request *request = &enrolment->request;
    sd_bus_message *call = web_daemon_message(enrolment->daemon, ISO_CONTRACT_ENROLL_START);
    if (call && web__enrolment_append(call, request) < 0) {
        call = sd_bus_message_unref(call);
    }
    /* The daemon reports the first step before it answers. */
    enrolment->report = (struct web_enrolment_report){.poses = request->poses};
    (void)snprintf(enrolment->report.person, sizeof enrolment->report.person, "%s",
                   request->person);
    (void)snprintf(enrolment->report.account, sizeof enrolment->report.account, "%s",
                   request->account);
    enrolment->step = START;
    web_daemon_send(enrolment->daemon, call, 0, on_step, enrolment);
}

static void on_relief(void *context, struct web_chunk *chunk)
{
    struct web_enrolment *enrolment = context;
    web_stream_set_send(&enrolment->viewers, WEB_ROLE_ENROLLER, chunk);
}

/* Takes over the stream of the reply of WatchRelief. */
static int take_relief(struct web_enrolment *enrolment, sd_bus_message *reply)
{
    int fd = -1;
    int r = sd_bus_message_read(reply, "h", &fd);
    if (r >= 0) {
        fd = fcntl(fd, F_DUPFD_CLOEXEC, 0);
        r = fd < 0 ? -errno
                   : web_relief_new(enrolment->event, fd, on_relief, enrolment, &enrolment->relief);
    }
    return r;
}

static void run(struct web_enrolment *enrolment)
{
    enrolment->step = RUNNING;
    enrolment->report.state = WEB_ENROLMENT_RUNNING;
    enrolment->watched_ns = web_now_ns();
    look_again(enrolment);
    call_begun(enrolment, NULL);
    tell(enrolment);
}

/* The daemon has answered a step of the beginning. */
static void on_step(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    struct web_enrolment *enrolment = context;
    const struct web_enrolment_request *request = &enrolment->request;
    sd_bus_error own = SD_BUS_ERROR_NULL;
    if (!error && enrolment->step == WATCH) {
        const int r = take_relief(enrolment, reply);
        error = r < 0 ? (sd_bus_error_set_errno(&own, r), &own) : NULL;
    }
    if (error) {
        refuse(enrolment, error);
    } else if (enrolment->step == CONSENT) {
        enrolment->step = ACT;
        web_daemon_record(enrolment->daemon, request->account, "enroll", request->person, on_step,
                          enrolment);
    } else if (enrolment->step == ACT) {
        send_step(enrolment, CLAIM, ISO_CONTRACT_CLAIM);
    } else if (enrolment->step == CLAIM) {
        send_step(enrolment, WATCH, ISO_CONTRACT_WATCH_RELIEF);
    } else if (enrolment->step == WATCH) {
        start(enrolment);
    } else {
        run(enrolment);
    }
    sd_bus_error_free(&own);
}

void web_enrolment_begin(struct web_enrolment *enrolment,
                         const struct web_enrolment_request *request,
                         void (*on_begun)(void *context, const sd_bus_error *error), void *context)
{
    enrolment->request = *request;
    enrolment->on_begun = on_begun;
    enrolment->begun_context = context;
    enrolment->step = CONSENT;
    web_daemon_record(enrolment->daemon, request->account, "consent", request->person, on_step,
                      enrolment);
}

/* ---- while it runs ---- */

static bool is_watched(const struct web_enrolment *enrolment)
{
    const uint64_t session = enrolment->request.session;
    return web_stream_set_of(&enrolment->viewers, session) > 0 ||
           web_feed_viewers(enrolment->feed, session) > 0;
}

static int on_tick(sd_event_source *source, uint64_t usec, void *context)
{
    struct web_enrolment *enrolment = context;
    const int64_t t_ns = web_now_ns();
    (void)source;
    (void)usec;
    if (enrolment->step == IDLE) {
        return 0;
    }
    if (is_watched(enrolment)) {
        enrolment->watched_ns = t_ns;
    }
    if (enrolment->step == RUNNING &&
        (t_ns - enrolment->watched_ns >= enrolment->left_ns ||
         !web_session_goes_on(enrolment->sessions, enrolment->request.session, t_ns))) {
        end_run(enrolment, "left");
    } else if (enrolment->step == RELEASE && !enrolment->is_releasing &&
               t_ns - enrolment->released_ns >= release_again_ns) {
        send_release(enrolment);
    }
    look_again(enrolment);
    return 0;
}

/* A daemon that does not answer, or that does something else, does not enrol anybody. Its signals
 * and answers come in the order in which it sent them, so the end was not reported. */
static void on_status(void *context, const json_t *status)
{
    struct web_enrolment *enrolment = context;
    const char *mode = cli_state_text(status, "mode");
    if (enrolment->step == RUNNING && !status) {
        end_run(enrolment, "no-daemon");
    } else if (enrolment->step == RUNNING && mode && strcmp(mode, "enroll") != 0) {
        end_run(enrolment, ISO_CONTRACT_RESULT_FAILED);
    }
}

static void on_signal(void *context, const char *member, sd_bus_message *signal)
{
    struct web_enrolment *enrolment = context;
    bool done = false;
    if (enrolment->step != START && enrolment->step != RUNNING) {
        return;
    }
    if (strcmp(member, ISO_CONTRACT_ENROLL_STEP) == 0) {
        web__enrolment_read_step(&enrolment->report, signal);
    } else if (strcmp(member, ISO_CONTRACT_ENROLL_STATUS) == 0) {
        done = web__enrolment_read_status(&enrolment->report, signal);
    } else {
        return;
    }
    if (enrolment->step == RUNNING && done) {
        end_run(enrolment, NULL);
    } else if (enrolment->step == RUNNING) {
        tell(enrolment);
    }
}

/* ---- for the handlers ---- */

bool web_enrolment_is_busy(const struct web_enrolment *enrolment)
{
    return enrolment->step != IDLE;
}

bool web_enrolment_is_of(const struct web_enrolment *enrolment, uint64_t session)
{
    return enrolment->step == RUNNING && enrolment->request.session == session && session != 0;
}

bool web_enrolment_end(struct web_enrolment *enrolment, uint64_t session,
                       void (*on_ended)(void *context), void *context)
{
    if (!web_enrolment_is_of(enrolment, session)) {
        return false;
    }
    enrolment->on_ended = on_ended;
    enrolment->ended_context = context;
    end_run(enrolment, "stopped");
    return true;
}

bool web_enrolment_is_known(const struct web_enrolment *enrolment)
{
    return enrolment->report.state != WEB_ENROLMENT_NONE;
}

json_t *web_enrolment_json(const struct web_enrolment *enrolment, uint64_t session)
{
    json_t *object = web__enrolment_report_json(&enrolment->report);
    if (session != 0 && enrolment->report.state != WEB_ENROLMENT_NONE) {
        (void)json_object_set_new(object, "own",
                                  json_boolean(session == enrolment->request.session));
    }
    return object;
}

static void on_viewer_gone(void *context, struct web_stream *stream)
{
    struct web_enrolment *enrolment = context;
    web_stream_set_remove(&enrolment->viewers, stream);
}

void web_enrolment_open_relief(struct web_enrolment *enrolment, struct web_exchange *exchange)
{
    (void)web_stream_set_open(&enrolment->viewers, exchange, "application/octet-stream",
                              WEB_STREAM_FRAMES, on_viewer_gone, enrolment);
}

int web_enrolment_new(const struct web_enrolment_setup *setup, struct web_enrolment **out)
{
    struct web_enrolment *enrolment = calloc(1, sizeof *enrolment);
    if (!enrolment) {
        return -ENOMEM;
    }
    int r = sd_event_add_time_relative(setup->event, &enrolment->tick, CLOCK_MONOTONIC, 0, 0,
                                       on_tick, enrolment);
    if (r >= 0) {
        r = sd_event_source_set_enabled(enrolment->tick, SD_EVENT_OFF);
    }
    if (r < 0) {
        sd_event_source_disable_unref(enrolment->tick);
        free(enrolment);
        return r;
    }
    enrolment->event = sd_event_ref(setup->event);
    enrolment->daemon = setup->daemon;
    enrolment->feed = setup->feed;
    enrolment->sessions = setup->sessions;
    enrolment->left_ns = (int64_t)(setup->left_ms ? setup->left_ms : WEB_ENROLMENT_LEFT_MS) *
                         1000000;
    enrolment->listener = (struct web_daemon_listener){
        .on_status = on_status, .on_signal = on_signal, .context = enrolment};
    web_daemon_listen(setup->daemon, &enrolment->listener);
    *out = enrolment;
    return 0;
}

void web_enrolment_free(struct web_enrolment *enrolment)
{
    if (enrolment) {
        web_daemon_unlisten(enrolment->daemon, &enrolment->listener);
        sd_event_source_disable_unref(enrolment->tick);
        web_relief_free(enrolment->relief);
        sd_event_unref(enrolment->event);
        sd_bus_error_free(&enrolment->refusal);
        free(enrolment);
    }
}

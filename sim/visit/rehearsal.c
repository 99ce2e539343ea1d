#include "sim/visit/rehearsal.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/contract.h"
#include "firmware/parts.h"
#include "sim/progress.h"
#include "sim/virtual_clock.h"
#include "sim/visit/slot.h"
#include "sim/visit/trace.h"
#include "sim/visit/visit_picture.h"

/* Time passes in steps of at most this, as it would for a daemon. */
static const int64_t step_ns = 20 * ISO_NS_PER_MS;
/* Longest enrolment and longest visit, by the virtual clock. */
static const int64_t limit_ns = 30 * ISO_NS_PER_S;

/* One run, and what the appliance has told of the action or visit that goes on. */
struct rehearsal {
    const struct sim_rehearsal_options *options;
    struct iso_fault *fault;
    struct sim_virtual_clock clock;
    struct iso_config config;
    char slot[ISO_CONFIG_TEXT_SIZE];
    struct iso_parts *parts;
    struct iso_appliance_parts lent;
    struct iso_appliance *appliance;

    bool enrol_done;
    char enrol_result[64];
    struct sim_door_verdict verdict; /* the first of the visit */
    bool unlocked;                   /* at any time of the visit */
    struct sim_trace *trace;         /* of the visit to be drawn; NULL: none is */
};

static void on_enroll(void *context, const char *result, bool done, unsigned stage, unsigned stages,
                      double quality, const char *person)
{
    struct rehearsal *r = context;
    (void)stage;
    (void)stages;
    (void)quality;
    (void)person;
    r->enrol_done = r->enrol_done || done;
    (void)snprintf(r->enrol_result, sizeof r->enrol_result, "%s", result);
}

static void on_recognition(void *context, enum iso_appliance_mode mode, const char *result,
                           bool done, const char *person, double score, double threshold)
{
    (void)context;
    (void)mode;
    (void)result;
    (void)done;
    (void)person;
    (void)score;
    (void)threshold;
}

static void on_visit(void *context, const struct iso_visit *visit)
{
    struct rehearsal *r = context;
    if (r->verdict.given) {
        return;
    }
    if (r->trace) {
        sim_trace_decide(r->trace, r->clock.now_ns);
    }
    r->verdict = (struct sim_door_verdict){
        .given = true,
        .allow = visit->verdict.allow,
        .score = visit->verdict.score,
        .threshold = visit->threshold,
        .frames = (uint32_t)visit->verdict.frames,
        .latency_us = visit->latency_ns / 1000,
    };
    (void)snprintf(r->verdict.person, sizeof r->verdict.person, "%s", visit->person);
    (void)snprintf(r->verdict.reason, sizeof r->verdict.reason, "%s",
                   iso_reason_name(visit->verdict.reason));
    (void)snprintf(r->verdict.door, sizeof r->verdict.door, "%s",
                   iso_door_answer_name(visit->door));
}

static void on_hint(void *context, enum iso_capture capture)
{
    (void)context;
    (void)capture;
}

static void on_view(void *context, const struct iso_view *view)
{
    (void)context;
    (void)view;
}

static void on_picture(void *context, const struct iso_frame *frame)
{
    (void)context;
    (void)frame;
}

static bool is_locked(const char *state)
{
    return strcmp(state, iso_door_state_name(ISO_DOOR_LOCKED)) == 0;
}

static void on_door(void *context, const char *state, const char *cause)
{
    struct rehearsal *r = context;
    (void)cause;
    r->unlocked = r->unlocked || !is_locked(state);
}

static void on_claim_lost(void *context)
{
    (void)context;
}

static void on_message(void *context, int priority, const char *text)
{
    (void)context;
    (void)priority;
    (void)text;
}

static int make_config(struct rehearsal *r)
{
    const struct sim_rehearsal_options *o = r->options;
    struct iso_config *c = &r->config;
    const struct {
        char *to;
        const char *directory, *name;
    } paths[] = {
        {r->slot, o->state, "/slot"},
        {c->sensor.path, o->state, "/slot"},
        {c->gallery.path, o->state, "/gallery.db"},
        {c->log.path, o->state, "/audit.log"},
        {c->model.head, o->model, ""},
        {c->model.metric, o->metric, ""},
    };
    *c = iso_config_default();
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
        int n = snprintf(paths[i].to, ISO_CONFIG_TEXT_SIZE, "%s%s", paths[i].directory,
                         paths[i].name);
        if (n < 0 || n >= ISO_CONFIG_TEXT_SIZE) {
            return iso_fault_set(r->fault, -ENAMETOOLONG, "%s: path too long", paths[i].directory);
        }
    }
    c->log.journal = false;  /* it is no visit of today's */
    c->lockout.failures = 0; /* a corpus has more strangers in a row than a door */
    c->lockout.attacks = 0;
    (void)snprintf(c->sensor.pace, sizeof c->sensor.pace, "realtime");
    c->decision.threshold = isnan(o->threshold) ? c->decision.threshold : o->threshold;
    return 0;
}

static int open_appliance(struct rehearsal *r)
{
    const struct iso_appliance_events events = {
        .enroll_status = on_enroll,
        .recognition_status = on_recognition,
        .visit = on_visit,
        .hint = on_hint,
        .view = on_view,
        .picture = on_picture,
        .door_changed = on_door,
        .claim_lost = on_claim_lost,
        .message = on_message,
        .context = r,
    };
    const struct iso_times times = sim_virtual_clock_times(&r->clock);
    int error = make_config(r);
    error = error ? error : iso_parts_open(&r->config, &times, &r->parts, r->fault);
    if (error) {
        return error;
    }
    r->lent = iso_parts_lend(r->parts, &events);
    if (r->trace) {
        r->lent.pipeline = sim_trace_pipeline(r->trace, &r->lent.pipeline);
    }
    error = iso_appliance_new(&r->lent, &r->appliance);
    if (error) {
        return iso_fault_set(r->fault, error, "%s", strerror(-error));
    }
    return iso_appliance_start(r->appliance, r->fault);
}

/* What is due now is done, then time passes until something else is. */
static void step(struct rehearsal *r)
{
    const int64_t wake_ns = iso_appliance_step(r->appliance);
    const int64_t next_ns = r->clock.now_ns + step_ns;
    sim_virtual_clock_advance(&r->clock, wake_ns < next_ns ? wake_ns : next_ns);
}

/* Nobody is there for longer than the appliance remembers a visitor, and the door locks again. */
static int clear(struct rehearsal *r)
{
    const int64_t start_ns = r->clock.now_ns;
    const int64_t quiet_ns = 2 * (int64_t)r->config.decision.gap_ms * ISO_NS_PER_MS;
    int error = sim_slot_clear(r->slot, r->fault);
    while (!error) {
        const int64_t spent_ns = r->clock.now_ns - start_ns;
        if (spent_ns >= quiet_ns && iso_appliance_status(r->appliance).door == ISO_DOOR_LOCKED) {
            return 0;
        }
        if (spent_ns >= limit_ns) {
            return iso_fault_set(r->fault, -ETIMEDOUT, "the door does not lock again");
        }
        step(r);
    }
    return error;
}

static int enrol(struct rehearsal *r, const struct sim_corpus_row *row)
{
    const struct iso_enroll_request request = {.person = row->subject,
                                               .allow_duplicate = r->options->allow_duplicate};
    const int64_t end_ns = r->clock.now_ns + limit_ns;
    int error = iso_appliance_claim(r->appliance);
    r->enrol_done = false;
    error = error ? error : iso_appliance_enroll(r->appliance, &request, r->fault);
    error = error ? error : sim_slot_point(r->slot, r->options->corpus, row->recording, r->fault);
    while (!error && !r->enrol_done && r->clock.now_ns < end_ns) {
        step(r);
    }
    iso_appliance_release(r->appliance);
    error = error ? error : clear(r);
    if (!error && strcmp(r->enrol_result, ISO_CONTRACT_RESULT_COMPLETED) != 0) {
        error = iso_fault_set(r->fault, -ENOMSG, "%s: %s is not enrolled: %s", row->recording,
                              row->subject, r->enrol_result);
    }
    return error;
}

/* Until a verdict, or until all frames were seen and nothing came of them. */
static int visit(struct rehearsal *r, const struct sim_corpus_row *row, struct sim_visit *out)
{
    const int64_t end_ns = r->clock.now_ns + limit_ns;
    const uint64_t last_frame = iso_appliance_status(r->appliance).frames + row->count;
    r->verdict = (struct sim_door_verdict){0};
    r->unlocked = false;
    int error = sim_slot_point(r->slot, r->options->corpus, row->recording, r->fault);
    while (!error && !r->verdict.given && r->clock.now_ns < end_ns &&
           iso_appliance_status(r->appliance).frames < last_frame) {
        step(r);
    }
    error = error ? error : clear(r); /* in which a late verdict still counts */
    *out = (struct sim_visit){.row = row, .verdict = r->verdict, .unlocked = r->unlocked};
    return error;
}

/* A visit that is drawn. */
static int visit_and_draw(struct rehearsal *r, const struct sim_corpus_row *row,
                          struct sim_visit *out)
{
    sim_trace_begin(r->trace, r->clock.now_ns);
    const int error = visit(r, row, out);
    sim_trace_end(r->trace, r->lent.door_io, r->clock.now_ns);
    return error ? error
                 : sim_visit_picture(r->trace, out, r->lent.gallery, r->options->picture, r->fault);
}

/* Whether a row is a visit that is to be played. */
static bool is_wanted(const struct rehearsal *r, const struct sim_corpus_row *row)
{
    return row->role != SIM_ROLE_GALLERY &&
           (!r->options->visit || strcmp(row->recording, r->options->visit) == 0);
}

static int play(struct rehearsal *r, const struct sim_corpus *corpus, sim_visit_listener *listener,
                void *context, struct sim_visit *visits, size_t *n_visits)
{
    size_t count = 0;
    int error = 0;
    const bool shown = sim_progress_begin("playing recordings to the appliance", corpus->n_rows);
    for (size_t i = 0; !error && i < corpus->n_rows; i++) {
        if (corpus->rows[i].role == SIM_ROLE_GALLERY) {
            error = enrol(r, &corpus->rows[i]);
            sim_progress_step(1);
        }
    }
    for (size_t i = 0; !error && i < corpus->n_rows; i++) {
        const struct sim_corpus_row *row = &corpus->rows[i];
        if (!is_wanted(r, row) || sim_visit_was_played(visits, count, row->recording)) {
            continue;
        }
        error = r->trace ? visit_and_draw(r, row, &visits[count]) : visit(r, row, &visits[count]);
        if (!error) {
            sim_progress_pause();
            listener(&visits[count++], context);
            sim_progress_resume();
        }
        sim_progress_step(1);
    }
    sim_progress_end(shown);
    if (!error && r->options->visit && count == 0) {
        error = iso_fault_set(r->fault, -ENOENT, "the corpus has no visit '%s'", r->options->visit);
    }
    *n_visits = error ? *n_visits : count;
    return error;
}

int sim_rehearse(const struct sim_rehearsal_options *options, const struct sim_corpus *corpus,
                 sim_visit_listener *listener, void *context, struct sim_visit *visits,
                 size_t *n_visits, struct iso_fault *fault)
{
    struct sim_trace trace = {.on = false};
    struct rehearsal r = {.options = options,
                          .fault = fault,
                          .clock = sim_virtual_clock_start(),
                          .trace = options->picture ? &trace : NULL};
    int error = open_appliance(&r);
    error = error ? error : play(&r, corpus, listener, context, visits, n_visits);
    if (r.appliance) {
        iso_appliance_stop(r.appliance);
    }
    iso_appliance_free(r.appliance);
    iso_parts_close(r.parts);
    sim_trace_done(&trace);
    return error;
}

#include "sim/door/rehearsal_door.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

static void on_enroll(void *context, const char *result, bool done, unsigned stage, unsigned stages,
                      double quality, const char *person)
{
    struct sim_rehearsal_door *door = context;
    (void)stage;
    (void)stages;
    (void)quality;
    (void)person;
    door->enrol_done = door->enrol_done || done;
    (void)snprintf(door->enrol_result, sizeof door->enrol_result, "%s", result);
}

static void on_enroll_step(void *context, const char *pose, const char *state, unsigned step,
                           unsigned steps, double turn_deg)
{
    (void)context;
    (void)pose;
    (void)state;
    (void)step;
    (void)steps;
    (void)turn_deg;
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
    struct sim_rehearsal_door *door = context;
    if (door->verdict.given) {
        return;
    }
    if (door->trace) {
        sim_trace_decide(door->trace, door->clock->now_ns);
    }
    door->verdict = (struct sim_door_verdict){
        .given = true,
        .allow = visit->verdict.allow,
        .score = visit->verdict.score,
        .threshold = visit->threshold,
        .frames = (uint32_t)visit->verdict.frames,
        .latency_us = visit->latency_ns / 1000,
    };
    (void)snprintf(door->verdict.person, sizeof door->verdict.person, "%s", visit->person);
    (void)snprintf(door->verdict.reason, sizeof door->verdict.reason, "%s",
                   iso_reason_name(visit->verdict.reason));
    (void)snprintf(door->verdict.door, sizeof door->verdict.door, "%s",
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
    struct sim_rehearsal_door *door = context;
    (void)cause;
    door->unlocked = door->unlocked || !is_locked(state);
}

static void on_claim_lost(void *context)
{
    (void)context;
}

static void on_wanted(void *context, const char *what)
{
    (void)context;
    (void)what;
}

static void on_message(void *context, int priority, const char *text)
{
    (void)context;
    (void)priority;
    (void)text;
}

static int make_config(const struct sim_rehearsal_setup *setup, struct iso_config *out,
                       struct iso_fault *fault)
{
    struct iso_config *c = out;
    const struct {
        char *to;
        const char *directory, *name;
    } paths[] = {
        {c->gallery.path, setup->state, "/gallery.db"},
        {c->log.path, setup->state, "/audit.log"},
        {c->model.head, setup->model, ""},
        {c->model.metric, setup->metric, ""},
    };
    *c = iso_config_default();
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
        const int n = snprintf(paths[i].to, ISO_CONFIG_TEXT_SIZE, "%s%s", paths[i].directory,
                               paths[i].name);
        if (n < 0 || n >= ISO_CONFIG_TEXT_SIZE) {
            return iso_fault_set(fault, -ENAMETOOLONG, "%s: path too long", paths[i].directory);
        }
    }
    c->log.journal = false;  /* the journal is for real visits */
    c->lockout.failures = 0; /* a corpus has more strangers one after another than a real door */
    c->lockout.attacks = 0;
    c->decision.level = setup->level;
    c->match.adapt = setup->adapt;
    c->decision.threshold = isnan(setup->threshold) ? c->decision.threshold : setup->threshold;
    return iso_config_set_sensor_option(c, "path", setup->slot, fault);
}

static const struct iso_appliance_events all_events = {
    .enroll_status = on_enroll,
    .enroll_step = on_enroll_step,
    .recognition_status = on_recognition,
    .visit = on_visit,
    .wanted = on_wanted,
    .hint = on_hint,
    .view = on_view,
    .picture = on_picture,
    .door_changed = on_door,
    .claim_lost = on_claim_lost,
    .message = on_message,
};

int sim_rehearsal_door_open(struct sim_rehearsal_door *door,
                            const struct sim_rehearsal_setup *setup,
                            struct sim_virtual_clock *clock, struct sim_shared_extraction *shared,
                            struct sim_trace *trace, struct iso_fault *fault)
{
    struct iso_appliance_events events = all_events;
    events.context = door;
    door->clock = clock;
    door->trace = trace;
    const struct iso_times times = sim_virtual_clock_times(clock);
    int error = make_config(setup, &door->config, fault);
    if (!error) {
        error = iso_components_open(&door->config, &times, false, &door->parts, fault);
    }
    if (error) {
        return error;
    }
    door->lent = iso_components_lend(door->parts, &events);
    door->lent.pipeline = sim_shared_pipeline_join(shared, &door->lent.pipeline, &door->pipeline);
    if (trace) {
        door->lent.pipeline = sim_trace_pipeline(trace, &door->lent.pipeline);
    }
    error = iso_appliance_new(&door->lent, &door->appliance);
    if (error) {
        return iso_fault_set(fault, error, "%s", strerror(-error));
    }
    return iso_appliance_start(door->appliance, fault);
}

void sim_rehearsal_door_close(struct sim_rehearsal_door *door)
{
    if (door->appliance) {
        iso_appliance_stop(door->appliance);
    }
    iso_appliance_free(door->appliance);
    iso_components_close(door->parts);
}

int sim_rehearsal_door_enrol(struct sim_rehearsal_door *door, const char *person,
                             bool allow_duplicate, struct iso_fault *fault)
{
    const struct iso_enroll_request request = {.person = person,
                                               .allow_duplicate = allow_duplicate};
    const int error = iso_appliance_claim(door->appliance);
    door->enrol_done = false;
    if (error) {
        return error;
    }
    return iso_appliance_enroll(door->appliance, &request, fault);
}

int sim_rehearsal_door_settle(struct sim_rehearsal_door *door, struct iso_fault *fault)
{
    const struct timespec pause = {.tv_nsec = 200000};
    struct iso_gallery *gallery = door->lent.gallery;
    struct iso_site_state state = iso_gallery_site(gallery);
    while (state.due && !state.error) {
        if (!iso_gallery_follow_site(gallery)) {
            (void)nanosleep(&pause, NULL);
        }
        state = iso_gallery_site(gallery);
    }
    return state.error ? iso_fault_set(fault, state.error, "the metric cannot be adapted: %s",
                                       strerror(-state.error))
                       : 0;
}

void sim_rehearsal_door_visit(struct sim_rehearsal_door *door, size_t n_frames)
{
    door->last_frame = iso_appliance_status(door->appliance).frames + n_frames;
    door->verdict = (struct sim_door_verdict){.given = false};
    door->unlocked = false;
}

bool sim_rehearsal_door_is_through(const struct sim_rehearsal_door *door)
{
    return door->verdict.given || iso_appliance_status(door->appliance).frames >= door->last_frame;
}

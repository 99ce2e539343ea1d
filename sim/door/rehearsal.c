#include "sim/door/rehearsal.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/contract/contract.h"
#include "sim/base/make_directory.h"
#include "sim/base/progress.h"
#include "sim/door/rehearsal_door.h"
#include "sim/door/slot.h"
#include "sim/door/visit_picture.h"

/* Greatest step of the clock. */
static const int64_t step_ns = 20 * ISO_NS_PER_MS;
/* Time limit of an enrolment, of a visit, and of the wait for locked doors, by the virtual clock.
 */
static const int64_t limit_ns = 30 * ISO_NS_PER_S;

/* One run. The doors are side by side, and all of them see each visitor at the same time. */
struct rehearsal {
    const struct sim_rehearsal_options *options;
    struct iso_fault *fault;
    struct sim_virtual_clock clock;
    char slot[PATH_MAX];
    struct sim_shared_extraction shared;
    size_t n_doors;
    struct sim_rehearsal_door doors[SIM_DOORS_MAX];
    struct sim_trace *trace; /* of the visit to draw; NULL: none */
};

const char *sim_level_name(enum iso_level level)
{
    static const char *const names[SIM_LEVELS] = {"convenient", "balanced", "strict"};
    return (unsigned)level < SIM_LEVELS ? names[level] : NULL;
}

/* One door's place and settings. */
struct door_plan {
    enum iso_level level;
    bool adapt;
};

/* The directory of a door's gallery and log. Each of several doors has its own folder. */
static int make_state(const struct rehearsal *r, struct door_plan plan, char state[PATH_MAX])
{
    const bool alone = r->n_doors == 1;
    const int n = snprintf(state, PATH_MAX, "%s%s%s%s", r->options->state, alone ? "" : "/",
                           alone ? "" : sim_level_name(plan.level),
                           !alone && r->options->adapt_too && plan.adapt ? "-adapted" : "");
    if (n < 0 || n >= PATH_MAX) {
        return iso_fault_set(r->fault, -ENAMETOOLONG, "%s: path too long", r->options->state);
    }
    return alone ? 0 : sim_make_new_directory(state, r->fault);
}

static int open_door(struct rehearsal *r, struct door_plan plan, struct sim_rehearsal_door *door)
{
    char state[PATH_MAX];
    const struct sim_rehearsal_setup setup = {
        .slot = r->slot,
        .state = state,
        .model = r->options->model,
        .metric = r->options->metric,
        .threshold = r->options->threshold,
        .level = plan.level,
        .adapt = plan.adapt,
    };
    const int error = make_state(r, plan, state);
    if (error) {
        return error;
    }
    return sim_rehearsal_door_open(door, &setup, &r->clock, &r->shared, r->trace, r->fault);
}

/* The settings of door number i. */
static struct door_plan plan_door(const struct sim_rehearsal_options *o, size_t i)
{
    const enum iso_level one = o->level ? *o->level : iso_config_default().decision.level;
    return (struct door_plan){
        .level = o->all_levels ? (enum iso_level)(i % SIM_LEVELS) : one,
        .adapt = o->adapt || i >= SIM_LEVELS,
    };
}

static int open_doors(struct rehearsal *r)
{
    const struct sim_rehearsal_options *o = r->options;
    const int n = snprintf(r->slot, sizeof r->slot, "%s/slot", o->state);
    if (n < 0 || (size_t)n >= sizeof r->slot) {
        return iso_fault_set(r->fault, -ENAMETOOLONG, "%s: path too long", o->state);
    }
    const size_t beside = o->adapt_too ? SIM_DOORS_MAX : SIM_LEVELS;
    r->n_doors = o->all_levels ? beside : 1;
    int error = 0;
    for (size_t i = 0; !error && i < r->n_doors; i++) {
        error = open_door(r, plan_door(o, i), &r->doors[i]);
    }
    return error;
}

static int settle_doors(struct rehearsal *r)
{
    int error = 0;
    for (size_t i = 0; !error && i < r->n_doors; i++) {
        error = sim_rehearsal_door_settle(&r->doors[i], r->fault);
    }
    return error;
}

/* Runs the work that is due now, then advances the clock to the next due time, by at most step_ns.
 */
static void step_doors(struct rehearsal *r)
{
    int64_t next_ns = r->clock.now_ns + step_ns;
    for (size_t i = 0; i < r->n_doors; i++) {
        const int64_t wake_ns = iso_appliance_step(r->doors[i].appliance);
        next_ns = wake_ns < next_ns ? wake_ns : next_ns;
    }
    sim_virtual_clock_advance(&r->clock, next_ns);
}

static bool all_locked(const struct rehearsal *r)
{
    for (size_t i = 0; i < r->n_doors; i++) {
        if (iso_appliance_status(r->doors[i].appliance).door != ISO_DOOR_LOCKED) {
            return false;
        }
    }
    return true;
}

/* Leaves the doors empty until the appliance has forgotten the visitor and the doors are locked
 * again. */
static int clear_doors(struct rehearsal *r)
{
    const int64_t start_ns = r->clock.now_ns;
    const int64_t quiet_ns = 2 * (int64_t)r->doors[0].config.decision.gap_ms * ISO_NS_PER_MS;
    const int error = sim_slot_clear(r->slot, r->fault);
    while (!error) {
        const int64_t spent_ns = r->clock.now_ns - start_ns;
        if (spent_ns >= quiet_ns && all_locked(r)) {
            return 0;
        }
        if (spent_ns >= limit_ns) {
            return iso_fault_set(r->fault, -ETIMEDOUT, "the door does not lock again");
        }
        step_doors(r);
    }
    return error;
}

static bool all_enrolled(const struct rehearsal *r)
{
    for (size_t i = 0; i < r->n_doors; i++) {
        if (!r->doors[i].enrol_done) {
            return false;
        }
    }
    return true;
}

/* The result of a finished enrolment: -ENOMSG if a door could not enrol the person. */
static int check_enrolled(const struct rehearsal *r, const struct sim_corpus_row *row)
{
    for (size_t i = 0; i < r->n_doors; i++) {
        const char *result = r->doors[i].enrol_result;
        if (strcmp(result, ISO_CONTRACT_RESULT_COMPLETED) != 0) {
            return iso_fault_set(r->fault, -ENOMSG, "%s: %s is not enrolled: %s", row->recording,
                                 row->subject, result);
        }
    }
    return 0;
}

static int enrol_person(struct rehearsal *r, const struct sim_corpus_row *row)
{
    const int64_t end_ns = r->clock.now_ns + limit_ns;
    int error = 0;
    for (size_t i = 0; !error && i < r->n_doors; i++) {
        error = sim_rehearsal_door_enrol(&r->doors[i], row->subject, r->options->allow_duplicate,
                                         r->fault);
    }
    if (!error) {
        error = sim_slot_point(r->slot, r->options->corpus, row->recording, r->fault);
    }
    while (!error && !all_enrolled(r) && r->clock.now_ns < end_ns) {
        step_doors(r);
    }
    for (size_t i = 0; i < r->n_doors; i++) {
        iso_appliance_release(r->doors[i].appliance);
    }
    if (!error) {
        error = clear_doors(r);
    }
    if (!error) {
        error = settle_doors(r);
    }
    if (error) {
        return error;
    }
    return check_enrolled(r, row);
}

static bool all_through(const struct rehearsal *r)
{
    for (size_t i = 0; i < r->n_doors; i++) {
        if (!sim_rehearsal_door_is_through(&r->doors[i])) {
            return false;
        }
    }
    return true;
}

/* Runs until every door has a verdict, or until all frames were examined without one. out[i] is
 * the result of door i. */
static int await_verdicts(struct rehearsal *r, const struct sim_corpus_row *row,
                          struct sim_visit *out[SIM_DOORS_MAX])
{
    const int64_t end_ns = r->clock.now_ns + limit_ns;
    for (size_t i = 0; i < r->n_doors; i++) {
        sim_rehearsal_door_visit(&r->doors[i], row->count);
    }
    int error = sim_slot_point(r->slot, r->options->corpus, row->recording, r->fault);
    while (!error && !all_through(r) && r->clock.now_ns < end_ns) {
        step_doors(r);
    }
    if (!error) {
        /* A verdict that comes during this wait still counts. */
        error = clear_doors(r);
    }
    for (size_t i = 0; i < r->n_doors; i++) {
        const struct sim_rehearsal_door *door = &r->doors[i];
        *out[i] = (struct sim_visit){
            .row = row, .verdict = door->verdict, .unlocked = door->unlocked};
    }
    return error;
}

/* Plays a visit at one door and draws it. */
static int visit_and_draw(struct rehearsal *r, const struct sim_corpus_row *row,
                          struct sim_visit *out[SIM_DOORS_MAX])
{
    const struct iso_appliance_borrowed *lent = &r->doors[0].lent;
    sim_trace_begin(r->trace, r->clock.now_ns);
    const int error = await_verdicts(r, row, out);
    sim_trace_end(r->trace, lent->door_io, r->clock.now_ns);
    if (error) {
        return error;
    }
    return sim_visit_picture(r->trace, out[0], lent->gallery, r->options->picture, r->fault);
}

/* Whether a row is a visit to play. */
static bool is_wanted(const struct rehearsal *r, const struct sim_corpus_row *row)
{
    return row->role != SIM_ROLE_GALLERY &&
           (!r->options->visit || strcmp(row->recording, r->options->visit) == 0);
}

static int enrol_all(struct rehearsal *r, const struct sim_corpus *corpus)
{
    int error = 0;
    for (size_t i = 0; !error && i < corpus->n_rows; i++) {
        if (corpus->rows[i].role == SIM_ROLE_GALLERY) {
            error = enrol_person(r, &corpus->rows[i]);
            if (error == -ENOMSG && r->options->not_enrolled) {
                ++*r->options->not_enrolled;
                error = 0;
            }
            sim_progress_step(1);
        }
    }
    return error;
}

/* Plays one visit at every door. `visits` is the result of the first door; the results of the
 * other doors follow at intervals of n_rows. */
static int play_visit(struct rehearsal *r, const struct sim_corpus_row *row, size_t n_rows,
                      sim_visit_listener *listener, void *context, struct sim_visit *visits)
{
    struct sim_visit *out[SIM_DOORS_MAX] = {NULL};
    for (size_t i = 0; i < r->n_doors; i++) {
        out[i] = &visits[i * n_rows];
    }
    const int error = r->trace ? visit_and_draw(r, row, out) : await_verdicts(r, row, out);
    for (size_t i = 0; !error && i < r->n_doors; i++) {
        sim_progress_pause();
        listener(out[i], context);
        sim_progress_resume();
    }
    return error;
}

static int play_rows(struct rehearsal *r, const struct sim_corpus *corpus,
                     sim_visit_listener *listener, void *context, struct sim_visit *visits,
                     size_t *n_visits)
{
    size_t count = 0;
    const bool shown = sim_progress_begin("playing recordings to the appliance", corpus->n_rows);
    int error = enrol_all(r, corpus);
    for (size_t i = 0; !error && i < corpus->n_rows; i++) {
        const struct sim_corpus_row *row = &corpus->rows[i];
        if (!is_wanted(r, row) || sim_visit_was_played(visits, count, row->recording)) {
            continue;
        }
        error = play_visit(r, row, corpus->n_rows, listener, context, &visits[count]);
        count += !error;
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
    struct rehearsal *r = calloc(1, sizeof *r);
    struct sim_trace *trace = calloc(1, sizeof *trace); /* on = false */
    if (!r || !trace) {
        free(r);
        free(trace);
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    r->options = options;
    r->fault = fault;
    r->clock = sim_virtual_clock_start();
    r->trace = options->picture ? trace : NULL;
    int error = open_doors(r);
    if (!error) {
        error = play_rows(r, corpus, listener, context, visits, n_visits);
    }
    for (size_t i = 0; i < SIM_DOORS_MAX; i++) {
        sim_rehearsal_door_close(&r->doors[i]);
    }
    sim_shared_extraction_done(&r->shared);
    sim_trace_done(trace);
    free(r);
    free(trace);
    return error;
}

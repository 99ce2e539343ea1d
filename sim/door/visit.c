#include "sim/door/visit.h"

#include <errno.h>
#include <string.h>
#include <time.h>

#include "firmware/contract/contract.h"
#include "sim/base/progress.h"
#include "sim/door/slot.h"

/* Slow enough for the daemon's limit on calls (firmware/bus/call_rate.h). Signals wake the loop
 * earlier. */
enum { LOOK_MS = 60 };

/* One run: data shared by the functions below. */
struct play {
    const struct sim_visit_options *options;
    struct sim_door_watch *watch;
    struct iso_fault *fault;
};

struct sim_visit_options sim_visit_options_default(void)
{
    return (struct sim_visit_options){
        .roles = {[SIM_ROLE_PROBE] = true, [SIM_ROLE_IMPOSTOR] = true},
        .settle_ms = 1000,
        .limit_ms = 30000,
    };
}

static int64_t now_ms(void)
{
    struct timespec now;

    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

/* Waits for a verdict, or until all the visitor's frames were examined without one. The frames
 * are counted, so that a slow machine has enough time. */
static int wait_for_verdict(const struct play *play, uint64_t last_frame)
{
    const int64_t end_ms = now_ms() + play->options->limit_ms;
    int64_t quiet_since_ms = 0;

    while (!sim_door_watch_verdict(play->watch).given && now_ms() < end_ms) {
        uint64_t frames;
        int error = sim_door_watch_frames(play->watch, &frames, play->fault);
        if (!error && frames >= last_frame && quiet_since_ms == 0) {
            quiet_since_ms = now_ms();
        }
        if (quiet_since_ms && now_ms() - quiet_since_ms >= play->options->settle_ms) {
            break;
        }
        if (!error) {
            error = sim_door_watch_step(play->watch, LOOK_MS, play->fault);
        }
        if (error) {
            return error;
        }
    }
    return 0;
}

/* Waits until the door is locked, at least for the settling time. */
static int wait_for_quiet(const struct play *play)
{
    const int64_t start_ms = now_ms();

    for (;;) {
        const int64_t spent_ms = now_ms() - start_ms;
        if (spent_ms >= play->options->settle_ms && sim_door_watch_is_locked(play->watch)) {
            return 0;
        }
        if (spent_ms >= play->options->limit_ms) {
            return iso_fault_set(play->fault, -ETIMEDOUT, "the door does not lock again");
        }
        const int error = sim_door_watch_step(play->watch, LOOK_MS, play->fault);
        if (error) {
            return error;
        }
    }
}

static int play_row(const struct play *play, const struct sim_corpus_row *row,
                    struct sim_visit *visit)
{
    const struct sim_visit_options *options = play->options;
    uint64_t frames;
    int error = sim_door_watch_frames(play->watch, &frames, play->fault);

    if (error) {
        return error;
    }
    sim_door_watch_reset(play->watch);
    error = sim_slot_point(options->slot, options->corpus, row->recording, play->fault);
    if (!error) {
        error = wait_for_verdict(play, frames + row->count);
    }
    if (!error) {
        error = sim_slot_clear(options->slot, play->fault);
    }
    if (!error) {
        /* A verdict that comes during this wait still counts. */
        error = wait_for_quiet(play);
    }
    if (error) {
        return error;
    }
    visit->row = row;
    visit->verdict = sim_door_watch_verdict(play->watch);
    visit->unlocked = sim_door_watch_was_unlocked(play->watch);
    return 0;
}

bool sim_visit_was_played(const struct sim_visit *visits, size_t n_visits, const char *recording)
{
    for (size_t i = 0; i < n_visits; i++) {
        if (strcmp(visits[i].row->recording, recording) == 0) {
            return true;
        }
    }
    return false;
}

int sim_visit_play(const struct sim_visit_options *options, const struct sim_corpus *corpus,
                   sim_visit_listener *listener, void *context, struct sim_visit *visits,
                   size_t *n_visits, struct iso_fault *fault)
{
    struct play play = {.options = options, .fault = fault};
    size_t count = 0;
    int error = sim_slot_clear(options->slot, fault);

    if (!error) {
        error = sim_door_watch_open(options->address, &play.watch, fault);
    }
    if (!error) {
        error = wait_for_quiet(&play);
    }
    const bool shown = sim_progress_begin("playing visits to the daemon", corpus->n_rows);
    for (size_t i = 0; !error && i < corpus->n_rows; i++) {
        const struct sim_corpus_row *row = &corpus->rows[i];
        sim_progress_step(1);
        if (!options->roles[row->role] || sim_visit_was_played(visits, count, row->recording)) {
            continue;
        }
        error = play_row(&play, row, &visits[count]);
        if (!error) {
            sim_progress_pause();
            listener(&visits[count++], context);
            sim_progress_resume();
        }
    }
    sim_progress_end(shown);
    if (error) {
        (void)!sim_slot_clear(options->slot, NULL); /* keep the first fault */
    } else {
        *n_visits = count;
    }
    sim_door_watch_close(play.watch);
    return error;
}

/* For visits that must not succeed: an unlocked door or the verdict "allow" counts as admission. */
static bool is_let_in(const struct sim_visit *visit)
{
    return visit->unlocked || (visit->verdict.given && visit->verdict.allow);
}

/* For visits that must succeed: the verdict was "allow", and the door could be unlocked or was
 * open.
 */
static bool is_admitted(const struct sim_visit *visit)
{
    return visit->verdict.given && visit->verdict.allow &&
           strcmp(visit->verdict.door, ISO_CONTRACT_DOOR_NOT_UNLOCKED) != 0;
}

static bool is_own_name(const struct sim_visit *visit)
{
    return visit->verdict.given && strcmp(visit->verdict.person, visit->row->subject) == 0;
}

/* Whether visit number `visit` is its subject's first. */
static bool is_first_of_subject(const struct sim_visit *visits, size_t visit)
{
    for (size_t i = 0; i < visit; i++) {
        if (visits[i].row->role == SIM_ROLE_PROBE &&
            strcmp(visits[i].row->subject, visits[visit].row->subject) == 0) {
            return false;
        }
    }
    return true;
}

/* Whether any visit of the subject was admitted under the correct name. */
static bool is_ever_admitted(const struct sim_visit *visits, size_t n_visits, const char *subject)
{
    for (size_t i = 0; i < n_visits; i++) {
        if (visits[i].row->role == SIM_ROLE_PROBE && strcmp(visits[i].row->subject, subject) == 0 &&
            is_admitted(&visits[i]) && is_own_name(&visits[i])) {
            return true;
        }
    }
    return false;
}

struct sim_visit_summary sim_visit_judge(const struct sim_visit *visits, size_t n_visits)
{
    struct sim_visit_summary summary = {0};

    for (size_t i = 0; i < n_visits; i++) {
        const struct sim_visit *visit = &visits[i];
        if (visit->row->role != SIM_ROLE_PROBE) {
            summary.impostors++;
            summary.impostors_let_in += is_let_in(visit);
            continue;
        }
        summary.probes++;
        summary.probes_admitted += is_admitted(visit) && is_own_name(visit);
        summary.misnamed += is_let_in(visit) && !is_own_name(visit);
        if (is_first_of_subject(visits, i)) {
            summary.people++;
            summary.people_admitted += is_ever_admitted(visits, n_visits, visit->row->subject);
        }
    }
    summary.good = n_visits > 0 && summary.people_admitted == summary.people &&
                   summary.misnamed == 0 && summary.impostors_let_in == 0;
    return summary;
}

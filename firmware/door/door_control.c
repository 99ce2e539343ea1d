#include "firmware/door/door_control.h"

#include <errno.h>
#include <stdio.h>

#include "drivers/base/times.h"
#include "firmware/contract/contract.h"

const char *iso_door_answer_name(enum iso_door_answer answer)
{
    static const char *const names[] = {
        [ISO_DOOR_NOT_ASKED] = "",
        [ISO_DOOR_DID_UNLOCK] = ISO_CONTRACT_DOOR_UNLOCKED,
        [ISO_DOOR_STOOD_OPEN] = ISO_CONTRACT_DOOR_OPEN,
        [ISO_DOOR_DID_NOT_UNLOCK] = ISO_CONTRACT_DOOR_NOT_UNLOCKED,
    };
    return names[answer];
}

/* Lines with a descriptor report a change of an input by it, and are only read to notice that a
 * chip is gone: Linux 6.1 wakes nobody for that. */
static const int64_t watched_poll_ns = 200 * ISO_NS_PER_MS;

void iso_door_control_init(struct iso_door_control *control, const struct iso_door_options *options,
                           const struct iso_door_timing *timing, struct iso_door_io *io,
                           void (*changed)(void *context, enum iso_door_event cause), void *context)
{
    *control = (struct iso_door_control){
        .io = io,
        .timing = *timing,
        .wait_ns = timing->retry_ns,
        .read_ns = ISO_NEVER_NS,
        .changed = changed,
        .context = context,
    };
    iso_door_init(&control->door, options);
}

/* Whether an event is reported even if the state stays the same. */
static bool is_alarm(enum iso_door_event event)
{
    return event == ISO_DOOR_ON_TAMPER || event == ISO_DOOR_ON_TAMPER_ENDED;
}

static void tell_change(struct iso_door_control *control, enum iso_door_event event, int64_t now_ns)
{
    const bool changed = iso_door_handle(&control->door, event, now_ns);
    if (changed || is_alarm(event)) {
        control->changed(control->context, event);
    }
}

/* ---- lines ---- */

static int64_t earlier_time(int64_t a_ns, int64_t b_ns)
{
    return a_ns < b_ns ? a_ns : b_ns;
}

/* The time from one reading of the inputs to the next. */
static int64_t reading_interval_ns(const struct iso_door_control *control)
{
    const int64_t poll_ns = control->timing.poll_ns;
    const bool watched = !control->broken && iso_door_io_poll_fd(control->io) >= 0;
    return watched && poll_ns < watched_poll_ns ? watched_poll_ns : poll_ns;
}

/* Notes whether the lines work. Passes a change of that to the state machine. */
static void note_lines(struct iso_door_control *control, const struct iso_fault *fault, bool broken,
                       int64_t now_ns)
{
    if (broken) {
        control->fault = *fault;
    }
    if (broken == control->broken) {
        return;
    }
    control->broken = broken;
    if (broken) {
        if (control->read_ns != ISO_NEVER_NS) { /* from now on the lines are read by time only */
            control->read_ns = earlier_time(control->read_ns, now_ns + control->timing.poll_ns);
        }
        tell_change(control, ISO_DOOR_ON_FAULT, now_ns);
    } else if (!control->asked_fault) {
        tell_change(control, ISO_DOOR_ON_RECOVERED, now_ns);
    }
}

/* The levels that the lines should have: those of the door, and the lamps of others where the door
 * has nothing to show. */
static struct iso_door_outputs wanted_outputs(const struct iso_door_control *control)
{
    struct iso_door_outputs wanted = iso_door_outputs_of(&control->door);
    const bool quiet = control->door.state == ISO_DOOR_LOCKED &&
                       !wanted.active[ISO_DOOR_LED_GRANTED] &&
                       !wanted.active[ISO_DOOR_LED_REFUSED] && !wanted.active[ISO_DOOR_BUZZER];
    if (quiet) {
        wanted.active[ISO_DOOR_LED_GRANTED] = control->lamps.granted;
        wanted.active[ISO_DOOR_LED_REFUSED] = control->lamps.refused;
        wanted.active[ISO_DOOR_BUZZER] = control->lamps.buzzer;
    }
    return wanted;
}

/* Switches the lines whose level differs. After a failure the level of no line is known, and the
 * next call switches all of them. */
static bool switch_outputs(struct iso_door_control *control, struct iso_fault *fault)
{
    const struct iso_door_outputs wanted = wanted_outputs(control);
    bool fine = true;
    for (int i = 0; i < ISO_DOOR_OUTPUTS; i++) {
        if (control->known && control->outputs.active[i] == wanted.active[i]) {
            continue;
        }
        const int error = iso_door_io_set_output(control->io, (enum iso_door_output)i,
                                                 wanted.active[i], fault);
        fine = fine && !error; /* the loop still switches the other lines */
        if (i == ISO_DOOR_RELAY) {
            control->relay_failed = error != 0;
        }
    }
    control->outputs = wanted;
    control->known = fine;
    return fine;
}

static bool read_inputs(struct iso_door_control *control, struct iso_door_inputs *out,
                        int64_t now_ns, struct iso_fault *fault)
{
    control->read_ns = now_ns + reading_interval_ns(control);
    return iso_door_io_get_inputs(control->io, out, fault) == 0;
}

static void tell_inputs(struct iso_door_control *control, const struct iso_door_inputs *inputs,
                        int64_t now_ns)
{
    const bool *now = inputs->active, *before = control->inputs.active;
    if (now[ISO_DOOR_EXIT_BUTTON] && !before[ISO_DOOR_EXIT_BUTTON]) {
        /* The button comes first, because the person who opens the door has pressed it. */
        tell_change(control, ISO_DOOR_ON_EXIT_BUTTON, now_ns);
    }
    if (now[ISO_DOOR_CONTACT] != before[ISO_DOOR_CONTACT]) {
        tell_change(control, now[ISO_DOOR_CONTACT] ? ISO_DOOR_ON_OPENED : ISO_DOOR_ON_CLOSED,
                    now_ns);
    }
    if (now[ISO_DOOR_TAMPER] != before[ISO_DOOR_TAMPER]) {
        tell_change(control, now[ISO_DOOR_TAMPER] ? ISO_DOOR_ON_TAMPER : ISO_DOOR_ON_TAMPER_ENDED,
                    now_ns);
    }
    control->inputs = *inputs;
}

/* ---- lost lines ---- */

static void wait_for_lines(struct iso_door_control *control, int64_t now_ns)
{
    const int64_t longer_ns = control->wait_ns * 2, max_ns = control->timing.retry_max_ns;
    control->open_ns = now_ns + control->wait_ns;
    control->wait_ns = longer_ns < max_ns ? longer_ns : max_ns;
}

/* Returns true if the lines are open, or could be opened again. */
static bool have_lines(struct iso_door_control *control, int64_t now_ns)
{
    struct iso_fault fault = {.text = ""};
    if (!iso_door_io_is_lost(control->io)) {
        return true;
    }
    if (now_ns < control->open_ns) {
        return false;
    }
    const struct iso_door_outputs wanted = wanted_outputs(control);
    if (iso_door_io_reopen(control->io, &wanted, &fault)) {
        note_lines(control, &fault, true, now_ns);
        wait_for_lines(control, now_ns);
        return false;
    }
    control->outputs = wanted;
    control->known = true;
    control->relay_failed = false;
    control->read_ns = now_ns;
    return true;
}

/* Called after every operation that may have noticed the loss of the lines. */
static void note_loss(struct iso_door_control *control, bool had_lines, int64_t now_ns)
{
    if (had_lines && iso_door_io_is_lost(control->io)) {
        control->known = false;
        control->relay_failed = true;
        wait_for_lines(control, now_ns);
    }
}

/* ---- calls ---- */

static void apply_outputs(struct iso_door_control *control, int64_t now_ns)
{
    struct iso_fault fault = {.text = ""};
    if (iso_door_io_is_lost(control->io)) {
        return; /* the fault has been reported already */
    }
    if (!switch_outputs(control, &fault)) {
        note_lines(control, &fault, true, now_ns);
        note_loss(control, true, now_ns);
    }
}

/* Reads the inputs and switches the outputs. Any failure is a fault of the door, which ends when
 * everything works again. */
static void exercise_lines(struct iso_door_control *control, int64_t now_ns)
{
    struct iso_fault fault = {.text = ""};
    struct iso_door_inputs inputs;
    const bool fine = read_inputs(control, &inputs, now_ns, &fault);
    if (fine) {
        control->wait_ns = control->timing.retry_ns;
        tell_inputs(control, &inputs, now_ns);
    }
    const bool switched = fine && switch_outputs(control, &fault);
    note_lines(control, &fault, !fine || !switched, now_ns);
    note_loss(control, true, now_ns);
}

void iso_door_control_start(struct iso_door_control *control, int64_t now_ns)
{
    struct iso_fault fault = {.text = ""};
    struct iso_door_inputs inputs = {{false}};
    control->open_ns = now_ns;
    const bool there = have_lines(control, now_ns);
    const bool fine = there && read_inputs(control, &inputs, now_ns, &fault);
    const bool open = inputs.active[ISO_DOOR_CONTACT];
    if (there) {
        note_lines(control, &fault, !fine, now_ns);
        note_loss(control, true, now_ns);
    }
    control->inputs.active[ISO_DOOR_CONTACT] = open;
    tell_change(control, open ? ISO_DOOR_ON_START_OPEN : ISO_DOOR_ON_START, now_ns);
    if (fine) {
        tell_inputs(control, &inputs, now_ns);
    }
    apply_outputs(control, now_ns);
}

void iso_door_control_stop(struct iso_door_control *control, int64_t now_ns)
{
    tell_change(control, ISO_DOOR_ON_STOP, now_ns);
    apply_outputs(control, now_ns);
    control->read_ns = ISO_NEVER_NS;
}

static enum iso_door_answer answer_of(const struct iso_door_control *control)
{
    switch (control->door.state) {
    case ISO_DOOR_UNLOCKED:
        return ISO_DOOR_DID_UNLOCK;
    case ISO_DOOR_OPENED:
    case ISO_DOOR_HELD_OPEN:
    case ISO_DOOR_FORCED:
        return ISO_DOOR_STOOD_OPEN;
    default:
        return ISO_DOOR_DID_NOT_UNLOCK;
    }
}

/* Unlocks the door because of an event. The lock is switched first, so that the report says what
 * the lock did. If the relay did not follow, or its line is gone, the event is withdrawn: the lock
 * does not unlock later, when the line is back. */
static enum iso_door_answer unlock_by(struct iso_door_control *control, enum iso_door_event event,
                                      int64_t now_ns)
{
    struct iso_fault fault = {.text = ""};
    const bool unlocks = iso_door_handle(&control->door, event, now_ns);
    const bool had_lines = !iso_door_io_is_lost(control->io);
    const bool fine = had_lines && switch_outputs(control, &fault);
    const bool failed = control->relay_failed || iso_door_io_is_lost(control->io);
    if (failed && unlocks) {
        (void)iso_door_handle(&control->door, ISO_DOOR_ON_NOT_SWITCHED, now_ns);
    } else if (failed && control->door.state == ISO_DOOR_UNLOCKED) {
        /* An earlier report said that the door is unlocked. */
        tell_change(control, ISO_DOOR_ON_NOT_SWITCHED, now_ns);
    } else if (unlocks) {
        control->changed(control->context, event);
    }
    if (had_lines && !fine) {
        note_lines(control, &fault, true, now_ns);
        note_loss(control, true, now_ns);
    }
    if (failed) {
        apply_outputs(control, now_ns); /* the lock goes back to rest if its line works */
    }
    return answer_of(control);
}

enum iso_door_answer iso_door_control_grant(struct iso_door_control *control, int64_t now_ns)
{
    return unlock_by(control, ISO_DOOR_ON_GRANT, now_ns);
}

void iso_door_control_withdraw(struct iso_door_control *control, int64_t now_ns)
{
    tell_change(control, ISO_DOOR_ON_NOT_SWITCHED, now_ns);
    apply_outputs(control, now_ns);
}

void iso_door_control_refuse(struct iso_door_control *control, int64_t now_ns)
{
    tell_change(control, ISO_DOOR_ON_REFUSE, now_ns);
    apply_outputs(control, now_ns);
}

static int lines_at_fault(const struct iso_door_control *control, struct iso_fault *fault)
{
    return iso_fault_set_code(fault, control->fault.code, -ENODEV,
                              "the door's lines are at fault: %.200s", control->fault.text);
}

int iso_door_control_may_test(const struct iso_door_control *control, struct iso_fault *fault)
{
    const enum iso_door_state state = control->door.state;
    if (control->broken) {
        return lines_at_fault(control, fault);
    }
    return state == ISO_DOOR_LOCKED
               ? 0
               : iso_fault_set(fault, -EBUSY, "the door is %s%s, not locked",
                               state == ISO_DOOR_FAULT ? "at " : "", iso_door_state_name(state));
}

int iso_door_control_test(struct iso_door_control *control, int64_t now_ns, struct iso_fault *fault)
{
    const int error = iso_door_control_may_test(control, fault);
    if (error) {
        return error;
    }
    return unlock_by(control, ISO_DOOR_ON_TEST, now_ns) == ISO_DOOR_DID_UNLOCK
               ? 0
               : lines_at_fault(control, fault);
}

void iso_door_control_show(struct iso_door_control *control, const struct iso_door_lamps *lamps,
                           int64_t now_ns)
{
    control->lamps = *lamps;
    apply_outputs(control, now_ns);
}

void iso_door_control_set_fault(struct iso_door_control *control, bool fault, int64_t now_ns)
{
    control->asked_fault = fault;
    if (fault) {
        tell_change(control, ISO_DOOR_ON_FAULT, now_ns);
    } else if (!control->broken) {
        tell_change(control, ISO_DOOR_ON_RECOVERED, now_ns);
    }
    apply_outputs(control, now_ns);
}

void iso_door_control_step(struct iso_door_control *control, bool now, int64_t now_ns)
{
    if (have_lines(control, now_ns) && (now || now_ns >= control->read_ns)) {
        exercise_lines(control, now_ns);
    }
    tell_change(control, ISO_DOOR_ON_TIME, now_ns);
    apply_outputs(control, now_ns);
}

int64_t iso_door_control_due_ns(const struct iso_door_control *control)
{
    const int64_t door_ns = iso_door_due_ns(&control->door);
    const bool lost = iso_door_io_is_lost(control->io);
    const int64_t lines_ns = lost ? control->open_ns : control->read_ns;
    return earlier_time(door_ns, lines_ns);
}

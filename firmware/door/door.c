#include "firmware/door/door.h"

#include <stddef.h>

#include "drivers/base/times.h"

const char *iso_door_state_name(enum iso_door_state state)
{
    static const char *const names[ISO_DOOR_STATES] = {
        "stopped", "locked", "unlocked", "opened", "held-open", "forced", "fault",
    };
    return (unsigned)state < ISO_DOOR_STATES ? names[state] : NULL;
}

const char *iso_door_event_name(enum iso_door_event event)
{
    static const char *const names[ISO_DOOR_EVENTS] = {
        "start",        "start-open",  "stop",      "grant",        "refuse",
        "test",         "exit-button", "opened",    "closed",       "tamper",
        "tamper-ended", "fault",       "recovered", "not-switched", "time",
    };
    return (unsigned)event < ISO_DOOR_EVENTS ? names[event] : NULL;
}

void iso_door_init(struct iso_door *door, const struct iso_door_options *options)
{
    *door = (struct iso_door){
        .options = *options,
        .state = ISO_DOOR_STOPPED,
        .state_due_ns = ISO_NEVER_NS,
        .pulse_due_ns = ISO_NEVER_NS,
        .refused_due_ns = ISO_NEVER_NS,
    };
}

static enum iso_door_state resting_state(const struct iso_door *door)
{
    return door->fault ? ISO_DOOR_FAULT : ISO_DOOR_LOCKED;
}

/* The time at which a state ends by itself if it is entered, or entered again, now. */
static int64_t due_of(const struct iso_door *door, enum iso_door_state state,
                      enum iso_door_event event, int64_t now_ns)
{
    switch (state) {
    case ISO_DOOR_UNLOCKED:
        return now_ns + (event == ISO_DOOR_ON_TEST ? ISO_DOOR_TEST_MS * ISO_NS_PER_MS
                                                   : door->options.unlock_ns);
    case ISO_DOOR_OPENED:
        return now_ns + door->options.held_ns;
    default:
        return ISO_NEVER_NS;
    }
}

/* Applies the effect of an event on the flags, and on the times of refusal and pulse. */
static void set_flags(struct iso_door *door, enum iso_door_event event, int64_t now_ns)
{
    switch (event) {
    case ISO_DOOR_ON_FAULT:
        door->fault = true;
        break;
    case ISO_DOOR_ON_RECOVERED:
        door->fault = false;
        break;
    case ISO_DOOR_ON_TAMPER:
        door->tamper = true;
        break;
    case ISO_DOOR_ON_TAMPER_ENDED:
        door->tamper = false;
        break;
    case ISO_DOOR_ON_REFUSE:
        door->refused_due_ns = now_ns + door->options.refused_ns;
        break;
    case ISO_DOOR_ON_GRANT:
    case ISO_DOOR_ON_STOP:
        door->refused_due_ns = ISO_NEVER_NS;
        break;
    case ISO_DOOR_ON_TIME:
        if (now_ns >= door->refused_due_ns) {
            door->refused_due_ns = ISO_NEVER_NS;
        }
        if (now_ns >= door->pulse_due_ns) {
            door->pulse_due_ns = ISO_NEVER_NS;
        }
        break;
    default:
        break;
    }
}

static enum iso_door_state after_time(const struct iso_door *door, int64_t now_ns)
{
    if (now_ns < door->state_due_ns) {
        return door->state;
    }
    return door->state == ISO_DOOR_OPENED ? ISO_DOOR_HELD_OPEN : resting_state(door);
}

static enum iso_door_state after_opened(const struct iso_door *door)
{
    switch (door->state) {
    case ISO_DOOR_LOCKED:
        return ISO_DOOR_FORCED;
    case ISO_DOOR_UNLOCKED:
        return ISO_DOOR_OPENED;
    case ISO_DOOR_FAULT:
        return door->options.fail == ISO_DOOR_FAIL_SAFE ? ISO_DOOR_OPENED : ISO_DOOR_FORCED;
    default:
        return door->state;
    }
}

static bool is_open(enum iso_door_state state)
{
    return state == ISO_DOOR_OPENED || state == ISO_DOOR_HELD_OPEN || state == ISO_DOOR_FORCED;
}

static bool is_shut(enum iso_door_state state)
{
    return state == ISO_DOOR_LOCKED || state == ISO_DOOR_UNLOCKED || state == ISO_DOOR_FAULT;
}

/* The state that follows once the flags are set. It is the same state if the event changes
 * nothing. */
static enum iso_door_state state_after(const struct iso_door *door, enum iso_door_event event,
                                       int64_t now_ns)
{
    const enum iso_door_state state = door->state;
    switch (event) {
    case ISO_DOOR_ON_START:
        return state == ISO_DOOR_STOPPED ? resting_state(door) : state;
    case ISO_DOOR_ON_START_OPEN:
        return state == ISO_DOOR_STOPPED ? ISO_DOOR_OPENED : state;
    case ISO_DOOR_ON_STOP:
        return ISO_DOOR_STOPPED;
    case ISO_DOOR_ON_GRANT:
    case ISO_DOOR_ON_TEST:
        return state == ISO_DOOR_LOCKED ? ISO_DOOR_UNLOCKED : state;
    case ISO_DOOR_ON_EXIT_BUTTON:
        return is_shut(state) ? ISO_DOOR_UNLOCKED : state;
    case ISO_DOOR_ON_OPENED:
        return after_opened(door);
    case ISO_DOOR_ON_CLOSED:
        return is_open(state) ? resting_state(door) : state;
    case ISO_DOOR_ON_FAULT:
    case ISO_DOOR_ON_RECOVERED:
        return state == ISO_DOOR_LOCKED || state == ISO_DOOR_FAULT ? resting_state(door) : state;
    case ISO_DOOR_ON_NOT_SWITCHED:
        return state == ISO_DOOR_UNLOCKED ? resting_state(door) : state;
    case ISO_DOOR_ON_TIME:
        return after_time(door, now_ns);
    default:
        return state;
    }
}

/* Whether the event starts the time of an unlocked door again. */
static bool renews_unlocking(const struct iso_door *door, enum iso_door_event event)
{
    return door->state == ISO_DOOR_UNLOCKED &&
           (event == ISO_DOOR_ON_EXIT_BUTTON || (event == ISO_DOOR_ON_GRANT && !door->fault));
}

bool iso_door_handle(struct iso_door *door, enum iso_door_event event, int64_t now_ns)
{
    set_flags(door, event, now_ns);
    const enum iso_door_state next = state_after(door, event, now_ns);
    const bool changed = next != door->state;
    if (changed || renews_unlocking(door, event)) {
        const bool pulses = next == ISO_DOOR_UNLOCKED && door->options.pulse_ns > 0;
        door->state_due_ns = due_of(door, next, event, now_ns);
        door->pulse_due_ns = pulses ? now_ns + door->options.pulse_ns : ISO_NEVER_NS;
    }
    door->state = next;
    return changed;
}

static int64_t earliest_time(int64_t a, int64_t b)
{
    return a < b ? a : b;
}

int64_t iso_door_due_ns(const struct iso_door *door)
{
    return earliest_time(door->state_due_ns,
                         earliest_time(door->pulse_due_ns, door->refused_due_ns));
}

static bool relay_is_powered(const struct iso_door *door)
{
    if (door->state == ISO_DOOR_STOPPED || door->state == ISO_DOOR_FAULT) {
        return false;
    }
    const bool lasts = door->options.pulse_ns == 0 || door->pulse_due_ns != ISO_NEVER_NS;
    const bool unlock = door->state == ISO_DOOR_UNLOCKED && lasts;
    return door->options.fail == ISO_DOOR_FAIL_SECURE ? unlock : !unlock;
}

struct iso_door_outputs iso_door_outputs_of(const struct iso_door *door)
{
    const enum iso_door_state state = door->state;
    struct iso_door_outputs out = {{false}};
    if (state == ISO_DOOR_STOPPED) {
        return out;
    }
    out.active[ISO_DOOR_RELAY] = relay_is_powered(door);
    out.active[ISO_DOOR_LED_GRANTED] = state == ISO_DOOR_UNLOCKED || state == ISO_DOOR_OPENED;
    out.active[ISO_DOOR_LED_REFUSED] = door->refused_due_ns != ISO_NEVER_NS;
    out.active[ISO_DOOR_BUZZER] = state == ISO_DOOR_HELD_OPEN || state == ISO_DOOR_FORCED ||
                                  door->tamper;
    out.active[ISO_DOOR_PROJECTOR] = true;
    return out;
}

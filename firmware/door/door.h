/* The door as a state machine. Pure: time is an argument.
 *
 * A lock is fail-secure (a strike: power unlocks it) or fail-safe (a magnet: power locks it). In
 * STOPPED and FAULT the relay is without power, as it is when the appliance has none: fail-secure
 * is then locked, fail-safe is unlocked. So anybody who can cause FAULT (by unplugging
 * the depth sensor, for example) opens a fail-safe door; that is what fail-safe means.
 *
 * REST below is FAULT while a fault lasts, else LOCKED. Legal transitions; every other event
 * leaves the state as it is:
 *
 *   STOPPED    start -> REST     start-open -> OPENED
 *   LOCKED     grant, exit-button -> UNLOCKED     opened -> FORCED     fault -> FAULT
 *              test -> UNLOCKED, for ISO_DOOR_TEST_MS
 *   FAULT      exit-button -> UNLOCKED     recovered -> LOCKED
 *              opened -> FORCED (fail-secure), OPENED (fail-safe)
 *   UNLOCKED   opened -> OPENED     after unlock_ms, not-switched -> REST
 *              grant, exit-button: unlock_ms anew (grant: not while a fault lasts)
 *   OPENED     closed -> REST     after held_ms -> HELD_OPEN
 *   HELD_OPEN  closed -> REST
 *   FORCED     closed -> REST
 *   every one  stop -> STOPPED
 *
 * Besides the state there are three flags: a fault lasts (fault, recovered), the housing is open
 * (tamper, tamper-ended), and somebody was refused less than refused_ms ago and not let in since
 * (refuse).
 *
 * Outputs, from state and flags alone:
 *   relay        unlocks in UNLOCKED, for no longer than pulse_ms if that is given (for locks that
 *                stay unlocked by themselves until the door was used, and for other controllers);
 *                locks again as soon as the door has opened, so that it is locked when it falls
 *                shut; without power in STOPPED and FAULT
 *   led_granted  UNLOCKED, OPENED
 *   led_refused  while the flag of a refusal is set
 *   buzzer       HELD_OPEN, FORCED, and while the housing is open; not in STOPPED
 *   projector    in every state but STOPPED: a sensor that needs it looks all the time */
#ifndef ISO_FIRMWARE_DOOR_DOOR_H
#define ISO_FIRMWARE_DOOR_DOOR_H

#include <stdbool.h>
#include <stdint.h>

#include "drivers/door/door_io.h"

enum iso_door_state {
    ISO_DOOR_STOPPED = 0,
    ISO_DOOR_LOCKED,
    ISO_DOOR_UNLOCKED,
    ISO_DOOR_OPENED,
    ISO_DOOR_HELD_OPEN,
    ISO_DOOR_FORCED,
    ISO_DOOR_FAULT,
    ISO_DOOR_STATES
};

enum iso_door_event {
    ISO_DOOR_ON_START,      /* the door is shut at the start */
    ISO_DOOR_ON_START_OPEN, /* the door is open at the start */
    ISO_DOOR_ON_STOP,
    ISO_DOOR_ON_GRANT, /* a recognised person is let in */
    ISO_DOOR_ON_REFUSE,
    ISO_DOOR_ON_TEST, /* an administrator tests the relay */
    ISO_DOOR_ON_EXIT_BUTTON,
    ISO_DOOR_ON_OPENED,
    ISO_DOOR_ON_CLOSED,
    ISO_DOOR_ON_TAMPER,
    ISO_DOOR_ON_TAMPER_ENDED,
    ISO_DOOR_ON_FAULT,
    ISO_DOOR_ON_RECOVERED,
    ISO_DOOR_ON_NOT_SWITCHED, /* the relay did not follow a grant, which is withdrawn */
    ISO_DOOR_ON_TIME,         /* time has passed */
    ISO_DOOR_EVENTS
};

/* "stopped", "locked", "unlocked", "opened", "held-open", "forced", "fault"; NULL for another
 * value. */
const char *iso_door_state_name(enum iso_door_state state);

/* "start", "start-open", "stop", "grant", "refuse", "test", "exit-button", "opened", "closed",
 * "tamper", "tamper-ended", "fault", "recovered", "not-switched", "time"; NULL for another
 * value. */
const char *iso_door_event_name(enum iso_door_event event);

/* How long a test unlocks the door. */
enum { ISO_DOOR_TEST_MS = 500 };

enum iso_door_fail {
    ISO_DOOR_FAIL_SECURE = 0,
    ISO_DOOR_FAIL_SAFE,
};

struct iso_door_options {
    enum iso_door_fail fail;
    int64_t unlock_ns, held_ns, refused_ns;
    int64_t pulse_ns; /* 0: the relay stays switched */
};

struct iso_door {
    struct iso_door_options options;
    enum iso_door_state state;
    bool fault, tamper;
    int64_t state_due_ns;   /* when the state ends by itself; ISO_NEVER_NS: it does not */
    int64_t pulse_due_ns;   /* when the relay's pulse ends; ISO_NEVER_NS: there is none */
    int64_t refused_due_ns; /* until when the refusal is shown; ISO_NEVER_NS: there is none */
};

/* Makes a stopped door. */
void iso_door_init(struct iso_door *door, const struct iso_door_options *options);

/* Handles an event, which causes at most one transition. Pass the events of the inputs before the
 * event ISO_DOOR_ON_TIME for the time since the last reading: a person who opens the door in the
 * last moment of unlock_ms does not force it. Returns true if the state has changed. */
bool iso_door_handle(struct iso_door *door, enum iso_door_event event, int64_t now_ns);

/* The time at which ISO_DOOR_ON_TIME will have an effect; ISO_NEVER_NS if nothing is due. */
int64_t iso_door_due_ns(const struct iso_door *door);

/* The levels of the outputs for the present state and flags. */
struct iso_door_outputs iso_door_outputs_of(const struct iso_door *door);

#endif

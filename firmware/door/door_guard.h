/* Runs the control of the door (door_control.h) in a thread of its own. The thread waits only for
 * the lines of the door and for its times, so that relay, exit button, contact and tamper switch
 * never wait for the disk, for recognition or for the bus.
 *
 * The thread waits for an edge of the inputs, for the next time that is due, or to be woken. Every
 * call from another thread holds the guard's mutex for as long as lines are switched, a few
 * milliseconds at most. The thread has a real-time priority where the process may have one;
 * iso_door_guard_look tells whether it has.
 *
 * Each change of the door is handed to `record` at once, by the thread in which it happened and
 * with the mutex held: it must neither wait nor call the guard. The same news then wait in a ring
 * until the appliance reports them (iso_door_guard_next). A guard can start before the log is
 * open: its changes wait until iso_door_guard_attach.
 *
 * Tests that inject a clock use the guard without a thread: the caller then steps the door. With a
 * thread the clock must be CLOCK_BOOTTIME, which runs while the machine is suspended: a door that
 * was unlocked before a suspension locks when the machine resumes. */
#ifndef ISO_FIRMWARE_DOOR_DOOR_GUARD_H
#define ISO_FIRMWARE_DOOR_DOOR_GUARD_H

#include "core/base/clock.h"
#include "firmware/door/door_control.h"

enum { ISO_DOOR_GUARD_PRIORITY = 20, ISO_DOOR_GUARD_NEWS = 64 };

/* A change of the door: its time, its cause, and the state of the door after it. */
struct iso_door_news {
    int64_t t_ns; /* by the guard's clock */
    enum iso_door_event cause;
    enum iso_door_state state;
    bool tamper;
    struct iso_fault fault; /* of the lines; "" while they work */
};

struct iso_door_guard_options {
    struct iso_door_options door;
    struct iso_door_timing timing;
    struct iso_clock clock;
    struct iso_door_io *io; /* may be lost; must outlive the guard */
    bool threaded;
    /* Called for every change. NULL: see iso_door_guard_attach. */
    void (*record)(void *context, const struct iso_door_news *news);
    void *context;
};

struct iso_door_guard;

/* Makes a stopped door. -ENOMEM, or with `threaded` an errno of making descriptors. */
int iso_door_guard_new(const struct iso_door_guard_options *options, struct iso_door_guard **out)
    __attribute__((warn_unused_result));

/* Ends the thread, and frees the guard. iso_door_guard_stop must be called before. NULL is
 * accepted. */
void iso_door_guard_free(struct iso_door_guard *guard);

/* Passes the changes since the start to `record`, the oldest first, and from then on each change at
 * once. Returns how many earlier changes are missing, because only the newest ISO_DOOR_GUARD_NEWS
 * are kept. Call it once, before any news are taken, for a guard that was made without `record`. */
size_t iso_door_guard_attach(struct iso_door_guard *guard,
                             void (*record)(void *context, const struct iso_door_news *news),
                             void *context);

/* Stops the calls of `record`, because the log is about to close. NULL is accepted. */
void iso_door_guard_detach(struct iso_door_guard *guard);

/* Starts the door and its thread. -EAGAIN, -ENOMEM: no thread can be had. */
int iso_door_guard_start(struct iso_door_guard *guard) __attribute__((warn_unused_result));

/* Switches every output off for good: the thread, if there is one, ends. */
void iso_door_guard_stop(struct iso_door_guard *guard);

/* Lets somebody in, unless it is later than until_ns by the guard's clock. Then it returns -ESTALE,
 * and the lock was not switched, or is back at rest if the time ran out during the switching.
 * Otherwise it returns 0, and *answer says what the door did. */
int iso_door_guard_grant(struct iso_door_guard *guard, int64_t until_ns,
                         enum iso_door_answer *answer) __attribute__((warn_unused_result));

/* These have the same effect as the functions of the door's control with the same names. */
void iso_door_guard_refuse(struct iso_door_guard *guard);
int iso_door_guard_test(struct iso_door_guard *guard, struct iso_fault *fault)
    __attribute__((warn_unused_result));
int iso_door_guard_may_test(struct iso_door_guard *guard, struct iso_fault *fault)
    __attribute__((warn_unused_result));
void iso_door_guard_set_fault(struct iso_door_guard *guard, bool fault);
void iso_door_guard_show(struct iso_door_guard *guard, const struct iso_door_lamps *lamps);

/* Changes how long the door stays unlocked, may be held open, and shows a refusal, from the next
 * time on. The other options stay. */
void iso_door_guard_set_times(struct iso_door_guard *guard, const struct iso_door_options *times);

/* Sends the card number of the person granted last. Errors of iso_door_io_send_card; also -EACCES,
 * without a fault, if the door is not unlocked, and -ESTALE if it is later than until_ns of that
 * grant. */
int iso_door_guard_send_card(struct iso_door_guard *guard, const struct iso_wiegand_card *card,
                             struct iso_fault *fault) __attribute__((warn_unused_result));

/* The present state of the door. */
struct iso_door_look {
    enum iso_door_state state;
    struct iso_fault fault; /* of the lines; "" while they work */
    bool tamper;            /* the case is open */
    bool ordinary; /* its thread has no real-time priority, because the process may not have one */
};

struct iso_door_look iso_door_guard_look(struct iso_door_guard *guard);

/* Takes the oldest news that were not taken yet; false: there are none. If nobody takes news in
 * time, the oldest are overwritten; *missed is the number of those since the last call. */
bool iso_door_guard_next(struct iso_door_guard *guard, struct iso_door_news *news, size_t *missed);

/* A descriptor that polls readable while there are news (with a thread), or when a step is needed
 * (without one; negative if the lines have no descriptor). */
int iso_door_guard_fd(struct iso_door_guard *guard);

/* Without a thread: does what is due now, and returns the time of the next step, by the guard's
 * clock. With a thread: does nothing, and returns ISO_NEVER_NS. */
void iso_door_guard_step(struct iso_door_guard *guard);
int64_t iso_door_guard_due_ns(struct iso_door_guard *guard);

#endif

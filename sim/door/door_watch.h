/* Watches the door of a running daemon over the bus: its verdicts, its lock, and the number of
 * frames that it has received. One thread. */
#ifndef SIM_DOOR_DOOR_WATCH_H
#define SIM_DOOR_DOOR_WATCH_H

#include <stdbool.h>
#include <stdint.h>

#include "core/base/fault.h"

/* The daemon's signal Visit (firmware/contract/contract.h). */
struct sim_door_verdict {
    bool given; /* if false, the other fields are not set */
    bool allow;
    char person[256]; /* "" when unknown */
    double score, threshold;
    uint32_t frames;
    int64_t latency_us;
    char reason[16]; /* one of the words in firmware/visit/decision.h */
    char door[16];   /* the door's action after "allow" (firmware/contract/contract.h); "" after
                        "deny" */
};

struct sim_door_watch;

/* Connects to the bus at `address` and asks for the state of the lock. -ENOENT if no daemon is on
 * the bus, -ENOMEM, or the errno of the bus. */
int sim_door_watch_open(const char *address, struct sim_door_watch **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Disconnects and frees the watch. NULL is allowed. */
void sim_door_watch_close(struct sim_door_watch *watch);

/* Takes one message that has arrived. If there is none, waits for one for at most `duration_ms`;
 * the next call takes it. Errors of the bus. */
int sim_door_watch_step(struct sim_door_watch *watch, int64_t duration_ms, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Clears the verdict and the record of an unlocked door, for a new visit. */
void sim_door_watch_reset(struct sim_door_watch *watch);

/* The first verdict after the reset. */
struct sim_door_verdict sim_door_watch_verdict(const struct sim_door_watch *watch);

/* Whether the door is locked now, and whether it was unlocked at any time after the reset. */
bool sim_door_watch_is_locked(const struct sim_door_watch *watch);
bool sim_door_watch_was_unlocked(const struct sim_door_watch *watch);

/* Asks the daemon for the number of frames received from its sensor. Errors of the bus. */
int sim_door_watch_frames(struct sim_door_watch *watch, uint64_t *frames, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif

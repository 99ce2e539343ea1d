/* When a rollout tells more doors, and when it stops. Pure.
 *
 *   stage 1      the first doors that ask, as many as the administrator says
 *   stage n + 1  as many again as were told up to then, so that their number doubles
 *
 * The next stage begins when all doors of the present one are healthy, or have failed without being
 * too many, and when the time to wait is over since the last of them did. A rollout stops when
 * more doors have failed than it may have. It is done when no door waits any more. */
#ifndef ISO_ENROLL_HUB_UPDATE_ROLLOUT_STAGE_H
#define ISO_ENROLL_HUB_UPDATE_ROLLOUT_STAGE_H

#include <stdint.h>

enum hub_rollout_state {
    HUB_ROLLOUT_RUNNING,
    HUB_ROLLOUT_STOPPED,
    HUB_ROLLOUT_DONE,
    HUB_ROLLOUT_REPLACED, /* by a later one of the same zone */
    HUB_ROLLOUT_STATES
};

struct hub_rollout_count {
    int64_t told;     /* doors that were told */
    int64_t finished; /* of those: healthy or failed */
    int64_t failed;   /* of those */
    int64_t waiting;  /* doors that were not told */
    /* When the last of those that were told finished. A door that fails by silence again and again
     * has finished the first time. */
    int64_t finished_s;
};

struct hub_rollout_stage {
    enum hub_rollout_state state;
    int64_t stage, most; /* of doors that are told up to its end */
    int64_t stop_after, wait_s;
};

/* Moves the stage on as far as the doors permit. Only a running rollout changes. */
void hub_rollout_move(struct hub_rollout_stage *stage, const struct hub_rollout_count *count,
                      int64_t now_s);

/* Within which time the doors of a stage begin to fetch, so that they need HUB_ROLLOUT_BYTES_PER_S
 * together, in seconds; HUB_ROLLOUT_SPREAD_MOST_S at most. `doors`: that take part in all. */
enum { HUB_ROLLOUT_BYTES_PER_S = 12500000, HUB_ROLLOUT_SPREAD_MOST_S = 4 * 3600 };
uint32_t hub_rollout_spread_s(const struct hub_rollout_stage *stage, int64_t doors, uint64_t bytes);

#endif

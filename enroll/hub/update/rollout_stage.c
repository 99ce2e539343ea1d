#include "enroll/hub/update/rollout_stage.h"

void hub_rollout_move(struct hub_rollout_stage *stage, const struct hub_rollout_count *count,
                      int64_t now_s)
{
    if (stage->state != HUB_ROLLOUT_RUNNING) {
        return;
    }
    if (count->failed > stage->stop_after) {
        stage->state = HUB_ROLLOUT_STOPPED;
        return;
    }
    if (count->finished < count->told) {
        return;
    }
    if (count->waiting == 0) {
        stage->state = HUB_ROLLOUT_DONE;
        return;
    }
    /* The stage is full, and all of it have finished. */
    if (count->told >= stage->most && now_s - count->finished_s >= stage->wait_s) {
        stage->stage++;
        stage->most = 2 * count->told;
    }
}

uint32_t hub_rollout_spread_s(const struct hub_rollout_stage *stage, int64_t doors, uint64_t bytes)
{
    /* Half of all doors that were told are of the present stage, but for the first one. Doors may
     * have left the rollout since the stage began; one at least is told now. */
    const int64_t most = stage->most < doors ? stage->most : doors;
    const int64_t fetching = stage->stage == 1 ? most : most - stage->most / 2;
    const double seconds = (double)(fetching > 1 ? fetching : 1) * (double)bytes /
                           HUB_ROLLOUT_BYTES_PER_S;
    return seconds < HUB_ROLLOUT_SPREAD_MOST_S ? (uint32_t)seconds : HUB_ROLLOUT_SPREAD_MOST_S;
}

#include "tests/firmware/faults/fault_step.h"

#include <errno.h>
#include <string.h>

const int actor_faces[ACTORS] = {[ANNA] = 50, [BOB] = 80, [CARL] = 110, [STRANGER] = 65};

static const int no_face_of_theirs = 300;

static void hand_up(struct world *w, int64_t t_ns, enum actor actor, int x_mm)
{
    const int64_t gap_ns = w->rig->config.decision.gap_ms * ISO_NS_PER_MS;
    const bool echo = actor == w->last_actor && x_mm == w->last_x_mm && t_ns - w->last_ns < gap_ns;
    enum iso_capture capture = actor == NOBODY ? ISO_CAPTURE_NOBODY : ISO_CAPTURE_OK;
    if (actor == PICTURE) {
        capture = ISO_CAPTURE_FLAT;
    }
    puppet_sensor_add_at(&w->rig->sensor, t_ns, actor_faces[actor], capture, x_mm);
    w->last_actor = actor;
    w->last_x_mm = x_mm;
    w->last_ns = t_ns;
    if (w->rig->now_ns - t_ns < w->rig->config.sensor.stale_ms * ISO_NS_PER_MS) {
        w->oracle.sighted_ns = t_ns;
    }
    if (actor_faces[actor]) {
        oracle_see(w, t_ns, actor, echo);
    }
}

void world_expose(struct world *w)
{
    const int64_t t_ns = w->rig->now_ns + FRAME_MS * ISO_NS_PER_MS;
    struct puppet_pipeline *pipeline = &w->rig->puppet;
    pipeline->extract_error = 0;
    pipeline->raving = false;
    w->frames++;
    w->oracle.fetched = oracle_fetched(w);
    if (!w->running || strcmp(iso_appliance_status(w->rig->appliance).sensor_state, "lost") == 0) {
        w->n_late = 0;
        return; /* a closed camera exposes no frame */
    }
    if (!world_is_faulty(w, SIM_FAULT_SENSOR_FROZEN)) {
        w->x_mm = w->frames % 7; /* no person stands quite still */
    }
    if (world_is_faulty(w, SIM_FAULT_SENSOR_GONE) || world_is_faulty(w, SIM_FAULT_SENSOR_DROP)) {
        return;
    }
    if (world_is_faulty(w, SIM_FAULT_SENSOR_BLANK)) {
        hand_up(w, t_ns, NOBODY, w->x_mm);
    } else if (world_is_faulty(w, SIM_FAULT_SENSOR_CORRUPT)) {
        /* A fault changes several frames in a row, so that a decision which kept part of an earlier
         * frame could find two that agree. */
        const int kind = w->frames / 4 % 3;
        pipeline->raving = kind == 0;
        pipeline->extract_error = kind == 1 ? -EDOM : 0;
        puppet_sensor_add_at(&w->rig->sensor, t_ns, no_face_of_theirs,
                             pipeline->raving ? ISO_CAPTURE_OK : ISO_CAPTURE_NOT_A_FACE, w->x_mm);
        w->oracle.sighted_ns = t_ns;
    } else if (world_is_faulty(w, SIM_FAULT_SENSOR_LATE)) {
        w->late[w->n_late].t_ns = t_ns;
        w->late[w->n_late].actor = w->actor;
        w->late[w->n_late++].x_mm = w->x_mm;
    } else {
        for (; w->n_late > 0; w->n_late = 0) {
            for (int i = 0; i < w->n_late; i++) {
                hand_up(w, w->late[i].t_ns, w->late[i].actor, w->late[i].x_mm);
            }
        }
        hand_up(w, t_ns, w->actor, w->x_mm);
        if (world_is_faulty(w, SIM_FAULT_SENSOR_TWICE)) {
            puppet_sensor_add_at(&w->rig->sensor, t_ns, actor_faces[w->actor], ISO_CAPTURE_OK,
                                 w->x_mm);
        }
    }
}

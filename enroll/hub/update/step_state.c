/* What a door says of its updates, and what it means in its rollout. */
#include <string.h>

#include "enroll/hub/update/step_parts.h"

static enum hub__door_state state_of_report(enum iso_fleet_update_state state,
                                            enum hub__door_state before)
{
    switch (state) {
    case ISO_FLEET_UPDATE_FETCHING:
    case ISO_FLEET_UPDATE_INSTALLING:
        return HUB__DOOR_FETCHING;
    case ISO_FLEET_UPDATE_INSTALLED:
        return HUB__DOOR_INSTALLED;
    case ISO_FLEET_UPDATE_FAILED:
        return HUB__DOOR_FAILED;
    case ISO_FLEET_UPDATE_WENT_BACK:
        return HUB__DOOR_WENT_BACK;
    default:
        return before;
    }
}

bool hub__step_is_mute(const struct hub__step *s)
{
    return s->counts && (!s->report.is_known || s->report.state == ISO_FLEET_UPDATE_NONE);
}

static bool has_failed(const struct hub__step *s)
{
    return s->state == HUB__DOOR_FAILED || s->state == HUB__DOOR_WENT_BACK;
}

/* A door that says nothing is left as it is if it has come to its end here, also if it does not
 * count any more: it restarts, and would be told again as one that is able at last. */
static bool is_left(const struct hub__step *s)
{
    return hub__step_is_mute(s) ||
           ((has_failed(s) || s->state == HUB__DOOR_HEALTHY) &&
            (!s->report.is_known || s->report.state == ISO_FLEET_UPDATE_NONE));
}

enum hub__door_state hub__step_state(const struct hub__step *s, const char **why)
{
    const struct iso_fleet_update_report *report = &s->report;
    const bool is_this = iso_fleet_id_is_same(&report->rollout, &s->rollout);
    *why = s->why;
    if (is_left(s)) {
        return s->state;
    }
    *why = "";
    if (!report->is_known) {
        *why = "its release does not know updates by the hub";
        return HUB__DOOR_UNABLE;
    }
    if (report->state == ISO_FLEET_UPDATE_NONE) {
        *why = "this machine takes no updates";
        return HUB__DOOR_UNABLE;
    }
    if (strcmp(report->version, s->version) == 0 &&
        (report->state == ISO_FLEET_UPDATE_HEALTHY || report->state == ISO_FLEET_UPDATE_IDLE)) {
        return HUB__DOOR_HEALTHY;
    }
    /* It would begin the same again, and its stage would never end. */
    if (s->stuck) {
        *why = s->why;
        return HUB__DOOR_FAILED;
    }
    if (is_this && report->state != ISO_FLEET_UPDATE_HEALTHY &&
        report->state != ISO_FLEET_UPDATE_IDLE) {
        *why = report->fault;
        return state_of_report(report->state, s->state);
    }
    if (has_failed(s) && !s->counts) { /* before somebody let the rollout go on */
        *why = s->why;
        return s->state;
    }
    if (s->file.size == 0) {
        *why = "the hub has no file of this version for its board";
        return HUB__DOOR_UNABLE;
    }
    if (s->state == HUB__DOOR_UNABLE) {
        return HUB__DOOR_WAITING;
    }
    if (s->state == HUB__DOOR_FAILED && s->counts) { /* it was silent, and reports again */
        return HUB__DOOR_TOLD;
    }
    *why = s->why;
    return s->state;
}

int hub__step_store(const struct hub__step *s, enum hub__door_state state, bool counts,
                    const char *why, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    hub_value_id(&values, &s->rollout);
    hub_value_id(&values, s->door);
    hub_value_text(&values, hub__door_state_word(state));
    hub_value_switch(&values, counts);
    hub_value_integer(&values, s->store->now_s());
    hub_value_text(&values, why);
    hub_value_text(&values, s->file.board); /* "" without a file */
    hub_value_integer(&values, s->mute_s);
    hub_value_integer(&values, s->clock_s);
    /* A door that says something else of the same state has not moved. A door that is told,
     * fetching or installed is at work. */
    return hub_db_run_often(
        s->store->db,
        "UPDATE rollout_door SET "
        "changed_s = CASE WHEN state = $3 THEN changed_s ELSE $5 END, "
        "finished_s = CASE WHEN state <> $3 AND $3 IN ('healthy', 'failed', 'went-back') THEN $5 "
        "ELSE finished_s END, "
        "work_s = CASE WHEN state IN ('told', 'fetching', 'installed') AND "
        "$3 NOT IN ('told', 'fetching', 'installed') THEN work_s + $9 - work_from_s "
        "ELSE work_s END, "
        "work_from_s = CASE WHEN $3 IN ('told', 'fetching', 'installed') AND "
        "state NOT IN ('told', 'fetching', 'installed') THEN $9 ELSE work_from_s END, "
        "state = $3, counts = $4, fault = $6, board = $7, mute_s = $8, "
        "stuck = stuck AND $3 <> 'healthy' WHERE rollout = $1 AND door = $2",
        &values, NULL, fault);
}

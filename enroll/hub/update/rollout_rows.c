#include "enroll/hub/update/rollout_rows.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

static const char *const door_words[HUB__DOOR_STATES] = {
    [HUB__DOOR_FAILED] = "failed",       [HUB__DOOR_WENT_BACK] = "went-back",
    [HUB__DOOR_TOLD] = "told",           [HUB__DOOR_FETCHING] = "fetching",
    [HUB__DOOR_INSTALLED] = "installed", [HUB__DOOR_WAITING] = "waiting",
    [HUB__DOOR_UNABLE] = "unable",       [HUB__DOOR_HEALTHY] = "healthy",
};

static const char *const rollout_words[HUB_ROLLOUT_STATES] = {"running", "stopped", "done",
                                                              "replaced"};

const char *hub__door_state_word(enum hub__door_state state)
{
    return door_words[state];
}

enum hub__door_state hub__door_state_read(const char *word)
{
    for (unsigned i = 0; i < HUB__DOOR_STATES; i++) {
        if (strcmp(word, door_words[i]) == 0) {
            return (enum hub__door_state)i;
        }
    }
    return HUB__DOOR_WAITING;
}

const char *hub_rollout_state_word(enum hub_rollout_state state)
{
    return rollout_words[state];
}

/* A word that is none stops: the table has no others. */
static enum hub_rollout_state rollout_state_read(const char *word)
{
    for (unsigned i = 0; i < HUB_ROLLOUT_STATES; i++) {
        if (strcmp(word, rollout_words[i]) == 0) {
            return (enum hub_rollout_state)i;
        }
    }
    return HUB_ROLLOUT_STOPPED;
}

void hub__rollout_stage_row(const PGresult *rows, int row, int column,
                            struct hub_rollout_stage *out)
{
    *out = (struct hub_rollout_stage){
        .state = rollout_state_read(hub_row_text(rows, row, column)),
        .stage = hub_row_integer(rows, row, column + 1),
        .most = hub_row_integer(rows, row, column + 2),
        .stop_after = hub_row_integer(rows, row, column + 3),
        .wait_s = hub_row_integer(rows, row, column + 4),
    };
}

int hub__update_file_row(const PGresult *rows, int row, struct hub_update_file *out,
                         struct iso_fault *fault)
{
    struct hub_update_file file = {.size = (uint64_t)hub_row_integer(rows, row, 2),
                                   .added_s = hub_row_integer(rows, row, 4)};
    (void)snprintf(file.version, sizeof file.version, "%s", hub_row_text(rows, row, 0));
    (void)snprintf(file.board, sizeof file.board, "%s", hub_row_text(rows, row, 1));
    if (hub_row_copy(rows, row, 3, file.sha256, sizeof file.sha256)) {
        return iso_fault_set(fault, -EIO, "update %s: the database has no digest of its file",
                             file.version);
    }
    *out = file;
    return 0;
}

int hub__rollout_count(struct hub_store *store, const struct iso_fleet_id *rollout,
                       struct hub_rollout_count *out, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    hub_value_id(&values, rollout);
    const int error = hub_db_run_often(
        store->db,
        "SELECT count(*) FILTER (WHERE counts), "
        "count(*) FILTER (WHERE counts AND state IN ('healthy', 'failed', 'went-back')), "
        "count(*) FILTER (WHERE counts AND state IN ('failed', 'went-back')), "
        "count(*) FILTER (WHERE state = 'waiting'), "
        "coalesce(max(finished_s) FILTER (WHERE counts), 0) FROM rollout_door WHERE rollout = $1",
        &values, &rows, fault);
    if (!error) {
        *out = (struct hub_rollout_count){
            .told = hub_row_integer(rows, 0, 0),
            .finished = hub_row_integer(rows, 0, 1),
            .failed = hub_row_integer(rows, 0, 2),
            .waiting = hub_row_integer(rows, 0, 3),
            .finished_s = hub_row_integer(rows, 0, 4),
        };
        PQclear(rows);
    }
    return error;
}

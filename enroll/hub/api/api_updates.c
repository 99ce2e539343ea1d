/* Updates of the doors' image: the files, and how far the zones are with them. */
#include <errno.h>
#include <sodium.h>

#include "enroll/hub/api/api.h"
#include "enroll/hub/api/look.h"
#include "enroll/hub/update/hub_update.h"

static int append_file(void *list, const struct hub_update_file *file)
{
    char digits[2 * sizeof file->sha256 + 1];

    return json_array_append_new(
               list,
               json_pack("{s:s, s:s, s:I, s:s, s:I}", "version", file->version, "board",
                         file->board, "bytes", (json_int_t)file->size, "sha256",
                         sodium_bin2hex(digits, sizeof digits, file->sha256, sizeof file->sha256),
                         "added_s", (json_int_t)file->added_s))
               ? -ENOMEM
               : 0;
}

static int append_rollout(void *list, const struct hub_rollout *rollout)
{
    const struct hub_rollout_count *count = &rollout->count;
    char id[ISO_FLEET_ID_TEXT_SIZE];

    return json_array_append_new(
               list,
               json_pack("{s:s, s:s, s:s, s:s, s:s, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I}", "id",
                         iso_fleet_id_text(&rollout->id, id), "version", rollout->version, "zone",
                         rollout->zone, "state", hub_rollout_state_word(rollout->stage.state),
                         "why", rollout->why, "stage", (json_int_t)rollout->stage.stage,
                         "started_s", (json_int_t)rollout->started_s, "doors",
                         (json_int_t)rollout->doors, "healthy", (json_int_t)rollout->healthy,
                         "failed", (json_int_t)count->failed, "at_work",
                         (json_int_t)(count->told - count->finished), "waiting",
                         (json_int_t)count->waiting, "unable", (json_int_t)rollout->unable))
               ? -ENOMEM
               : 0;
}

static int list_updates(struct hub_call *call, struct hub_store *store, struct iso_fault *fault)
{
    json_t *files = json_array(), *rollouts = json_array();
    int error = hub_update_each(store, append_file, files, fault);

    error = error ? error : hub_rollout_each(store, append_rollout, rollouts, fault);
    call->json = json_pack("{s:o, s:o}", "files", files, "rollouts", rollouts);
    return error == -ENOMEM || (!error && !call->json) ? hub__no_memory(fault) : error;
}

void hub__api_list_updates(void *api, struct web_exchange *exchange)
{
    hub__call(api, exchange, HUB_LANE_LOOKS, list_updates);
}

static int append_door(void *list, const struct hub_rollout_door *door)
{
    return json_array_append_new(list, json_pack("{s:s, s:s, s:s, s:I, s:I}", "name", door->name,
                                                 "state", door->state, "fault", door->fault,
                                                 "changed_s", (json_int_t)door->changed_s,
                                                 "reported_s", (json_int_t)door->reported_s))
               ? -ENOMEM
               : 0;
}

static int show_doors(struct hub_call *call, struct hub_store *store, const struct hub_zone *zone,
                      struct iso_fault *fault)
{
    json_t *list = json_array();
    int error = hub_rollout_doors(store, zone->name, append_door, list, fault);

    error = error == -ENOENT ? 0 : error; /* the zone has had no rollout */
    call->json = json_pack("{s:o}", "doors", list);
    return error == -ENOMEM || (!error && !call->json) ? hub__no_memory(fault) : error;
}

static int list_rollout_doors(struct hub_call *call, struct hub_store *store,
                              struct iso_fault *fault)
{
    struct hub_zone zone;
    const int error = hub__look_zone(call, store, web_exchange_part(call->request), &zone, fault);

    return error ? error : show_doors(call, store, &zone, fault);
}

void hub__api_list_rollout_doors(void *api, struct web_exchange *exchange)
{
    hub__call(api, exchange, HUB_LANE_LOOKS, list_rollout_doors);
}

/* Stops the rollout of a zone, or lets it go on. The request names it, because the zone may have
 * another one since its sender looked. */
static int turn_rollout(struct hub_call *call, struct hub_store *store, struct iso_fault *fault)
{
    struct hub_zone zone;
    struct iso_fleet_id id;
    bool has = false, running = false;
    int error = hub__call_flag(call, "running", &has, &running, fault);
    const char *text = error
                           ? NULL
                           : hub__call_text(call, "id", ISO_FLEET_ID_TEXT_SIZE - 1, &error, fault);

    if (!error && iso_fleet_id_read(text, &id)) {
        return hub__call_refuse(call, fault, 400, "invalid-member",
                                "id has to be that of a rollout");
    }
    if (!error && !has) {
        return hub__call_refuse(call, fault, 400, "invalid-member",
                                "running has to be true or false");
    }
    error = error ? error
                  : hub__look_zone(call, store, web_exchange_part(call->request), &zone, fault);
    if (error) {
        return error;
    }
    call->absent = "no-such-update"; /* the version of a stopped rollout may be removed */
    error = running ? hub_rollout_resume(store, zone.name, &id, fault)
                    : hub_rollout_stop(store, zone.name, &id, fault);
    return error ? error : show_doors(call, store, &zone, fault);
}

void hub__api_turn_rollout(void *api, struct web_exchange *exchange)
{
    hub__call(api, exchange, HUB_LANE_CHANGES, turn_rollout);
}

#include <jansson.h>
#include <stdio.h>
#include <string.h>

#include "enroll/hub/update/update_step.h"

static const char *member(const json_t *object, const char *name)
{
    const char *text = json_string_value(json_object_get(object, name));
    return text ? text : "";
}

/* A word that cannot be one counts as missing, so that only good words get into the tables. */
static void take_word(const json_t *object, const char *name, char out[ISO_FLEET_UPDATE_WORD_SIZE])
{
    const char *text = member(object, name);
    if (iso_fleet_update_word_is_good(text)) {
        (void)snprintf(out, ISO_FLEET_UPDATE_WORD_SIZE, "%s", text);
    }
}

void hub__update_report_read(const char *health, struct iso_fleet_update_report *out)
{
    json_t *object = json_loads(health, 0, NULL);
    *out = (struct iso_fleet_update_report){.is_known = false};
    if (iso_fleet_update_state_read(member(object, ISO_FLEET_UPDATE_STATE), &out->state) == 0) {
        out->is_known = true;
        if (iso_fleet_id_read(member(object, ISO_FLEET_UPDATE_ROLLOUT), &out->rollout)) {
            out->rollout = (struct iso_fleet_id){.bytes = {0}};
        }
        take_word(object, ISO_FLEET_UPDATE_VERSION, out->version);
        take_word(object, ISO_FLEET_UPDATE_BOARD, out->board);
        iso_fleet_update_fault_copy(out->fault, member(object, ISO_FLEET_UPDATE_FAULT));
    }
    json_decref(object);
}

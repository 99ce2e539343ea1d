/* Settings that are changed while the appliance works. The parts have copies of some of them, which
 * the owners of these parts renew. */
#include <errno.h>
#include <stdio.h>
#include <syslog.h>

#include "firmware/appliance/appliance_access.h"
#include "firmware/appliance/appliance_calls.h"
#include "firmware/config/door_options.h"

/* The door may have started before the settings could be read. */
static void set_door_times(const struct iso_appliance *appliance)
{
    const struct iso_appliance_borrowed *borrowed = &appliance->borrowed;
    const struct iso_door_guard_options options = iso_door_options_of(
        &borrowed->config->door, &borrowed->times, borrowed->door_io, borrowed->threads);
    iso_door_guard_set_times(appliance->door, &options.door);
}

void iso__appliance_apply_settings(struct iso_appliance *appliance)
{
    iso__appliance_end_wait(appliance);
    set_door_times(appliance);
    iso__appliance_end_attack(appliance);
    iso__appliance_init_face(appliance);
    iso__appliance_init_visit(appliance);
    iso__appliance_configure_lockout(appliance);
    iso__appliance_stale_agree(appliance);
}

/* ---- at the start ---- */

static void warn(void *context, const char *text)
{
    iso__appliance_say(context, LOG_WARNING, "%s", text);
}

static void record_load(struct iso_appliance *appliance, const struct iso_settings_file *file)
{
    char note[96];
    struct iso_audit_record record = iso_audit_record_of("setting");
    (void)snprintf(note, sizeof note, "file %llu, settings changed: %zu",
                   (unsigned long long)file->number, file->n);
    record.reason = "loaded";
    record.note = note;
    (void)iso__appliance_note(appliance, &record);
}

void iso__appliance_load_settings(struct iso_appliance *appliance)
{
    struct iso_live_settings *settings = appliance->borrowed.settings;
    struct iso_audit_record record = iso_audit_record_of("setting");
    struct iso_fault fault = {.text = ""};
    if (!settings) {
        return;
    }
    if (iso_live_settings_load(settings, warn, appliance, &fault)) {
        iso__appliance_say(appliance, LOG_ERR,
                           "%s: settings that were changed are lost, those of the configuration "
                           "file hold",
                           fault.text);
        record.reason = "damaged";
        record.note = fault.text;
        (void)iso__appliance_note(appliance, &record);
    } else if (settings->file.number > 0) {
        record_load(appliance, &settings->file);
        set_door_times(appliance);
        iso__appliance_init_face(appliance);
        iso__appliance_init_visit(appliance);
    }
}

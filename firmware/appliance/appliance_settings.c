/* Settings that are changed while the appliance works. The parts have copies of some of them, which
 * the owners of these parts renew. */
#include <errno.h>
#include <stdio.h>
#include <syslog.h>

#include "firmware/appliance/administration.h"
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

static void apply(struct iso_appliance *appliance)
{
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

/* ---- a change ---- */

static int check(const struct iso_appliance *appliance, const struct iso_setting_request *request,
                 struct iso_live_change *change, struct iso_fault *fault)
{
    const struct iso_live_settings *settings = appliance->borrowed.settings;
    if (!settings) {
        return iso_fault_set(fault, -ENOSYS, "settings cannot be changed while the daemon runs");
    }
    const int error = iso_live_settings_check(settings, request->section, request->key,
                                              request->value, change, fault);
    return error ? error : iso__appliance_may_begin(appliance, fault);
}

/* Records the change before it is made. */
static int announce(struct iso_appliance *appliance, const struct iso_setting_request *request,
                    const struct iso_live_change *change, struct iso_fault *fault)
{
    char note[160];
    struct iso_audit_record record = iso_audit_record_of("setting");
    (void)snprintf(note, sizeof note, "%s.%s, %.64s", change->key->section, change->key->name,
                   request->who);
    record.reason = change->reset ? "reset" : "set";
    record.before = change->before;
    record.after = change->after;
    record.note = note;
    return iso__appliance_record_first(appliance, &record, fault);
}

/* Learned templates are deleted as soon as there shall be none. */
static void follow_learning(struct iso_appliance *appliance, int before)
{
    if (before > 0) {
        iso__appliance_unlearn(appliance);
    }
}

int iso_appliance_set_setting(struct iso_appliance *appliance,
                              const struct iso_setting_request *request,
                              char value[ISO_LIVE_VALUE_SIZE], struct iso_fault *fault)
{
    struct iso_live_change change;
    struct iso_fault own = {.text = ""};
    int error = check(appliance, request, &change, fault);
    if (!error) {
        error = announce(appliance, request, &change, fault);
    }
    if (error) {
        return error;
    }
    const int templates = appliance->borrowed.config->update.templates;
    error = iso_live_settings_make(appliance->borrowed.settings, &change, &own);
    iso__appliance_note_storage(appliance, error, &own);
    if (error) {
        struct iso_audit_record record = iso_audit_record_of("setting");
        record.reason = "failed";
        record.note = own.text;
        (void)iso__appliance_record(appliance, &record);
        return iso_fault_set_code(fault, own.code, error, "%s", own.text);
    }
    apply(appliance);
    follow_learning(appliance, templates);
    iso__appliance_say(appliance, LOG_NOTICE, "setting %s.%s: %s", request->section, request->key,
                       change.after);
    (void)snprintf(value, ISO_LIVE_VALUE_SIZE, "%s", change.after);
    return 0;
}

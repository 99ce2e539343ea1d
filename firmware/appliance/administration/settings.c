/* The act of an administrator that changes a setting. */
#include <errno.h>
#include <stdio.h>
#include <syslog.h>

#include "firmware/appliance/administration/administration.h"
#include "firmware/appliance/appliance_calls.h"

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
    iso__appliance_apply_settings(appliance);
    follow_learning(appliance, templates);
    iso__appliance_say(appliance, LOG_NOTICE, "setting %s.%s: %s", request->section, request->key,
                       change.after);
    (void)snprintf(value, ISO_LIVE_VALUE_SIZE, "%s", change.after);
    return 0;
}

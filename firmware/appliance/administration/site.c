/* The acts of an administrator that take back what people have taught the metric. */
#include <stdio.h>
#include <syslog.h>

#include "firmware/appliance/administration/administration.h"
#include "firmware/appliance/appliance_calls.h"

/* Takes back what templates have taught the metric. It is recorded before it is done, and its
 * result after it. */
static int take_back(struct iso_appliance *appliance, const char *reason, const char *who,
                     int (*change)(struct iso_gallery *gallery, size_t *n, struct iso_fault *fault),
                     size_t *n, struct iso_fault *fault)
{
    struct iso_audit_record record = iso_audit_record_of("site");
    struct iso_fault own = {.text = ""};
    char note[80];
    int error = iso__appliance_may_begin(appliance, fault);
    record.reason = reason;
    record.note = who;
    if (!error) {
        error = iso__appliance_record_first(appliance, &record, fault);
    }
    if (error) {
        return error;
    }
    error = change(appliance->borrowed.gallery, n, &own);
    (void)snprintf(note, sizeof note, "%zu %s the metric", error ? 0 : *n,
                   error || *n != 1 ? "templates no longer teach" : "template no longer teaches");
    record.reason = error ? "failed" : "done";
    record.note = error ? own.text : note;
    (void)iso__appliance_record(appliance, &record);
    iso__appliance_note_storage(appliance, error, &own);
    iso__appliance_say(appliance, error ? LOG_ERR : LOG_NOTICE, "site %s: %s", reason,
                       record.reason);
    if (error) {
        return iso_fault_set_code(fault, own.code, error, "%s", own.text);
    }
    if (*n > 0) {
        iso__appliance_record_gallery(appliance, "gallery", NULL);
    }
    return 0;
}

int iso_appliance_reset_site(struct iso_appliance *appliance, const char *who, size_t *n,
                             struct iso_fault *fault)
{
    return take_back(appliance, "reset", who, iso_gallery_reset_site, n, fault);
}

int iso_appliance_roll_back_site(struct iso_appliance *appliance, const char *who, size_t *n,
                                 struct iso_fault *fault)
{
    return take_back(appliance, "rollback", who, iso_gallery_roll_back_site, n, fault);
}

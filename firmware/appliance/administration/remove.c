/* Removes people from the gallery, and wipes the data of them that is left in memory. */
#include <errno.h>
#include <stdio.h>

#include "firmware/appliance/appliance_access.h"
#include "firmware/appliance/appliance_calls.h"
#include "firmware/appliance/appliance_claim.h"

void iso__appliance_forget_person(struct iso_appliance *appliance, const char *name)
{
    const struct iso_pipeline *pipeline = &appliance->borrowed.pipeline;
    const bool idle = appliance->mode == ISO_APPLIANCE_WATCH ||
                      appliance->mode == ISO_APPLIANCE_CLAIMED;
    iso__appliance_forget_outcome(appliance, name);
    if (idle) { /* during an action they belong to the person who is seen now */
        iso__appliance_forget_claim(appliance);
        iso__appliance_forget_enrolment(appliance);
    }
    if (pipeline->ops->forget) {
        pipeline->ops->forget(pipeline->self);
    }
}

int iso_appliance_remove(struct iso_appliance *appliance, const char *person,
                         struct iso_fault *fault)
{
    struct iso_audit_record record = iso_audit_record_of("delete");
    struct iso_fault own = {.text = ""};
    const struct iso_person *known = iso_gallery_find(appliance->borrowed.gallery, person);
    char name[ISO_PERSON_NAME_SIZE]; /* as the gallery spells it */
    if (iso_gallery_state(appliance->borrowed.gallery, fault)) {
        return -EIO;
    }
    if (!known) {
        return iso_fault_set(fault, -ENOENT, "%s: no such person", person);
    }
    (void)snprintf(name, sizeof name, "%s", known->name);
    record.person = name;
    int error = iso__appliance_may_change(appliance, known, fault);
    if (!error) {
        error = iso__appliance_record_first(appliance, &record, fault);
    }
    if (error) {
        return error;
    }
    iso__appliance_end_wait(appliance);
    iso_site_access_forget(appliance->access.site, known->id);
    error = iso_gallery_remove(appliance->borrowed.gallery, name, &own);
    if (error) {
        record.reason = "not-deleted";
        record.note = own.text;
        (void)iso__appliance_record(appliance, &record);
        iso__appliance_note_storage(appliance, error, &own);
        return iso_fault_set_code(fault, own.code, error, "%s", own.text);
    }
    iso__appliance_record_gallery(appliance, "gallery", NULL);
    iso__appliance_forget_person(appliance, name);
    return 0;
}

/* What the appliance knows of its disk, and how a gallery that is out of service comes back. */
#include <errno.h>
#include <syslog.h>

#include "drivers/file/storage_fault.h"
#include "firmware/appliance/appliance_state.h"

static const int64_t retry_ns = ISO_NS_PER_S;

void iso__appliance_note_storage(struct iso_appliance *appliance, int error,
                                 const struct iso_fault *fault)
{
    if (iso_storage_is_refusal(error)) {
        appliance->storage_fault = *fault;
    } else if (!error) {
        appliance->storage_fault = (struct iso_fault){.text = ""};
    }
}

const struct iso_fault *iso__appliance_storage_fault(const struct iso_appliance *appliance)
{
    const bool unread = appliance->lockout_read_ns != ISO_NEVER_NS;
    return unread ? &appliance->lockout_fault : &appliance->storage_fault;
}

void iso__appliance_storage_time(struct iso_appliance *appliance, int64_t t_ns)
{
    struct iso_gallery *gallery = appliance->borrowed.gallery;
    struct iso_fault fault = {.text = ""};
    if (!iso_gallery_state(gallery, &fault)) {
        appliance->gallery_retry_ns = ISO_NEVER_NS;
        return;
    }
    if (appliance->gallery_retry_ns == ISO_NEVER_NS) {
        char tag[ISO_FAULT_TAG_SIZE];
        iso__appliance_say(appliance, LOG_ERR, "%s: nobody is let in%s", fault.text,
                           iso_fault_tag(fault.code, tag));
    } else if (t_ns < appliance->gallery_retry_ns) {
        return;
    }
    appliance->gallery_retry_ns = t_ns + retry_ns;
    if (iso_gallery_recover(gallery, &fault)) {
        iso__appliance_note_storage(appliance, -EIO, &fault);
        return;
    }
    appliance->gallery_retry_ns = ISO_NEVER_NS;
    iso_decision_reset(&appliance->decision); /* who was not compared begins anew */
    iso__appliance_say(appliance, LOG_NOTICE, "the gallery is in service again");
    iso__appliance_record_gallery(appliance, "gallery", "read from the disk again");
}

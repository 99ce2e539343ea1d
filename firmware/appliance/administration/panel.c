/* The act of an administrator that lets the access panel set its key. */
#include <errno.h>
#include <syslog.h>

#include "firmware/appliance/administration/administration.h"
#include "firmware/appliance/appliance_calls.h"

int iso_appliance_install_panel(struct iso_appliance *appliance, struct iso_fault *fault)
{
    struct iso_audit_record record = iso_audit_record_of("panel");
    record.reason = "install";
    if (!appliance->borrowed.panel) {
        return iso_fault_set(fault, -ENODEV, "there is no access panel: [panel] port is empty");
    }
    const int error = iso__appliance_record_first(appliance, &record, fault);
    if (!error) {
        iso_panel_install(appliance->borrowed.panel);
        iso__appliance_say(appliance, LOG_NOTICE, "panel install");
    }
    return error;
}

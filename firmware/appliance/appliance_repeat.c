/* Frames that come again: a camera that is stuck, or fed with stored ones. */
#include <errno.h>
#include <stdio.h>
#include <syslog.h>

#include "firmware/appliance/appliance_state.h"

static void record(struct iso_appliance *appliance, const char *reason, const char *note)
{
    struct iso_audit_record record = iso_audit_record_of("sensor");
    record.reason = reason;
    record.note = note;
    (void)iso__appliance_note(appliance, &record);
}

static void tell_stuck(struct iso_appliance *appliance)
{
    struct iso_sensor_supervisor *supervisor = &appliance->supervisor;
    (void)iso_fault_set_code(&supervisor->fault, ISO_FAULT_SENSOR_REPEATS, -EBADMSG,
                             "sensor %s: its frames repeat earlier ones, they count for nothing",
                             supervisor->model);
    iso__appliance_warn(appliance, &supervisor->fault);
    record(appliance, "repeats", supervisor->fault.text);
}

static void tell_free(struct iso_appliance *appliance)
{
    iso__appliance_say(appliance, LOG_NOTICE, "sensor %s: its frames are new again",
                       appliance->supervisor.model);
    record(appliance, "started", "its frames are new again");
}

bool iso__appliance_repeats(struct iso_appliance *appliance, const struct iso_frame *frame)
{
    const struct iso_fingerprint print = iso_fingerprint_of(
        frame, appliance->extraction.camera_from_face.translation_mm);
    const bool known = iso_frame_memory_repeats(appliance->shown, &print,
                                                iso_times_now_ns(&appliance->borrowed.times));
    const bool repeats = known && !appliance->supervisor.repeats;
    if (iso_repeat_watch_take(&appliance->repeats, repeats)) {
        if (appliance->repeats.stuck) {
            tell_stuck(appliance);
        } else {
            tell_free(appliance);
        }
    }
    return repeats;
}

void iso__appliance_repeat_reset(struct iso_appliance *appliance)
{
    appliance->repeats = (struct iso_repeat_watch){.stuck = false};
}

/* Frames that repeat earlier ones: the camera is stuck, or somebody feeds it with stored frames. */
#include <errno.h>
#include <stdio.h>
#include <syslog.h>

#include "firmware/appliance/appliance_calls.h"

int iso__appliance_new_repeats(struct iso_appliance *appliance)
{
    const struct iso_frame_memory_options options = iso_frame_memory_options_default();
    return iso_frame_memory_new(&options, &appliance->repeats.shown) ? -ENOMEM : 0;
}

void iso__appliance_free_repeats(struct iso_appliance *appliance)
{
    iso_frame_memory_free(appliance->repeats.shown);
}

static void record_sensor(struct iso_appliance *appliance, const char *reason, const char *note)
{
    struct iso_audit_record record = iso_audit_record_of("sensor");
    record.reason = reason;
    record.note = note;
    (void)iso__appliance_note(appliance, &record);
}

static void tell_stuck(struct iso_appliance *appliance)
{
    struct iso_fault fault;
    (void)iso_fault_set_code(&fault, ISO_FAULT_SENSOR_REPEATS, -EBADMSG,
                             "sensor %s: its frames repeat earlier ones and are ignored",
                             appliance->sensor.supervisor.model);
    iso__appliance_blame_sensor(appliance, &fault);
    record_sensor(appliance, "repeats", fault.text);
}

static void tell_free(struct iso_appliance *appliance)
{
    iso__appliance_say(appliance, LOG_NOTICE, "sensor %s: its frames are new again",
                       appliance->sensor.supervisor.model);
    record_sensor(appliance, "started", "its frames are new again");
}

bool iso__appliance_repeats(struct iso_appliance *appliance, const struct iso_frame *frame)
{
    const struct iso_fingerprint print = iso_fingerprint_of(
        frame, appliance->face.extraction.camera_from_face.translation_mm);
    const bool known = iso_frame_memory_repeats(appliance->repeats.shown, &print,
                                                iso_times_now_ns(&appliance->borrowed.times));
    const bool repeats = known && !appliance->sensor.supervisor.repeats;
    if (iso_repeat_watch_take(&appliance->repeats.watch, repeats)) {
        if (appliance->repeats.watch.stuck) {
            tell_stuck(appliance);
        } else {
            tell_free(appliance);
        }
    }
    return repeats;
}

void iso__appliance_repeat_reset(struct iso_appliance *appliance)
{
    appliance->repeats.watch = (struct iso_repeat_watch){.stuck = false};
}

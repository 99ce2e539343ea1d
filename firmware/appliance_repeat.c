/* Frames that come again: a camera that is stuck, or fed with stored ones. */
#include <stdio.h>
#include <syslog.h>

#include "firmware/appliance_state.h"

/* One frame may look like another by chance; so many in a row do not. */
enum { STUCK_FRAMES = 3 };

static void record(struct iso_appliance *appliance, const char *reason, const char *note)
{
    struct iso_audit_record record = iso_audit_record_of("sensor");
    record.reason = reason;
    record.note = note;
    (void)iso__appliance_note(appliance, &record);
}

static void tell_stuck(struct iso_appliance *appliance)
{
    struct iso_sensor_keeper *keeper = &appliance->keeper;
    appliance->stuck = true;
    (void)snprintf(keeper->fault, sizeof keeper->fault,
                   "sensor %s: its frames repeat earlier ones, they count for nothing",
                   keeper->model);
    iso__appliance_say(appliance, LOG_WARNING, "%s", keeper->fault);
    record(appliance, "repeats", keeper->fault);
}

static void tell_free(struct iso_appliance *appliance)
{
    appliance->stuck = false;
    iso__appliance_say(appliance, LOG_NOTICE, "sensor %s: its frames are new again",
                       appliance->keeper.model);
    record(appliance, "started", "its frames are new again");
}

bool iso__appliance_repeats(struct iso_appliance *appliance, const struct iso_frame *frame)
{
    const struct iso_fingerprint print = iso_fingerprint_of(
        frame, appliance->extraction.camera_from_face.translation_mm);
    const bool known = iso_frame_memory_repeats(appliance->shown, &print,
                                                iso_times_now_ns(&appliance->parts.times));
    const bool repeats = known && !appliance->keeper.repeats;
    appliance->repeats = repeats ? appliance->repeats + 1 : 0;
    if (!appliance->stuck && appliance->repeats == STUCK_FRAMES) {
        tell_stuck(appliance);
    } else if (appliance->stuck && !repeats) {
        tell_free(appliance);
    }
    return repeats;
}

void iso__appliance_repeat_reset(struct iso_appliance *appliance)
{
    appliance->repeats = 0;
    appliance->stuck = false;
}

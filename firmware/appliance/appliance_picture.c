/* One picture of what the camera sees, for the client that has the claim. */
#include <errno.h>

#include "firmware/appliance/appliance_calls.h"

/* A camera that works delivers a frame in less time. */
static const int64_t patience_ns = 3 * ISO_NS_PER_S;

static int may_ask(const struct iso_appliance *appliance, struct iso_fault *fault)
{
    if (appliance->mode == ISO_APPLIANCE_WATCH) {
        return iso_fault_set(fault, -EACCES, "claim the camera first");
    }
    if (appliance->mode != ISO_APPLIANCE_CLAIMED) {
        return iso_fault_set(fault, -EBUSY, "%s goes on, stop it first",
                             iso_appliance_mode_name(appliance->mode));
    }
    if (appliance->picture.due) {
        return iso_fault_set(fault, -EBUSY, "the picture asked for before has not come yet");
    }
    return iso__appliance_has_sensor(appliance, fault);
}

int iso_appliance_picture(struct iso_appliance *appliance, struct iso_fault *fault)
{
    const struct iso_audit_record record = iso_audit_record_of("picture");
    int error = may_ask(appliance, fault);
    if (!error) {
        error = iso__appliance_record_first(appliance, &record, fault);
    }
    if (!error) {
        appliance->picture.due = true;
        appliance->picture.end_ns = iso_times_now_ns(&appliance->borrowed.times) + patience_ns;
    }
    return error;
}

/* Answers the client that waits, if there is one. */
static void answer(struct iso_appliance *appliance, const struct iso_frame *frame)
{
    const struct iso_appliance_events *events = &appliance->borrowed.events;
    if (appliance->picture.due) {
        appliance->picture.due = false;
        events->picture(events->context, frame);
    }
}

void iso__appliance_picture_frame(struct iso_appliance *appliance, const struct iso_frame *frame)
{
    answer(appliance, frame);
}

void iso__appliance_picture_drop(struct iso_appliance *appliance)
{
    answer(appliance, NULL);
}

int64_t iso__appliance_picture_due_ns(const struct iso_appliance *appliance)
{
    return appliance->picture.due ? appliance->picture.end_ns : ISO_NEVER_NS;
}

void iso__appliance_picture_time(struct iso_appliance *appliance, int64_t now_ns)
{
    if (appliance->picture.due && now_ns >= appliance->picture.end_ns) {
        answer(appliance, NULL);
    }
}

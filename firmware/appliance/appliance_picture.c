/* The frames that clients see: one picture for the client that has the claim, and all frames for
 * those who watch. */
#include <errno.h>

#include "firmware/appliance/appliance_access.h"
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

/* ---- all frames ---- */

void iso_appliance_report_frames(struct iso_appliance *appliance, bool on)
{
    appliance->picture.reports = on;
}

int iso_appliance_record_relief(struct iso_appliance *appliance, struct iso_fault *fault)
{
    const struct iso_audit_record record = iso_audit_record_of("relief");
    if (appliance->mode == ISO_APPLIANCE_WATCH) {
        return iso_fault_set(fault, -EACCES, "claim the camera first");
    }
    return iso__appliance_record_first(appliance, &record, fault);
}

/* Whether the verdict of the last visit belongs to the person who is seen now. */
static bool has_verdict(const struct iso_appliance *appliance)
{
    return appliance->mode == ISO_APPLIANCE_WATCH &&
           appliance->visit.decision.state == ISO_DECISION_SPENT;
}

static void report_frame(const struct iso_appliance *appliance, const struct iso_frame *frame,
                         enum iso_capture capture)
{
    const struct iso_appliance_events *events = &appliance->borrowed.events;
    const struct iso_rigid *pose = &appliance->face.extraction.camera_from_face;
    const enum iso_reason lock = iso__appliance_lock_reason(appliance);
    const struct iso_verdict *verdict = &appliance->outcome.verdict;
    const char *wanted = iso__appliance_wanted(appliance);
    const bool has_face = capture != ISO_CAPTURE_NOBODY && capture != ISO_CAPTURE_NO_FACE &&
                          pose->translation_mm.z > 0.0;
    const struct iso_seen_frame seen = {
        .frame = frame,
        .camera_from_face = has_face ? pose : NULL,
        .distance_mm = has_face ? pose->translation_mm.z : 0.0,
        .mode = appliance->mode,
        .hint = appliance->mode == ISO_APPLIANCE_CLAIMED
                    ? ISO_CAPTURE_OK
                    : iso_hint_filter_word(&appliance->visit.hints),
        .verdict = *wanted                   ? ISO_CONTRACT_VERDICT_WAIT
                   : !has_verdict(appliance) ? ""
                   : verdict->allow          ? "allow"
                                             : "deny",
        .reason = *wanted                  ? wanted
                  : has_verdict(appliance) ? iso_reason_name(verdict->reason)
                                           : "",
        .lockdown = appliance->lockout.state.lockdown,
        .locked_out = lock == ISO_REASON_LOCKED_OUT,
    };
    events->seen(events->context, &seen);
}

void iso__appliance_report_frame(struct iso_appliance *appliance, const struct iso_frame *frame,
                                 enum iso_capture capture)
{
    if (appliance->picture.reports) {
        report_frame(appliance, frame, capture);
    }
}

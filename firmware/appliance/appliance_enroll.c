/* ENROLL: adds a person, or templates of a person, to the gallery. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <syslog.h>

#include "drivers/file/storage_fault.h"
#include "firmware/appliance/appliance_calls.h"
#include "firmware/appliance/appliance_claim.h"
#include "firmware/config/enroll_options.h"
#include "firmware/contract/contract.h"

/* The stored limits of a person; NULL: no limits. */
static struct iso_validity validity_of(const struct iso_person *person)
{
    return person ? (struct iso_validity){person->valid_from_s, person->valid_until_s}
                  : (struct iso_validity){0};
}

static int check_request(const struct iso_appliance *appliance,
                         const struct iso_enroll_request *request, struct iso_fault *fault)
{
    const struct iso_person *known = iso_gallery_find(appliance->borrowed.gallery, request->person);
    const struct iso_validity before = validity_of(known);
    const int64_t now_s = iso_times_wall_ns(&appliance->borrowed.times) / ISO_NS_PER_S;
    char validity_flaw[ISO_VALIDITY_FLAW_SIZE];
    if (!iso_validity_is_fine(&before, &request->validity, now_s, validity_flaw)) {
        return iso_fault_set(fault, -EINVAL, "%s", validity_flaw);
    }
    const int error = iso__appliance_may_change(appliance, known, fault);
    return error ? error
                 : iso_gallery_room(appliance->borrowed.gallery, request->person,
                                    request->poses ? ISO_ENROLL_POSES : 1, fault);
}

/* ---- the steps of an enrolment with poses ---- */

static void tell_step(const struct iso_appliance *appliance, enum iso_enroll_pose pose,
                      const char *state, double turn_deg)
{
    const struct iso_appliance_events *events = &appliance->borrowed.events;
    events->enroll_step(events->context, iso_enroll_pose_name(pose), state, (unsigned)pose + 1,
                        ISO_ENROLL_POSES, turn_deg);
}

/* Reports the steps that have ended since the present step was `before`, and the one that has
 * begun. */
static void tell_steps_since(struct iso_appliance *appliance, enum iso_enroll_pose before)
{
    const struct iso_enrolment *enrolment = &appliance->enrolling.enrolment;
    if (!enrolment->options.poses || enrolment->pose == before) {
        return;
    }
    for (enum iso_enroll_pose pose = before; pose < enrolment->pose; pose++) {
        tell_step(appliance, pose,
                  enrolment->kept[pose] ? ISO_CONTRACT_STEP_PASSED : ISO_CONTRACT_STEP_LEFT_OUT,
                  0.0);
    }
    iso__appliance_reset_hints(appliance); /* the frames of the step before no longer count */
    if (enrolment->state == ISO_ENROLMENT_ACTIVE) {
        tell_step(appliance, enrolment->pose, ISO_CONTRACT_STEP_BEGUN, 0.0);
    }
}

static struct iso_enroll_gate gate_of(const struct iso_appliance *appliance)
{
    struct iso_enroll_gate gate = iso_enroll_gate_of(&appliance->borrowed.config->enroll);
    if (appliance->mode == ISO_APPLIANCE_ENROLL) {
        gate.pose = appliance->enrolling.enrolment.pose;
    }
    return gate;
}

/* Reports how far the head is from the pose, if it is not in the pose. */
static void tell_turn(const struct iso_appliance *appliance)
{
    const struct iso_extraction *extraction = &appliance->face.extraction;
    const struct iso_enroll_gate gate = gate_of(appliance);
    double turn_rad = 0.0;
    if (appliance->enrolling.enrolment.options.poses && extraction->fitted &&
        iso_enroll_pose_judge(gate.pose, &gate.angles, extraction->yaw_rad, extraction->pitch_rad,
                              &turn_rad) != ISO_CAPTURE_OK) {
        tell_step(appliance, gate.pose, ISO_CONTRACT_STEP_TURN, turn_rad / ISO_RAD_PER_DEG);
    }
}

/* ---- beginning ---- */

int iso_appliance_enroll(struct iso_appliance *appliance, const struct iso_enroll_request *request,
                         struct iso_fault *fault)
{
    const struct iso_config_enroll *config = &appliance->borrowed.config->enroll;
    const struct iso_enrolment_options options = {
        .stages = config->stages,
        .poses = request->poses,
        .pose_stages = config->pose_stages,
        .pose_timeout_ns = config->pose_timeout_ms * ISO_NS_PER_MS,
        .agree_score = config->agree_score,
        .duplicate_score = config->duplicate_score,
        .attack_frames = appliance->borrowed.config->decision.attack_frames,
        .timeout_ns = config->timeout_ms * ISO_NS_PER_MS,
        .allow_duplicate = request->allow_duplicate,
    };
    int error = iso__appliance_may_act(appliance, fault);
    if (!error) {
        error = check_request(appliance, request, fault);
    }
    if (error) {
        return error;
    }
    const struct iso_person *known = iso_gallery_find(appliance->borrowed.gallery, request->person);
    appliance->enrolling.person = (struct iso_person){.id = known ? known->id : 0};
    appliance->enrolling.validity = request->validity;
    (void)snprintf(appliance->enrolling.person.name, sizeof appliance->enrolling.person.name, "%s",
                   known ? known->name : request->person);
    iso_enrolment_begin(&appliance->enrolling.enrolment, &options,
                        iso__appliance_now_ns(appliance));
    iso__appliance_begin_action(appliance, ISO_APPLIANCE_ENROLL, config->timeout_ms);
    if (request->poses) {
        tell_step(appliance, ISO_ENROLL_FRONTAL, ISO_CONTRACT_STEP_BEGUN, 0.0);
    }
    return 0;
}

/* ---- the end ---- */

/* The person whose face the enrolment shows under another name; NULL: nobody. */
static const struct iso_person *duplicate_of(const struct iso_appliance *appliance)
{
    return appliance->enrolling.enrolment.state == ISO_ENROLMENT_DUPLICATE
               ? iso_gallery_find_id(appliance->borrowed.gallery,
                                     appliance->enrolling.enrolment.duplicate_of)
               : NULL;
}

/* `detail`: the name of that person, the error of the disk, or "". */
static void tell_enrolment(const struct iso_appliance *appliance, const char *result, bool done,
                           double quality, const char *detail)
{
    const struct iso_appliance_events *events = &appliance->borrowed.events;
    events->enroll_status(events->context, result, done,
                          (unsigned)appliance->enrolling.enrolment.stage,
                          (unsigned)appliance->enrolling.enrolment.stages, quality, detail);
}

static struct iso_audit_record enrolment_record(const struct iso_appliance *appliance,
                                                const char *reason)
{
    struct iso_audit_record record = iso_audit_record_of("enroll");
    record.person = appliance->enrolling.person.name;
    record.reason = reason;
    record.frames = appliance->enrolling.enrolment.stage;
    if (appliance->enrolling.enrolment.attack_frames > 0) {
        record.attack_frames = appliance->enrolling.enrolment.attack_frames;
    }
    return record;
}

static int record_enrolment(struct iso_appliance *appliance, const char *reason, const char *note)
{
    struct iso_audit_record record = enrolment_record(appliance, reason);
    record.note = note;
    return iso__appliance_record(appliance, &record);
}

/* Writes the poses that are kept, such as "poses: frontal left up"; "" without poses. */
static void write_poses(const struct iso_enrolment *enrolment, char out[static 64])
{
    size_t used = 0;
    out[0] = '\0';
    for (int pose = 0; enrolment->options.poses && pose < ISO_ENROLL_POSES; pose++) {
        if (enrolment->kept[pose]) {
            used += (size_t)snprintf(out + used, 64 - used, "%s %s", used ? "" : "poses:",
                                     iso_enroll_pose_name((enum iso_enroll_pose)pose));
        }
    }
}

/* Records that the enrolment is complete, which poses it has, and which limits of validity it
 * changes. Limits that the request does not name stay as the gallery has them. */
static int record_completion(struct iso_appliance *appliance, struct iso_fault *fault)
{
    struct iso_audit_record record = enrolment_record(appliance, ISO_CONTRACT_RESULT_COMPLETED);
    char poses[64];
    const struct iso_person *known = iso_gallery_find_id(appliance->borrowed.gallery,
                                                         appliance->enrolling.person.id);
    if (appliance->enrolling.person.id != 0 && !known) {
        /* The person was removed meanwhile, and with the person the limits that were not named. */
        return iso_fault_set(fault, -ENOENT, "%s: no such person",
                             appliance->enrolling.person.name);
    }
    const struct iso_validity before = validity_of(known);
    const struct iso_validity after = iso_validity_after(&before, &appliance->enrolling.validity);
    char before_text[ISO_VALIDITY_TEXT_SIZE], after_text[ISO_VALIDITY_TEXT_SIZE];
    appliance->enrolling.person.valid_from_s = after.from_s;
    appliance->enrolling.person.valid_until_s = after.until_s;
    if (!iso_validity_is_same(&before, &after)) {
        iso_validity_text(&before, before_text);
        iso_validity_text(&after, after_text);
        record.before = known ? before_text : NULL;
        record.after = after_text;
    }
    write_poses(&appliance->enrolling.enrolment, poses);
    record.note = *poses ? poses : NULL;
    return iso__appliance_record_first(appliance, &record, fault);
}

/* Points `out` [ISO_ENROLL_POSES] to the templates to be kept, and returns their number. */
static int kept_templates(const struct iso_enrolment *enrolment, const struct iso_template **out)
{
    int n = 0;
    for (int pose = 0; pose < ISO_ENROLL_POSES; pose++) {
        if (enrolment->kept[pose]) {
            out[n++] = &enrolment->fused[pose];
        }
    }
    return n;
}

static int add_person(struct iso_appliance *appliance, struct iso_fault *fault)
{
    const struct iso_template *templates[ISO_ENROLL_POSES];
    const int n = kept_templates(&appliance->enrolling.enrolment, templates);
    const int error = iso_gallery_add_all(appliance->borrowed.gallery, &appliance->enrolling.person,
                                          templates, n, fault);
    if (error) {
        (void)record_enrolment(appliance, "not-stored", fault->text);
        iso__appliance_note_storage(appliance, error, fault);
    }
    return error;
}

/* Stores the templates, after the record of them. Without a record nothing is stored. */
static int keep_enrolment(struct iso_appliance *appliance, struct iso_fault *fault)
{
    appliance->enrolling.person.enrolled_s = iso_times_wall_ns(&appliance->borrowed.times) /
                                             ISO_NS_PER_S;
    int error = iso_gallery_state(appliance->borrowed.gallery, fault);
    if (!error) { /* the hub may have sent this person meanwhile */
        error = iso__appliance_may_change(
            appliance,
            iso_gallery_find(appliance->borrowed.gallery, appliance->enrolling.person.name), fault);
    }
    if (!error) {
        error = record_completion(appliance, fault);
    }
    if (!error) {
        error = add_person(appliance, fault);
    }
    if (error) {
        iso__appliance_say(appliance, LOG_ERR, "an enrolment could not be stored: %s",
                           iso_storage_is_refusal(error) ? fault->text : strerror(-error));
        return error;
    }
    iso__appliance_record_gallery(appliance, "gallery", NULL);
    return 0;
}

/* The note in the record of an enrolment that failed: the cue of an attack, or the name of a
 * duplicate; NULL: none. */
static const char *enrolment_note(const struct iso_appliance *appliance)
{
    const struct iso_person *duplicate = duplicate_of(appliance);
    if (appliance->enrolling.enrolment.state == ISO_ENROLMENT_ATTACK) {
        return iso_capture_name(appliance->enrolling.enrolment.cue);
    }
    return duplicate ? duplicate->name : NULL;
}

/* The detail for clients: the name of a duplicate, or the error of the disk; "": none. */
static const char *enrolment_detail(const struct iso_appliance *appliance, int error,
                                    const struct iso_fault *fault)
{
    const struct iso_person *duplicate = duplicate_of(appliance);
    if (duplicate) {
        return duplicate->name;
    }
    return iso_storage_is_refusal(error) ? fault->text : "";
}

/* Reports a final state of the enrolment. */
static void finish_enrolment(struct iso_appliance *appliance)
{
    static const char *const results[] = {
        [ISO_ENROLMENT_COMPLETED] = ISO_CONTRACT_RESULT_COMPLETED,
        [ISO_ENROLMENT_DUPLICATE] = ISO_CONTRACT_RESULT_DUPLICATE,
        [ISO_ENROLMENT_FAILED] = ISO_CONTRACT_RESULT_FAILED,
        [ISO_ENROLMENT_TIMED_OUT] = ISO_CONTRACT_RESULT_TIMED_OUT,
        [ISO_ENROLMENT_DISCONNECTED] = ISO_CONTRACT_RESULT_DISCONNECTED,
        [ISO_ENROLMENT_ATTACK] = ISO_CONTRACT_RESULT_ATTACK,
        [ISO_ENROLMENT_OTHER_FACE] = ISO_CONTRACT_RESULT_OTHER_FACE,
    };
    const enum iso_enrolment_state state = appliance->enrolling.enrolment.state;
    const char *result = results[state];
    bool has_quality = state == ISO_ENROLMENT_COMPLETED || state == ISO_ENROLMENT_DUPLICATE;
    struct iso_fault fault = {.text = ""};
    int error = 0;
    if (state == ISO_ENROLMENT_ACTIVE) {
        return;
    }
    if (state == ISO_ENROLMENT_COMPLETED) {
        error = keep_enrolment(appliance, &fault);
    } else {
        (void)record_enrolment(appliance, result, enrolment_note(appliance));
    }
    if (error) {
        result = iso_storage_is_refusal(error) ? ISO_CONTRACT_RESULT_NOT_STORED
                                               : ISO_CONTRACT_RESULT_FAILED;
        has_quality = false;
    }
    tell_enrolment(
        appliance, result, true,
        has_quality ? (double)appliance->enrolling.enrolment.fused[ISO_ENROLL_FRONTAL].quality : 0,
        enrolment_detail(appliance, error, &fault));
    iso__appliance_end_action(appliance);
}

void iso__appliance_tell_enrolment_hint(struct iso_appliance *appliance, const char *word)
{
    tell_turn(appliance);
    tell_enrolment(appliance, word, false, 0, "");
}

void iso__appliance_disconnect_enrolment(struct iso_appliance *appliance)
{
    iso_enrolment_disconnect(&appliance->enrolling.enrolment);
    finish_enrolment(appliance);
}

void iso__appliance_time_enrolment(struct iso_appliance *appliance, int64_t now_ns)
{
    const enum iso_enroll_pose pose = appliance->enrolling.enrolment.pose;
    iso_enrolment_time(&appliance->enrolling.enrolment, now_ns);
    tell_steps_since(appliance, pose);
    finish_enrolment(appliance);
}

int64_t iso__appliance_enrolment_due_ns(const struct iso_appliance *appliance)
{
    return iso_enrolment_due_ns(&appliance->enrolling.enrolment);
}

void iso__appliance_wipe_enrolment(struct iso_appliance *appliance)
{
    iso_enrolment_wipe(&appliance->enrolling.enrolment);
}

void iso__appliance_forget_enrolment(struct iso_appliance *appliance)
{
    explicit_bzero(&appliance->enrolling.person, sizeof appliance->enrolling.person);
    iso__appliance_wipe_enrolment(appliance);
}

enum iso_capture iso__appliance_enroll_gate(const struct iso_appliance *appliance)
{
    const struct iso_enroll_gate gate = gate_of(appliance);
    return iso_enroll_gate_judge(&gate, &appliance->face.extraction);
}

void iso__appliance_enroll_attack(struct iso_appliance *appliance, enum iso_capture cue)
{
    iso_enrolment_attack(&appliance->enrolling.enrolment, cue);
    finish_enrolment(appliance);
}

void iso__appliance_enroll_face(struct iso_appliance *appliance)
{
    const struct iso_template *tmpl = &appliance->face.extraction.tmpl;
    struct iso_enrolment_gallery gallery = {.person = appliance->enrolling.person.id};
    const enum iso_enroll_pose pose = appliance->enrolling.enrolment.pose;
    bool passed = false;
    gallery.everybody = iso_gallery_everybody(appliance->borrowed.gallery);
    gallery.own = iso_gallery_only(appliance->borrowed.gallery, gallery.person);
    const int error = iso_enrolment_frame(&appliance->enrolling.enrolment, tmpl,
                                          iso__appliance_now_ns(appliance),
                                          &appliance->borrowed.pipeline, &gallery, &passed);
    if (error) {
        struct iso_fault fault;
        (void)iso_fault_set(&fault, error, "%s", strerror(-error));
        iso__appliance_complain(appliance, &fault);
    }
    if (passed) {
        iso__appliance_forget_hint(appliance);
        tell_enrolment(appliance, ISO_CONTRACT_RESULT_STAGE_PASSED, false, (double)tmpl->quality,
                       "");
    } else if (!error) {
        tell_enrolment(appliance, ISO_CONTRACT_RESULT_STAGE_MISFIT, false, 0, "");
    }
    tell_steps_since(appliance, pose);
    finish_enrolment(appliance);
}

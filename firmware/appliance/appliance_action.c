/* What a client does with a camera that it has claimed. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <syslog.h>

#include "drivers/file/storage_fault.h"
#include "firmware/appliance/appliance_state.h"
#include "firmware/appliance/enroll_gate.h"
#include "firmware/contract/contract.h"

static bool is_action(enum iso_appliance_mode mode)
{
    return mode >= ISO_APPLIANCE_ENROLL;
}

/* ---- claim ---- */

/* CLAIMED, with the whole time of a claim again. */
static void rest(struct iso_appliance *appliance)
{
    iso_decision_reset(&appliance->decision);
    iso_enrolment_wipe(&appliance->enrolment);
    appliance->mode = ISO_APPLIANCE_CLAIMED;
    appliance->deadline_ns = iso__appliance_now_ns(appliance) +
                             appliance->borrowed.config->bus.claim_ms * ISO_NS_PER_MS;
}

int iso_appliance_claim(struct iso_appliance *appliance)
{
    if (appliance->mode != ISO_APPLIANCE_WATCH) {
        return -EBUSY;
    }
    rest(appliance);
    appliance->ended = ISO_APPLIANCE_CLAIMED;
    return 0;
}

void iso_appliance_release(struct iso_appliance *appliance)
{
    if (appliance->mode != ISO_APPLIANCE_WATCH) {
        iso__appliance_picture_drop(appliance);
        rest(appliance);
        iso_hint_filter_reset(&appliance->hints);
        appliance->mode = ISO_APPLIANCE_WATCH;
    }
}

/* ---- beginning ---- */

static int may_begin(const struct iso_appliance *appliance, struct iso_fault *fault)
{
    if (appliance->mode == ISO_APPLIANCE_WATCH) {
        return iso_fault_set(fault, -EACCES, "claim the camera first");
    }
    if (is_action(appliance->mode)) {
        return iso_fault_set(fault, -EBUSY, "%s goes on, stop it first",
                             iso_appliance_mode_name(appliance->mode));
    }
    if (!appliance->supervisor.sensor) {
        return iso_fault_set_code(fault, appliance->supervisor.fault.code, -ENODEV, "%s",
                                  appliance->supervisor.fault.text);
    }
    return iso_gallery_state(appliance->borrowed.gallery, fault);
}

/* Whoever is locked out of the door learns nothing in another way. */
static int may_recognise(const struct iso_appliance *appliance, struct iso_fault *fault)
{
    const enum iso_reason refusal = iso_lockout_refusal(&appliance->lockout);
    const int error = may_begin(appliance, fault);
    if (!error && refusal != ISO_REASON_NONE) {
        return iso_fault_set(fault, -EPERM, "nobody is recognised now: %s",
                             iso_reason_name(refusal));
    }
    return error;
}

static void begin(struct iso_appliance *appliance, enum iso_appliance_mode mode, int duration_ms)
{
    iso_decision_reset(&appliance->decision);
    iso_hint_filter_reset(&appliance->hints);
    iso__appliance_picture_drop(appliance); /* who is enrolled now is not shown */
    appliance->mode = mode;
    appliance->ended = ISO_APPLIANCE_CLAIMED;
    appliance->deadline_ns = iso__appliance_now_ns(appliance) + duration_ms * ISO_NS_PER_MS;
}

/* Limits as they are stored; nobody has none. */
static struct iso_validity validity_of(const struct iso_person *person)
{
    return person ? (struct iso_validity){person->valid_from_s, person->valid_until_s}
                  : (struct iso_validity){0};
}

static int check_request(const struct iso_appliance *appliance,
                         const struct iso_enroll_request *request, struct iso_fault *fault)
{
    const char *flaw = iso_person_name_flaw(request->person);
    if (flaw) {
        return iso_fault_set(fault, -EINVAL, "%s", flaw);
    }
    const struct iso_person *known = iso_gallery_find(appliance->borrowed.gallery, request->person);
    const struct iso_validity before = validity_of(known);
    const int64_t now_s = iso_times_wall_ns(&appliance->borrowed.times) / ISO_NS_PER_S;
    char validity_flaw[ISO_VALIDITY_FLAW_SIZE];
    if (!iso_validity_is_fine(&before, &request->validity, now_s, validity_flaw)) {
        return iso_fault_set(fault, -EINVAL, "%s", validity_flaw);
    }
    return iso_gallery_room(appliance->borrowed.gallery, request->person, fault);
}

int iso_appliance_enroll(struct iso_appliance *appliance, const struct iso_enroll_request *request,
                         struct iso_fault *fault)
{
    const struct iso_config_enroll *config = &appliance->borrowed.config->enroll;
    const struct iso_enrolment_options options = {
        .stages = config->stages,
        .agree_score = config->agree_score,
        .duplicate_score = config->duplicate_score,
        .attack_frames = appliance->borrowed.config->decision.attack_frames,
        .timeout_ns = config->timeout_ms * ISO_NS_PER_MS,
        .allow_duplicate = request->allow_duplicate,
    };
    int error = may_begin(appliance, fault);
    if (!error) {
        error = check_request(appliance, request, fault);
    }
    if (error) {
        return error;
    }
    const struct iso_person *known = iso_gallery_find(appliance->borrowed.gallery, request->person);
    appliance->person = (struct iso_person){.id = known ? known->id : 0};
    appliance->validity = request->validity;
    (void)snprintf(appliance->person.name, sizeof appliance->person.name, "%s",
                   known ? known->name : request->person);
    iso_enrolment_begin(&appliance->enrolment, &options, iso__appliance_now_ns(appliance));
    begin(appliance, ISO_APPLIANCE_ENROLL, config->timeout_ms);
    return 0;
}

int iso_appliance_verify(struct iso_appliance *appliance, const char *person,
                         struct iso_fault *fault)
{
    const int error = may_recognise(appliance, fault);
    if (error) {
        return error;
    }
    const struct iso_person *known = iso_gallery_find(appliance->borrowed.gallery, person);
    if (!known) {
        return iso_fault_set(fault, -ENOENT, "%s: no such person", person);
    }
    if (known->usable == 0) {
        return iso_fault_set(fault, -EINVAL,
                             "%s: the %u templates are of another algorithm; enrol anew", person,
                             known->templates);
    }
    appliance->person = *known;
    begin(appliance, ISO_APPLIANCE_VERIFY, appliance->borrowed.config->bus.action_ms);
    return 0;
}

int iso_appliance_identify(struct iso_appliance *appliance, struct iso_fault *fault)
{
    const int error = may_recognise(appliance, fault);
    if (!error) {
        begin(appliance, ISO_APPLIANCE_IDENTIFY, appliance->borrowed.config->bus.action_ms);
    }
    return error;
}

int iso_appliance_stop_action(struct iso_appliance *appliance, enum iso_appliance_mode mode)
{
    if (!is_action(mode) || (appliance->mode != mode && appliance->ended != mode)) {
        return -ENODATA;
    }
    if (appliance->mode == mode) {
        rest(appliance);
    }
    appliance->ended = ISO_APPLIANCE_CLAIMED;
    return 0;
}

/* ---- reporting ---- */

/* Whom the enrolment that ends duplicates; NULL: nobody. */
static const struct iso_person *duplicate_of(const struct iso_appliance *appliance)
{
    return appliance->enrolment.state == ISO_ENROLMENT_DUPLICATE
               ? iso_gallery_find_id(appliance->borrowed.gallery, appliance->enrolment.duplicate_of)
               : NULL;
}

/* `detail`: whom it duplicates, what the disk refused, or "". */
static void tell_enrolment(const struct iso_appliance *appliance, const char *result, bool done,
                           double quality, const char *detail)
{
    const struct iso_appliance_events *events = &appliance->borrowed.events;
    events->enroll_status(events->context, result, done, (unsigned)appliance->enrolment.stage,
                          (unsigned)appliance->enrolment.options.stages, quality, detail);
}

static void tell_recognition(const struct iso_appliance *appliance, const char *result, bool done,
                             const char *person, double score)
{
    const struct iso_appliance_events *events = &appliance->borrowed.events;
    events->recognition_status(events->context, appliance->mode, result, done, person, score,
                               iso__appliance_threshold(appliance));
}

/* The action has ended by itself; `tell` comes before, as it needs the mode. */
static void end(struct iso_appliance *appliance)
{
    const enum iso_appliance_mode mode = appliance->mode;
    rest(appliance);
    appliance->ended = mode;
}

void iso__appliance_tell_hint(struct iso_appliance *appliance, enum iso_capture capture)
{
    const struct iso_appliance_events *events = &appliance->borrowed.events;
    char word[48];
    (void)snprintf(word, sizeof word, ISO_CONTRACT_RESULT_RETRY "%s", iso_capture_name(capture));
    if (appliance->mode == ISO_APPLIANCE_WATCH) {
        events->hint(events->context, capture);
    } else if (appliance->mode == ISO_APPLIANCE_ENROLL) {
        tell_enrolment(appliance, word, false, 0, "");
    } else {
        tell_recognition(appliance, word, false, "", NAN);
    }
}

/* ---- enrolling ---- */

static struct iso_audit_record enrolment_record(const struct iso_appliance *appliance,
                                                const char *reason)
{
    struct iso_audit_record record = iso_audit_record_of("enroll");
    record.person = appliance->person.name;
    record.reason = reason;
    record.frames = appliance->enrolment.stage;
    if (appliance->enrolment.attack_frames > 0) {
        record.attack_frames = appliance->enrolment.attack_frames;
    }
    return record;
}

static int record_enrolment(struct iso_appliance *appliance, const char *reason, const char *note)
{
    struct iso_audit_record record = enrolment_record(appliance, reason);
    record.note = note;
    return iso__appliance_record(appliance, &record);
}

/* That it is complete, and which limits it changes. The person takes the limits that follow: those
 * that were not named stay as the gallery has them. */
static int record_completion(struct iso_appliance *appliance, struct iso_fault *fault)
{
    struct iso_audit_record record = enrolment_record(appliance, ISO_CONTRACT_RESULT_COMPLETED);
    const struct iso_person *known = iso_gallery_find_id(appliance->borrowed.gallery,
                                                         appliance->person.id);
    if (appliance->person.id != 0 && !known) {
        /* Removed meanwhile: limits that were not named are not known any more. */
        return iso_fault_set(fault, -ENOENT, "%s: no such person", appliance->person.name);
    }
    const struct iso_validity before = validity_of(known);
    const struct iso_validity after = iso_validity_after(&before, &appliance->validity);
    char before_text[ISO_VALIDITY_TEXT_SIZE], after_text[ISO_VALIDITY_TEXT_SIZE];
    appliance->person.valid_from_s = after.from_s;
    appliance->person.valid_until_s = after.until_s;
    if (!iso_validity_is_same(&before, &after)) {
        iso_validity_text(&before, before_text);
        iso_validity_text(&after, after_text);
        record.before = known ? before_text : NULL;
        record.after = after_text;
    }
    return iso__appliance_record_first(appliance, &record, fault);
}

/* Puts the template into the gallery. What cannot be logged is not done. */
static int keep(struct iso_appliance *appliance, struct iso_fault *fault)
{
    appliance->person.enrolled_s = iso_times_wall_ns(&appliance->borrowed.times) / ISO_NS_PER_S;
    int error = iso_gallery_state(appliance->borrowed.gallery, fault);
    error = error ? error : record_completion(appliance, fault);
    if (!error) {
        error = iso_gallery_add(appliance->borrowed.gallery, &appliance->person,
                                &appliance->enrolment.fused, fault);
        if (error) {
            (void)record_enrolment(appliance, "not-stored", fault->text);
            iso__appliance_note_storage(appliance, error, fault);
        }
    }
    if (error) {
        iso__appliance_say(appliance, LOG_ERR, "an enrolment could not be stored: %s",
                           iso_storage_is_refusal(error) ? fault->text : strerror(-error));
        return error;
    }
    iso__appliance_record_gallery(appliance, "gallery", NULL);
    return 0;
}

/* What the record of an enrolment that failed says besides its result; NULL: nothing. */
static const char *enrolment_note(const struct iso_appliance *appliance)
{
    const struct iso_person *duplicate = duplicate_of(appliance);
    return appliance->enrolment.state == ISO_ENROLMENT_ATTACK
               ? iso_capture_name(appliance->enrolment.cue)
           : duplicate ? duplicate->name
                       : NULL;
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
    const enum iso_enrolment_state state = appliance->enrolment.state;
    const char *result = results[state];
    bool has_quality = state == ISO_ENROLMENT_COMPLETED || state == ISO_ENROLMENT_DUPLICATE;
    const struct iso_person *duplicate = duplicate_of(appliance);
    struct iso_fault fault = {.text = ""};
    int error = 0;
    if (state == ISO_ENROLMENT_ACTIVE) {
        return;
    }
    if (state != ISO_ENROLMENT_COMPLETED) {
        (void)record_enrolment(appliance, result, enrolment_note(appliance));
    } else if ((error = keep(appliance, &fault)) != 0) {
        result = iso_storage_is_refusal(error) ? ISO_CONTRACT_RESULT_NOT_STORED
                                               : ISO_CONTRACT_RESULT_FAILED;
        has_quality = false;
    }
    tell_enrolment(appliance, result, true,
                   has_quality ? (double)appliance->enrolment.fused.quality : 0,
                   duplicate                       ? duplicate->name
                   : iso_storage_is_refusal(error) ? fault.text
                                                   : "");
    end(appliance);
}

enum iso_capture iso__appliance_enroll_gate(const struct iso_appliance *appliance)
{
    const struct iso_enroll_gate gate = iso_enroll_gate_of(&appliance->borrowed.config->enroll);
    return iso_enroll_gate_judge(&gate, &appliance->extraction);
}

void iso__appliance_enroll_attack(struct iso_appliance *appliance, enum iso_capture cue)
{
    iso_enrolment_attack(&appliance->enrolment, cue);
    finish_enrolment(appliance);
}

void iso__appliance_enroll_face(struct iso_appliance *appliance)
{
    const struct iso_template *tmpl = &appliance->extraction.tmpl;
    struct iso_enrolment_gallery gallery = {.person = appliance->person.id};
    bool passed = false;
    gallery.everybody = iso_gallery_everybody(appliance->borrowed.gallery);
    gallery.own = iso_gallery_only(appliance->borrowed.gallery, gallery.person);
    const int error = iso_enrolment_frame(&appliance->enrolment, tmpl,
                                          &appliance->borrowed.pipeline, &gallery, &passed);
    if (error) {
        struct iso_fault fault;
        (void)iso_fault_set(&fault, error, "%s", strerror(-error));
        iso__appliance_complain(appliance, &fault);
    }
    if (passed) {
        iso_hint_filter_forget(&appliance->hints);
        tell_enrolment(appliance, ISO_CONTRACT_RESULT_STAGE_PASSED, false, (double)tmpl->quality,
                       "");
    } else if (!error) {
        tell_enrolment(appliance, ISO_CONTRACT_RESULT_STAGE_MISFIT, false, 0, "");
    }
    finish_enrolment(appliance);
}

/* ---- verifying and identifying ---- */

void iso__appliance_finish_recognition(struct iso_appliance *appliance,
                                       const struct iso_verdict *verdict)
{
    const char *result = verdict->reason == ISO_REASON_MATCH    ? ISO_CONTRACT_RESULT_MATCH
                         : verdict->reason == ISO_REASON_ATTACK ? ISO_CONTRACT_RESULT_ATTACK
                                                                : ISO_CONTRACT_RESULT_NO_MATCH;
    const struct iso_person *found = iso_gallery_find_id(appliance->borrowed.gallery,
                                                         verdict->person);
    const char *person = appliance->mode == ISO_APPLIANCE_VERIFY ? appliance->person.name
                         : found                                 ? found->name
                                                                 : "";
    struct iso_audit_record record = iso_audit_record_of(iso_appliance_mode_name(appliance->mode));
    record.person = *person ? person : NULL;
    record.reason = result;
    record.score = verdict->score;
    record.threshold = iso__appliance_threshold(appliance);
    record.frames = verdict->frames;
    if (verdict->attack_frames > 0) {
        record.attack_frames = verdict->attack_frames;
        record.note = iso_capture_name(verdict->cue);
    }
    (void)iso__appliance_note(appliance, &record);
    tell_recognition(appliance, result, true, person, verdict->score);
    end(appliance);
}

/* ---- ends from outside ---- */

void iso__appliance_action_disconnect(struct iso_appliance *appliance)
{
    if (appliance->mode == ISO_APPLIANCE_ENROLL) {
        iso_enrolment_disconnect(&appliance->enrolment);
        finish_enrolment(appliance);
    } else if (is_action(appliance->mode)) {
        tell_recognition(appliance, ISO_CONTRACT_RESULT_DISCONNECTED, true, "", NAN);
        end(appliance);
    }
}

void iso__appliance_action_deadline(struct iso_appliance *appliance, int64_t now)
{
    if (appliance->mode == ISO_APPLIANCE_WATCH || now < appliance->deadline_ns) {
        return;
    }
    if (appliance->mode == ISO_APPLIANCE_CLAIMED) {
        iso__appliance_say(appliance, LOG_NOTICE, "a client held the camera and did nothing");
        iso_appliance_release(appliance);
        appliance->borrowed.events.claim_lost(appliance->borrowed.events.context);
    } else if (appliance->mode == ISO_APPLIANCE_ENROLL) {
        iso_enrolment_time(&appliance->enrolment, now);
        finish_enrolment(appliance);
    } else {
        tell_recognition(appliance, ISO_CONTRACT_RESULT_TIMED_OUT, true, "", NAN);
        end(appliance);
    }
}

/* ---- deleting ---- */

int iso_appliance_remove(struct iso_appliance *appliance, const char *person,
                         struct iso_fault *fault)
{
    struct iso_audit_record record = iso_audit_record_of("delete");
    struct iso_fault own = {.text = ""};
    const struct iso_person *known = iso_gallery_find(appliance->borrowed.gallery, person);
    char name[ISO_PERSON_NAME_SIZE]; /* as it is spelt; the gallery's own goes with the person */
    if (iso_gallery_state(appliance->borrowed.gallery, fault)) {
        return -EIO;
    }
    if (!known) {
        return iso_fault_set(fault, -ENOENT, "%s: no such person", person);
    }
    (void)snprintf(name, sizeof name, "%s", known->name);
    record.person = name;
    int error = iso__appliance_record_first(appliance, &record, fault);
    if (error) {
        return error;
    }
    error = iso_gallery_remove(appliance->borrowed.gallery, name, &own);
    if (error) {
        record.reason = "not-deleted";
        record.note = own.text;
        (void)iso__appliance_record(appliance, &record);
        iso__appliance_note_storage(appliance, error, &own);
        return iso_fault_set_code(fault, own.code, error, "%s", own.text);
    }
    iso__appliance_record_gallery(appliance, "gallery", NULL);
    iso__appliance_forget(appliance, name);
    return 0;
}

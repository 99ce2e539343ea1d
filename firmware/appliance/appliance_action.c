/* The claim of a client, and the actions that it begins. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <syslog.h>

#include "firmware/appliance/appliance_calls.h"
#include "firmware/appliance/appliance_claim.h"
#include "firmware/contract/contract.h"

void iso__appliance_init_claim(struct iso_appliance *appliance)
{
    appliance->claim.ended = ISO_APPLIANCE_CLAIMED;
}

static bool is_action(enum iso_appliance_mode mode)
{
    return mode >= ISO_APPLIANCE_ENROLL;
}

/* ---- claim ---- */

/* Goes to CLAIMED; the time of the claim begins anew. */
static void rest_claimed(struct iso_appliance *appliance)
{
    iso__appliance_decide_anew(appliance);
    iso__appliance_wipe_enrolment(appliance);
    appliance->mode = ISO_APPLIANCE_CLAIMED;
    appliance->claim.deadline_ns = iso__appliance_now_ns(appliance) +
                                   appliance->borrowed.config->bus.claim_ms * ISO_NS_PER_MS;
}

int iso_appliance_claim(struct iso_appliance *appliance)
{
    if (appliance->mode != ISO_APPLIANCE_WATCH) {
        return -EBUSY;
    }
    rest_claimed(appliance);
    appliance->claim.ended = ISO_APPLIANCE_CLAIMED;
    return 0;
}

void iso_appliance_release(struct iso_appliance *appliance)
{
    appliance->claim.login = false;
    if (appliance->mode != ISO_APPLIANCE_WATCH) {
        iso__appliance_picture_drop(appliance);
        rest_claimed(appliance);
        iso__appliance_reset_hints(appliance);
        appliance->mode = ISO_APPLIANCE_WATCH;
    }
}

/* ---- beginning ---- */

int iso__appliance_may_act(const struct iso_appliance *appliance, struct iso_fault *fault)
{
    if (appliance->mode == ISO_APPLIANCE_WATCH) {
        return iso_fault_set(fault, -EACCES, "claim the camera first");
    }
    if (is_action(appliance->mode)) {
        return iso_fault_set(fault, -EBUSY, "%s goes on, stop it first",
                             iso_appliance_mode_name(appliance->mode));
    }
    const int error = iso__appliance_has_sensor(appliance, fault);
    return error ? error : iso_gallery_state(appliance->borrowed.gallery, fault);
}

/* During a lock-out the bus does not tell either whether a face is known. */
static int may_recognise(const struct iso_appliance *appliance, struct iso_fault *fault)
{
    const enum iso_reason refusal = iso__appliance_lock_reason(appliance);
    const int error = iso__appliance_may_act(appliance, fault);
    if (!error && refusal != ISO_REASON_NONE) {
        return iso_fault_set(fault, -EPERM, "nobody is recognised now: %s",
                             iso_reason_name(refusal));
    }
    return error;
}

void iso__appliance_begin_action(struct iso_appliance *appliance, enum iso_appliance_mode mode,
                                 int duration_ms)
{
    iso__appliance_decide_anew(appliance);
    iso__appliance_reset_hints(appliance);
    iso__appliance_picture_drop(appliance); /* the person who is enrolled now is not shown */
    appliance->mode = mode;
    appliance->claim.ended = ISO_APPLIANCE_CLAIMED;
    appliance->claim.deadline_ns = iso__appliance_now_ns(appliance) + duration_ms * ISO_NS_PER_MS;
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
    appliance->claim.person = *known;
    iso__appliance_begin_action(appliance, ISO_APPLIANCE_VERIFY,
                                appliance->borrowed.config->bus.action_ms);
    return 0;
}

/* The door opens to nobody outside of his or her limits, and neither does a login. */
static int may_log_in(const struct iso_appliance *appliance, const char *name,
                      struct iso_fault *fault)
{
    const struct iso_person *person = iso_gallery_find(appliance->borrowed.gallery, name);
    if (!appliance->borrowed.config->login.desk) {
        return iso_fault_set(fault, -EOPNOTSUPP,
                             "this appliance guards a door and serves no logins ([login] desk)");
    }
    if (person && !iso__appliance_is_valid(appliance, person->id)) {
        return iso_fault_set(fault, -EPERM, "%s: not valid at this time", name);
    }
    return person ? iso__appliance_fleet_admits(appliance, person->id, fault) : 0;
}

int iso_appliance_verify_login(struct iso_appliance *appliance, const char *person,
                               struct iso_fault *fault)
{
    int error = may_log_in(appliance, person, fault);
    if (error) {
        return error;
    }
    if (iso_appliance_claim(appliance)) {
        return iso_fault_set(fault, -EBUSY, "another client has the camera");
    }
    error = iso_appliance_verify(appliance, person, fault);
    if (error) {
        iso_appliance_release(appliance);
        return error;
    }
    appliance->claim.login = true;
    appliance->claim.deadline_ns = iso__appliance_now_ns(appliance) +
                                   appliance->borrowed.config->login.longest_ms * ISO_NS_PER_MS;
    return 0;
}

int iso_appliance_identify(struct iso_appliance *appliance, struct iso_fault *fault)
{
    const int error = may_recognise(appliance, fault);
    if (!error) {
        iso__appliance_begin_action(appliance, ISO_APPLIANCE_IDENTIFY,
                                    appliance->borrowed.config->bus.action_ms);
    }
    return error;
}

int iso_appliance_stop_action(struct iso_appliance *appliance, enum iso_appliance_mode mode)
{
    if (!is_action(mode) || (appliance->mode != mode && appliance->claim.ended != mode)) {
        return -ENODATA;
    }
    if (appliance->mode == mode) {
        rest_claimed(appliance);
    }
    appliance->claim.ended = ISO_APPLIANCE_CLAIMED;
    return 0;
}

/* ---- reporting ---- */

static void tell_recognition(const struct iso_appliance *appliance, const char *result, bool done,
                             const char *person, double score)
{
    const struct iso_appliance_events *events = &appliance->borrowed.events;
    events->recognition_status(events->context, appliance->mode, result, done, person, score,
                               iso__appliance_threshold(appliance));
}

void iso__appliance_end_action(struct iso_appliance *appliance)
{
    const enum iso_appliance_mode mode = appliance->mode;
    rest_claimed(appliance);
    appliance->claim.ended = mode;
    if (appliance->claim.login) {
        iso_appliance_release(appliance);
        appliance->borrowed.events.claim_lost(appliance->borrowed.events.context);
    }
}

void iso__appliance_tell_hint(struct iso_appliance *appliance, enum iso_capture capture)
{
    const struct iso_appliance_events *events = &appliance->borrowed.events;
    char word[48];
    (void)snprintf(word, sizeof word, ISO_CONTRACT_RESULT_RETRY "%s", iso_capture_name(capture));
    if (appliance->mode == ISO_APPLIANCE_WATCH) {
        events->hint(events->context, capture);
    } else if (appliance->mode == ISO_APPLIANCE_ENROLL) {
        iso__appliance_tell_enrolment_hint(appliance, word);
    } else {
        tell_recognition(appliance, word, false, "", NAN);
    }
}

/* ---- verifying and identifying ---- */

static const char *result_of(const struct iso_verdict *verdict)
{
    switch (verdict->reason) {
    case ISO_REASON_MATCH:
        return ISO_CONTRACT_RESULT_MATCH;
    case ISO_REASON_ATTACK:
        return ISO_CONTRACT_RESULT_ATTACK;
    default:
        return ISO_CONTRACT_RESULT_NO_MATCH;
    }
}

/* The name in the result of a recognition: with VERIFY the person asked for, with IDENTIFY the
 * person found, or "". */
static const char *name_found(const struct iso_appliance *appliance,
                              const struct iso_verdict *verdict)
{
    if (appliance->mode == ISO_APPLIANCE_VERIFY) {
        return appliance->claim.person.name;
    }
    const struct iso_person *found = iso_gallery_find_id(appliance->borrowed.gallery,
                                                         verdict->person);
    return found ? found->name : "";
}

/* The result of a login: nobody logs in whom the door would not let in, also if the lease ended
 * while the person was looking. */
static const char *result_at_end(const struct iso_appliance *appliance,
                                 const struct iso_verdict *verdict)
{
    const bool refused = appliance->claim.login && verdict->reason == ISO_REASON_MATCH &&
                         iso__appliance_fleet_admits(appliance, verdict->person, NULL);
    return refused ? ISO_CONTRACT_RESULT_NO_MATCH : result_of(verdict);
}

void iso__appliance_finish_recognition(struct iso_appliance *appliance,
                                       const struct iso_verdict *verdict)
{
    const char *result = result_at_end(appliance, verdict);
    const char *person = name_found(appliance, verdict);
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
    iso__appliance_end_action(appliance);
}

/* ---- ends from outside ---- */

void iso__appliance_action_disconnect(struct iso_appliance *appliance)
{
    if (appliance->mode == ISO_APPLIANCE_ENROLL) {
        iso__appliance_disconnect_enrolment(appliance);
    } else if (is_action(appliance->mode)) {
        tell_recognition(appliance, ISO_CONTRACT_RESULT_DISCONNECTED, true, "", NAN);
        iso__appliance_end_action(appliance);
    }
}

int64_t iso__appliance_action_due_ns(const struct iso_appliance *appliance)
{
    if (appliance->mode == ISO_APPLIANCE_ENROLL) {
        return iso__appliance_enrolment_due_ns(appliance);
    }
    return appliance->mode == ISO_APPLIANCE_WATCH ? ISO_NEVER_NS : appliance->claim.deadline_ns;
}

void iso__appliance_action_deadline(struct iso_appliance *appliance, int64_t now)
{
    if (now < iso__appliance_action_due_ns(appliance)) {
        return;
    }
    if (appliance->mode == ISO_APPLIANCE_CLAIMED) {
        iso__appliance_say(appliance, LOG_NOTICE,
                           "a client claimed the camera and did nothing: the claim has ended");
        iso_appliance_release(appliance);
        appliance->borrowed.events.claim_lost(appliance->borrowed.events.context);
    } else if (appliance->mode == ISO_APPLIANCE_ENROLL) {
        iso__appliance_time_enrolment(appliance, now);
    } else {
        tell_recognition(appliance, ISO_CONTRACT_RESULT_TIMED_OUT, true, "", NAN);
        iso__appliance_end_action(appliance);
    }
}

void iso__appliance_forget_claim(struct iso_appliance *appliance)
{
    explicit_bzero(&appliance->claim.person, sizeof appliance->claim.person);
}

/* What becomes of a frame, by mode. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <syslog.h>

#include "drivers/terminal/words.h"
#include "firmware/appliance/appliance_state.h"

/* As often as somebody who turns a camera can follow. */
static const int64_t view_interval_ns = 100 * ISO_NS_PER_MS;

void iso__appliance_complain(struct iso_appliance *appliance, const struct iso_fault *fault)
{
    if (!appliance->complaining) {
        iso__appliance_warn(appliance, fault);
    }
    appliance->complaining = true;
}

static void finish(struct iso_appliance *appliance, struct iso_verdict *verdict)
{
    iso__appliance_shut_out(appliance, verdict);
    if (appliance->mode == ISO_APPLIANCE_WATCH) {
        iso__appliance_finish_visit(appliance, *verdict);
    } else {
        iso__appliance_finish_recognition(appliance, verdict);
    }
    iso__appliance_count_verdict(appliance, verdict);
}

/* One record an attempt: what it looked like, in how many frames, for how long. */
static void record_attack(struct iso_appliance *appliance, const struct iso_attack_attempt *attempt)
{
    char note[64];
    struct iso_audit_record record = iso_audit_record_of("attack");
    record.reason = iso_capture_name(attempt->cue);
    record.attack_frames = attempt->frames;
    (void)snprintf(note, sizeof note, "within %.1f s",
                   (double)attempt->duration_ns / (double)ISO_NS_PER_S);
    record.note = note;
    (void)iso__appliance_note(appliance, &record);
    iso__appliance_say(appliance, LOG_WARNING, "attack: %s, %d %s %s", record.reason,
                       attempt->frames, iso_plural((uint64_t)attempt->frames, "frame", "frames"),
                       note);
}

void iso__appliance_end_attack(struct iso_appliance *appliance)
{
    struct iso_attack_attempt attempt;
    if (iso_attack_tally_end(&appliance->attacks, &attempt)) {
        record_attack(appliance, &attempt);
    }
}

void iso__appliance_time(struct iso_appliance *appliance, int64_t t_ns)
{
    struct iso_verdict verdict;
    struct iso_attack_attempt attempt;
    if (iso_decision_time(&appliance->decision, t_ns, &verdict)) {
        finish(appliance, &verdict);
    }
    if (iso_attack_tally_time(&appliance->attacks, t_ns, &attempt)) {
        record_attack(appliance, &attempt);
    }
}

/* The gallery's opinion of the template just extracted: 0, -ENODATA, or an error of the search. */
static int compare(const struct iso_appliance *appliance, struct iso_decision_frame *out)
{
    const struct iso_pipeline *pipeline = &appliance->borrowed.pipeline;
    struct iso_gallery *gallery = appliance->borrowed.gallery;
    const struct iso_candidate_list among = appliance->mode == ISO_APPLIANCE_VERIFY
                                                ? iso_gallery_only(gallery, appliance->person.id)
                                                : iso_gallery_everybody(gallery);
    struct iso_search_hit hits[2];
    int n = 0;
    const int error = pipeline->ops->search(pipeline->self, &among, &appliance->extraction.tmpl,
                                            hits, 2, &n);
    if (error) {
        return error;
    }
    *out = (struct iso_decision_frame){
        .person = n > 0 ? hits[0].person : 0,
        .score = n > 0 ? hits[0].score : NAN,
        .second_score = n > 1 ? hits[1].score : -INFINITY,
    };
    return 0;
}

/* Another face than before. At the door the one before has left; a client's action goes on with
 * the new one. */
static void follow_track(struct iso_appliance *appliance)
{
    struct iso_verdict verdict;
    if (iso_decision_track(&appliance->decision, appliance->motion.track, &verdict) &&
        appliance->mode == ISO_APPLIANCE_WATCH) {
        finish(appliance, &verdict);
    }
}

/* Takes a usable face in. OK, or why it is none after all. */
static enum iso_capture recognise(struct iso_appliance *appliance, int64_t t_ns, int64_t arrival_ns)
{
    struct iso_decision_frame face = {.score = NAN};
    struct iso_verdict verdict;
    const int error = iso__appliance_is_shut(appliance) ? 0 : compare(appliance, &face);
    if (error) {
        if (error != -ENODATA) {
            struct iso_fault fault;
            (void)iso_fault_set(&fault, error, "%s", strerror(-error));
            iso__appliance_complain(appliance, &fault);
        }
        return ISO_CAPTURE_TOO_FEW_POINTS;
    }
    follow_track(appliance);
    face.t_ns = t_ns;
    face.track = appliance->motion.track;
    /* Who somebody is does not depend on the time; whether the door opens does. */
    face.valid = appliance->mode != ISO_APPLIANCE_WATCH ||
                 iso__appliance_is_valid(appliance, face.person);
    if (appliance->decision.n_frames == 0) {
        appliance->arrival_ns = arrival_ns;
    }
    iso_decision_set_threshold(&appliance->decision, iso__appliance_threshold(appliance));
    if (iso_decision_face(&appliance->decision, &face, &verdict)) {
        finish(appliance, &verdict);
    }
    return ISO_CAPTURE_OK;
}

static enum iso_capture take_face(struct iso_appliance *appliance, int64_t t_ns, int64_t arrival_ns)
{
    if (appliance->mode == ISO_APPLIANCE_ENROLL) {
        iso__appliance_enroll_face(appliance);
        return ISO_CAPTURE_OK;
    }
    return recognise(appliance, t_ns, arrival_ns);
}

/* Takes a frame in that shows a picture, a screen or a mask. */
static void take_attack(struct iso_appliance *appliance, enum iso_capture cue, int64_t t_ns,
                        int64_t arrival_ns)
{
    struct iso_verdict verdict;
    iso_attack_tally_frame(&appliance->attacks, cue, t_ns);
    appliance->counts.attack_frames++;
    if (appliance->mode == ISO_APPLIANCE_ENROLL) {
        iso__appliance_enroll_attack(appliance, cue);
        return;
    }
    if (appliance->decision.state == ISO_DECISION_IDLE) {
        appliance->arrival_ns = arrival_ns;
    }
    if (iso_decision_attack(&appliance->decision, cue, t_ns, &verdict)) {
        finish(appliance, &verdict);
    }
}

static int extract(struct iso_appliance *appliance, const struct iso_frame *frame)
{
    const struct iso_pipeline *pipeline = &appliance->borrowed.pipeline;
    const int error = pipeline->ops->extract(pipeline->self, frame, appliance->supervisor.model,
                                             &appliance->extraction);
    if (error) {
        struct iso_fault fault;
        (void)iso_fault_set(&fault, error, "frame %llu: no template: %s",
                            (unsigned long long)frame->sequence, strerror(-error));
        iso__appliance_complain(appliance, &fault);
    }
    return error;
}

/* Whether a face that was fitted moves as the living do; one that has not been seen for long enough
 * is given the benefit of the doubt. */
static bool is_lifeless(struct iso_appliance *appliance, const struct iso_frame *frame)
{
    const struct iso_extraction *extraction = &appliance->extraction;
    if (appliance->motion.track != appliance->liveness_track) { /* somebody else */
        const struct iso_liveness_options options = appliance->liveness.options;
        iso_liveness_init(&options, &appliance->liveness);
        appliance->liveness_track = appliance->motion.track;
    }
    const struct iso_liveness_frame seen = {
        .t_ns = frame->t_ns,
        .camera_from_face = extraction->camera_from_face,
        .sigma_mm = extraction->sigma_mm[ISO_LM_NASION],
        .digest = iso_liveness_digest(frame, extraction->camera_from_face.translation_mm),
    };
    return iso_liveness_feed(&appliance->liveness, &seen) == ISO_LIVENESS_STILL;
}

/* What becomes of the frame just extracted: the extraction's own word, or what speaks against using
 * a good one. */
static enum iso_capture judge(struct iso_appliance *appliance, const struct iso_frame *frame)
{
    const int64_t t_ns = frame->t_ns;
    const struct iso_extraction *extraction = &appliance->extraction;
    appliance->motion = (struct iso_track_motion){0};
    if (extraction->fitted) {
        appliance->motion = iso_track_pose(&appliance->track, t_ns, &extraction->camera_from_face);
    }
    if (extraction->outcome != ISO_CAPTURE_OK) {
        return extraction->outcome;
    }
    if (is_lifeless(appliance, frame)) {
        return ISO_CAPTURE_STILL;
    }
    if (appliance->motion.moving) {
        return ISO_CAPTURE_MOVING;
    }
    return appliance->mode == ISO_APPLIANCE_ENROLL ? iso__appliance_enroll_gate(appliance)
                                                   : ISO_CAPTURE_OK;
}

/* Whether a word may become a hint. An empty scene never does. For a client's action, a person is
 * there and waits for hints; at the door somebody has to be seen, and a face that has got its
 * verdict needs none. */
static bool may_hint(const struct iso_appliance *appliance, enum iso_capture capture)
{
    if (capture == ISO_CAPTURE_NOBODY) {
        return false;
    }
    if (appliance->mode != ISO_APPLIANCE_WATCH) {
        return appliance->mode != ISO_APPLIANCE_CLAIMED;
    }
    return capture != ISO_CAPTURE_NO_FACE && appliance->decision.state != ISO_DECISION_SPENT;
}

/* The interval between hints is the person's time, not the frames', of which some are late. */
static void give_hint(struct iso_appliance *appliance, enum iso_capture capture)
{
    const int64_t now_ns = iso_times_now_ns(&appliance->borrowed.times);
    const enum iso_capture vote = may_hint(appliance, capture) ? capture : ISO_CAPTURE_OK;
    const enum iso_capture hint = iso_hint_filter_frame(&appliance->hints, vote, now_ns);
    if (hint != ISO_CAPTURE_OK) {
        iso__appliance_tell_hint(appliance, hint);
    }
}

/* How long a scene that moved counts as one with somebody in it. */
static const int64_t scene_quiet_ns = 2 * ISO_NS_PER_S;

/* What is told of a frame. Something within reach that is not a face and does not move is
 * furniture: nobody is there. The decision does not depend on this. */
static enum iso_capture tell_of(struct iso_appliance *appliance, const struct iso_frame *frame,
                                enum iso_capture capture)
{
    const bool moves = iso_scene_motion_feed(&appliance->scene_motion, frame,
                                             appliance->borrowed.config->sensor.distance_max_mm,
                                             scene_quiet_ns);

    return capture == ISO_CAPTURE_NOT_A_FACE && !moves ? ISO_CAPTURE_NOBODY : capture;
}

/* Keeps what was seen for who asks, and tells it to who listens. */
static void show(struct iso_appliance *appliance, enum iso_capture capture)
{
    const struct iso_appliance_events *events = &appliance->borrowed.events;
    const int64_t now_ns = iso_times_now_ns(&appliance->borrowed.times);
    appliance->view = iso_view_of(&appliance->extraction, capture, &appliance->motion);
    if (appliance->aimed && now_ns - appliance->view_told_ns >= view_interval_ns) {
        appliance->view_told_ns = now_ns;
        events->view(events->context, &appliance->view);
    }
    appliance->has_view = true;
}

/* Counts what the image said of the face. */
static void note_image(struct iso_appliance *appliance)
{
    const struct iso_pipeline *pipeline = &appliance->borrowed.pipeline;
    if (appliance->decision.state == ISO_DECISION_IDLE) {
        appliance->image = (struct iso_image_tally){0};
    }
    if (pipeline->ops->seen) {
        iso_image_tally_take(&appliance->image, pipeline->ops->seen(pipeline->self));
    }
}

/* What comes so late that it says nothing about who is there now; for a frame that was exposed
 * before the machine was suspended nobody knows how late it is. */
static bool is_stale(struct iso_appliance *appliance, const struct iso_frame *frame,
                     int64_t arrival_ns)
{
    const int64_t stale_ns = appliance->borrowed.config->sensor.stale_ms * ISO_NS_PER_MS;
    struct iso_fault fault;
    if (frame->t_ns < appliance->suspension.awake_ns) {
        return true;
    }
    if (arrival_ns - frame->t_ns < stale_ns) {
        return false;
    }
    (void)iso_fault_set(&fault, -ESTALE, "frame %llu is %lld ms late",
                        (unsigned long long)frame->sequence,
                        (long long)((arrival_ns - frame->t_ns) / ISO_NS_PER_MS));
    iso__appliance_complain(appliance, &fault);
    return true;
}

/* A frame that is the one before it again, to the bit, is no second opinion of the face in it: it
 * must not agree with itself. (Some more of them are an attack, see is_lifeless.) */
static bool is_echo(const struct iso_appliance *appliance)
{
    return appliance->borrowed.config->motion.frozen_frames > 0 && appliance->liveness.repeated > 0;
}

/* Whether a frame may count as evidence. Every usable one is remembered, whatever else speaks
 * against it: it may come again. */
static bool counts(struct iso_appliance *appliance, const struct iso_frame *frame)
{
    const bool repeats = appliance->extraction.outcome == ISO_CAPTURE_OK &&
                         iso__appliance_repeats(appliance, frame);
    return !repeats && !is_echo(appliance);
}

void iso__appliance_frame(struct iso_appliance *appliance, const struct iso_frame *frame,
                          int64_t arrival_ns)
{
    if (is_stale(appliance, frame, arrival_ns)) {
        iso__appliance_time(appliance, arrival_ns);
        return;
    }
    iso__appliance_time(appliance, frame->t_ns);
    iso__appliance_picture_frame(appliance, frame);
    if (appliance->mode == ISO_APPLIANCE_CLAIMED || extract(appliance, frame)) {
        return;
    }
    note_image(appliance);
    enum iso_capture capture = judge(appliance, frame);
    const bool evidence = counts(appliance, frame);
    if (capture == ISO_CAPTURE_OK) {
        iso__appliance_stale_frame(appliance, frame);
        appliance->complaining = false;
        capture = evidence ? take_face(appliance, frame->t_ns, arrival_ns) : capture;
    } else if (iso_capture_is_attack(capture)) {
        take_attack(appliance, capture, frame->t_ns, arrival_ns);
    }
    iso_template_wipe(&appliance->extraction.tmpl);
    capture = tell_of(appliance, frame, capture);
    show(appliance, capture);
    give_hint(appliance, capture);
}

int64_t iso__appliance_due_ns(const struct iso_appliance *appliance)
{
    const int64_t decision_ns = iso_decision_due_ns(&appliance->decision);
    const int64_t attack_ns = iso_attack_tally_due_ns(&appliance->attacks);
    const int64_t lockout_ns = iso_lockout_due_ns(&appliance->lockout);
    int64_t due_ns = decision_ns < attack_ns ? decision_ns : attack_ns;
    due_ns = lockout_ns < due_ns ? lockout_ns : due_ns;
    due_ns = appliance->lockout_save_ns < due_ns ? appliance->lockout_save_ns : due_ns;
    due_ns = appliance->lockout_read_ns < due_ns ? appliance->lockout_read_ns : due_ns;
    due_ns = appliance->gallery_retry_ns < due_ns ? appliance->gallery_retry_ns : due_ns;
    if (appliance->picture_due && appliance->picture_end_ns < due_ns) {
        due_ns = appliance->picture_end_ns;
    }
    if (appliance->mode == ISO_APPLIANCE_WATCH || due_ns < appliance->deadline_ns) {
        return due_ns;
    }
    return appliance->deadline_ns;
}

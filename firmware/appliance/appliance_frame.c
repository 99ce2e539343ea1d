/* Handles a frame as the mode asks. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <syslog.h>

#include "drivers/terminal/words.h"
#include "firmware/appliance/appliance_access.h"
#include "firmware/appliance/appliance_calls.h"
#include "firmware/appliance/appliance_claim.h"

/* An attempt that lasts longer becomes several records. */
static const int64_t attack_longest_ns = 60 * ISO_NS_PER_S;

void iso__appliance_init_visit(struct iso_appliance *appliance)
{
    const struct iso_config *config = appliance->borrowed.config;
    const struct iso_decision_options decision = iso__appliance_decision_options(config);
    const struct iso_hint_options hints = {
        .hold = config->hint.hold_frames,
        .interval_ns = config->hint.interval_ms * ISO_NS_PER_MS,
    };
    iso_decision_init(&appliance->visit.decision, &decision);
    iso_hint_filter_init(&appliance->visit.hints, &hints);
    iso_attack_tally_init(&appliance->visit.attacks, decision.refractory_ns, attack_longest_ns);
}

void iso__appliance_decide_anew(struct iso_appliance *appliance)
{
    iso_decision_reset(&appliance->visit.decision);
    iso__appliance_end_wait(appliance);
}

void iso__appliance_reset_hints(struct iso_appliance *appliance)
{
    iso_hint_filter_reset(&appliance->visit.hints);
}

void iso__appliance_forget_hint(struct iso_appliance *appliance)
{
    iso_hint_filter_forget(&appliance->visit.hints);
}

static void finish_verdict(struct iso_appliance *appliance, struct iso_verdict *verdict)
{
    iso__appliance_shut_out(appliance, verdict);
    if (appliance->mode == ISO_APPLIANCE_WATCH) {
        if (!iso__appliance_finish_visit(appliance, verdict)) {
            return; /* the policy wants more */
        }
    } else {
        iso__appliance_finish_recognition(appliance, verdict);
    }
    iso__appliance_count_verdict(appliance, verdict);
}

/* Writes one record for an attempt: its cue, its number of frames, its duration. */
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
    if (iso_attack_tally_end(&appliance->visit.attacks, &attempt)) {
        record_attack(appliance, &attempt);
    }
}

void iso__appliance_time(struct iso_appliance *appliance, int64_t t_ns)
{
    struct iso_verdict verdict;
    struct iso_attack_attempt attempt;
    if (iso_decision_time(&appliance->visit.decision, t_ns, &verdict)) {
        finish_verdict(appliance, &verdict);
    }
    if (iso_attack_tally_time(&appliance->visit.attacks, t_ns, &attempt)) {
        record_attack(appliance, &attempt);
    }
}

/* Compares the template just extracted with the gallery. -ENODATA the template cannot be compared,
 * or another error of the search. */
static int compare_face(const struct iso_appliance *appliance, struct iso_decision_frame *out)
{
    const struct iso_pipeline *pipeline = &appliance->borrowed.pipeline;
    struct iso_gallery *gallery = appliance->borrowed.gallery;
    const int64_t only = appliance->mode == ISO_APPLIANCE_VERIFY
                             ? appliance->claim.person.id
                             : iso__appliance_only_person(appliance);
    const struct iso_candidate_list among = only ? iso_gallery_only(gallery, only)
                                                 : iso_gallery_everybody(gallery);
    struct iso_search_hit hits[2];
    int n = 0;
    const int error = pipeline->ops->search(pipeline->self, &among,
                                            &appliance->face.extraction.tmpl, hits, 2, &n);
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

/* Tells the decision which face is seen now. At the door, another face means that the person
 * before has left; an action of a client goes on with the new face. */
static void follow_track(struct iso_appliance *appliance)
{
    struct iso_verdict verdict;
    if (iso_decision_track(&appliance->visit.decision, appliance->face.motion.track, &verdict) &&
        appliance->mode == ISO_APPLIANCE_WATCH) {
        finish_verdict(appliance, &verdict);
    }
}

/* Counts a frame of a face in the visit, and ends the visit if that decides it. */
static void count_face(struct iso_appliance *appliance, struct iso_decision_frame *face,
                       int64_t arrival_ns)
{
    struct iso_verdict verdict;
    follow_track(appliance);
    face->track = appliance->face.motion.track;
    /* The time of day matters for opening the door, and not for telling who a person is. */
    face->valid = appliance->mode != ISO_APPLIANCE_WATCH ||
                  iso__appliance_is_valid(appliance, face->person);
    if (appliance->visit.decision.n_frames == 0) {
        appliance->visit.arrival_ns = arrival_ns;
    }
    iso_decision_set_threshold(&appliance->visit.decision, iso__appliance_threshold(appliance));
    if (iso_decision_face(&appliance->visit.decision, face, &verdict)) {
        finish_verdict(appliance, &verdict);
    }
}

/* Handles a usable face. Returns OK, or the reason why the face cannot be used after all. */
static enum iso_capture recognise_face(struct iso_appliance *appliance, int64_t t_ns,
                                       int64_t arrival_ns)
{
    struct iso_decision_frame face = {.score = NAN};
    const int error = iso__appliance_is_shut(appliance) ? 0 : compare_face(appliance, &face);
    if (error) {
        if (error != -ENODATA) {
            struct iso_fault fault;
            (void)iso_fault_set(&fault, error, "%s", strerror(-error));
            iso__appliance_complain(appliance, &fault);
        }
        return ISO_CAPTURE_TOO_FEW_POINTS;
    }
    face.t_ns = t_ns;
    count_face(appliance, &face, arrival_ns);
    return ISO_CAPTURE_OK;
}

/* A desk machine has no door to watch. Between logins it recognises nobody and counts no strangers
 * who walk by, whose number would lock its users out. */
static bool is_desk_at_rest(const struct iso_appliance *appliance)
{
    return appliance->mode == ISO_APPLIANCE_WATCH && appliance->borrowed.config->login.desk;
}

static enum iso_capture take_face(struct iso_appliance *appliance, int64_t t_ns, int64_t arrival_ns)
{
    if (is_desk_at_rest(appliance)) {
        return ISO_CAPTURE_OK;
    }
    if (appliance->mode == ISO_APPLIANCE_ENROLL) {
        iso__appliance_enroll_face(appliance);
        return ISO_CAPTURE_OK;
    }
    return recognise_face(appliance, t_ns, arrival_ns);
}

/* Handles a frame that has a cue of a presentation attack (iso_capture_is_attack). */
static void take_attack(struct iso_appliance *appliance, enum iso_capture cue, int64_t t_ns,
                        int64_t arrival_ns)
{
    struct iso_verdict verdict;
    if (is_desk_at_rest(appliance)) {
        return;
    }
    iso_attack_tally_frame(&appliance->visit.attacks, cue, t_ns);
    iso__appliance_count_attack_frame(appliance);
    if (appliance->mode == ISO_APPLIANCE_ENROLL) {
        iso__appliance_enroll_attack(appliance, cue);
        return;
    }
    if (appliance->visit.decision.state == ISO_DECISION_IDLE) {
        appliance->visit.arrival_ns = arrival_ns;
    }
    if (iso_decision_attack(&appliance->visit.decision, cue, t_ns, &verdict)) {
        finish_verdict(appliance, &verdict);
    }
}

/* Handles a frame of a head that is turned far and also has a cue of an attack. The attitude of a
 * living head may give this cue, so it is no attack frame. It counts as a frame of
 * nobody. So an attacker who holds a mask at an angle cannot get in with a few frames without a cue
 * among many with one. */
static void take_doubtful_face(struct iso_appliance *appliance, int64_t t_ns, int64_t arrival_ns)
{
    struct iso_decision_frame nobody = {.score = NAN, .t_ns = t_ns};
    if (appliance->mode != ISO_APPLIANCE_ENROLL && !is_desk_at_rest(appliance)) {
        count_face(appliance, &nobody, arrival_ns);
    }
}

/* Whether a word may become a hint. An empty scene never does. During a client's action a person is
 * there and waits for hints. At the door, only a face that has no verdict yet gets hints. */
static bool may_hint(const struct iso_appliance *appliance, enum iso_capture capture)
{
    if (capture == ISO_CAPTURE_NOBODY) {
        return false;
    }
    if (appliance->mode != ISO_APPLIANCE_WATCH) {
        return appliance->mode != ISO_APPLIANCE_CLAIMED;
    }
    return capture != ISO_CAPTURE_NO_FACE && appliance->visit.decision.state != ISO_DECISION_SPENT;
}

/* Gives a hint if one is due. The interval between hints is measured by the time at which they are
 * given, and not by the times of the frames. */
static void give_hint(struct iso_appliance *appliance, enum iso_capture capture)
{
    const int64_t now_ns = iso_times_now_ns(&appliance->borrowed.times);
    const enum iso_capture vote = may_hint(appliance, capture) ? capture : ISO_CAPTURE_OK;
    const enum iso_capture hint = iso_hint_filter_frame(&appliance->visit.hints, vote, now_ns);
    if (hint != ISO_CAPTURE_OK) {
        iso__appliance_tell_hint(appliance, hint);
    }
}

/* Counts the result of the image check. */
static void note_image(struct iso_appliance *appliance)
{
    const struct iso_pipeline *pipeline = &appliance->borrowed.pipeline;
    if (appliance->visit.decision.state == ISO_DECISION_IDLE) {
        appliance->visit.image = (struct iso_image_tally){0};
    }
    if (pipeline->ops->seen) {
        iso_image_tally_take(&appliance->visit.image, pipeline->ops->seen(pipeline->self));
    }
}

void iso__appliance_frame(struct iso_appliance *appliance, const struct iso_frame *frame,
                          int64_t arrival_ns)
{
    if (iso__appliance_is_stale(appliance, frame, arrival_ns)) {
        iso__appliance_time(appliance, arrival_ns);
        return;
    }
    iso__appliance_time(appliance, frame->t_ns);
    iso__appliance_picture_frame(appliance, frame);
    /* At rest a desk machine examines frames only for somebody who aims the sensor. */
    if (appliance->mode == ISO_APPLIANCE_CLAIMED ||
        (is_desk_at_rest(appliance) && !iso_appliance_is_aimed(appliance))) {
        iso__appliance_end_rest(appliance);
        iso__appliance_report_frame(appliance, frame, ISO_CAPTURE_NOBODY);
        return;
    }
    if (iso__appliance_rests(appliance, frame)) {
        iso__appliance_report_frame(appliance, frame, ISO_CAPTURE_NOBODY);
        return;
    }
    if (iso__appliance_extract(appliance, frame)) {
        return;
    }
    note_image(appliance);
    enum iso_capture capture = iso__appliance_judge(appliance, frame);
    const bool evidence = iso__appliance_is_evidence(appliance, frame);
    if (capture == ISO_CAPTURE_OK) {
        iso__appliance_stale_frame(appliance, frame);
        iso__appliance_end_complaints(appliance);
        capture = evidence ? take_face(appliance, frame->t_ns, arrival_ns) : capture;
    } else if (iso_capture_is_attack(capture)) {
        take_attack(appliance, capture, frame->t_ns, arrival_ns);
    } else if (evidence && iso_capture_is_attack(appliance->face.extraction.cue)) {
        take_doubtful_face(appliance, frame->t_ns, arrival_ns);
    }
    iso__appliance_wipe_template(appliance);
    capture = iso__appliance_tell_of(appliance, frame, capture);
    iso__appliance_show(appliance, capture);
    give_hint(appliance, capture);
    iso__appliance_report_frame(appliance, frame, capture);
}

int64_t iso__appliance_visit_due_ns(const struct iso_appliance *appliance)
{
    const int64_t decision_ns = iso_decision_due_ns(&appliance->visit.decision);
    const int64_t attack_ns = iso_attack_tally_due_ns(&appliance->visit.attacks);
    return decision_ns < attack_ns ? decision_ns : attack_ns;
}

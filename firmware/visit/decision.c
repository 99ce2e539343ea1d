#include "firmware/visit/decision.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "drivers/base/times.h"

const char *iso_reason_name(enum iso_reason reason)
{
    static const char *const names[ISO_REASONS] = {
        "none",         "match",         "unknown",    "left",       "not-valid",
        "unlogged",     "attack",        "locked-out", "lockdown",   "no-gallery",
        "no-lockout",   "not-on-record", "stale",      "open",       "credential",
        "disabled",     "not-here",      "not-now",    "not-enough", "wrong-factor",
        "antipassback", "no-pair",       "no-policy",  "no-lease",   "not-approved",
    };
    return (unsigned)reason < ISO_REASONS ? names[reason] : NULL;
}

void iso_decision_init(struct iso_decision *decision, const struct iso_decision_options *options)
{
    *decision = (struct iso_decision){.options = *options};
    iso_decision_reset(decision);
}

static void forget_face(struct iso_decision *decision)
{
    decision->n_frames = 0;
    decision->best_score = NAN;
}

void iso_decision_set_threshold(struct iso_decision *decision, double threshold)
{
    decision->options.threshold = threshold;
}

void iso_decision_reset(struct iso_decision *decision)
{
    decision->state = ISO_DECISION_IDLE;
    decision->n_attack_frames = 0;
    memset(decision->by_cue, 0, sizeof decision->by_cue);
    forget_face(decision);
}

void iso_decision_spend(struct iso_decision *decision, int64_t t_ns)
{
    iso_decision_reset(decision);
    decision->state = ISO_DECISION_SPENT;
    decision->verdict_ns = decision->seen_ns = t_ns;
}

/* The person for whom a frame counts, or 0. A frame whose score is not finite counts for nobody,
 * because no comparison gives such a score. */
static int64_t counted_person(const struct iso_decision_options *options,
                              const struct iso_decision_frame *frame)
{
    const bool sure = isfinite(frame->score) && frame->score >= options->threshold &&
                      frame->score - frame->second_score >= options->margin;
    return sure ? frame->person : 0;
}

/* Counts the frames that count for a person and are not stale at t_ns. Also finds their best score
 * and the time of the oldest. */
static int count_of(const struct iso_decision *decision, int64_t person, int64_t t_ns, double *best,
                    int64_t *since_ns)
{
    int count = 0;
    for (int i = 0; i < decision->n_frames; i++) {
        if (decision->frames[i].person != person ||
            t_ns - decision->frames[i].t_ns > decision->options.stale_ns) {
            continue;
        }
        if (count == 0) {
            *best = decision->frames[i].score;
            *since_ns = decision->frames[i].t_ns;
        }
        *best = fmax(*best, decision->frames[i].score);
        count++;
    }
    return count;
}

static void spend_visit(struct iso_decision *decision, int64_t t_ns)
{
    decision->state = ISO_DECISION_SPENT;
    decision->verdict_ns = t_ns;
}

/* The number of frames that have to agree: `agree`, and at least half of the usable frames of the
 * visit. Otherwise each further frame would be one more chance for a stranger. */
static int frames_needed(const struct iso_decision *decision)
{
    const int half = (decision->n_frames + 1) / 2;
    return half > decision->options.agree ? half : decision->options.agree;
}

/* Notes that a person is there. Returns false in the state SPENT, in which frames do not count. */
static bool enter_visit(struct iso_decision *decision, int64_t t_ns)
{
    decision->seen_ns = t_ns;
    if (decision->state == ISO_DECISION_IDLE) {
        iso_decision_reset(decision);
        decision->state = ISO_DECISION_VISIT;
    }
    return decision->state == ISO_DECISION_VISIT;
}

static enum iso_capture main_cue(const struct iso_decision *decision)
{
    enum iso_capture cue = ISO_CAPTURE_OK; /* no attack frame has this cue */
    for (int i = 0; i < ISO_CAPTURES; i++) {
        if (decision->by_cue[i] > decision->by_cue[cue]) {
            cue = (enum iso_capture)i;
        }
    }
    return cue;
}

/* The verdict on the visit, with this reason. Every verdict is DENY until the caller allows it. */
static struct iso_verdict verdict_for(const struct iso_decision *decision, enum iso_reason reason)
{
    return (struct iso_verdict){
        .reason = reason,
        .score = decision->best_score,
        .frames = decision->n_frames,
        .attack_frames = decision->n_attack_frames,
        .cue = main_cue(decision),
    };
}

static void note_frame(struct iso_decision *decision, const struct iso_decision_frame *frame)
{
    const int64_t person = counted_person(&decision->options, frame);
    decision->frames[decision->n_frames].person = person;
    decision->frames[decision->n_frames].score = frame->score;
    decision->frames[decision->n_frames].t_ns = frame->t_ns;
    decision->n_frames++;
    if (frame->person != 0 && isfinite(frame->score)) {
        /* fmax() returns the other argument if one is NaN. */
        decision->best_score = fmax(decision->best_score, frame->score);
    }
}

bool iso_decision_track(struct iso_decision *decision, uint64_t track, struct iso_verdict *verdict)
{
    const bool left = decision->state == ISO_DECISION_VISIT && decision->n_frames > 0 &&
                      decision->track != track;
    if (left) {
        *verdict = verdict_for(decision, ISO_REASON_LEFT);
        forget_face(decision);
        if (decision->n_attack_frames == 0) {
            iso_decision_reset(decision);
        }
    }
    return left;
}

bool iso_decision_face(struct iso_decision *decision, const struct iso_decision_frame *frame,
                       struct iso_verdict *verdict)
{
    if (!enter_visit(decision, frame->t_ns)) {
        return false;
    }
    if (decision->n_frames > 0 && decision->track != frame->track) {
        /* The caller did not report the new track: frames of two tracks must not agree. */
        forget_face(decision);
    }
    decision->track = frame->track;
    note_frame(decision, frame);
    const int64_t person = decision->frames[decision->n_frames - 1].person;
    double best = NAN;
    int64_t since_ns = frame->t_ns;
    if (person != 0 &&
        count_of(decision, person, frame->t_ns, &best, &since_ns) >= frames_needed(decision)) {
        *verdict = verdict_for(decision, frame->valid ? ISO_REASON_MATCH : ISO_REASON_NOT_VALID);
        verdict->allow = frame->valid;
        verdict->person = person;
        verdict->score = best;
        verdict->since_ns = since_ns;
    } else if (decision->n_frames >= decision->options.max_frames) {
        *verdict = verdict_for(decision, ISO_REASON_UNKNOWN);
    } else {
        return false;
    }
    spend_visit(decision, frame->t_ns);
    return true;
}

bool iso_decision_attack(struct iso_decision *decision, enum iso_capture cue, int64_t t_ns,
                         struct iso_verdict *verdict)
{
    if (!enter_visit(decision, t_ns)) {
        return false;
    }
    decision->n_attack_frames++;
    decision->by_cue[cue]++;
    if (decision->n_attack_frames < decision->options.attack_frames) {
        return false;
    }
    *verdict = verdict_for(decision, ISO_REASON_ATTACK);
    spend_visit(decision, t_ns);
    return true;
}

bool iso_decision_time(struct iso_decision *decision, int64_t t_ns, struct iso_verdict *verdict)
{
    if (decision->state == ISO_DECISION_IDLE || t_ns < iso_decision_due_ns(decision)) {
        return false;
    }
    const bool left = decision->state == ISO_DECISION_VISIT && decision->n_frames > 0;
    if (left) {
        *verdict = verdict_for(decision, ISO_REASON_LEFT);
    }
    iso_decision_reset(decision);
    return left;
}

int64_t iso_decision_due_ns(const struct iso_decision *decision)
{
    if (decision->state == ISO_DECISION_IDLE) {
        return ISO_NEVER_NS;
    }
    const int64_t gone_ns = decision->seen_ns + decision->options.gap_ns;
    const int64_t again_ns = decision->verdict_ns + decision->options.refractory_ns;
    return decision->state == ISO_DECISION_SPENT && again_ns < gone_ns ? again_ns : gone_ns;
}

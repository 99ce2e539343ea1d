#include "firmware/decision.h"

#include <math.h>
#include <stddef.h>

#include "firmware/times.h"

const char *iso_reason_name(enum iso_reason reason)
{
    static const char *const names[ISO_REASONS] = {
        "none", "match", "unknown", "left", "not-valid", "unlogged",
    };
    return (unsigned)reason < ISO_REASONS ? names[reason] : NULL;
}

void iso_decision_init(struct iso_decision *decision, const struct iso_decision_options *options)
{
    *decision = (struct iso_decision){.options = *options};
    iso_decision_reset(decision);
}

void iso_decision_reset(struct iso_decision *decision)
{
    decision->state = ISO_DECISION_IDLE;
    decision->n_frames = 0;
    decision->best_score = NAN;
}

/* Whom a frame counts for, or 0. Comparisons with NaN are false, and so count for nobody. */
static int64_t counted_person(const struct iso_decision_options *options,
                              const struct iso_decision_frame *frame)
{
    const bool sure = frame->score >= options->threshold &&
                      frame->score - frame->second_score >= options->margin;
    return sure ? frame->person : 0;
}

static int count_of(const struct iso_decision *decision, int64_t person, double *best)
{
    int count = 0;
    for (int i = 0; i < decision->n_frames; i++) {
        if (decision->frames[i].person == person) {
            *best = count ? fmax(*best, decision->frames[i].score) : decision->frames[i].score;
            count++;
        }
    }
    return count;
}

static void spend(struct iso_decision *decision, int64_t t_ns)
{
    decision->state = ISO_DECISION_SPENT;
    decision->verdict_ns = t_ns;
}

static struct iso_verdict deny(const struct iso_decision *decision, enum iso_reason reason)
{
    return (struct iso_verdict){
        .reason = reason,
        .score = decision->best_score,
        .frames = decision->n_frames,
    };
}

static void note(struct iso_decision *decision, const struct iso_decision_frame *frame)
{
    const int64_t person = counted_person(&decision->options, frame);
    decision->frames[decision->n_frames].person = person;
    decision->frames[decision->n_frames].score = frame->score;
    decision->n_frames++;
    if (frame->person != 0) {
        decision->best_score = fmax(decision->best_score, frame->score); /* of a NaN: the other */
    }
}

bool iso_decision_face(struct iso_decision *decision, const struct iso_decision_frame *frame,
                       struct iso_verdict *verdict)
{
    decision->seen_ns = frame->t_ns;
    if (decision->state == ISO_DECISION_SPENT) {
        return false;
    }
    if (decision->state == ISO_DECISION_IDLE) {
        iso_decision_reset(decision);
        decision->state = ISO_DECISION_VISIT;
    }
    note(decision, frame);
    const int64_t person = decision->frames[decision->n_frames - 1].person;
    double best = NAN;
    if (person != 0 && count_of(decision, person, &best) >= decision->options.agree) {
        *verdict = (struct iso_verdict){
            .allow = frame->valid,
            .reason = frame->valid ? ISO_REASON_MATCH : ISO_REASON_NOT_VALID,
            .person = person,
            .score = best,
            .frames = decision->n_frames,
        };
    } else if (decision->n_frames >= decision->options.max_frames) {
        *verdict = deny(decision, ISO_REASON_UNKNOWN);
    } else {
        return false;
    }
    spend(decision, frame->t_ns);
    return true;
}

bool iso_decision_time(struct iso_decision *decision, int64_t t_ns, struct iso_verdict *verdict)
{
    const enum iso_decision_state state = decision->state;
    if (state == ISO_DECISION_IDLE || t_ns < iso_decision_due_ns(decision)) {
        return false;
    }
    if (state == ISO_DECISION_VISIT) {
        *verdict = deny(decision, ISO_REASON_LEFT);
    }
    iso_decision_reset(decision);
    return state == ISO_DECISION_VISIT;
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

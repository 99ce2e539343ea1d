/* The decision against an oracle. The oracle judges random visits a second time, from the list of
 * all events, by the rules of firmware/visit/decision.h and without the decision's counters and
 * states. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/base/times.h"
#include "firmware/visit/decision.h"

enum { EVENTS = 60, RUNS = 20000 };

struct event {
    enum { NOTHING, FACE, ATTACK } kind;
    int64_t t_ns;
    struct iso_decision_frame face;
    enum iso_capture cue;
};

/* ---- the oracle ---- */

struct oracle {
    struct iso_decision_options options;
    struct event seen[EVENTS]; /* events of the present visit, used or not */
    int n;                     /* their number; 0: nobody is there */
    int spent_at;              /* a verdict has used seen[] up to here; 0: none */
};

/* Returns the index of the first event of the last face: all later faces are on the same track.
 * o->n: there is no face. */
static int first_of_face(const struct oracle *o)
{
    int first = o->n;
    uint64_t track = 0;
    for (int i = o->n - 1; i >= 0; i--) {
        if (o->seen[i].kind == FACE) {
            if (track != 0 && o->seen[i].face.track != track) {
                break;
            }
            track = o->seen[i].face.track;
            first = i;
        }
    }
    return first;
}

static int count(const struct oracle *o, int from, int kind)
{
    int n = 0;
    for (int i = from; i < o->n; i++) {
        n += (int)o->seen[i].kind == kind;
    }
    return n;
}

static bool counts(const struct oracle *o, const struct iso_decision_frame *face)
{
    return face->person != 0 && face->score >= o->options.threshold &&
           face->score - face->second_score >= o->options.margin;
}

static struct iso_verdict describe(const struct oracle *o, enum iso_reason reason)
{
    const int first = first_of_face(o);
    struct iso_verdict verdict = {.reason = reason, .score = NAN, .cue = ISO_CAPTURE_OK};
    verdict.frames = count(o, first, FACE);
    verdict.attack_frames = count(o, 0, ATTACK);
    for (int i = first; i < o->n; i++) {
        if (o->seen[i].kind == FACE && o->seen[i].face.person != 0) {
            verdict.score = fmax(verdict.score, o->seen[i].face.score);
        }
    }
    for (int cue = 0, most = 0; cue < ISO_CAPTURES; cue++) {
        int n = 0;
        for (int i = 0; i < o->n; i++) {
            n += o->seen[i].kind == ATTACK && (int)o->seen[i].cue == cue;
        }
        verdict.cue = n > most ? (enum iso_capture)cue : verdict.cue;
        most = n > most ? n : most;
    }
    return verdict;
}

/* Advances the time. Returns whether the person has left with a verdict. */
static bool oracle_time(struct oracle *o, int64_t t_ns, struct iso_verdict *verdict)
{
    if (o->n == 0) {
        return false;
    }
    const bool gone = t_ns - o->seen[o->n - 1].t_ns >= o->options.gap_ns;
    const bool again = o->spent_at > 0 &&
                       t_ns - o->seen[o->spent_at - 1].t_ns >= o->options.refractory_ns;
    const bool told = gone && o->spent_at == 0 && count(o, 0, FACE) > 0;
    if (told) {
        *verdict = describe(o, ISO_REASON_LEFT);
    }
    if (gone || again) {
        o->n = 0;
        o->spent_at = 0;
    }
    return told;
}

/* Handles the track of the next face. Returns whether another face has left with a verdict. Then
 * the frames with faces are forgotten, and those with attacks are kept. */
static bool oracle_track(struct oracle *o, uint64_t track, struct iso_verdict *verdict)
{
    const int first = first_of_face(o);
    if (o->spent_at > 0 || first == o->n || o->seen[first].face.track == track) {
        return false;
    }
    *verdict = describe(o, ISO_REASON_LEFT);
    int kept = 0;
    for (int i = 0; i < o->n; i++) {
        if (o->seen[i].kind == ATTACK) {
            o->seen[kept++] = o->seen[i];
        }
    }
    if (kept > 0) { /* a person was there until just now */
        o->seen[kept] = o->seen[o->n - 1];
        o->seen[kept].kind = NOTHING;
        kept++;
    }
    o->n = kept;
    return true;
}

static bool oracle_frame(struct oracle *o, const struct event *event, struct iso_verdict *verdict)
{
    o->seen[o->n++] = *event;
    if (o->spent_at > 0) {
        return false;
    }
    if (event->kind == ATTACK && count(o, 0, ATTACK) >= o->options.attack_frames) {
        *verdict = describe(o, ISO_REASON_ATTACK);
        o->spent_at = o->n;
        return true;
    }
    if (event->kind != FACE) {
        return false;
    }
    int agreeing = 0;
    double best = -INFINITY;
    int64_t since_ns = 0;
    for (int i = first_of_face(o); i < o->n; i++) {
        if (o->seen[i].kind == FACE && counts(o, &o->seen[i].face) &&
            o->seen[i].face.person == event->face.person &&
            o->seen[i].t_ns + o->options.stale_ns >= event->t_ns) {
            since_ns = agreeing ? since_ns : o->seen[i].t_ns;
            agreeing++;
            best = fmax(best, o->seen[i].face.score);
        }
    }
    if (counts(o, &event->face) && agreeing >= o->options.agree &&
        2 * agreeing >= count(o, first_of_face(o), FACE)) {
        *verdict = describe(o, event->face.valid ? ISO_REASON_MATCH : ISO_REASON_NOT_VALID);
        verdict->allow = event->face.valid;
        verdict->person = event->face.person;
        verdict->score = best;
        verdict->since_ns = since_ns;
    } else if (count(o, first_of_face(o), FACE) >= o->options.max_frames) {
        *verdict = describe(o, ISO_REASON_UNKNOWN);
    } else {
        return false;
    }
    o->spent_at = o->n;
    return true;
}

/* ---- the comparison ---- */

static int verdicts[ISO_REASONS];

static void compare(bool told, const struct iso_verdict *verdict, bool expected,
                    const struct iso_verdict *wanted, int run, int event)
{
    const bool same_score = verdict->score == wanted->score ||
                            (isnan(verdict->score) && isnan(wanted->score));
    if (told != expected) {
        fail_msg("run %d, event %d: %s, not %s", run, event,
                 told ? iso_reason_name(verdict->reason) : "nothing",
                 expected ? iso_reason_name(wanted->reason) : "nothing");
    }
    if (told && (verdict->allow != wanted->allow || verdict->reason != wanted->reason ||
                 verdict->person != wanted->person || !same_score ||
                 verdict->frames != wanted->frames || verdict->since_ns != wanted->since_ns ||
                 verdict->cue != wanted->cue || verdict->attack_frames != wanted->attack_frames)) {
        fail_msg("run %d, event %d: %s %d %g %d %d, not %s %d %g %d %d", run, event,
                 iso_reason_name(verdict->reason), (int)verdict->person, verdict->score,
                 verdict->frames, verdict->attack_frames, iso_reason_name(wanted->reason),
                 (int)wanted->person, wanted->score, wanted->frames, wanted->attack_frames);
    }
    if (told) {
        verdicts[verdict->reason]++;
    }
}

static int draw(int n)
{
    return rand() % n;
}

static struct event draw_event(int64_t t_ns, int n_tracks)
{
    static const enum iso_capture cues[] = {ISO_CAPTURE_FLAT, ISO_CAPTURE_STILL};
    struct event event = {.t_ns = t_ns, .cue = cues[draw(2)]};
    event.kind = FACE;
    if (draw(10) >= 6) {
        event.kind = draw(2) ? ATTACK : NOTHING;
    }
    event.face = (struct iso_decision_frame){
        .t_ns = t_ns,
        .person = draw(3),
        .score = draw(20) ? (double)draw(8) : (double)NAN,
        .second_score = draw(3) ? -(double)INFINITY : (double)draw(8),
        .valid = draw(4) != 0,
        .track = 1 + (uint64_t)(draw(6) ? 0 : draw(n_tracks)),
    };
    return event;
}

static void play(int run)
{
    const struct iso_decision_options options = {
        .threshold = 3,
        .margin = 1,
        .agree = 1 + draw(3),
        .max_frames = 3 + draw(4),
        .attack_frames = 1 + draw(3),
        .gap_ns = 20,
        .refractory_ns = 10 + draw(60),
        .stale_ns = 5 + draw(60),
    };
    struct oracle oracle = {.options = options};
    struct iso_decision decision;
    const int n_tracks = 1 + draw(3);
    int64_t t_ns = draw(1000);
    iso_decision_init(&decision, &options);
    for (int i = 0; i < EVENTS; i++) {
        t_ns += draw(8) ? draw(8) : draw(40);
        const struct event event = draw_event(t_ns, n_tracks);
        struct iso_verdict verdict = {0}, wanted = {0};
        bool told = iso_decision_time(&decision, t_ns, &verdict);
        compare(told, &verdict, oracle_time(&oracle, t_ns, &wanted), &wanted, run, i);
        if (event.kind == FACE) {
            told = iso_decision_track(&decision, event.face.track, &verdict);
            compare(told, &verdict, oracle_track(&oracle, event.face.track, &wanted), &wanted, run,
                    i);
            told = iso_decision_face(&decision, &event.face, &verdict);
        } else {
            told = event.kind == ATTACK &&
                   iso_decision_attack(&decision, event.cue, t_ns, &verdict);
        }
        const bool expected = event.kind != NOTHING && oracle_frame(&oracle, &event, &wanted);
        compare(told, &verdict, expected, &wanted, run, i);
    }
}

static void agrees_with_the_oracle(void **state)
{
    (void)state;
    srand(20261121);
    for (int run = 0; run < RUNS; run++) {
        play(run);
    }
    for (int i = ISO_REASON_MATCH; i < ISO_REASONS; i++) {
        print_message("%-9s %d\n", iso_reason_name((enum iso_reason)i), verdicts[i]);
        assert_true(i == ISO_REASON_UNLOGGED || i >= ISO_REASON_LOCKED_OUT ||
                    verdicts[i] > 1000); /* each verdict was tested often */
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(agrees_with_the_oracle)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

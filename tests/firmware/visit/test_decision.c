/* Verdicts over the frames of one visit. */
#include <math.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/base/times.h"
#include "firmware/visit/decision.h"

enum { ANNA = 7, BOB = 12 };

static struct iso_decision decision;
static struct iso_verdict verdict;

#define MS ISO_NS_PER_MS

static int setup(void **state)
{
    const struct iso_decision_options options = {
        .threshold = 4,
        .margin = 0.5,
        .agree = 2,
        .max_frames = 5,
        .attack_frames = 2,
        .gap_ns = 1500 * MS,
        .refractory_ns = 8000 * MS,
        .stale_ns = 1000 * MS,
    };
    (void)state;
    iso_decision_init(&decision, &options);
    verdict = (struct iso_verdict){.allow = true, .frames = -1}; /* to see that it is untouched */
    return 0;
}

/* A usable face at a time; true if that led to a verdict. */
static bool face(int64_t t_ms, int64_t person, double score, double second, bool valid)
{
    const struct iso_decision_frame frame = {t_ms * MS, person, score, second, valid, 1};
    assert_false(iso_decision_time(&decision, t_ms * MS, &verdict));
    return iso_decision_face(&decision, &frame, &verdict);
}

static void all_zero_is_deny(void **state)
{
    const struct iso_verdict zero = {0};
    (void)state;
    assert_false(zero.allow);
    assert_int_equal(zero.reason, ISO_REASON_NONE);
    assert_string_equal(iso_reason_name(ISO_REASON_NOT_VALID), "not-valid");
    assert_null(iso_reason_name(ISO_REASONS));
}

static void allows_after_agreement(void **state)
{
    (void)state;
    assert_false(face(100, ANNA, 6, 1, true));
    assert_int_equal(decision.state, ISO_DECISION_VISIT);
    assert_int_equal(verdict.frames, -1);
    assert_true(face(133, ANNA, 5, 1, true));
    assert_true(verdict.allow);
    assert_int_equal(verdict.reason, ISO_REASON_MATCH);
    assert_int_equal(verdict.person, ANNA);
    assert_true(verdict.score == 6);
    assert_int_equal(verdict.frames, 2);
    assert_int_equal(verdict.since_ns, 100 * MS);
    assert_int_equal(decision.state, ISO_DECISION_SPENT);
}

/* An old frame is no witness of who is there now, however often the face was seen since. */
static void a_stale_frame_agrees_with_nobody(void **state)
{
    (void)state;
    assert_false(face(100, ANNA, 6, 1, true));
    assert_false(face(600, ANNA, 1, 0, true)); /* hidden for a while */
    assert_false(face(1101, ANNA, 5, 1, true));
    assert_true(face(2101, ANNA, 5.5, 1, true)); /* exactly as old as a frame may be */
    assert_true(verdict.allow);
    assert_int_equal(verdict.since_ns, 1101 * MS);
    assert_true(verdict.score == 5.5);
    assert_int_equal(verdict.frames, 4);
}

static void one_frame_may_be_enough(void **state)
{
    (void)state;
    decision.options.agree = 1;
    assert_true(face(100, ANNA, 4, -INFINITY, true));
    assert_true(verdict.allow);
}

static void agreement_need_not_be_in_a_row(void **state)
{
    (void)state;
    assert_false(face(100, ANNA, 6, 1, true));
    assert_false(face(133, BOB, 6, 1, true));
    assert_false(face(166, ANNA, 3.9, 1, true));
    assert_true(face(200, BOB, 7, 1, true));
    assert_int_equal(verdict.person, BOB);
    assert_true(verdict.score == 7);
    assert_int_equal(verdict.frames, 4);
}

/* A stranger who passes now and then has not passed: further frames are no further chances. */
static void half_of_the_frames_have_to_agree(void **state)
{
    (void)state;
    decision.options.max_frames = 6;
    assert_false(face(100, ANNA, 6, 1, true));
    assert_false(face(133, ANNA, 3, 1, true));
    assert_false(face(166, ANNA, 3, 1, true));
    assert_false(face(200, ANNA, 3, 1, true));
    assert_false(face(233, ANNA, 6, 1, true)); /* 2 of 5 */
    assert_true(face(266, ANNA, 5, 1, true));  /* 3 of 6 */
    assert_true(verdict.allow);
    assert_int_equal(verdict.frames, 6);
}

static void two_of_six_are_not_enough(void **state)
{
    (void)state;
    decision.options.max_frames = 6;
    for (int i = 0; i < 4; i++) {
        assert_false(face(100 + 33 * i, ANNA, 3, 1, true));
    }
    assert_false(face(240, ANNA, 6, 1, true));
    assert_true(face(280, ANNA, 6, 1, true));
    assert_false(verdict.allow);
    assert_int_equal(verdict.reason, ISO_REASON_UNKNOWN);
}

/* Frames are judged by the threshold that held when they came. */
static void a_new_threshold_holds_from_the_next_frame_on(void **state)
{
    (void)state;
    assert_false(face(100, ANNA, 4.5, 1, true));
    iso_decision_set_threshold(&decision, 5);
    assert_false(face(133, ANNA, 4.5, 1, true));
    assert_true(face(166, ANNA, 5, 1, true));
    assert_true(verdict.allow);
}

static void denies_without_agreement(void **state)
{
    (void)state;
    for (int i = 0; i < 4; i++) {
        assert_false(face(100 + 33 * i, ANNA, 3.999, 1, true));
    }
    assert_true(face(300, ANNA, 4, 1, true)); /* one is not two */
    assert_false(verdict.allow);
    assert_int_equal(verdict.reason, ISO_REASON_UNKNOWN);
    assert_int_equal(verdict.person, 0);
    assert_true(verdict.score == 4);
    assert_int_equal(verdict.frames, 5);
}

static void denies_out_of_time(void **state)
{
    (void)state;
    assert_false(face(100, ANNA, 6, 1, false));
    assert_true(face(133, ANNA, 6, 1, false));
    assert_false(verdict.allow);
    assert_int_equal(verdict.reason, ISO_REASON_NOT_VALID);
    assert_int_equal(verdict.person, ANNA);
}

static void wants_a_lead_over_the_second(void **state)
{
    (void)state;
    assert_false(face(100, ANNA, 6, 5.6, true));
    assert_false(face(133, ANNA, 6, 5.6, true));
    assert_false(face(166, ANNA, 6, 5.5, true));
    assert_true(face(200, ANNA, 6, 5.5, true));
    assert_true(verdict.allow);
    assert_int_equal(verdict.frames, 4);
}

static void nothing_counts_that_is_not_a_number(void **state)
{
    (void)state;
    for (int i = 0; i < 4; i++) {
        assert_false(face(100 + i, ANNA, NAN, -INFINITY, true));
    }
    assert_true(face(200, ANNA, NAN, NAN, true));
    assert_false(verdict.allow);
    assert_true(isnan(verdict.score));
}

static void nothing_counts_that_is_infinite(void **state)
{
    (void)state;
    for (int i = 0; i < 4; i++) {
        assert_false(face(100 + i, ANNA, INFINITY, -INFINITY, true));
    }
    assert_true(face(200, ANNA, INFINITY, -INFINITY, true));
    assert_false(verdict.allow);
    assert_true(isnan(verdict.score));
}

static void an_empty_gallery_denies(void **state)
{
    (void)state;
    for (int i = 0; i < 4; i++) {
        assert_false(face(100 + i, 0, 99, -INFINITY, true));
    }
    assert_true(face(200, 0, 99, -INFINITY, true));
    assert_false(verdict.allow);
    assert_int_equal(verdict.person, 0);
    assert_true(isnan(verdict.score));
}

static void denies_who_leaves(void **state)
{
    (void)state;
    assert_false(face(100, ANNA, 6, 1, true));
    assert_int_equal(iso_decision_due_ns(&decision), 1600 * MS);
    assert_false(iso_decision_time(&decision, 1600 * MS - 1, &verdict));
    assert_true(iso_decision_time(&decision, 1600 * MS, &verdict));
    assert_false(verdict.allow);
    assert_int_equal(verdict.reason, ISO_REASON_LEFT);
    assert_int_equal(verdict.person, 0);
    assert_true(verdict.score == 6);
    assert_int_equal(decision.state, ISO_DECISION_IDLE);
    assert_int_equal(iso_decision_due_ns(&decision), ISO_NEVER_NS);
    assert_false(face(5000, ANNA, 6, 1, true)); /* the frame before does not count any more */
}

static void says_nothing_twice(void **state)
{
    (void)state;
    (void)face(100, ANNA, 6, 1, true);
    assert_true(face(133, ANNA, 6, 1, true));
    for (int t = 166; t < 8000; t += 33) {
        assert_false(face(t, ANNA, 6, 1, true));
    }
    assert_int_equal(iso_decision_due_ns(&decision), 8133 * MS);
}

static void looks_again_at_who_stays(void **state)
{
    (void)state;
    (void)face(100, ANNA, 6, 1, true);
    assert_true(face(133, ANNA, 6, 1, true));
    for (int t = 1000; t <= 8000; t += 1000) {
        assert_false(face(t, BOB, 6, 1, true));
    }
    assert_false(iso_decision_time(&decision, 8133 * MS, &verdict));
    assert_int_equal(decision.state, ISO_DECISION_IDLE);
    assert_false(face(8140, BOB, 6, 1, true));
    assert_true(face(8173, BOB, 6, 1, true));
    assert_int_equal(verdict.person, BOB);
    assert_int_equal(verdict.frames, 2);
}

static void is_ready_for_the_next_when_one_has_left(void **state)
{
    (void)state;
    (void)face(100, ANNA, 6, 1, true);
    assert_true(face(133, ANNA, 6, 1, true));
    assert_int_equal(iso_decision_due_ns(&decision), 1633 * MS);
    assert_false(iso_decision_time(&decision, 1633 * MS, &verdict));
    assert_int_equal(decision.state, ISO_DECISION_IDLE);
}

static void forgets_on_reset(void **state)
{
    (void)state;
    (void)face(100, ANNA, 6, 1, true);
    iso_decision_reset(&decision);
    assert_int_equal(iso_decision_due_ns(&decision), ISO_NEVER_NS);
    assert_false(iso_decision_time(&decision, 90000 * MS, &verdict));
    assert_false(face(90033, ANNA, 6, 1, true));
    assert_int_equal(verdict.frames, -1);
}

/* ---- attacks ---- */

static bool attack(int64_t t_ms, enum iso_capture cue)
{
    assert_false(iso_decision_time(&decision, t_ms * MS, &verdict));
    return iso_decision_attack(&decision, cue, t_ms * MS, &verdict);
}

static void an_attack_is_a_visit_that_is_denied(void **state)
{
    (void)state;
    assert_false(attack(100, ISO_CAPTURE_FLAT));
    assert_int_equal(decision.state, ISO_DECISION_VISIT);
    assert_int_equal(verdict.frames, -1);
    assert_true(attack(133, ISO_CAPTURE_FLAT));
    assert_false(verdict.allow);
    assert_int_equal(verdict.reason, ISO_REASON_ATTACK);
    assert_string_equal(iso_reason_name(verdict.reason), "attack");
    assert_int_equal(verdict.frames, 0);
    assert_int_equal(verdict.attack_frames, 2);
    assert_int_equal(verdict.cue, ISO_CAPTURE_FLAT);
    assert_true(isnan(verdict.score));
    assert_int_equal(decision.state, ISO_DECISION_SPENT);
}

static void cues_count_among_usable_frames(void **state)
{
    (void)state;
    decision.options.agree = 3;
    assert_false(face(100, ANNA, 6, 1, true));
    assert_false(attack(133, ISO_CAPTURE_EYES_CUT));
    assert_false(face(166, ANNA, 6, 1, true));
    assert_true(attack(200, ISO_CAPTURE_STILL));
    assert_int_equal(verdict.reason, ISO_REASON_ATTACK);
    assert_int_equal(verdict.frames, 2);
    assert_int_equal(verdict.person, 0);
    assert_true(verdict.score == 6);
    assert_int_equal(verdict.cue, ISO_CAPTURE_EYES_CUT); /* of two as many, the first of the list */
    for (int t = 233; t < 8000; t += 33) {
        assert_false(face(t, ANNA, 6, 1, true)); /* whoever takes the mask off waits */
    }
}

static void one_cue_may_be_a_mistake(void **state)
{
    (void)state;
    assert_false(attack(100, ISO_CAPTURE_BENT));
    assert_false(face(133, ANNA, 6, 1, true));
    assert_true(face(166, ANNA, 6, 1, true));
    assert_true(verdict.allow);
    assert_int_equal(verdict.attack_frames, 1);
    assert_int_equal(verdict.cue, ISO_CAPTURE_BENT);
}

static void a_cue_alone_is_no_visit(void **state)
{
    (void)state;
    assert_false(attack(100, ISO_CAPTURE_BENT));
    assert_int_equal(iso_decision_due_ns(&decision), 1600 * MS);
    assert_false(iso_decision_time(&decision, 1600 * MS, &verdict));
    assert_int_equal(decision.state, ISO_DECISION_IDLE);
    assert_int_equal(verdict.frames, -1);
    assert_false(attack(1700, ISO_CAPTURE_BENT)); /* the one before is forgotten */
}

static void an_attack_that_stays_is_denied_once(void **state)
{
    (void)state;
    (void)attack(100, ISO_CAPTURE_FLAT);
    assert_true(attack(133, ISO_CAPTURE_FLAT));
    for (int t = 166; t < 8133; t += 33) {
        assert_false(attack(t, ISO_CAPTURE_FLAT));
    }
    assert_false(iso_decision_time(&decision, 8133 * MS, &verdict));
    assert_int_equal(decision.state, ISO_DECISION_IDLE);
    assert_false(attack(8150, ISO_CAPTURE_FLAT));
    assert_true(attack(8183, ISO_CAPTURE_FLAT));
}

/* ---- tracks ---- */

/* A usable face of a track; the verdict on the face before is in `verdict`. */
static bool face_of(uint64_t track, int64_t t_ms, int64_t person)
{
    const struct iso_decision_frame frame = {t_ms * MS, person, 6, 1, true, track};
    assert_false(iso_decision_time(&decision, t_ms * MS, &verdict));
    const bool told = iso_decision_track(&decision, track, &verdict);
    assert_false(iso_decision_face(&decision, &frame, &verdict));
    return told;
}

static void two_faces_do_not_agree(void **state)
{
    (void)state;
    assert_false(face_of(1, 100, ANNA));
    assert_true(face_of(2, 133, ANNA));
    assert_int_equal(verdict.reason, ISO_REASON_LEFT);
    assert_false(verdict.allow);
    assert_int_equal(verdict.frames, 1);
    assert_true(face_of(3, 166, ANNA));
    assert_int_equal(verdict.frames, 1);
    assert_int_equal(decision.n_frames, 1);
    const struct iso_decision_frame frame = {200 * MS, ANNA, 6, 1, true, 3};
    assert_false(iso_decision_track(&decision, 3, &verdict));
    assert_true(iso_decision_face(&decision, &frame, &verdict));
    assert_true(verdict.allow);
    assert_int_equal(verdict.frames, 2);
}

/* A caller that tells of no track gets no agreement of two faces out of it. */
static void two_faces_do_not_agree_untold(void **state)
{
    const struct iso_decision_frame one = {100 * MS, ANNA, 6, 1, true, 1};
    const struct iso_decision_frame other = {133 * MS, ANNA, 6, 1, true, 2};
    (void)state;
    assert_false(iso_decision_face(&decision, &one, &verdict));
    assert_false(iso_decision_face(&decision, &other, &verdict));
}

static void another_face_does_not_wash_off_an_attack(void **state)
{
    (void)state;
    assert_false(face_of(1, 100, ANNA));
    assert_false(attack(133, ISO_CAPTURE_SCREEN));
    assert_true(face_of(2, 166, ANNA));
    assert_int_equal(verdict.reason, ISO_REASON_LEFT);
    assert_true(attack(200, ISO_CAPTURE_SCREEN));
    assert_int_equal(verdict.reason, ISO_REASON_ATTACK);
    assert_int_equal(verdict.attack_frames, 2);
    assert_int_equal(verdict.frames, 1);
}

static void who_jumps_does_not_shorten_the_wait(void **state)
{
    (void)state;
    (void)face_of(1, 100, ANNA);
    assert_true(face(133, ANNA, 6, 1, true));
    assert_false(face_of(2, 166, ANNA));
    assert_false(face_of(2, 200, ANNA));
    assert_int_equal(decision.state, ISO_DECISION_SPENT);
}

static void holds_the_longest_visit(void **state)
{
    (void)state;
    decision.options.max_frames = ISO_DECISION_FRAMES_MAX;
    decision.options.agree = ISO_DECISION_FRAMES_MAX;
    for (int i = 1; i < ISO_DECISION_FRAMES_MAX; i++) {
        assert_false(face(i, ANNA, 6, 1, true));
    }
    assert_true(face(ISO_DECISION_FRAMES_MAX, ANNA, 6, 1, true));
    assert_true(verdict.allow);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(all_zero_is_deny, setup),
        cmocka_unit_test_setup(allows_after_agreement, setup),
        cmocka_unit_test_setup(one_frame_may_be_enough, setup),
        cmocka_unit_test_setup(agreement_need_not_be_in_a_row, setup),
        cmocka_unit_test_setup(half_of_the_frames_have_to_agree, setup),
        cmocka_unit_test_setup(two_of_six_are_not_enough, setup),
        cmocka_unit_test_setup(a_new_threshold_holds_from_the_next_frame_on, setup),
        cmocka_unit_test_setup(denies_without_agreement, setup),
        cmocka_unit_test_setup(denies_out_of_time, setup),
        cmocka_unit_test_setup(wants_a_lead_over_the_second, setup),
        cmocka_unit_test_setup(nothing_counts_that_is_not_a_number, setup),
        cmocka_unit_test_setup(nothing_counts_that_is_infinite, setup),
        cmocka_unit_test_setup(an_empty_gallery_denies, setup),
        cmocka_unit_test_setup(denies_who_leaves, setup),
        cmocka_unit_test_setup(says_nothing_twice, setup),
        cmocka_unit_test_setup(looks_again_at_who_stays, setup),
        cmocka_unit_test_setup(is_ready_for_the_next_when_one_has_left, setup),
        cmocka_unit_test_setup(forgets_on_reset, setup),
        cmocka_unit_test_setup(an_attack_is_a_visit_that_is_denied, setup),
        cmocka_unit_test_setup(cues_count_among_usable_frames, setup),
        cmocka_unit_test_setup(one_cue_may_be_a_mistake, setup),
        cmocka_unit_test_setup(a_cue_alone_is_no_visit, setup),
        cmocka_unit_test_setup(an_attack_that_stays_is_denied_once, setup),
        cmocka_unit_test_setup(two_faces_do_not_agree, setup),
        cmocka_unit_test_setup(two_faces_do_not_agree_untold, setup),
        cmocka_unit_test_setup(another_face_does_not_wash_off_an_attack, setup),
        cmocka_unit_test_setup(who_jumps_does_not_shorten_the_wait, setup),
        cmocka_unit_test_setup(a_stale_frame_agrees_with_nobody, setup),
        cmocka_unit_test_setup(holds_the_longest_visit, setup),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

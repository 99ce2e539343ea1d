/* Verdicts over the frames of one visit. */
#include <math.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/firmware/visit/decision_rig.h"

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

/* A stranger whose frames pass now and then is not admitted. More frames do not give more chances.
 */
static void half_of_the_frames_have_to_agree(void **state)
{
    (void)state;
    decision.options.max_frames = 6;
    assert_false(face(100, ANNA, 6, 1, true));
    assert_false(face(133, ANNA, 3, 1, true));
    assert_false(face(166, ANNA, 3, 1, true));
    assert_false(face(200, ANNA, 3, 1, true));
    assert_false(face(233, ANNA, 6, 1, true)); /* 2 of 5 frames */
    assert_true(face(266, ANNA, 5, 1, true));  /* 3 of 6 frames */
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

/* The threshold at the time of a frame decides about this frame. */
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
    assert_true(face(300, ANNA, 4, 1, true)); /* one frame is not enough */
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

static void needs_a_lead_over_the_second(void **state)
{
    (void)state;
    assert_false(face(100, ANNA, 6, 5.6, true));
    assert_false(face(133, ANNA, 6, 5.6, true));
    assert_false(face(166, ANNA, 6, 5.5, true));
    assert_true(face(200, ANNA, 6, 5.5, true));
    assert_true(verdict.allow);
    assert_int_equal(verdict.frames, 4);
}

static void a_score_that_is_no_number_does_not_count(void **state)
{
    (void)state;
    for (int i = 0; i < 4; i++) {
        assert_false(face(100 + i, ANNA, NAN, -INFINITY, true));
    }
    assert_true(face(200, ANNA, NAN, NAN, true));
    assert_false(verdict.allow);
    assert_true(isnan(verdict.score));
}

static void an_infinite_score_does_not_count(void **state)
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

static void denies_a_person_who_leaves(void **state)
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
    assert_false(face(5000, ANNA, 6, 1, true)); /* the previous frame does not count any more */
}

static void gives_one_verdict_only(void **state)
{
    (void)state;
    (void)face(100, ANNA, 6, 1, true);
    assert_true(face(133, ANNA, 6, 1, true));
    for (int t = 166; t < 8000; t += 33) {
        assert_false(face(t, ANNA, 6, 1, true));
    }
    assert_int_equal(iso_decision_due_ns(&decision), 8133 * MS);
}

static void decides_again_on_a_person_who_stays(void **state)
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

/* ---- the longest visit ---- */

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
        cmocka_unit_test_setup(all_zero_is_deny, decision_rig_setup),
        cmocka_unit_test_setup(allows_after_agreement, decision_rig_setup),
        cmocka_unit_test_setup(one_frame_may_be_enough, decision_rig_setup),
        cmocka_unit_test_setup(agreement_need_not_be_in_a_row, decision_rig_setup),
        cmocka_unit_test_setup(half_of_the_frames_have_to_agree, decision_rig_setup),
        cmocka_unit_test_setup(two_of_six_are_not_enough, decision_rig_setup),
        cmocka_unit_test_setup(a_new_threshold_holds_from_the_next_frame_on, decision_rig_setup),
        cmocka_unit_test_setup(denies_without_agreement, decision_rig_setup),
        cmocka_unit_test_setup(denies_out_of_time, decision_rig_setup),
        cmocka_unit_test_setup(needs_a_lead_over_the_second, decision_rig_setup),
        cmocka_unit_test_setup(a_score_that_is_no_number_does_not_count, decision_rig_setup),
        cmocka_unit_test_setup(an_infinite_score_does_not_count, decision_rig_setup),
        cmocka_unit_test_setup(an_empty_gallery_denies, decision_rig_setup),
        cmocka_unit_test_setup(denies_a_person_who_leaves, decision_rig_setup),
        cmocka_unit_test_setup(gives_one_verdict_only, decision_rig_setup),
        cmocka_unit_test_setup(decides_again_on_a_person_who_stays, decision_rig_setup),
        cmocka_unit_test_setup(is_ready_for_the_next_when_one_has_left, decision_rig_setup),
        cmocka_unit_test_setup(forgets_on_reset, decision_rig_setup),
        cmocka_unit_test_setup(holds_the_longest_visit, decision_rig_setup),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

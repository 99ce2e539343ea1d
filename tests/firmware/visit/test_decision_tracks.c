/* Verdicts with cues of an attack, or with more than one face. */
#include <math.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/firmware/visit/decision_rig.h"

/* An old frame does not show who is there now, however often the face was seen since then. */
static void a_stale_frame_agrees_with_nobody(void **state)
{
    (void)state;
    assert_false(face(100, ANNA, 6, 1, true));
    assert_false(face(600, ANNA, 1, 0, true)); /* the face is hidden for a while */
    assert_false(face(1101, ANNA, 5, 1, true));
    assert_true(face(2101, ANNA, 5.5, 1, true)); /* that of 1101 ms has exactly the greatest age */
    assert_true(verdict.allow);
    assert_int_equal(verdict.since_ns, 1101 * MS);
    assert_true(verdict.score == 5.5);
    assert_int_equal(verdict.frames, 4);
}

/* ---- attacks ---- */

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
    assert_int_equal(verdict.cue, ISO_CAPTURE_EYES_CUT); /* a tie: the first wins */
    for (int t = 233; t < 8000; t += 33) {
        assert_false(face(t, ANNA, 6, 1, true)); /* a person who takes a mask off has to wait */
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
    assert_false(attack(1700, ISO_CAPTURE_BENT)); /* the previous attempt is forgotten */
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

/* Adds a usable face of a track. Returns whether there was a verdict on the previous face, which is
 * then in `verdict`. */
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

/* Even if the caller does not report the new track, two faces do not agree. */
static void two_faces_do_not_agree_without_a_report(void **state)
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

static void a_jump_does_not_shorten_the_wait(void **state)
{
    (void)state;
    (void)face_of(1, 100, ANNA);
    assert_true(face(133, ANNA, 6, 1, true));
    assert_false(face_of(2, 166, ANNA));
    assert_false(face_of(2, 200, ANNA));
    assert_int_equal(decision.state, ISO_DECISION_SPENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(an_attack_is_a_visit_that_is_denied, decision_rig_setup),
        cmocka_unit_test_setup(cues_count_among_usable_frames, decision_rig_setup),
        cmocka_unit_test_setup(one_cue_may_be_a_mistake, decision_rig_setup),
        cmocka_unit_test_setup(a_cue_alone_is_no_visit, decision_rig_setup),
        cmocka_unit_test_setup(an_attack_that_stays_is_denied_once, decision_rig_setup),
        cmocka_unit_test_setup(two_faces_do_not_agree, decision_rig_setup),
        cmocka_unit_test_setup(two_faces_do_not_agree_without_a_report, decision_rig_setup),
        cmocka_unit_test_setup(another_face_does_not_wash_off_an_attack, decision_rig_setup),
        cmocka_unit_test_setup(a_jump_does_not_shorten_the_wait, decision_rig_setup),
        cmocka_unit_test_setup(a_stale_frame_agrees_with_nobody, decision_rig_setup),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

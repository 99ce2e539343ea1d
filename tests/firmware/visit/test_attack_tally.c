/* The tally that groups attack frames into attempts. */
#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/base/times.h"
#include "firmware/visit/attack_tally.h"

static struct iso_attack_tally tally;
static struct iso_attack_attempt attempt;

#define MS ISO_NS_PER_MS

static int setup(void **state)
{
    (void)state;
    iso_attack_tally_init(&tally, 800 * MS, 3000 * MS);
    attempt = (struct iso_attack_attempt){.frames = -1};
    return 0;
}

static void frame(int64_t t_ms, enum iso_capture cue)
{
    assert_false(iso_attack_tally_time(&tally, t_ms * MS, &attempt));
    iso_attack_tally_frame(&tally, cue, t_ms * MS);
}

static void nothing_is_no_attempt(void **state)
{
    (void)state;
    assert_int_equal(iso_attack_tally_due_ns(&tally), ISO_NEVER_NS);
    assert_false(iso_attack_tally_time(&tally, 99999 * MS, &attempt));
    assert_false(iso_attack_tally_end(&tally, &attempt));
    assert_int_equal(attempt.frames, -1);
}

static void an_attempt_ends_in_quiet(void **state)
{
    (void)state;
    frame(100, ISO_CAPTURE_BENT);
    frame(200, ISO_CAPTURE_FLAT);
    frame(300, ISO_CAPTURE_SCREEN);
    frame(450, ISO_CAPTURE_FLAT);
    assert_int_equal(iso_attack_tally_due_ns(&tally), 1250 * MS);
    assert_false(iso_attack_tally_time(&tally, 1250 * MS - 1, &attempt));
    assert_true(iso_attack_tally_time(&tally, 1250 * MS, &attempt));
    assert_int_equal(attempt.cue, ISO_CAPTURE_FLAT);
    assert_int_equal(attempt.frames, 4);
    assert_int_equal(attempt.duration_ns, 350 * MS);
    assert_int_equal(iso_attack_tally_due_ns(&tally), ISO_NEVER_NS);
}

static void of_two_equal_cues_the_first_is_reported(void **state)
{
    (void)state;
    frame(100, ISO_CAPTURE_STILL);
    frame(200, ISO_CAPTURE_FLAT);
    assert_true(iso_attack_tally_end(&tally, &attempt));
    assert_int_equal(attempt.cue, ISO_CAPTURE_STILL);
    assert_int_equal(attempt.frames, 2);
    frame(300, ISO_CAPTURE_EYES_CUT); /* nothing is left of the previous attempt */
    assert_true(iso_attack_tally_end(&tally, &attempt));
    assert_int_equal(attempt.cue, ISO_CAPTURE_EYES_CUT);
    assert_int_equal(attempt.frames, 1);
    assert_int_equal(attempt.duration_ns, 0);
}

/* A picture that hangs there for an hour gives a record from time to time, and not one for each
 * frame. */
static void a_long_attempt_is_reported_in_parts(void **state)
{
    int told = 0, frames = 0;
    (void)state;
    for (int64_t t_ms = 0; t_ms < 30000; t_ms += 33) {
        if (iso_attack_tally_time(&tally, t_ms * MS, &attempt)) {
            assert_in_range(attempt.duration_ns, 2950 * MS, 3000 * MS);
            frames += attempt.frames;
            told++;
        }
        iso_attack_tally_frame(&tally, ISO_CAPTURE_FLAT, t_ms * MS);
    }
    assert_true(iso_attack_tally_end(&tally, &attempt));
    assert_int_equal(frames + attempt.frames, 910);
    assert_int_equal(told, 9);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(nothing_is_no_attempt, setup),
        cmocka_unit_test_setup(an_attempt_ends_in_quiet, setup),
        cmocka_unit_test_setup(of_two_equal_cues_the_first_is_reported, setup),
        cmocka_unit_test_setup(a_long_attempt_is_reported_in_parts, setup),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

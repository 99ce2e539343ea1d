/* Which hint is given, and when. */
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/visit/hint_filter.h"

static struct iso_hint_filter filter;
static int64_t now_ms;

#define MS ISO_NS_PER_MS

static int setup(void **state)
{
    const struct iso_hint_options options = {.hold = 3, .interval_ns = 1000 * MS};
    (void)state;
    now_ms = 5000;
    iso_hint_filter_init(&filter, &options);
    return 0;
}

/* Adds n frames, 33 ms apart. Returns the given hints, each as "word ". */
static const char *show(enum iso_capture capture, int n)
{
    static char given[512];
    given[0] = '\0';
    for (int i = 0; i < n; i++) {
        const enum iso_capture hint = iso_hint_filter_frame(&filter, capture, now_ms * MS);
        if (hint != ISO_CAPTURE_OK) {
            strcat(strcat(given, iso_capture_name(hint)), " ");
        }
        now_ms += 33;
    }
    return given;
}

static void a_word_must_hold(void **state)
{
    (void)state;
    assert_string_equal(show(ISO_CAPTURE_TOO_FAR, 2), "");
    assert_string_equal(show(ISO_CAPTURE_TOO_FAR, 1), "too-far ");
}

static void a_hint_that_goes_on_is_repeated(void **state)
{
    (void)state;
    assert_string_equal(show(ISO_CAPTURE_TOO_FAR, 30), "too-far ");
    assert_string_equal(show(ISO_CAPTURE_TOO_FAR, 5), "too-far "); /* 1 s after the third frame */
    assert_string_equal(show(ISO_CAPTURE_TOO_FAR, 28), "");
}

/* Two words in turn give one hint a second, in any order. */
static void does_not_flicker(void **state)
{
    char all[512] = "";
    int hints = 0;
    (void)state;
    for (int i = 0; i < 60; i++) {
        strcat(all, show(i % 2 ? ISO_CAPTURE_TURN_LEFT : ISO_CAPTURE_LOOK_UP, 1));
    }
    for (const char *at = all; (at = strchr(at, ' ')); at++) {
        hints++;
    }
    assert_int_equal(hints, 2); /* in 2 s */
}

static void the_most_frequent_reason_is_given(void **state)
{
    (void)state;
    filter.options.interval_ns = 0;
    assert_string_equal(show(ISO_CAPTURE_TURN_LEFT, 2), "");
    assert_string_equal(show(ISO_CAPTURE_LOOK_UP, 2), "");
    assert_string_equal(show(ISO_CAPTURE_TURN_LEFT, 1), "turn-left ");
    assert_string_equal(show(ISO_CAPTURE_LOOK_UP, 1), "look-up "); /* 3 to 3: the newest wins */
    assert_string_equal(show(ISO_CAPTURE_TOO_FAR, 1), ""); /* a corrected fault gives no hint */
    assert_string_equal(show(ISO_CAPTURE_LOOK_UP, 1), "look-up ");
}

static void usable_frames_give_no_hint(void **state)
{
    (void)state;
    assert_string_equal(show(ISO_CAPTURE_OK, 5), "");
    assert_string_equal(show(ISO_CAPTURE_TURN_LEFT, 3), ""); /* 3 of 8 frames */
    assert_string_equal(show(ISO_CAPTURE_TURN_LEFT, 1), "turn-left ");
}

static void old_frames_do_not_vote(void **state)
{
    (void)state;
    assert_string_equal(show(ISO_CAPTURE_TOO_FAR, 2), "");
    now_ms += 2000;
    assert_string_equal(show(ISO_CAPTURE_TOO_FAR, 2), "");
    assert_string_equal(show(ISO_CAPTURE_TOO_FAR, 1), "too-far ");
}

static void after_a_reset_a_hint_need_not_wait(void **state)
{
    (void)state;
    assert_string_equal(show(ISO_CAPTURE_TOO_FAR, 3), "too-far ");
    iso_hint_filter_reset(&filter);
    assert_string_equal(show(ISO_CAPTURE_TOO_FAR, 3), "too-far ");
    iso_hint_filter_forget(&filter);
    assert_string_equal(show(ISO_CAPTURE_TOO_FAR, 3), "");
}

/* For random inputs, hints keep their distance in time, and each of them has lasted. */
static void any_sequence(void **state)
{
    (void)state;
    srand(7);
    for (int run = 0; run < 300; run++) {
        enum iso_capture shown[100];
        int64_t told_ms = -100000, t_ms = 0;
        const int n_words = 1 + rand() % 4, hold = 1 + rand() % ISO_HINT_FRAMES;
        const struct iso_hint_options options = {.hold = hold, .interval_ns = 500 * MS};
        iso_hint_filter_init(&filter, &options);
        for (int i = 0; i < 100; i++) {
            t_ms += rand() % 80;
            shown[i] = (enum iso_capture)(ISO_CAPTURE_OK + rand() % n_words);
            const enum iso_capture hint = iso_hint_filter_frame(&filter, shown[i], t_ms * MS);
            if (hint == ISO_CAPTURE_OK) {
                continue;
            }
            int held = 0;
            for (int j = i; j >= 0 && j > i - ISO_HINT_FRAMES; j--) {
                held += shown[j] == hint;
            }
            assert_true(held >= hold);
            assert_int_equal(hint, shown[i]);
            assert_true(t_ms - told_ms >= 500);
            told_ms = t_ms;
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(a_word_must_hold, setup),
        cmocka_unit_test_setup(a_hint_that_goes_on_is_repeated, setup),
        cmocka_unit_test_setup(does_not_flicker, setup),
        cmocka_unit_test_setup(the_most_frequent_reason_is_given, setup),
        cmocka_unit_test_setup(usable_frames_give_no_hint, setup),
        cmocka_unit_test_setup(old_frames_do_not_vote, setup),
        cmocka_unit_test_setup(after_a_reset_a_hint_need_not_wait, setup),
        cmocka_unit_test_setup(any_sequence, setup),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* A sensor that repeats its frames is reported once, and not at every second frame. */
#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/visit/repeat_watch.h"

/* Takes n frames of a kind. Returns how often the state changed. */
static int take(struct iso_repeat_watch *watch, bool repeats, int n)
{
    int changes = 0;
    for (int i = 0; i < n; i++) {
        changes += iso_repeat_watch_take(watch, repeats);
    }
    return changes;
}

static void three_repeated_frames_are_a_fault(void **state)
{
    struct iso_repeat_watch watch = {.stuck = false};
    (void)state;
    assert_int_equal(take(&watch, true, 2), 0);
    assert_int_equal(take(&watch, false, 1), 0);
    assert_int_equal(take(&watch, true, 2), 0);
    assert_false(watch.stuck);
    assert_int_equal(take(&watch, true, 1), 1);
    assert_true(watch.stuck);
    assert_int_equal(take(&watch, true, 1000), 0);
}

static void a_run_of_new_frames_ends_it(void **state)
{
    struct iso_repeat_watch watch = {.stuck = false};
    (void)state;
    assert_int_equal(take(&watch, true, ISO_REPEATS_TO_STUCK), 1);
    assert_int_equal(take(&watch, false, ISO_NEW_TO_FREE - 1), 0);
    assert_int_equal(take(&watch, true, 1), 0);
    assert_int_equal(take(&watch, false, ISO_NEW_TO_FREE - 1), 0);
    assert_true(watch.stuck);
    assert_int_equal(take(&watch, false, 1), 1);
    assert_false(watch.stuck);
}

/* Repeated and new frames in turn give one fault without an end. */
static void turns_do_not_flap(void **state)
{
    struct iso_repeat_watch watch = {.stuck = false};
    int changes = 0;
    (void)state;
    for (int i = 0; i < 1000; i++) {
        changes += take(&watch, true, 3);
        changes += take(&watch, false, 1 + i % (ISO_NEW_TO_FREE - 1));
    }
    assert_int_equal(changes, 1);
    assert_true(watch.stuck);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(three_repeated_frames_are_a_fault),
        cmocka_unit_test(a_run_of_new_frames_ends_it),
        cmocka_unit_test(turns_do_not_flap),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

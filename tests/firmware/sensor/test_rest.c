/* When an appliance rests, which frames it examines then, and what ends the rest. */
#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/sensor/rest.h"

static const int64_t after_ns = 10000000000, frame_ns = 33333333;

struct door {
    struct iso_rest rest;
    int64_t t_ns;
    int examined;
};

/* A frame comes. Returns whether it was examined. */
static bool come(struct door *door, bool stirs, bool wanted, bool busy)
{
    door->t_ns += door->rest.resting ? ISO_REST_INTERVAL_NS : frame_ns;
    const struct iso_rest_frame frame = {.t_ns = door->t_ns, .stirs = stirs, .wanted = wanted};
    if (iso_rest_skips(&door->rest, &frame)) {
        return false;
    }
    iso_rest_note(&door->rest, door->t_ns, busy, after_ns);
    door->examined++;
    return true;
}

static void rest_until(struct door *door, int64_t t_ns)
{
    while (door->t_ns < t_ns) {
        (void)come(door, false, false, false);
    }
}

static void rest_begins_when_nobody_was_there_for_long(void **state)
{
    struct door door = {.t_ns = 0};
    (void)state;
    rest_until(&door, after_ns / 2);
    assert_true(come(&door, false, false, true));
    const int64_t busy_ns = door.t_ns;
    rest_until(&door, busy_ns + after_ns - frame_ns);
    assert_false(door.rest.resting);
    rest_until(&door, busy_ns + after_ns + frame_ns);
    assert_true(door.rest.resting);
}

static void one_frame_a_second_is_examined_at_rest(void **state)
{
    struct door door = {.t_ns = 0};
    (void)state;
    rest_until(&door, after_ns + 2 * frame_ns);
    assert_true(door.rest.resting);
    door.examined = 0;
    rest_until(&door, door.t_ns + 60 * ISO_REST_EXAMINE_NS);
    assert_in_range(door.examined, 50, 60);
}

static void a_frame_that_stirs_is_examined_at_once(void **state)
{
    struct door door = {.t_ns = 0};
    (void)state;
    rest_until(&door, 2 * after_ns);
    while (come(&door, false, false, false)) {
    }
    assert_true(door.rest.resting);
    assert_true(come(&door, true, false, false));
    /* The time begins anew, although the examination found nobody. */
    for (int i = 0; i < 100; i++) {
        assert_false(door.rest.resting);
        assert_true(come(&door, false, false, false));
    }
}

static void a_client_who_waits_ends_rest(void **state)
{
    struct door door = {.t_ns = 0};
    (void)state;
    rest_until(&door, 2 * after_ns);
    assert_true(come(&door, false, true, false));
    assert_false(door.rest.resting);
}

static void somebody_found_by_the_examination_ends_rest(void **state)
{
    struct door door = {.t_ns = 0};
    (void)state;
    rest_until(&door, 2 * after_ns);
    assert_true(door.rest.resting);
    while (!come(&door, false, false, true)) {
    }
    assert_false(door.rest.resting);
}

static void no_time_means_never(void **state)
{
    struct iso_rest rest = {.resting = false};
    (void)state;
    for (int64_t s = 0; s < 3600; s++) {
        iso_rest_note(&rest, s * 1000000000, false, 0);
        assert_false(rest.resting);
    }
}

static void an_opened_sensor_begins_awake(void **state)
{
    struct door door = {.t_ns = 0};
    (void)state;
    rest_until(&door, 2 * after_ns);
    assert_true(door.rest.resting);
    iso_rest_end(&door.rest);
    assert_true(come(&door, false, false, false));
    assert_false(door.rest.resting);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(rest_begins_when_nobody_was_there_for_long),
        cmocka_unit_test(one_frame_a_second_is_examined_at_rest),
        cmocka_unit_test(a_frame_that_stirs_is_examined_at_once),
        cmocka_unit_test(a_client_who_waits_ends_rest),
        cmocka_unit_test(somebody_found_by_the_examination_ends_rest),
        cmocka_unit_test(no_time_means_never),
        cmocka_unit_test(an_opened_sensor_begins_awake),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

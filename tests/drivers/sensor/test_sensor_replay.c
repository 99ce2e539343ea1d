/* The replay sensor: pace, loops, damaged frames, and the slot for visitors. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "drivers/sensor/replay/sensor_replay.h"
#include "tests/support/devices/manual_clock.h"
#include "tests/support/scratch.h"
#include "tests/support/stored_frames.h"

#define MS INT64_C(1000000)

static int64_t now_ns;

/* Writes the recordings `r` (three frames, 125 ms apart) and `one` (one frame) into the scratch
 * directory. */
static int setup(void **state)
{
    int error = scratch_setup(state);
    if (!error) {
        stored_frames_write(scratch_path(*state, "r"), 3);
        stored_frames_write(scratch_path(*state, "one"), 1);
    }
    now_ns = 5000 * MS;
    return error;
}

static struct iso_sensor *start(const char *path, const char *pace, const char *loop)
{
    const struct iso_option options[] = {{"path", path}, {"pace", pace}, {"loop", loop}};
    struct iso_clock clock = manual_clock(&now_ns);
    struct iso_sensor *sensor = NULL;
    assert_int_equal(iso_sensor_open("replay", options, 3, &clock, &sensor, NULL), 0);
    assert_int_equal(iso_sensor_start(sensor, NULL), 0);
    return sensor;
}

static void assert_nothing(struct iso_sensor *sensor)
{
    const struct iso_frame *frame = NULL;
    assert_int_equal(iso_sensor_wait(sensor, now_ns + 1000 * MS, &frame, NULL), -ETIMEDOUT);
    assert_null(frame);
}

/* Asserts that the next frame is frame number `stored` of its recording, and has the time t_ns. */
static void assert_frame(struct iso_sensor *sensor, int stored, uint64_t sequence, int64_t t_ns)
{
    const struct iso_frame *frame = NULL;
    assert_int_equal(iso_sensor_wait(sensor, now_ns, &frame, NULL), 0);
    assert_true(iso_frame_depth_at(frame, 1, 0) == (float)(1001 + 100 * stored) / 2);
    assert_int_equal(frame->sequence, sequence);
    assert_int_equal(frame->t_ns, t_ns);
}

static void assert_damage(struct iso_sensor *sensor, const char *expected)
{
    const struct iso_frame *frame = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(iso_sensor_wait(sensor, now_ns, &frame, &fault), -EBADMSG);
    assert_non_null(strstr(fault.text, expected));
    assert_null(frame);
}

static int64_t due(struct iso_sensor *sensor)
{
    int64_t due_ns = 0;
    assert_int_equal(iso_sensor_next_due_ns(sensor, &due_ns), 0);
    return due_ns - now_ns;
}

/* Points the slot at a recording in one step, as the program for visitors does. */
static void fill_slot(void **state, const char *recording)
{
    const char *fresh = scratch_path(*state, "slot.new");
    assert_int_equal(symlink(recording, fresh), 0);
    assert_int_equal(rename(fresh, scratch_path(*state, "slot")), 0);
}

static void assert_option_refused(const struct iso_option *options, size_t n, const char *expected)
{
    struct iso_clock clock = manual_clock(&now_ns);
    struct iso_sensor *sensor = NULL;
    struct iso_fault fault;
    assert_int_equal(iso_sensor_open("replay", options, n, &clock, &sensor, &fault), -EINVAL);
    assert_string_equal(fault.text, expected);
    assert_null(sensor);
}

static void refuses_bad_options(void **state)
{
    const struct iso_option unknown[] = {{"path", "x"}, {"fps", "3"}};
    const struct iso_option twice[] = {{"path", "x"}, {"path", "y"}};
    const struct iso_option pace[] = {{"path", "x"}, {"pace", "fast"}};
    const struct iso_option loop[] = {{"path", "x"}, {"loop", "1"}};
    const struct iso_option empty[] = {{"path", ""}};
    (void)state;
    assert_option_refused(unknown, 2, "sensor replay: unknown option 'fps'");
    assert_option_refused(twice, 2, "sensor replay: option 'path' is given twice");
    assert_option_refused(pace, 2, "sensor replay: bad value 'fast' for 'pace' (realtime|asap)");
    assert_option_refused(loop, 2, "sensor replay: bad value '1' for 'loop' (no|yes)");
    assert_option_refused(empty, 1, "sensor replay: option 'path' is missing");
    assert_option_refused(NULL, 0, "sensor replay: option 'path' is missing");
}

static void plays_in_real_time(void **state)
{
    struct iso_sensor *sensor = start(scratch_path(*state, "r"), "realtime", "no");
    int64_t began_ns = now_ns;
    assert_frame(sensor, 0, 0, began_ns);
    assert_nothing(sensor);
    assert_int_equal(due(sensor), 50 * MS); /* meanwhile the sensor checks the slot */
    now_ns += 100 * MS;
    assert_int_equal(due(sensor), 25 * MS);
    now_ns += 25 * MS - 1;
    assert_nothing(sensor);
    now_ns += 1;
    assert_frame(sensor, 1, 1, began_ns + 125 * MS);
    now_ns += 400 * MS; /* fetched late, but not lost */
    assert_frame(sensor, 2, 2, began_ns + 250 * MS);
    assert_nothing(sensor);
    assert_int_equal(due(sensor), 50 * MS);
    iso_sensor_close(sensor);
}

static void plays_at_once(void **state)
{
    struct iso_sensor *sensor = start(scratch_path(*state, "r"), "asap", "no");
    assert_frame(sensor, 0, 0, now_ns);
    assert_true(due(sensor) <= 1);
    assert_frame(sensor, 1, 1, now_ns + 1); /* time rises although the clock stands still */
    now_ns += 7 * MS;
    assert_frame(sensor, 2, 2, now_ns);
    assert_nothing(sensor);
    iso_sensor_close(sensor);
}

static void loops_in_time(void **state)
{
    struct iso_sensor *sensor = start(scratch_path(*state, "r"), "realtime", "yes");
    int64_t began_ns = now_ns;
    for (int i = 0; i < 7; i++) {
        assert_frame(sensor, i % 3, (uint64_t)i, began_ns + 125 * MS * i);
        assert_nothing(sensor);
        now_ns += 125 * MS;
    }
    iso_sensor_close(sensor);
    sensor = start(scratch_path(*state, "one"), "realtime", "yes");
    assert_frame(sensor, 0, 0, now_ns);
    assert_nothing(sensor);
    now_ns += 40 * MS;
    assert_frame(sensor, 0, 1, now_ns - 40 * MS + 33333333);
    iso_sensor_close(sensor);
}

/* Frames are 125 ms apart. At most one in 300 ms is wanted, so every third one comes. */
static void passes_over_frames_that_are_not_wanted(void **state)
{
    struct iso_sensor *sensor = start(scratch_path(*state, "r"), "realtime", "yes");
    const int64_t began_ns = now_ns;
    int64_t due_ns = 0;
    assert_frame(sensor, 0, 0, began_ns);
    iso_sensor_set_interval(sensor, 300 * MS);
    now_ns += 299 * MS;
    assert_nothing(sensor);
    now_ns = began_ns + 375 * MS;
    assert_frame(sensor, 0, 1, now_ns); /* number 3, which is number 0 again */
    assert_int_equal(iso_sensor_next_due_ns(sensor, &due_ns), 0);
    assert_int_equal(due_ns, now_ns + 100 * MS); /* the slot is looked at every 100 ms then */
    now_ns += 230 * MS;
    assert_nothing(sensor);
    assert_int_equal(iso_sensor_next_due_ns(sensor, &due_ns), 0);
    now_ns = began_ns + 700 * MS;
    assert_nothing(sensor);
    assert_int_equal(iso_sensor_next_due_ns(sensor, &due_ns), 0);
    assert_int_equal(due_ns, began_ns + 750 * MS); /* and not for the frames in between */
    iso_sensor_set_interval(sensor, 0);
    assert_int_equal(iso_sensor_next_due_ns(sensor, &due_ns), 0);
    assert_int_equal(due_ns, now_ns + 50 * MS);
    now_ns = began_ns + 750 * MS;
    assert_frame(sensor, 0, 2, now_ns);
    assert_int_equal(iso_sensor_health(sensor).lost, 0);
    iso_sensor_close(sensor);
}

static void starts_anew(void **state)
{
    struct iso_sensor *sensor = start(scratch_path(*state, "r"), "asap", "no");
    assert_frame(sensor, 0, 0, now_ns);
    assert_frame(sensor, 1, 1, now_ns + 1);
    assert_int_equal(iso_sensor_stop(sensor, NULL), 0);
    assert_int_equal(iso_sensor_start(sensor, NULL), 0);
    assert_frame(sensor, 0, 2, now_ns + 2);
    iso_sensor_close(sensor);
}

static void reports_damage_once_and_goes_on(void **state)
{
    scratch_write(scratch_path(*state, "r/depth/000001.png"), "\x89PNG", 4);
    struct iso_sensor *sensor = start(scratch_path(*state, "r"), "asap", "no");
    assert_frame(sensor, 0, 0, now_ns);
    assert_damage(sensor, "r/depth/000001.png: truncated");
    assert_frame(sensor, 2, 2, now_ns + 2);
    struct iso_sensor_health health = iso_sensor_health(sensor);
    assert_int_equal(health.faults, 1);
    assert_int_equal(health.lost, 1);
    assert_non_null(strstr(health.last_fault, "truncated"));
    iso_sensor_close(sensor);
}

static void refuses_a_recording_once(void **state)
{
    scratch_write_text(scratch_path(*state, "r/recording.ini"), "[recording]\nformat = x\n");
    struct iso_sensor *sensor = start(scratch_path(*state, "r"), "asap", "no");
    assert_damage(sensor, "r/recording.ini:2: bad value 'x' for format");
    assert_nothing(sensor);
    assert_nothing(sensor);
    iso_sensor_close(sensor);
}

static void describes_what_it_plays(void **state)
{
    struct iso_sensor *sensor = start(scratch_path(*state, "slot"), "asap", "no");
    struct iso_sensor_description description;
    assert_int_equal(iso_sensor_describe(sensor, &description), -ENODATA);
    fill_slot(state, "r");
    assert_frame(sensor, 0, 0, now_ns);
    assert_int_equal(iso_sensor_describe(sensor, &description), 0);
    assert_string_equal(description.model, "astra");
    assert_int_equal(description.width_px, STORED_WIDTH);
    assert_int_equal(description.height_px, STORED_HEIGHT);
    assert_false(description.intensity);
    iso_sensor_close(sensor);
}

static void visitors_come_and_go(void **state)
{
    struct iso_sensor *sensor = start(scratch_path(*state, "slot"), "realtime", "no");
    assert_nothing(sensor);
    assert_int_equal(due(sensor), 50 * MS);
    now_ns += 50 * MS;
    fill_slot(state, "r");
    assert_frame(sensor, 0, 0, now_ns);
    now_ns += 60 * MS;
    fill_slot(state, "one"); /* before the first recording was over */
    assert_frame(sensor, 0, 1, now_ns);
    now_ns += 500 * MS;
    assert_nothing(sensor);
    assert_int_equal(unlink(scratch_path(*state, "slot")), 0);
    assert_nothing(sensor);
    fill_slot(state, "r");
    assert_frame(sensor, 0, 2, now_ns);
    iso_sensor_close(sensor);
}

static void the_same_visitor_comes_again(void **state)
{
    struct iso_sensor *sensor = start(scratch_path(*state, "slot"), "asap", "no");
    fill_slot(state, "one");
    assert_frame(sensor, 0, 0, now_ns);
    assert_nothing(sensor);
    assert_int_equal(unlink(scratch_path(*state, "slot")), 0);
    assert_nothing(sensor);
    fill_slot(state, "one");
    assert_frame(sensor, 0, 1, now_ns + 1);
    iso_sensor_close(sensor);
}

static void a_visitor_is_played_from_where_he_was(void **state)
{
    /* The link changes, but frames of the two recordings never mix. */
    struct iso_sensor *sensor = start(scratch_path(*state, "slot"), "asap", "no");
    stored_plane_write(scratch_path(*state, "one/depth/000000.png"), STORED_WIDTH, STORED_HEIGHT,
                       16, 1, 4321);
    fill_slot(state, "r");
    assert_frame(sensor, 0, 0, now_ns);
    fill_slot(state, "one");
    const struct iso_frame *frame = NULL;
    assert_int_equal(iso_sensor_wait(sensor, now_ns, &frame, NULL), 0);
    assert_true(iso_frame_depth_at(frame, 1, 0) == 2160.5F);
    assert_nothing(sensor);
    iso_sensor_close(sensor);
}

static void a_dangling_link_is_reported_once(void **state)
{
    struct iso_sensor *sensor = start(scratch_path(*state, "slot"), "asap", "no");
    fill_slot(state, "nobody");
    assert_damage(sensor, "slot: No such file or directory");
    assert_nothing(sensor);
    fill_slot(state, "one");
    assert_frame(sensor, 0, 0, now_ns);
    iso_sensor_close(sensor);
}

static void the_shape_may_change(void **state)
{
    static const char wide[] = "[recording]\nformat=1\nsensor=texas\n[depth]\n"
                               "projection=orthographic\nwidth_px=9\nheight_px=4\npitch_mm=0.32\n"
                               "cx_px=4\ncy_px=2\nunit_mm=0.01\n";
    struct iso_sensor *sensor = start(scratch_path(*state, "slot"), "asap", "no");
    const struct iso_frame *frame = NULL;
    fill_slot(state, "r");
    assert_frame(sensor, 0, 0, now_ns);
    scratch_write_text(scratch_path(*state, "one/recording.ini"), wide);
    stored_plane_write(scratch_path(*state, "one/depth/000000.png"), 9, 4, 16, 1, 300);
    fill_slot(state, "one");
    assert_int_equal(iso_sensor_wait(sensor, now_ns, &frame, NULL), 0);
    assert_int_equal(frame->width_px, 9);
    assert_int_equal(frame->camera.projection, ISO_ORTHOGRAPHIC);
    assert_true(iso_frame_depth_at(frame, 8, 3) == 3.0F);
    iso_sensor_close(sensor);
}

static void a_path_that_cannot_be_looked_at(void **state)
{
    char path[5000];
    struct iso_fault fault;
    const struct iso_frame *frame = NULL;
    (void)state;
    memset(path, 'x', sizeof path);
    path[sizeof path - 1] = '\0';
    struct iso_sensor *sensor = start(path, "asap", "no");
    assert_int_equal(iso_sensor_wait(sensor, now_ns, &frame, &fault), -EIO);
    iso_sensor_close(sensor);
}

#define IN_SCRATCH(test) cmocka_unit_test_setup_teardown(test, setup, scratch_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(refuses_bad_options),
        IN_SCRATCH(plays_in_real_time),
        IN_SCRATCH(plays_at_once),
        IN_SCRATCH(loops_in_time),
        IN_SCRATCH(passes_over_frames_that_are_not_wanted),
        IN_SCRATCH(starts_anew),
        IN_SCRATCH(reports_damage_once_and_goes_on),
        IN_SCRATCH(refuses_a_recording_once),
        IN_SCRATCH(describes_what_it_plays),
        IN_SCRATCH(visitors_come_and_go),
        IN_SCRATCH(the_same_visitor_comes_again),
        IN_SCRATCH(a_visitor_is_played_from_where_he_was),
        IN_SCRATCH(a_dangling_link_is_reported_once),
        IN_SCRATCH(the_shape_may_change),
        cmocka_unit_test(a_path_that_cannot_be_looked_at),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

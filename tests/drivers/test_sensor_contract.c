/* What every back end of the sensor class owes its user (drivers/sensor/sensor.h). A new back end
 * adds a line to the table, with a stage that has at least three frames to deliver. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/sensor/sensor.h"
#include "tests/support/manual_clock.h"
#include "tests/support/scratch.h"
#include "tests/support/stored_frames.h"

static int64_t now_ns;

struct stage {
    void *scratch;
    struct iso_option options[4];
    size_t n_options;
};

struct back_end {
    const char *name;
    void (*set_up)(struct stage *stage);
};

static void set_up_replay(struct stage *stage)
{
    stored_frames_write(scratch_path(stage->scratch, "r"), 5);
    stage->options[0] = (struct iso_option){"path", scratch_path(stage->scratch, "r")};
    stage->n_options = 1;
}

static const struct back_end back_ends[] = {
    {"replay", set_up_replay},
};

enum { BACK_ENDS = sizeof back_ends / sizeof *back_ends };

static int open_sensor(const struct back_end *back_end, struct stage *stage,
                       struct iso_sensor **sensor)
{
    struct iso_clock clock = manual_clock(&now_ns);
    return iso_sensor_open(back_end->name, stage->options, stage->n_options, &clock, sensor, NULL);
}

/* Runs a test on every back end, each on a stage of its own. */
static void on_every_back_end(void (*test)(struct iso_sensor *sensor))
{
    for (int i = 0; i < BACK_ENDS; i++) {
        struct stage stage = {0};
        struct iso_sensor *sensor = NULL;
        now_ns = INT64_C(3600) * 1000000000;
        assert_int_equal(scratch_setup(&stage.scratch), 0);
        back_ends[i].set_up(&stage);
        assert_int_equal(open_sensor(&back_ends[i], &stage, &sensor), 0);
        test(sensor);
        iso_sensor_close(sensor);
        assert_int_equal(scratch_teardown(&stage.scratch), 0);
    }
}

/* The next frame, moving the clock to when the back end says it is due. */
static const struct iso_frame *fetch(struct iso_sensor *sensor)
{
    const struct iso_frame *frame = NULL;
    for (int tries = 0; tries < 1000; tries++) {
        int64_t due_ns;
        int error = iso_sensor_wait(sensor, now_ns + 1000000000, &frame, NULL);
        if (!error) {
            return frame;
        }
        assert_int_equal(error, -ETIMEDOUT);
        if (iso_sensor_next_due_ns(sensor, &due_ns) == 0 && due_ns > now_ns) {
            now_ns = due_ns;
        }
    }
    fail_msg("no frame from %s", iso_sensor_name(sensor));
    return NULL;
}

static void deliver(struct iso_sensor *sensor)
{
    uint64_t sequence = 0;
    int64_t t_ns = 0;
    assert_int_equal(iso_sensor_start(sensor, NULL), 0);
    for (int i = 0; i < 3; i++) {
        const struct iso_frame *frame = fetch(sensor);
        const char *flaw = "";
        int bad = iso_frame_check(frame, &flaw);
        assert_string_equal(flaw, "");
        assert_int_equal(bad, 0);
        assert_true(i == 0 || frame->sequence > sequence);
        assert_true(i == 0 || frame->t_ns > t_ns);
        assert_true(frame->t_ns <= now_ns);
        sequence = frame->sequence;
        t_ns = frame->t_ns;
    }
    assert_int_equal(iso_sensor_health(sensor).frames, 3);
    assert_int_equal(iso_sensor_health(sensor).lost, 0);
}

static void delivers_sound_frames_in_order(void **state)
{
    (void)state;
    on_every_back_end(deliver);
}

static void reuse(struct iso_sensor *sensor)
{
    assert_int_equal(iso_sensor_start(sensor, NULL), 0);
    const float *plane = fetch(sensor)->depth_mm;
    (void)fetch(sensor);
    assert_ptr_equal(fetch(sensor)->depth_mm, plane);
}

static void uses_its_buffer_again(void **state)
{
    (void)state;
    on_every_back_end(reuse);
}

static void stop_and_go(struct iso_sensor *sensor)
{
    const struct iso_frame *frame = NULL;
    for (int i = 0; i < 3; i++) {
        assert_int_equal(iso_sensor_start(sensor, NULL), 0);
        assert_int_equal(iso_sensor_start(sensor, NULL), -EBADFD);
        (void)fetch(sensor);
        assert_int_equal(iso_sensor_stop(sensor, NULL), 0);
        assert_int_equal(iso_sensor_stop(sensor, NULL), -EBADFD);
        assert_int_equal(iso_sensor_wait(sensor, now_ns, &frame, NULL), -EBADFD);
        now_ns += 1000000000;
    }
}

static void starts_and_stops_again_and_again(void **state)
{
    (void)state;
    on_every_back_end(stop_and_go);
}

static void close_while_streaming(struct iso_sensor *sensor)
{
    assert_int_equal(iso_sensor_start(sensor, NULL), 0);
    (void)fetch(sensor); /* and on_every_back_end closes it */
}

static void may_be_closed_at_any_time(void **state)
{
    (void)state;
    on_every_back_end(close_while_streaming);
}

static void describe(struct iso_sensor *sensor)
{
    struct iso_sensor_description description;
    int error = iso_sensor_describe(sensor, &description);
    assert_true(error == 0 || error == -ENODATA || error == -ENOSYS);
    assert_int_equal(iso_sensor_start(sensor, NULL), 0);
    const struct iso_frame *frame = fetch(sensor);
    if (iso_sensor_describe(sensor, &description) != -ENOSYS) {
        assert_int_equal(description.width_px, frame->width_px);
        assert_int_equal(description.height_px, frame->height_px);
        assert_int_equal(description.intensity, frame->intensity != NULL);
        assert_true(strlen(description.model) > 0);
    }
    assert_true(iso_sensor_poll_fd(sensor) >= 0 || iso_sensor_next_due_ns(sensor, &now_ns) == 0);
}

static void tells_how_to_wait_for_it(void **state)
{
    (void)state;
    on_every_back_end(describe);
}

static void refuses_unknown_options(void **state)
{
    (void)state;
    for (int i = 0; i < BACK_ENDS; i++) {
        struct iso_clock clock = manual_clock(&now_ns);
        const struct iso_option option = {"no-such-option", "1"};
        struct iso_sensor *sensor = NULL;
        struct iso_fault fault = {""};
        assert_int_equal(iso_sensor_open(back_ends[i].name, &option, 1, &clock, &sensor, &fault),
                         -EINVAL);
        assert_non_null(strstr(fault.text, back_ends[i].name));
        assert_non_null(strstr(fault.text, "no-such-option"));
        assert_null(sensor);
    }
}

static void no_back_end_is_left_out(void **state)
{
    (void)state;
    for (size_t r = 0; iso_sensor_registered(r); r++) {
        int i = 0;
        while (i < BACK_ENDS && strcmp(back_ends[i].name, iso_sensor_registered(r)) != 0) {
            i++;
        }
        assert_true(i < BACK_ENDS);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(delivers_sound_frames_in_order),
        cmocka_unit_test(uses_its_buffer_again),
        cmocka_unit_test(starts_and_stops_again_and_again),
        cmocka_unit_test(may_be_closed_at_any_time),
        cmocka_unit_test(tells_how_to_wait_for_it),
        cmocka_unit_test(refuses_unknown_options),
        cmocka_unit_test(no_back_end_is_left_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

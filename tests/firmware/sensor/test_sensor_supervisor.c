/* The supervisor that keeps a sensor running. */
#include <errno.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/base/times.h"
#include "tests/firmware/rigs/supervisor_rig.h"

#define MS ISO_NS_PER_MS

static void opens_and_hands_out_frames(void **state)
{
    const struct iso_frame *frame = NULL;
    (void)state;
    puppet_sensor_add(&supervisor_rig.sensor, 1200 * MS, 42, ISO_CAPTURE_OK);
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_BACK);
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_QUIET);
    assert_int_equal(
        iso_sensor_supervisor_due_ns(&supervisor_rig.supervisor, supervisor_rig.now_ns), 1200 * MS);
    assert_string_equal(supervisor_rig.supervisor.model, "");
    supervisor_rig.now_ns = 1200 * MS;
    assert_int_equal(
        iso_sensor_supervisor_look(&supervisor_rig.supervisor, supervisor_rig.now_ns, &frame),
        ISO_SENSOR_FRAME);
    assert_int_equal(frame->t_ns, 1200 * MS);
    assert_int_equal(supervisor_rig.supervisor.frames, 1);
    assert_string_equal(supervisor_rig.supervisor.model, "puppet9");
}

static void waits_longer_after_each_failure(void **state)
{
    static const int64_t tries_ms[] = {1000, 1100, 1300, 1700, 2400, 3100};
    (void)state;
    supervisor_rig.sensor.open_error = -ENODEV;
    for (size_t i = 0; i < sizeof tries_ms / sizeof *tries_ms; i++) {
        supervisor_rig.now_ns = tries_ms[i] * MS - 1;
        if (i > 0) {
            assert_int_equal(
                iso_sensor_supervisor_due_ns(&supervisor_rig.supervisor, supervisor_rig.now_ns),
                tries_ms[i] * MS);
            assert_int_equal(supervisor_rig_look(), ISO_SENSOR_QUIET);
        }
        supervisor_rig.now_ns = tries_ms[i] * MS;
        assert_int_equal(supervisor_rig_look(), ISO_SENSOR_FLAW);
        assert_string_equal(supervisor_rig.supervisor.fault.text, "puppet: will not open");
        assert_int_equal(supervisor_rig.supervisor.error, -ENODEV);
        assert_int_equal(supervisor_rig.supervisor.progress,
                         i + 1); /* the program is still alive */
    }
    supervisor_rig.sensor.open_error = 0;
    supervisor_rig.now_ns = 3800 * MS;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_BACK);
}

static void a_sensor_that_does_not_start_is_closed(void **state)
{
    (void)state;
    supervisor_rig.sensor.start_error = -EIO;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_FLAW);
    assert_string_equal(supervisor_rig.supervisor.fault.text, "puppet: will not start");
    assert_int_equal(supervisor_rig.sensor.closed, 1);
    assert_null(supervisor_rig.supervisor.sensor);
}

static void opens_a_lost_sensor_again(void **state)
{
    (void)state;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_BACK);
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_QUIET);
    supervisor_rig.sensor.wait_error = -ENODEV;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_GONE);
    assert_string_equal(supervisor_rig.supervisor.fault.text, "puppet: will not wait");
    assert_int_equal(supervisor_rig.sensor.closed, 1);
    supervisor_rig.sensor.wait_error = 0;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_QUIET);
    supervisor_rig.now_ns += 100 * MS;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_BACK);
}

/* A sensor that opens and fails at once is also tried less and less often. */
static void a_sign_of_life_shortens_the_wait(void **state)
{
    (void)state;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_BACK);
    supervisor_rig.sensor.wait_error = -EIO;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_GONE);
    supervisor_rig.now_ns += 100 * MS;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_BACK);
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_GONE);
    assert_int_equal(
        iso_sensor_supervisor_due_ns(&supervisor_rig.supervisor, supervisor_rig.now_ns),
        supervisor_rig.now_ns + 200 * MS);
    supervisor_rig.now_ns += 200 * MS;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_BACK);
    supervisor_rig.sensor.wait_error = 0;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_QUIET);
    supervisor_rig.sensor.wait_error = -EIO;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_GONE);
    assert_int_equal(
        iso_sensor_supervisor_due_ns(&supervisor_rig.supervisor, supervisor_rig.now_ns),
        supervisor_rig.now_ns + 100 * MS);
}

static void goes_on_after_a_damaged_frame(void **state)
{
    (void)state;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_BACK);
    supervisor_rig.sensor.wait_error = -EBADMSG;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_FLAW);
    assert_int_equal(supervisor_rig.sensor.closed, 0);
    supervisor_rig.sensor.wait_error = 0;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_QUIET);
}

static void an_idle_sensor_may_be_idle_for_good(void **state)
{
    (void)state;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_BACK);
    for (int i = 0; i < 100; i++) {
        const uint64_t progress = supervisor_rig.supervisor.progress;
        supervisor_rig.now_ns = iso_sensor_supervisor_due_ns(&supervisor_rig.supervisor,
                                                             supervisor_rig.now_ns);
        assert_int_equal(supervisor_rig_look(), ISO_SENSOR_QUIET);
        assert_int_equal(supervisor_rig.supervisor.progress, progress + 1);
    }
    assert_int_equal(supervisor_rig.now_ns, 6000 * MS);
}

static void a_silent_stream_is_broken(void **state)
{
    (void)state;
    supervisor_rig.sensor.streams = true;
    puppet_sensor_add(&supervisor_rig.sensor, 1500 * MS, 42, ISO_CAPTURE_OK);
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_BACK);
    const uint64_t progress = supervisor_rig.supervisor.progress;
    supervisor_rig.now_ns = 1499 * MS;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_QUIET);
    assert_int_equal(supervisor_rig.supervisor.progress, progress); /* silence is no progress */
    supervisor_rig.now_ns = 1500 * MS;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_FRAME);
    supervisor_rig.now_ns = 2499 * MS;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_QUIET);
    supervisor_rig.now_ns = 2500 * MS;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_GONE);
    assert_string_equal(supervisor_rig.supervisor.fault.text,
                        "sensor puppet: no frame for 1000 ms");
    assert_int_equal(supervisor_rig.supervisor.fault.code, ISO_FAULT_SENSOR_SILENT);
}

static void a_pause_is_reported_before_the_silence_is_over(void **state)
{
    (void)state;
    supervisor_rig.sensor.streams = true;
    puppet_sensor_add(&supervisor_rig.sensor, 1800 * MS, 42, ISO_CAPTURE_OK);
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_BACK);
    supervisor_rig.now_ns = 1399 * MS;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_QUIET);
    assert_true(supervisor_rig.supervisor.sees);
    supervisor_rig.now_ns = 1400 * MS;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_QUIET);
    assert_false(supervisor_rig.supervisor.sees);
    assert_string_equal(supervisor_rig.supervisor.fault.text,
                        "sensor puppet: nothing seen for 400 ms");
    assert_int_equal(supervisor_rig.supervisor.fault.code, ISO_FAULT_SENSOR_SILENT);
    assert_int_equal(supervisor_rig.sensor.closed, 0);
    supervisor_rig.now_ns = 1800 * MS;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_FRAME);
    assert_true(supervisor_rig.supervisor.sees);
}

static void frames_that_come_late_are_no_sight(void **state)
{
    (void)state;
    supervisor_rig.sensor.streams = true;
    for (int i = 0; i < 6; i++) {
        puppet_sensor_add(&supervisor_rig.sensor, (1000 + 100 * i) * MS, 42, ISO_CAPTURE_OK);
    }
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_BACK);
    supervisor_rig.now_ns = 1300 * MS; /* 300 ms late */
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_FRAME);
    assert_true(supervisor_rig.supervisor.sees);
    supervisor_rig.now_ns = 1400 * MS;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_FRAME);
    assert_false(supervisor_rig.supervisor.sees);
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_FRAME); /* 200 ms late */
    assert_true(supervisor_rig.supervisor.sees);
}

static void damaged_frames_are_no_sight(void **state)
{
    (void)state;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_BACK);
    supervisor_rig.sensor.wait_error = -EBADMSG;
    supervisor_rig.now_ns = 1399 * MS;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_FLAW);
    assert_true(supervisor_rig.supervisor.sees);
    supervisor_rig.now_ns = 1400 * MS;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_FLAW);
    assert_false(supervisor_rig.supervisor.sees);
    assert_string_equal(supervisor_rig.supervisor.fault.text, "puppet: will not wait");
}

static void a_sensor_that_was_opened_again_sees_nothing_yet(void **state)
{
    (void)state;
    supervisor_rig.sensor.streams = true;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_BACK);
    assert_true(supervisor_rig.supervisor.sees);
    supervisor_rig.sensor.wait_error = -ENODEV;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_GONE);
    assert_false(supervisor_rig.supervisor.sees);
    supervisor_rig.sensor.wait_error = 0;
    supervisor_rig.now_ns += 100 * MS;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_BACK);
    assert_false(supervisor_rig.supervisor.sees);
    puppet_sensor_add(&supervisor_rig.sensor, supervisor_rig.now_ns, 42, ISO_CAPTURE_OK);
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_FRAME);
    assert_true(supervisor_rig.supervisor.sees);
}

/* The caller has waited for the disk. The supervisor reads the sensor's frames before it calls the
 * sensor silent. */
static void a_caller_that_was_held_up_does_not_blame_the_sensor(void **state)
{
    (void)state;
    supervisor_rig.sensor.streams = true;
    puppet_sensor_add(&supervisor_rig.sensor, 1100 * MS, 42, ISO_CAPTURE_OK);
    puppet_sensor_add(&supervisor_rig.sensor, 1150 * MS, 42,
                      ISO_CAPTURE_OK); /* too old when it is read */
    puppet_sensor_add(&supervisor_rig.sensor, 11200 * MS, 42, ISO_CAPTURE_OK);
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_BACK);
    supervisor_rig.now_ns = 1100 * MS;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_FRAME);
    supervisor_rig.now_ns = 11105 * MS;
    iso_sensor_supervisor_excuse(&supervisor_rig.supervisor, 10000 * MS, supervisor_rig.now_ns);
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_FRAME);
    assert_true(supervisor_rig.supervisor.sees);
    supervisor_rig.now_ns = 11200 * MS;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_FRAME);
    assert_true(supervisor_rig.supervisor.sees);
}

/* The time without frames before a stall and after it counts together. So the supervisor finds a
 * dead sensor however often its caller is held up. */
static void a_dead_sensor_is_found_behind_a_stall(void **state)
{
    (void)state;
    supervisor_rig.sensor.streams = true;
    puppet_sensor_add(&supervisor_rig.sensor, 1100 * MS, 42, ISO_CAPTURE_OK);
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_BACK);
    supervisor_rig.now_ns = 1100 * MS;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_FRAME);
    for (int stall = 1; stall <= 3; stall++) {
        supervisor_rig.now_ns += 10000 * MS;
        iso_sensor_supervisor_excuse(&supervisor_rig.supervisor, 10000 * MS, supervisor_rig.now_ns);
        supervisor_rig.now_ns += 100 * MS;
        assert_int_equal(supervisor_rig_look(), ISO_SENSOR_QUIET);
        assert_true(supervisor_rig.supervisor.sees);
    }
    supervisor_rig.now_ns += 100 * MS; /* 400 ms without the stalls */
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_QUIET);
    assert_false(supervisor_rig.supervisor.sees);
    supervisor_rig.now_ns += 600 * MS;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_GONE);
}

static int64_t due_in_ms(void)
{
    return (iso_sensor_supervisor_due_ns(&supervisor_rig.supervisor, supervisor_rig.now_ns) -
            supervisor_rig.now_ns) /
           MS;
}

static void a_stream_without_a_descriptor_is_asked_every_5_ms(void **state)
{
    (void)state;
    supervisor_rig.sensor.streams = true;
    puppet_sensor_add(&supervisor_rig.sensor, 1000 * MS, 42, ISO_CAPTURE_OK);
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_BACK);
    assert_int_equal(due_in_ms(), 5);
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_FRAME);
    assert_int_equal(due_in_ms(), 5);
}

static void a_descriptor_is_waited_for(void **state)
{
    (void)state;
    supervisor_rig.sensor.streams = true;
    supervisor_rig.sensor.descriptor = 7;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_BACK);
    assert_int_equal(due_in_ms(), 50);
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_QUIET);
    assert_int_equal(due_in_ms(), 50);
}

static void frames_behind_a_frame_are_not_waited_for(void **state)
{
    (void)state;
    supervisor_rig.sensor.streams = true;
    supervisor_rig.sensor.descriptor = 7;
    puppet_sensor_add(&supervisor_rig.sensor, 1000 * MS, 42, ISO_CAPTURE_OK);
    puppet_sensor_add(&supervisor_rig.sensor, 1000 * MS + 1, 42, ISO_CAPTURE_OK);
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_BACK);
    supervisor_rig.now_ns += 1;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_FRAME);
    assert_int_equal(due_in_ms(), 0);
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_FRAME);
    assert_int_equal(due_in_ms(), 0);
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_QUIET);
    assert_int_equal(due_in_ms(), 50);
    supervisor_rig.sensor.wait_error =
        -EBADMSG; /* a sensor that fails each time is not asked for ever */
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_FLAW);
    assert_int_equal(due_in_ms(), 50);
}

/* The end of a pause or of a silence is found, although no descriptor signals it. */
static void pauses_without_a_descriptor_event_are_due(void **state)
{
    (void)state;
    supervisor_rig.sensor.streams = true;
    supervisor_rig.sensor.descriptor = 7;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_BACK);
    supervisor_rig.now_ns = 1370 * MS;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_QUIET);
    assert_int_equal(due_in_ms(), 30);
    supervisor_rig.now_ns = 1400 * MS;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_QUIET);
    assert_false(supervisor_rig.supervisor.sees);
    assert_int_equal(due_in_ms(), 50);
    supervisor_rig.now_ns = 1980 * MS;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_QUIET);
    assert_int_equal(due_in_ms(), 20);
    supervisor_rig.now_ns = 2000 * MS;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_GONE);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, supervisor_rig_setup, supervisor_rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(opens_and_hands_out_frames),
        TEST(waits_longer_after_each_failure),
        TEST(a_sensor_that_does_not_start_is_closed),
        TEST(opens_a_lost_sensor_again),
        TEST(a_sign_of_life_shortens_the_wait),
        TEST(goes_on_after_a_damaged_frame),
        TEST(an_idle_sensor_may_be_idle_for_good),
        TEST(a_silent_stream_is_broken),
        TEST(a_pause_is_reported_before_the_silence_is_over),
        TEST(frames_that_come_late_are_no_sight),
        TEST(damaged_frames_are_no_sight),
        TEST(a_sensor_that_was_opened_again_sees_nothing_yet),
        TEST(a_stream_without_a_descriptor_is_asked_every_5_ms),
        TEST(a_descriptor_is_waited_for),
        TEST(frames_behind_a_frame_are_not_waited_for),
        TEST(pauses_without_a_descriptor_event_are_due),
        cmocka_unit_test_setup_teardown(a_caller_that_was_held_up_does_not_blame_the_sensor,
                                        supervisor_rig_setup, supervisor_rig_teardown),
        cmocka_unit_test_setup_teardown(a_dead_sensor_is_found_behind_a_stall, supervisor_rig_setup,
                                        supervisor_rig_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

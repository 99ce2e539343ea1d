/* At rest few frames are wanted: how often the supervisor wakes its caller then. */
#include <errno.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/base/times.h"
#include "firmware/sensor/sensor_supervisor.h"
#include "tests/firmware/rigs/puppets.h"
#include "tests/support/devices/manual_clock.h"

#define MS ISO_NS_PER_MS

static int64_t now_ns;
static struct puppet_sensor sensor;
static struct iso_sensor_supervisor supervisor;

static int setup(void **state)
{
    const struct iso_sensor_supervisor_options options = {.silence_ns = 1000 * MS,
                                                          .retry_ns = 100 * MS,
                                                          .retry_max_ns = 700 * MS,
                                                          .pause_ns = 400 * MS,
                                                          .stale_ns = 300 * MS};
    const struct iso_sensor_source source = puppet_sensor_source(&sensor);
    (void)state;
    now_ns = 1000 * MS;
    sensor = (struct puppet_sensor){.clock = manual_clock(&now_ns)};
    iso_sensor_supervisor_init(&supervisor, &options, &source, now_ns);
    return 0;
}

static int teardown(void **state)
{
    (void)state;
    iso_sensor_supervisor_done(&supervisor);
    assert_int_equal(sensor.opened, sensor.closed);
    return 0;
}

static enum iso_sensor_news look(void)
{
    const struct iso_frame *frame = NULL;
    return iso_sensor_supervisor_look(&supervisor, now_ns, &frame);
}

static int64_t due_in_ms(void)
{
    return (iso_sensor_supervisor_due_ns(&supervisor, now_ns) - now_ns) / MS;
}

/* A camera of 30 frames a second, number i of which is exposed at i * FRAME_NS and is there at
 * once.
 */
enum { REST_NS = 80 * MS, FRAME_NS = 33333333 };

/* What a caller does who waits for the descriptor and for the due time. */
struct idling {
    int wakes, frames;
    int64_t worst_ns; /* from an exposure to the first frame handed out that is not older */
};

/* Waits as the event loop does: until a frame is there that the descriptor signals, or until the
 * next look is due. */
static void sleep_until_woken(int64_t next_frame_ns)
{
    const int64_t due_ns = iso_sensor_supervisor_due_ns(&supervisor, now_ns);
    const bool watched = iso_sensor_supervisor_fd(&supervisor, now_ns) >= 0;
    const int64_t frame_ns = next_frame_ns > now_ns ? next_frame_ns : now_ns;
    now_ns = watched && frame_ns < due_ns ? frame_ns : due_ns;
}

static struct idling idle_for(int64_t span_ns)
{
    struct idling idling = {.wakes = 0};
    const int64_t begin_ns = now_ns;
    int64_t made_ns = now_ns, before_ns = now_ns;
    while (now_ns < begin_ns + span_ns) {
        const int64_t slept_ns = now_ns;
        if (made_ns <= now_ns) { /* the frames up to the next one that has not been exposed yet */
            made_ns += FRAME_NS;
            puppet_sensor_add(&sensor, made_ns, 42, ISO_CAPTURE_OK);
            continue;
        }
        const bool waits = sensor.frames[sensor.next].t_ns <= now_ns;
        sleep_until_woken(waits ? now_ns : made_ns);
        idling.wakes += now_ns > slept_ns;
        const struct iso_frame *frame = NULL;
        if (iso_sensor_supervisor_look(&supervisor, now_ns, &frame) == ISO_SENSOR_FRAME) {
            /* A visitor who came just after the frame before this one waited longest. */
            const int64_t waited_ns = now_ns - before_ns;
            idling.worst_ns = waited_ns > idling.worst_ns ? waited_ns : idling.worst_ns;
            before_ns = frame->t_ns;
            idling.frames++;
        }
    }
    return idling;
}

static void begin_idling(int descriptor)
{
    sensor.streams = true;
    sensor.descriptor = descriptor;
    assert_int_equal(look(), ISO_SENSOR_BACK);
    puppet_sensor_add(&sensor, now_ns, 42, ISO_CAPTURE_OK);
    assert_int_equal(look(), ISO_SENSOR_FRAME);
    iso_sensor_supervisor_set_interval(&supervisor, REST_NS);
    assert_int_equal(sensor.interval_ns, REST_NS);
}

/* Frames that nobody wants wake nobody, and a visitor is still seen within 150 ms. */
static void at_rest_a_camera_wakes_its_caller_seldom(void **state)
{
    (void)state;
    begin_idling(7);
    const struct idling idling = idle_for(10000 * MS);
    assert_in_range(idling.frames, 99, 100);
    assert_in_range(idling.wakes, 150, 201);
    assert_in_range(idling.worst_ns, 90 * MS, 150 * MS);
    assert_true(supervisor.sees);
}

static void at_rest_a_stream_without_a_descriptor_is_asked_seldom(void **state)
{
    (void)state;
    begin_idling(0);
    assert_int_equal(iso_sensor_supervisor_fd(&supervisor, now_ns), -ENOSYS);
    const struct idling idling = idle_for(10000 * MS);
    assert_in_range(idling.frames, 80, 100);
    assert_in_range(idling.wakes, 150, 250);
    assert_in_range(idling.worst_ns, 90 * MS, 150 * MS);
}

static void the_descriptor_is_watched_again_when_a_frame_is_wanted(void **state)
{
    (void)state;
    assert_int_equal(iso_sensor_supervisor_fd(&supervisor, now_ns), -ENODEV);
    begin_idling(7);
    assert_int_equal(iso_sensor_supervisor_fd(&supervisor, now_ns), -EAGAIN);
    assert_int_equal(due_in_ms(), 80);
    now_ns += REST_NS - 1;
    assert_int_equal(iso_sensor_supervisor_fd(&supervisor, now_ns), -EAGAIN);
    assert_int_equal(look(), ISO_SENSOR_QUIET); /* the caller was woken by something else */
    assert_int_equal(iso_sensor_supervisor_due_ns(&supervisor, now_ns), now_ns + 1);
    now_ns += 1;
    assert_int_equal(iso_sensor_supervisor_fd(&supervisor, now_ns), 7);
    assert_int_equal(look(), ISO_SENSOR_QUIET);
    assert_int_equal(due_in_ms(), 50);
}

static void without_an_interval_the_descriptor_is_watched_at_once(void **state)
{
    (void)state;
    begin_idling(7);
    iso_sensor_supervisor_set_interval(&supervisor, 0);
    assert_int_equal(iso_sensor_supervisor_fd(&supervisor, now_ns), 7);
    assert_int_equal(due_in_ms(), 0);
    iso_sensor_supervisor_set_interval(&supervisor, REST_NS);
    sensor.wait_error = -ENODEV;
    assert_int_equal(look(), ISO_SENSOR_GONE);
    sensor.wait_error = 0;
    now_ns += 100 * MS;
    assert_int_equal(look(), ISO_SENSOR_BACK); /* an opened sensor gives every frame */
    assert_int_equal(iso_sensor_supervisor_fd(&supervisor, now_ns), 7);
    assert_int_equal(due_in_ms(), 50);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, setup, teardown)
    const struct CMUnitTest tests[] = {
        TEST(at_rest_a_camera_wakes_its_caller_seldom),
        TEST(at_rest_a_stream_without_a_descriptor_is_asked_seldom),
        TEST(the_descriptor_is_watched_again_when_a_frame_is_wanted),
        TEST(without_an_interval_the_descriptor_is_watched_at_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

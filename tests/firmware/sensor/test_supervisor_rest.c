/* At rest few frames are wanted: how often the supervisor wakes its caller then. */
#include <errno.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/base/times.h"
#include "tests/firmware/rigs/supervisor_rig.h"

#define MS ISO_NS_PER_MS

static int64_t due_in_ms(void)
{
    return (iso_sensor_supervisor_due_ns(&supervisor_rig.supervisor, supervisor_rig.now_ns) -
            supervisor_rig.now_ns) /
           MS;
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
    const int64_t due_ns = iso_sensor_supervisor_due_ns(&supervisor_rig.supervisor,
                                                        supervisor_rig.now_ns);
    const bool watched = iso_sensor_supervisor_fd(&supervisor_rig.supervisor,
                                                  supervisor_rig.now_ns) >= 0;
    const int64_t frame_ns = next_frame_ns > supervisor_rig.now_ns ? next_frame_ns
                                                                   : supervisor_rig.now_ns;
    supervisor_rig.now_ns = watched && frame_ns < due_ns ? frame_ns : due_ns;
}

static struct idling idle_for(int64_t span_ns)
{
    struct idling idling = {.wakes = 0};
    const int64_t begin_ns = supervisor_rig.now_ns;
    int64_t made_ns = supervisor_rig.now_ns, before_ns = supervisor_rig.now_ns;
    while (supervisor_rig.now_ns < begin_ns + span_ns) {
        const int64_t slept_ns = supervisor_rig.now_ns;
        if (made_ns <=
            supervisor_rig
                .now_ns) { /* the frames up to the next one that has not been exposed yet */
            made_ns += FRAME_NS;
            puppet_sensor_add(&supervisor_rig.sensor, made_ns, 42, ISO_CAPTURE_OK);
            continue;
        }
        const bool waits = supervisor_rig.sensor.frames[supervisor_rig.sensor.next].t_ns <=
                           supervisor_rig.now_ns;
        sleep_until_woken(waits ? supervisor_rig.now_ns : made_ns);
        idling.wakes += supervisor_rig.now_ns > slept_ns;
        const struct iso_frame *frame = NULL;
        if (iso_sensor_supervisor_look(&supervisor_rig.supervisor, supervisor_rig.now_ns, &frame) ==
            ISO_SENSOR_FRAME) {
            /* A visitor who came just after the frame before this one waited longest. */
            const int64_t waited_ns = supervisor_rig.now_ns - before_ns;
            idling.worst_ns = waited_ns > idling.worst_ns ? waited_ns : idling.worst_ns;
            before_ns = frame->t_ns;
            idling.frames++;
        }
    }
    return idling;
}

static void begin_idling(int descriptor)
{
    supervisor_rig.sensor.streams = true;
    supervisor_rig.sensor.descriptor = descriptor;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_BACK);
    puppet_sensor_add(&supervisor_rig.sensor, supervisor_rig.now_ns, 42, ISO_CAPTURE_OK);
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_FRAME);
    iso_sensor_supervisor_set_interval(&supervisor_rig.supervisor, REST_NS);
    assert_int_equal(supervisor_rig.sensor.interval_ns, REST_NS);
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
    assert_true(supervisor_rig.supervisor.sees);
}

static void at_rest_a_stream_without_a_descriptor_is_asked_seldom(void **state)
{
    (void)state;
    begin_idling(0);
    assert_int_equal(iso_sensor_supervisor_fd(&supervisor_rig.supervisor, supervisor_rig.now_ns),
                     -ENOSYS);
    const struct idling idling = idle_for(10000 * MS);
    assert_in_range(idling.frames, 80, 100);
    assert_in_range(idling.wakes, 150, 250);
    assert_in_range(idling.worst_ns, 90 * MS, 150 * MS);
}

static void the_descriptor_is_watched_again_when_a_frame_is_wanted(void **state)
{
    (void)state;
    assert_int_equal(iso_sensor_supervisor_fd(&supervisor_rig.supervisor, supervisor_rig.now_ns),
                     -ENODEV);
    begin_idling(7);
    assert_int_equal(iso_sensor_supervisor_fd(&supervisor_rig.supervisor, supervisor_rig.now_ns),
                     -EAGAIN);
    assert_int_equal(due_in_ms(), 80);
    supervisor_rig.now_ns += REST_NS - 1;
    assert_int_equal(iso_sensor_supervisor_fd(&supervisor_rig.supervisor, supervisor_rig.now_ns),
                     -EAGAIN);
    assert_int_equal(supervisor_rig_look(),
                     ISO_SENSOR_QUIET); /* the caller was woken by something else */
    assert_int_equal(
        iso_sensor_supervisor_due_ns(&supervisor_rig.supervisor, supervisor_rig.now_ns),
        supervisor_rig.now_ns + 1);
    supervisor_rig.now_ns += 1;
    assert_int_equal(iso_sensor_supervisor_fd(&supervisor_rig.supervisor, supervisor_rig.now_ns),
                     7);
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_QUIET);
    assert_int_equal(due_in_ms(), 50);
}

static void without_an_interval_the_descriptor_is_watched_at_once(void **state)
{
    (void)state;
    begin_idling(7);
    iso_sensor_supervisor_set_interval(&supervisor_rig.supervisor, 0);
    assert_int_equal(iso_sensor_supervisor_fd(&supervisor_rig.supervisor, supervisor_rig.now_ns),
                     7);
    assert_int_equal(due_in_ms(), 0);
    iso_sensor_supervisor_set_interval(&supervisor_rig.supervisor, REST_NS);
    supervisor_rig.sensor.wait_error = -ENODEV;
    assert_int_equal(supervisor_rig_look(), ISO_SENSOR_GONE);
    supervisor_rig.sensor.wait_error = 0;
    supervisor_rig.now_ns += 100 * MS;
    assert_int_equal(supervisor_rig_look(),
                     ISO_SENSOR_BACK); /* an opened sensor gives every frame */
    assert_int_equal(iso_sensor_supervisor_fd(&supervisor_rig.supervisor, supervisor_rig.now_ns),
                     7);
    assert_int_equal(due_in_ms(), 50);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, supervisor_rig_setup, supervisor_rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(at_rest_a_camera_wakes_its_caller_seldom),
        TEST(at_rest_a_stream_without_a_descriptor_is_asked_seldom),
        TEST(the_descriptor_is_watched_again_when_a_frame_is_wanted),
        TEST(without_an_interval_the_descriptor_is_watched_at_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

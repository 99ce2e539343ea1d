/* Repeated frames do not count, whatever the appliance does at that time. The frames are complete,
 * each with its own noise, so that the appliance itself finds the repetitions. */
#include <errno.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/appliance/appliance.h"
#include "firmware/visit/repeat_watch.h"
#include "sim/base/random.h"
#include "tests/firmware/rigs/rig.h"

enum { WIDTH = 160, HEIGHT = 120, NOSE_MM = 700, QUEUE_MAX = 64, CODE_PX = 3 };

/* Its face, number and position determine all pixels of a buffer: equal values give equal frames.
 * The pipeline of the puppets reads face and position from the first pixels (puppets.c). */
struct buffer {
    int64_t t_ns;
    int face, number, right_mm;
};

static struct camera {
    struct iso_clock clock;
    struct buffer queue[QUEUE_MAX];
    int n, next;
    bool gone;
    float depth_mm[WIDTH * HEIGHT];
    struct iso_frame frame;
} camera;

static void paint(const struct buffer *buffer)
{
    struct sim_random random = sim_random_seeded((uint64_t)buffer->number, 7, 0);
    for (int i = CODE_PX; i < WIDTH * HEIGHT; i++) {
        camera.depth_mm[i] = (float)(NOSE_MM + i % 40 + 2 * sim_random_normal(&random));
    }
    camera.depth_mm[0] = (float)(100 + buffer->face);
    camera.depth_mm[1] = (float)(100 + (int)ISO_CAPTURE_OK);
    camera.depth_mm[2] = (float)(1100 + buffer->right_mm);
}

static int camera_check(const struct iso_option *options, size_t n_options, struct iso_fault *fault)
{
    (void)options, (void)n_options, (void)fault;
    return 0;
}

static int camera_open(const struct iso_option *options, size_t n_options,
                       const struct iso_clock *clock, void **self, struct iso_fault *fault)
{
    (void)options, (void)n_options, (void)clock, (void)fault;
    *self = &camera;
    return 0;
}

static int camera_start(void *self, struct iso_fault *fault)
{
    (void)self, (void)fault;
    return 0;
}

static int camera_wait(void *self, int64_t deadline_ns, const struct iso_frame **frame,
                       struct iso_fault *fault)
{
    (void)self, (void)deadline_ns;
    if (camera.gone) {
        camera.gone = false; /* the next open finds it again */
        return iso_fault_set(fault, -ENODEV, "unplugged");
    }
    if (camera.next == camera.n ||
        camera.queue[camera.next].t_ns > iso_clock_now_ns(&camera.clock)) {
        return -ETIMEDOUT;
    }
    const struct buffer *buffer = &camera.queue[camera.next++];
    paint(buffer);
    camera.frame.t_ns = buffer->t_ns;
    camera.frame.sequence++;
    *frame = &camera.frame;
    return 0;
}

static int camera_next_due_ns(void *self, int64_t *due_ns)
{
    (void)self;
    *due_ns = camera.next < camera.n ? camera.queue[camera.next].t_ns
                                     : iso_clock_now_ns(&camera.clock) + 50 * ISO_NS_PER_MS;
    return 0;
}

static int camera_describe(void *self, struct iso_sensor_description *out)
{
    (void)self;
    *out = (struct iso_sensor_description){
        .model = "whole", .width_px = WIDTH, .height_px = HEIGHT};
    return 0;
}

static int camera_stop(void *self)
{
    (void)self;
    return 0;
}

static void camera_close(void *self)
{
    (void)self;
}

static const struct iso_sensor_ops camera_ops = {
    .name = "whole",
    .check = camera_check,
    .open = camera_open,
    .start = camera_start,
    .wait = camera_wait,
    .next_due_ns = camera_next_due_ns,
    .describe = camera_describe,
    .stop = camera_stop,
    .close = camera_close,
};

static int open_camera(void *context, struct iso_sensor **out, struct iso_fault *fault)
{
    (void)context;
    return iso_sensor_open_ops(&camera_ops, NULL, 0, &camera.clock, out, fault);
}

static int setup(void **state)
{
    if (rig_setup(state)) {
        return -1;
    }
    struct rig *rig = *state;
    iso_appliance_free(rig->appliance);
    camera = (struct camera){.clock = rig->borrowed.times.monotonic};
    camera.frame = (struct iso_frame){
        .camera = {.projection = ISO_PINHOLE,
                   .width_px = WIDTH,
                   .height_px = HEIGHT,
                   .fx_px = 290,
                   .fy_px = 290,
                   .cx_px = WIDTH / 2.0,
                   .cy_px = HEIGHT / 2.0},
        .width_px = WIDTH,
        .height_px = HEIGHT,
        .depth_mm = camera.depth_mm,
    };
    rig->borrowed.sensor = (struct iso_sensor_source){open_camera, NULL};
    rig->config.sensor.pause_ms = 600000;
    rig_enrol(rig, "anna", 50);
    const int error = iso_appliance_new(&rig->borrowed, &rig->appliance);
    if (!error) {
        rig_start(rig);
    }
    return error;
}

/* Shows one more buffer, after this time. */
static void queue(struct rig *rig, int face, int number, int right_mm, int64_t in_ms)
{
    assert_in_range(camera.n, 0, QUEUE_MAX - 1);
    camera.queue[camera.n++] = (struct buffer){
        .t_ns = rig->now_ns + in_ms * ISO_NS_PER_MS,
        .face = face,
        .number = number,
        .right_mm = right_mm,
    };
}

/* Shows the buffers `first` to `first` + n - 1 of a face, 33 ms apart, and lets the appliance
 * process them. */
static void play(struct rig *rig, int face, int first, int n)
{
    for (int i = 0; i < n; i++) {
        queue(rig, face, first + i, 0, 33 * (i + 1));
    }
    rig_run(rig, 33 * (n + 1));
    camera.n = camera.next = 0;
}

static void leave(struct rig *rig)
{
    rig_run(rig, 10000);
}

static bool was_let_in(struct rig *rig)
{
    return strstr(rig_news(rig), "visit allow anna") != NULL;
}

static void a_visit_that_is_played_again_opens_nothing(void **state)
{
    struct rig *rig = *state;
    play(rig, 50, 1, 2);
    assert_true(was_let_in(rig));
    for (int i = 0; i < 3; i++) {
        leave(rig);
        play(rig, 50, 1, 2);
        assert_false(was_let_in(rig));
    }
    leave(rig);
    play(rig, 50, 3, 2); /* a visit of anna herself */
    assert_true(was_let_in(rig));
}

static void one_new_frame_does_not_agree_with_known_ones(void **state)
{
    struct rig *rig = *state;
    play(rig, 50, 1, 2);
    assert_true(was_let_in(rig));
    leave(rig);
    play(rig, 50, 1, 3); /* two known buffers and a new one */
    assert_false(was_let_in(rig));
}

/* Anna moved too fast, so that her second frame was not used. */
static void frames_that_were_not_used_are_remembered(void **state)
{
    struct rig *rig = *state;
    queue(rig, 50, 1, 0, 33);
    queue(rig, 50, 2, 10, 66);
    rig_run(rig, 100);
    assert_false(was_let_in(rig));
    leave(rig);
    camera.n = camera.next = 0;
    queue(rig, 50, 2, 10, 33);
    queue(rig, 50, 3, 10, 66);
    rig_run(rig, 100);
    assert_false(was_let_in(rig));
}

/* An attacker unplugs the camera and plays recorded frames at the other end of the cable. */
static void a_camera_that_starts_again_has_no_new_frames(void **state)
{
    struct rig *rig = *state;
    play(rig, 50, 1, 2);
    assert_true(was_let_in(rig));
    camera.gone = true;
    rig_run(rig, 20000);
    assert_string_equal(iso_appliance_status(rig->appliance).sensor_state, "started");
    play(rig, 50, 1, 2);
    assert_false(was_let_in(rig));
}

static void a_stuck_camera_is_on_record_once(void **state)
{
    struct rig *rig = *state;
    play(rig, 50, 1, 4);
    play(rig, 50, 1, 2);
    assert_string_equal(iso_appliance_status(rig->appliance).sensor_state, "started");
    play(rig, 50, 3, 2);
    assert_string_equal(iso_appliance_status(rig->appliance).sensor_state, "repeats");
    assert_non_null(strstr(rig_record(rig, "sensor"), "\"reason\":\"repeats\""));
    play(rig, 50, 5, ISO_NEW_TO_FREE - 1);
    assert_string_equal(iso_appliance_status(rig->appliance).sensor_state, "repeats");
    play(rig, 50, 5 + ISO_NEW_TO_FREE - 1, 1);
    assert_string_equal(iso_appliance_status(rig->appliance).sensor_state, "started");
    assert_non_null(strstr(rig_record(rig, "sensor"), "\"reason\":\"started\""));
}

static void known_frames_identify_nobody_to_a_client(void **state)
{
    struct rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    play(rig, 50, 1, 2);
    leave(rig);
    assert_int_equal(iso_appliance_claim(rig->appliance), 0);
    assert_int_equal(iso_appliance_identify(rig->appliance, &fault), 0);
    (void)rig_news(rig);
    play(rig, 50, 1, 2);
    assert_null(strstr(rig_news(rig), "anna"));
    play(rig, 50, 3, 2);
    assert_non_null(strstr(rig_news(rig), "identify match anna"));
}

static void nobody_is_enrolled_by_known_frames(void **state)
{
    const struct iso_enroll_request bob = {.person = "bob"};
    struct rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    play(rig, 80, 1, 6); /* a stranger */
    leave(rig);
    assert_int_equal(iso_appliance_claim(rig->appliance), 0);
    assert_int_equal(iso_appliance_enroll(rig->appliance, &bob, &fault), 0);
    (void)rig_news(rig);
    play(rig, 80, 1, 6);
    assert_null(strstr(rig_news(rig), "stage"));
    assert_null(iso_gallery_find(rig->gallery, "bob"));
    for (int i = 0; i < 10 && !iso_gallery_find(rig->gallery, "bob"); i++) {
        play(rig, 80, 10 + 6 * i, 6);
    }
    assert_non_null(iso_gallery_find(rig->gallery, "bob"));
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, setup, rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_visit_that_is_played_again_opens_nothing),
        TEST(one_new_frame_does_not_agree_with_known_ones),
        TEST(frames_that_were_not_used_are_remembered),
        TEST(a_camera_that_starts_again_has_no_new_frames),
        TEST(a_stuck_camera_is_on_record_once),
        TEST(known_frames_identify_nobody_to_a_client),
        TEST(nobody_is_enrolled_by_known_frames),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* The stages of the sensor contract with cameras of the kernel: USB cameras that are programs,
 * behind the unmodified uvcvideo and libcamera. */
#include <errno.h>
#include <linux/videodev2.h>
#include <math.h>
#include <poll.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/stereo/calibration.h"
#include "drivers/stereo/stereo.h"
#include "tests/drivers/sensor/sensor_contract.h"
#include "tests/support/child_end.h"
#include "tests/support/devices/camera_bench.h"
#include "tests/support/devices/stereo_wall.h"
#include "tests/support/scratch.h"
#include "tests/support/stored_frames.h"
#include "tests/vm/usb/usb_bench.h"
#include "tests/vm/usb/usb_camera.h"

#define SHOT_NS INT64_C(33333333)

static void add_option(struct sensor_scene *scene, const char *key, const char *value)
{
    scene->options[scene->n_options++] = (struct iso_option){key, value};
}

enum { NODE_MAX = 64 };

/* The text of the option belongs to the stage; free_nodes frees it. */
static void add_node(struct sensor_scene *scene, const char *key, const char *node)
{
    char *text = test_malloc(NODE_MAX);
    (void)snprintf(text, NODE_MAX, "%s", node);
    assert_string_not_equal(text, "");
    add_option(scene, key, text);
}

static void free_nodes(struct sensor_scene *scene, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        test_free((void *)(uintptr_t)scene->options[i].value);
    }
}

/* ---- v4l2: a bench with a camera at USB ---- */

static void set_up_bench(struct sensor_scene *scene, double unit_mm, bool intensity)
{
    struct usb_bench *bench = NULL;
    struct iso_fault fault = {.text = ""};
    const char *recording = scratch_path(scene->scratch, "recording");
    const char *directory = scratch_path(scene->scratch, "bench");
    stored_frames_write_plain(recording, SENSOR_STAGE_FRAMES, unit_mm, intensity);
    scene->shutter_fd = camera_bench_make(directory, recording, true);
    scene->unit_mm = unit_mm;
    scene->intensity = intensity;
    if (usb_bench_new(directory, intensity, &bench, &fault)) {
        fail_msg("%s", fault.text);
    }
    scene->world = bench;
    add_node(scene, "device", usb_bench_node(bench, 0));
    if (intensity) {
        add_node(scene, "ir_device", usb_bench_node(bench, 1));
    }
    add_option(scene, "camera", scratch_path(directory, "camera.ini"));
    add_option(scene, "pair_ms", "1000"); /* each request makes one pair, even on a slow machine */
}

static void set_up_depth(struct sensor_scene *scene)
{
    set_up_bench(scene, 0.1, false);
}

static void set_up_depth_and_infrared(struct sensor_scene *scene)
{
    set_up_bench(scene, 1.0, true);
}

static void leave_bench(struct sensor_scene *scene)
{
    usb_bench_free(scene->world);
    camera_bench_leave(scene->shutter_fd);
    free_nodes(scene, scene->intensity ? 2 : 1);
}

static void press(struct sensor_scene *scene)
{
    scene->now_ns += SHOT_NS;
    camera_bench_press(scene->shutter_fd);
}

static void lose(struct sensor_scene *scene, int stored)
{
    (void)stored; /* the slot plays the frames in order */
    camera_bench_lose(scene->shutter_fd);
}

static void plug(struct sensor_scene *scene, bool in)
{
    camera_bench_plug(scratch_path(scene->scratch, "bench"), in);
}

static const struct sensor_stage depth = {
    .name = "v4l2: Z16 at USB",
    .back_end = "v4l2",
    .set_up = set_up_depth,
    .tear_down = leave_bench,
    .offer = press,
    .lose = lose,
    .plug = plug,
};

static const struct sensor_stage depth_and_infrared = {
    .name = "v4l2: Z16 and Y16 at USB",
    .back_end = "v4l2",
    .set_up = set_up_depth_and_infrared,
    .tear_down = leave_bench,
    .offer = press,
    .lose = lose,
    .plug = plug,
};

/* ---- stereo: two grey cameras before a wall that moves nearer ---- */

struct eyes {
    struct usb_camera *cameras[ISO_EYES];
    atomic_int next; /* the next picture */
    bool spoilt;     /* a picture was sent cut short */
    struct iso_stereo *stereo;
    struct iso_frame *expected;
};

static int disparity_px(int stored)
{
    return 40 + 4 * stored;
}

static void on_start(void *context, int n)
{
    struct eyes *eyes = context;
    if (n > 0) {
        atomic_store(&eyes->next, 0);
    }
}

/* Prepares the product's matcher with the default options of a sensor. expect_wall computes the
 * expected depths with it. */
static void prepare_matcher(struct eyes *eyes, const char *rig)
{
    struct iso_stereo_calibration calibration;
    const struct iso_stereo_options options = iso_stereo_options_default();
    assert_int_equal(iso_stereo_calibration_read(rig, &calibration, NULL), 0);
    assert_int_equal(iso_stereo_new(&calibration, &options, &eyes->stereo, NULL), 0);
    assert_int_equal(iso_frame_new(&iso_stereo_rectification(eyes->stereo)->camera, WALL_WIDTH,
                                   WALL_HEIGHT, true, &eyes->expected),
                     0);
}

/* Plugs the cameras in one after the other, so that their nodes are the same as before. */
static void plug_eyes(struct sensor_scene *scene, bool in)
{
    struct eyes *eyes = scene->world;
    for (int i = 0; i < ISO_EYES; i++) {
        assert_int_equal(usb_camera_plug(eyes->cameras[i], in, NULL), 0);
        if (in) {
            (void)usb_camera_node(eyes->cameras[i], 0);
        }
    }
}

static struct eyes *set_up_eyes(struct sensor_scene *scene)
{
    struct eyes *eyes = test_calloc(1, sizeof *eyes);
    struct iso_fault fault = {.text = ""};
    const char *rig = scratch_path(scene->scratch, "rig.ini");
    stereo_wall_write_rig(rig);
    prepare_matcher(eyes, rig);
    for (unsigned i = 0; i < ISO_EYES; i++) {
        const struct usb_camera_options options = {
            .serial = i == ISO_EYE_LEFT ? "LEFT" : "RIGHT",
            .port = i,
            .n_streams = 1,
            .streams = {{V4L2_PIX_FMT_GREY, WALL_WIDTH, WALL_HEIGHT}},
            .started = i == ISO_EYE_LEFT ? on_start : NULL,
            .context = eyes,
        };
        if (usb_camera_new(&options, &eyes->cameras[i], &fault)) {
            fail_msg("%s", fault.text);
        }
    }
    scene->world = eyes;
    scene->intensity = true;
    plug_eyes(scene, true);
    return eyes;
}

static void set_up_v4l2_stereo(struct sensor_scene *scene)
{
    struct eyes *eyes = set_up_eyes(scene);
    add_node(scene, "left", usb_camera_node(eyes->cameras[ISO_EYE_LEFT], 0));
    add_node(scene, "right", usb_camera_node(eyes->cameras[ISO_EYE_RIGHT], 0));
    add_option(scene, "calibration", scratch_path(scene->scratch, "rig.ini"));
    add_option(scene, "pair_ms", "1000");
}

static void leave_eyes(struct sensor_scene *scene)
{
    struct eyes *eyes = scene->world;
    usb_camera_free(eyes->cameras[ISO_EYE_LEFT]);
    usb_camera_free(eyes->cameras[ISO_EYE_RIGHT]);
    iso_stereo_free(eyes->stereo);
    iso_frame_free(eyes->expected);
    test_free(eyes);
    free_nodes(scene, ISO_EYES);
}

static void make_pair(int stored, uint8_t *left, uint8_t *right)
{
    stereo_wall_picture(0, left);
    stereo_wall_picture(-disparity_px(stored), right);
}

static void shoot(struct sensor_scene *scene, bool spoilt)
{
    static uint8_t pictures[ISO_EYES][WALL_WIDTH * WALL_HEIGHT];
    struct eyes *eyes = scene->world;
    make_pair(atomic_fetch_add(&eyes->next, 1) % SENSOR_STAGE_FRAMES, pictures[ISO_EYE_LEFT],
              pictures[ISO_EYE_RIGHT]);
    for (int i = 0; i < ISO_EYES; i++) {
        usb_camera_shoot(eyes->cameras[i], 0, pictures[i], spoilt);
    }
}

static void shoot_pair(struct sensor_scene *scene)
{
    scene->now_ns += SHOT_NS;
    shoot(scene, false);
}

static void spoil_pair(struct sensor_scene *scene, int stored)
{
    struct eyes *eyes = scene->world;
    (void)stored;
    eyes->spoilt = true;
    shoot(scene, true);
}

static void expect_wall(const struct sensor_scene *scene, const struct iso_frame *frame, int stored)
{
    static uint8_t left[WALL_WIDTH * WALL_HEIGHT], right[WALL_WIDTH * WALL_HEIGHT];
    const struct eyes *eyes = scene->world;
    const size_t bytes = sizeof(float) * WALL_WIDTH * WALL_HEIGHT;
    const size_t middle = WALL_HEIGHT / 2 * WALL_WIDTH + 3 * WALL_WIDTH / 4;
    const double z_mm = (double)WALL_FOCAL_PX * WALL_BASELINE_MM / disparity_px(stored);
    make_pair(stored, left, right);
    assert_int_equal(iso_stereo_compute(eyes->stereo, left, right, NULL, eyes->expected), 0);
    assert_int_equal(frame->width_px, WALL_WIDTH);
    assert_int_equal(frame->height_px, WALL_HEIGHT);
    assert_memory_equal(frame->depth_mm, eyes->expected->depth_mm, bytes);
    assert_memory_equal(frame->intensity, eyes->expected->intensity, bytes);
    assert_true(fabs((double)frame->depth_mm[middle] - z_mm) < 2.0); /* the distance of the wall */
}

static const struct sensor_stage v4l2_stereo = {
    .name = "v4l2-stereo: two GREY at USB",
    .back_end = "v4l2-stereo",
    .set_up = set_up_v4l2_stereo,
    .tear_down = leave_eyes,
    .offer = shoot_pair,
    .lose = spoil_pair,
    .plug = plug_eyes,
    .expect = expect_wall,
};

#ifdef ISOTHERM_LIBCAMERA
/* ---- the same through libcamera ---- */

/* libcamera's names of the cameras at the ports: \\VHCI-1-1:1.0-1d6b:0102 and so on. */
struct names {
    char ids[ISO_EYES][NODE_MAX];
};

static void note_name(const struct iso_sensor_device *device, void *context)
{
    struct names *names = context;
    for (int i = 0; i < ISO_EYES; i++) {
        char port[16];
        (void)snprintf(port, sizeof port, "-%d:1.0-", i + 1);
        if (strstr(device->id, port)) {
            (void)snprintf(names->ids[i], NODE_MAX, "%.63s", device->id);
        }
    }
}

/* libcamera sees the devices that udev has processed. While udev starts, it may close the
 * connection of a client, which then must ask again. */
static void settle(void)
{
    int status = -1;
    for (int tries = 0; status != 0 && tries < 10; tries++) {
        (void)poll(NULL, 0, tries ? 500 : 0);
        status = system("udevadm settle --timeout=60");
    }
    child_expect_code("udevadm settle", child_code(status), 0, NULL, NULL);
}

static void plug_settled(struct sensor_scene *scene, bool in)
{
    plug_eyes(scene, in);
    settle();
}

/* A thread of libcamera gives its buffers to the kernel a little after the start, and a test cannot
 * wait for that: earlier pictures are lost. The same happens when libcamera has all buffers at one
 * time, as after a lost picture: the buffer of that picture is queued after the others, and the
 * requests of the others are not completed before its own. The wait is counted in work and not in
 * time, because on a busy host both sides are slow. */
static void wait_for_buffers(struct sensor_scene *scene)
{
    struct eyes *eyes = scene->world;
    const bool wait = atomic_load(&eyes->next) == 0 || eyes->spoilt;
    for (int i = 0; wait && i < 100; i++) {
        for (volatile int work = 0; work < 100000; work++) {
        }
        (void)poll(NULL, 0, 2);
    }
}

static void shoot_buffered(struct sensor_scene *scene)
{
    wait_for_buffers(scene);
    shoot_pair(scene);
}

static void set_up_libcamera(struct sensor_scene *scene)
{
    struct names names = {{""}};
    (void)set_up_eyes(scene);
    settle();
    assert_int_equal(iso_sensor_probe("libcamera-stereo", note_name, &names, NULL), 0);
    add_node(scene, "left", names.ids[ISO_EYE_LEFT]);
    add_node(scene, "right", names.ids[ISO_EYE_RIGHT]);
    add_option(scene, "calibration", scratch_path(scene->scratch, "rig.ini"));
    add_option(scene, "pair_ms", "1000");
}

static const struct sensor_stage libcamera = {
    .name = "libcamera-stereo: two GREY at USB",
    .back_end = "libcamera-stereo",
    .set_up = set_up_libcamera,
    .tear_down = leave_eyes,
    .offer = shoot_buffered,
    .lose = spoil_pair,
    .plug = plug_settled,
    .expect = expect_wall,
};
#endif

const struct sensor_stage *const sensor_stages[] = {
    &depth,     &depth_and_infrared, &v4l2_stereo,
#ifdef ISOTHERM_LIBCAMERA
    &libcamera,
#endif
    NULL,
};

const char *const sensor_stages_elsewhere[] = {"replay", "openni2", NULL};

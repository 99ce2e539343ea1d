/* The stages of the back end openni2: the virtual camera behind the unmodified runtime, and a file
 * of this camera that the runtime's own recorder wrote. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "drivers/sensor/openni2/sensor_openni2.h"
#include "tests/drivers/sensor/sensor_contract.h"
#include "tests/support/devices/camera_bench.h"
#include "tests/support/devices/manual_clock.h"
#include "tests/support/scratch.h"
#include "tests/support/stored_frames.h"

static void add_option(struct sensor_scene *scene, const char *key, const char *value)
{
    scene->options[scene->n_options++] = (struct iso_option){key, value};
}

static void set_up_camera(struct sensor_scene *scene, double unit_mm, bool intensity)
{
    const char *recording = scratch_path(scene->scratch, "recording");
    stored_frames_write_plain(recording, SENSOR_STAGE_FRAMES, unit_mm, intensity);
    scene->shutter_fd = camera_bench_make(scratch_path(scene->scratch, "bench"), recording, true);
    scene->unit_mm = unit_mm;
    scene->intensity = intensity;
    if (intensity) {
        add_option(scene, "intensity", "ir");
    }
}

static void set_up_1mm(struct sensor_scene *scene)
{
    set_up_camera(scene, 1.0, false);
}

static void set_up_100um(struct sensor_scene *scene)
{
    set_up_camera(scene, 0.1, false);
}

static void set_up_ir(struct sensor_scene *scene)
{
    set_up_camera(scene, 0.1, true);
}

static void leave(struct sensor_scene *scene)
{
    iso_sensor_openni2_forget(); /* the runtime reads the name of the bench only when it starts */
    camera_bench_leave(scene->shutter_fd);
}

static void offer(struct sensor_scene *scene)
{
    scene->now_ns += INT64_C(33333333);
    camera_bench_press(scene->shutter_fd);
}

static void lose(struct sensor_scene *scene, int stored)
{
    (void)stored; /* loses the next frame */
    camera_bench_lose(scene->shutter_fd);
}

static void plug(struct sensor_scene *scene, bool in)
{
    camera_bench_plug(scratch_path(scene->scratch, "bench"), in);
}

/* Records the camera's frames. Each frame is fetched before the next one is made, so that none is
 * lost. */
static void record(struct sensor_scene *scene, const char *path)
{
    struct iso_clock clock = manual_clock(&scene->now_ns);
    struct iso_sensor *sensor = NULL;
    struct iso_fault fault = {.text = ""};
    add_option(scene, "record", path);
    if (iso_sensor_open("openni2", scene->options, scene->n_options, &clock, &sensor, &fault) ||
        iso_sensor_start(sensor, &fault)) {
        fail_msg("%s", fault.text);
    }
    for (int i = 0; i < SENSOR_STAGE_FRAMES; i++) {
        const struct iso_frame *frame = NULL;
        offer(scene);
        assert_int_equal(
            iso_sensor_wait(sensor, scene->now_ns + INT64_C(10000000000), &frame, &fault), 0);
    }
    iso_sensor_close(sensor);
    scene->n_options--;
}

static void set_up_file(struct sensor_scene *scene, double unit_mm, bool intensity)
{
    const char *path = scratch_path(scene->scratch, "recorded.oni");
    set_up_camera(scene, unit_mm, intensity);
    record(scene, path);
    add_option(scene, "path", path);
}

static void set_up_oni(struct sensor_scene *scene)
{
    set_up_file(scene, 0.1, false);
}

static void set_up_oni_ir(struct sensor_scene *scene)
{
    set_up_file(scene, 1.0, true);
}

const struct sensor_stage sensor_stage_openni2_1mm = {
    .name = "openni2, 1 mm",
    .back_end = "openni2",
    .set_up = set_up_1mm,
    .tear_down = leave,
    .offer = offer,
    .lose = lose,
    .plug = plug,
};

const struct sensor_stage sensor_stage_openni2_100um = {
    .name = "openni2, 100 um",
    .back_end = "openni2",
    .set_up = set_up_100um,
    .tear_down = leave,
    .offer = offer,
    .lose = lose,
    .plug = plug,
};

const struct sensor_stage sensor_stage_openni2_ir = {
    .name = "openni2 with infrared",
    .back_end = "openni2",
    .set_up = set_up_ir,
    .tear_down = leave,
    .offer = offer,
    .lose = lose,
    .plug = plug,
};

const struct sensor_stage sensor_stage_oni = {
    .name = "openni2, a file",
    .back_end = "openni2",
    .set_up = set_up_oni,
    .tear_down = leave,
};

const struct sensor_stage sensor_stage_oni_ir = {
    .name = "openni2, a file with infrared",
    .back_end = "openni2",
    .set_up = set_up_oni_ir,
    .tear_down = leave,
};

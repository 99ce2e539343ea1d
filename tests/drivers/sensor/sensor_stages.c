/* The stages of the sensor contract, and the stages of the back end replay. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>

#include "tests/drivers/sensor/sensor_contract.h"
#include "tests/support/scratch.h"
#include "tests/support/stored_frames.h"

const struct sensor_stage *const sensor_stages[] = {
    &sensor_stage_replay,
    &sensor_stage_replay_intensity,
#ifdef ISOTHERM_OPENNI2
    &sensor_stage_openni2_1mm,
    &sensor_stage_openni2_100um,
    &sensor_stage_openni2_ir,
    &sensor_stage_oni,
    &sensor_stage_oni_ir,
#endif
    NULL,
};

const char *const sensor_stages_elsewhere[] = {"v4l2", "v4l2-stereo", "libcamera-stereo", NULL};

static void set_up_recording(struct sensor_scene *scene, double unit_mm, bool intensity)
{
    const char *path = scratch_path(scene->scratch, "recording");
    stored_frames_write_plain(path, SENSOR_STAGE_FRAMES, unit_mm, intensity);
    scene->options[scene->n_options++] = (struct iso_option){"path", path};
    scene->unit_mm = unit_mm;
    scene->intensity = intensity;
}

static void set_up_replay(struct sensor_scene *scene)
{
    set_up_recording(scene, 0.5, false);
}

static void set_up_replay_intensity(struct sensor_scene *scene)
{
    set_up_recording(scene, 1.0, true);
}

/* Cuts a file short. */
static void damage(struct sensor_scene *scene, int stored)
{
    char name[64];
    (void)snprintf(name, sizeof name, "recording/depth/%06d.png", stored);
    scratch_write(scratch_path(scene->scratch, name), "\x89PNG\r\n\x1a\n", 8);
}

const struct sensor_stage sensor_stage_replay = {
    .name = "replay",
    .back_end = "replay",
    .set_up = set_up_replay,
    .lose = damage,
};

const struct sensor_stage sensor_stage_replay_intensity = {
    .name = "replay with intensity",
    .back_end = "replay",
    .set_up = set_up_replay_intensity,
    .lose = damage,
};

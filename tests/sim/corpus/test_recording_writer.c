/* The writer of recordings, checked by the reader. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/sim/corpus/written_recording.h"
#include "tests/support/scratch.h"

static void assert_cameras_equal(const struct iso_camera *a, const struct iso_camera *b)
{
    assert_int_equal(a->projection, b->projection);
    assert_int_equal(a->width_px, b->width_px);
    assert_int_equal(a->height_px, b->height_px);
    assert_true(a->fx_px == b->fx_px && a->fy_px == b->fy_px && a->pitch_mm == b->pitch_mm);
    assert_true(a->cx_px == b->cx_px && a->cy_px == b->cy_px);
    assert_true(a->k1 == b->k1 && a->k2 == b->k2 && a->k3 == b->k3);
    assert_true(a->p1 == b->p1 && a->p2 == b->p2);
}

static void a_written_recording_is_read_back(void **state)
{
    struct iso_recording_meta meta = written_meta();
    struct sim_recording_writer *writer = written_create(state, &meta);
    struct iso_frame *written = written_frame(true), *read;
    assert_int_equal(sim_recording_writer_append(writer, written, NULL), 0);
    written->t_ns += 1;
    written->depth_mm[20] = 0.0F;
    assert_int_equal(sim_recording_writer_append(writer, written, NULL), 0);
    written_finish(writer);
    struct iso_recording *recording = written_open(state);
    assert_string_equal(iso_recording_meta(recording)->sensor, "d435");
    assert_true(iso_recording_meta(recording)->unit_mm == 0.1);
    assert_cameras_equal(&iso_recording_meta(recording)->camera, &meta.camera);
    assert_int_equal(iso_recording_frames(recording), 2);
    assert_int_equal(iso_recording_frame_new(recording, &read), 0);
    assert_int_equal(iso_recording_read(recording, 1, read, NULL), 0);
    assert_int_equal(read->t_ns, written->t_ns);
    assert_memory_equal(read->depth_mm, written->depth_mm,
                        sizeof(float) * WRITTEN_WIDTH * WRITTEN_HEIGHT);
    assert_memory_equal(read->intensity, written->intensity,
                        sizeof(float) * WRITTEN_WIDTH * WRITTEN_HEIGHT);
    iso_frame_free(read);
    iso_frame_free(written);
    iso_recording_close(recording);
}

static void depths_are_rounded_to_the_unit(void **state)
{
    struct iso_recording_meta meta = written_meta();
    struct sim_recording_writer *writer = written_create(state, &meta);
    struct iso_frame *written = written_frame(false), *read;
    written->depth_mm[0] = 500.04F;
    written->depth_mm[1] = 500.06F;
    assert_int_equal(sim_recording_writer_append(writer, written, NULL), 0);
    written_finish(writer);
    struct iso_recording *recording = written_open(state);
    assert_false(iso_recording_has_intensity(recording));
    assert_int_equal(iso_recording_frame_new(recording, &read), 0);
    assert_int_equal(iso_recording_read(recording, 0, read, NULL), 0);
    assert_true(read->depth_mm[0] == 500.0F);
    assert_true(read->depth_mm[1] == (float)(5001 * 0.1));
    iso_frame_free(read);
    iso_frame_free(written);
    iso_recording_close(recording);
}

static void numbers_are_short(void **state)
{
    struct iso_recording_meta meta = written_meta();
    struct sim_recording_writer *writer = written_create(state, &meta);
    size_t size;
    sim_recording_writer_free(writer);
    char *ini = scratch_read(scratch_path(*state, "r/recording.ini"), &size);
    ini[size] = '\0';
    assert_non_null(strstr(ini, "\nfx_px = 425.3333333333333\n")); /* short and exact */
    assert_non_null(strstr(ini, "\nfy_px = 424.7\n"));
    assert_non_null(strstr(ini, "\nunit_mm = 0.1\n"));
    assert_null(strstr(ini, "k2"));
    free(ini);
}

static void an_orthographic_camera_is_read_back(void **state)
{
    struct iso_recording_meta meta = {
        .sensor = "texas",
        .camera = {.projection = ISO_ORTHOGRAPHIC,
                   .width_px = WRITTEN_WIDTH,
                   .height_px = WRITTEN_HEIGHT,
                   .pitch_mm = 0.32,
                   .cx_px = 6,
                   .cy_px = 4},
        .unit_mm = 0.01,
    };
    struct sim_recording_writer *writer = written_create(state, &meta);
    struct iso_frame *frame;
    assert_int_equal(iso_frame_new(&meta.camera, WRITTEN_WIDTH, WRITTEN_HEIGHT, false, &frame), 0);
    assert_int_equal(sim_recording_writer_append(writer, frame, NULL), 0);
    written_finish(writer);
    struct iso_recording *recording = written_open(state);
    assert_cameras_equal(&iso_recording_meta(recording)->camera, &meta.camera);
    iso_frame_free(frame);
    iso_recording_close(recording);
}

/* A crop of a large image becomes a small image. Points in space do not move. */
static void a_crop_moves_the_principal_point(void **state)
{
    struct iso_recording_meta meta = written_meta();
    struct iso_frame *written = written_frame(false), *read;
    written->camera.width_px = 640;
    written->camera.height_px = 480;
    written->camera.cx_px = 319.5;
    written->camera.cy_px = 239.5;
    written->crop_x_px = 300;
    written->crop_y_px = 200;
    meta.camera = sim_recording_camera(written);
    assert_int_equal(meta.camera.width_px, WRITTEN_WIDTH);
    assert_true(meta.camera.cx_px == 19.5 && meta.camera.cy_px == 39.5);
    /* The reader accepts principal points that are at most one image away. */
    struct sim_recording_writer *writer = NULL;
    struct iso_fault fault;
    assert_int_equal(
        sim_recording_writer_create(scratch_path(*state, "r"), &meta, 9, &writer, &fault), -EINVAL);
    written->crop_x_px = 310;
    written->crop_y_px = 234;
    meta.camera = sim_recording_camera(written);
    writer = written_create(state, &meta);
    assert_int_equal(sim_recording_writer_append(writer, written, NULL), 0);
    written_finish(writer);
    struct iso_recording *recording = written_open(state);
    assert_int_equal(iso_recording_frame_new(recording, &read), 0);
    assert_int_equal(iso_recording_read(recording, 0, read, NULL), 0);
    struct iso_vec3 a = iso_frame_point_at(written, 11, 3), b = iso_frame_point_at(read, 11, 3);
    assert_true(iso_norm(iso_sub(a, b)) < 1e-9);
    iso_frame_free(read);
    iso_frame_free(written);
    iso_recording_close(recording);
}

static void the_same_frames_make_the_same_bytes(void **state)
{
    struct iso_recording_meta meta = written_meta();
    struct iso_frame *frame = written_frame(true);
    static const char *const files[] = {"recording.ini", "depth.txt", "ir.txt", "depth/000000.png",
                                        "ir/000000.png"};
    for (int i = 0; i < 2; i++) {
        struct sim_recording_writer *writer = NULL;
        assert_int_equal(sim_recording_writer_create(scratch_path(*state, i ? "b" : "a"), &meta, 6,
                                                     &writer, NULL),
                         0);
        assert_int_equal(sim_recording_writer_append(writer, frame, NULL), 0);
        written_finish(writer);
    }
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        size_t size_a, size_b;
        void *a = scratch_read(scratch_path(scratch_path(*state, "a"), files[i]), &size_a);
        void *b = scratch_read(scratch_path(scratch_path(*state, "b"), files[i]), &size_b);
        assert_int_equal(size_a, size_b);
        assert_memory_equal(a, b, size_a);
        free(a);
        free(b);
    }
    iso_frame_free(frame);
}

static void landmarks_are_read_back(void **state)
{
    struct iso_recording_meta meta = written_meta();
    struct sim_recording_writer *writer = written_create(state, &meta);
    struct iso_frame *frame = written_frame(false);
    struct iso_recording_landmark *rows = NULL;
    size_t n = 0;
    assert_int_equal(sim_recording_writer_landmark(writer, "nasion", iso_vec3(1, 2, 3), NULL),
                     -EINVAL);
    for (int i = 0; i < 2; i++) {
        frame->t_ns++;
        assert_int_equal(sim_recording_writer_append(writer, frame, NULL), 0);
        assert_int_equal(sim_recording_writer_landmark(writer, "nose_tip",
                                                       iso_vec3(i - 0.5, -20.25, 700.125), NULL),
                         0);
    }
    written_finish(writer);
    struct iso_recording *recording = written_open(state);
    assert_int_equal(iso_recording_landmarks(recording, &rows, &n, NULL), 0);
    assert_int_equal(n, 2);
    assert_int_equal(rows[1].frame, 1);
    assert_string_equal(rows[1].name, "nose_tip");
    assert_true(rows[1].point_mm.x == 0.5 && rows[1].point_mm.y == -20.25);
    assert_true(rows[1].point_mm.z == 700.125);
    free(rows);
    iso_frame_free(frame);
    iso_recording_close(recording);
}

#define IN_SCRATCH(test) cmocka_unit_test_setup_teardown(test, scratch_setup, scratch_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        IN_SCRATCH(a_written_recording_is_read_back),
        IN_SCRATCH(depths_are_rounded_to_the_unit),
        IN_SCRATCH(numbers_are_short),
        IN_SCRATCH(an_orthographic_camera_is_read_back),
        IN_SCRATCH(a_crop_moves_the_principal_point),
        IN_SCRATCH(the_same_frames_make_the_same_bytes),
        IN_SCRATCH(landmarks_are_read_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

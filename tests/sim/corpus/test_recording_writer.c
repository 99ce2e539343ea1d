/* The writer of recordings, against the reader. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include <cmocka.h>

#include "drivers/recording/recording_writer.h"
#include "tests/support/scratch.h"

enum { WIDTH = 13, HEIGHT = 8 };

static struct iso_recording_meta pinhole(void)
{
    return (struct iso_recording_meta){
        .sensor = "d435",
        .camera = {.projection = ISO_PINHOLE,
                   .width_px = WIDTH,
                   .height_px = HEIGHT,
                   .fx_px = 1.0 / 3.0 + 425.0,
                   .fy_px = 424.7,
                   .cx_px = 6.1,
                   .cy_px = 3.9,
                   .k1 = 0.1,
                   .p2 = -1e-4},
        .unit_mm = 0.1,
    };
}

/* A frame of that camera; depths are whole counts, with the largest and the smallest among them. */
static struct iso_frame *new_frame(bool with_intensity)
{
    struct iso_recording_meta meta = pinhole();
    struct iso_frame *frame;
    assert_int_equal(iso_frame_new(&meta.camera, WIDTH, HEIGHT, with_intensity, &frame), 0);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        frame->depth_mm[i] = (float)((i * 631 % 65535 + 1) * meta.unit_mm);
        if (with_intensity) {
            frame->intensity[i] = (float)(i * 601 % 65536) / 65535.0F;
        }
    }
    frame->depth_mm[5] = 0.0F;
    frame->depth_mm[6] = (float)(65535 * meta.unit_mm);
    frame->depth_mm[7] = (float)(1 * meta.unit_mm);
    frame->t_ns = 1305031102175304001;
    return frame;
}

static struct sim_recording_writer *create(void **state, const struct iso_recording_meta *meta)
{
    struct sim_recording_writer *writer = NULL;
    struct iso_fault fault = {.text = ""};
    int error = sim_recording_writer_create(scratch_path(*state, "r"), meta, 9, &writer, &fault);
    assert_string_equal(fault.text, "");
    assert_int_equal(error, 0);
    return writer;
}

static void finish(struct sim_recording_writer *writer)
{
    assert_int_equal(sim_recording_writer_finish(writer, NULL), 0);
    sim_recording_writer_free(writer);
}

static struct iso_recording *open_recording(void **state)
{
    struct iso_recording *recording = NULL;
    struct iso_fault fault = {.text = ""};
    int error = iso_recording_open(scratch_path(*state, "r"), &recording, &fault);
    assert_string_equal(fault.text, "");
    assert_int_equal(error, 0);
    return recording;
}

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

static void what_is_written_is_read_back(void **state)
{
    struct iso_recording_meta meta = pinhole();
    struct sim_recording_writer *writer = create(state, &meta);
    struct iso_frame *written = new_frame(true), *read;
    assert_int_equal(sim_recording_writer_append(writer, written, NULL), 0);
    written->t_ns += 1;
    written->depth_mm[20] = 0.0F;
    assert_int_equal(sim_recording_writer_append(writer, written, NULL), 0);
    finish(writer);
    struct iso_recording *recording = open_recording(state);
    assert_string_equal(iso_recording_meta(recording)->sensor, "d435");
    assert_true(iso_recording_meta(recording)->unit_mm == 0.1);
    assert_cameras_equal(&iso_recording_meta(recording)->camera, &meta.camera);
    assert_int_equal(iso_recording_frames(recording), 2);
    assert_int_equal(iso_recording_frame_new(recording, &read), 0);
    assert_int_equal(iso_recording_read(recording, 1, read, NULL), 0);
    assert_int_equal(read->t_ns, written->t_ns);
    assert_memory_equal(read->depth_mm, written->depth_mm, sizeof(float) * WIDTH * HEIGHT);
    assert_memory_equal(read->intensity, written->intensity, sizeof(float) * WIDTH * HEIGHT);
    iso_frame_free(read);
    iso_frame_free(written);
    iso_recording_close(recording);
}

static void depths_are_rounded_to_the_unit(void **state)
{
    struct iso_recording_meta meta = pinhole();
    struct sim_recording_writer *writer = create(state, &meta);
    struct iso_frame *written = new_frame(false), *read;
    written->depth_mm[0] = 500.04F;
    written->depth_mm[1] = 500.06F;
    assert_int_equal(sim_recording_writer_append(writer, written, NULL), 0);
    finish(writer);
    struct iso_recording *recording = open_recording(state);
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
    struct iso_recording_meta meta = pinhole();
    struct sim_recording_writer *writer = create(state, &meta);
    size_t size;
    sim_recording_writer_free(writer);
    char *ini = scratch_read(scratch_path(*state, "r/recording.ini"), &size);
    ini[size] = '\0';
    assert_non_null(strstr(ini, "\nfx_px = 425.3333333333333\n")); /* as short as is exact */
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
                   .width_px = WIDTH,
                   .height_px = HEIGHT,
                   .pitch_mm = 0.32,
                   .cx_px = 6,
                   .cy_px = 4},
        .unit_mm = 0.01,
    };
    struct sim_recording_writer *writer = create(state, &meta);
    struct iso_frame *frame;
    assert_int_equal(iso_frame_new(&meta.camera, WIDTH, HEIGHT, false, &frame), 0);
    assert_int_equal(sim_recording_writer_append(writer, frame, NULL), 0);
    finish(writer);
    struct iso_recording *recording = open_recording(state);
    assert_cameras_equal(&iso_recording_meta(recording)->camera, &meta.camera);
    iso_frame_free(frame);
    iso_recording_close(recording);
}

/* A crop of a large image becomes a small image; points of space stay where they were. */
static void a_crop_moves_the_principal_point(void **state)
{
    struct iso_recording_meta meta = pinhole();
    struct iso_frame *written = new_frame(false), *read;
    written->camera.width_px = 640;
    written->camera.height_px = 480;
    written->camera.cx_px = 319.5;
    written->camera.cy_px = 239.5;
    written->crop_x_px = 300;
    written->crop_y_px = 200;
    meta.camera = sim_recording_camera(written);
    assert_int_equal(meta.camera.width_px, WIDTH);
    assert_true(meta.camera.cx_px == 19.5 && meta.camera.cy_px == 39.5);
    /* The reader accepts principal points up to one image away only. */
    struct sim_recording_writer *writer = NULL;
    struct iso_fault fault;
    assert_int_equal(
        sim_recording_writer_create(scratch_path(*state, "r"), &meta, 9, &writer, &fault), -EINVAL);
    written->crop_x_px = 310;
    written->crop_y_px = 234;
    meta.camera = sim_recording_camera(written);
    writer = create(state, &meta);
    assert_int_equal(sim_recording_writer_append(writer, written, NULL), 0);
    finish(writer);
    struct iso_recording *recording = open_recording(state);
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
    struct iso_recording_meta meta = pinhole();
    struct iso_frame *frame = new_frame(true);
    static const char *const files[] = {"recording.ini", "depth.txt", "ir.txt", "depth/000000.png",
                                        "ir/000000.png"};
    for (int i = 0; i < 2; i++) {
        struct sim_recording_writer *writer = NULL;
        assert_int_equal(sim_recording_writer_create(scratch_path(*state, i ? "b" : "a"), &meta, 6,
                                                     &writer, NULL),
                         0);
        assert_int_equal(sim_recording_writer_append(writer, frame, NULL), 0);
        finish(writer);
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
    struct iso_recording_meta meta = pinhole();
    struct sim_recording_writer *writer = create(state, &meta);
    struct iso_frame *frame = new_frame(false);
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
    finish(writer);
    struct iso_recording *recording = open_recording(state);
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

static void refuses_bad_landmarks(void **state)
{
    static const char *const names[] = {"", "a,b", "two words", "a2345678901234567890123456789012"};
    struct iso_recording_meta meta = pinhole();
    struct sim_recording_writer *writer = create(state, &meta);
    struct iso_frame *frame = new_frame(false);
    assert_int_equal(sim_recording_writer_append(writer, frame, NULL), 0);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        assert_int_equal(sim_recording_writer_landmark(writer, names[i], iso_vec3(1, 2, 3), NULL),
                         -EINVAL);
    }
    assert_int_equal(sim_recording_writer_landmark(writer, "nasion", iso_vec3(1, NAN, 3), NULL),
                     -EINVAL);
    finish(writer);
    assert_false(scratch_exists(scratch_path(*state, "r/landmarks.csv")));
    iso_frame_free(frame);
}

/* The frame is refused with `expected`, and nothing is left of it. */
static void assert_refused(struct sim_recording_writer *writer, const struct iso_frame *frame,
                           int error, const char *expected)
{
    struct iso_fault fault = {.text = ""};
    assert_int_equal(sim_recording_writer_append(writer, frame, &fault), error);
    assert_non_null(strstr(fault.text, expected));
}

static void refuses_frames_that_do_not_fit(void **state)
{
    struct iso_recording_meta meta = pinhole();
    struct sim_recording_writer *writer = create(state, &meta);
    struct iso_frame *frame = new_frame(true);
    assert_int_equal(sim_recording_writer_append(writer, frame, NULL), 0);
    assert_refused(writer, frame, -EINVAL, "r: frame 1: time does not rise");
    frame->t_ns++;
    frame->camera.fx_px += 1e-9;
    assert_refused(writer, frame, -EINVAL, "r: frame 1: another camera");
    frame->camera = meta.camera;
    frame->depth_mm[3] = 6553.56F;
    assert_refused(writer, frame, -ERANGE, "r: frame 1: depth 6553.56 mm does not fit");
    frame->depth_mm[3] = 0.04F;
    assert_refused(writer, frame, -ERANGE, "r: frame 1: depth 0.04 mm does not fit");
    frame->depth_mm[3] = NAN;
    assert_refused(writer, frame, -EINVAL, "r: frame 1: depth");
    frame->depth_mm[3] = 500.0F;
    frame->intensity[9] = 1.001F;
    assert_refused(writer, frame, -EINVAL, "r: frame 1: intensity outside 0..1");
    float *intensity = frame->intensity;
    frame->intensity = NULL;
    assert_refused(writer, frame, -EINVAL, "r: frame 1: intensity in some frames only");
    frame->intensity = intensity;
    frame->intensity[9] = 1.0F;
    assert_int_equal(sim_recording_writer_append(writer, frame, NULL), 0);
    finish(writer);
    struct iso_recording *recording = open_recording(state);
    assert_int_equal(iso_recording_frames(recording), 2);
    iso_recording_close(recording);
    iso_frame_free(frame);
}

static void refuses_time_before_zero(void **state)
{
    struct iso_recording_meta meta = pinhole();
    struct sim_recording_writer *writer = create(state, &meta);
    struct iso_frame *frame = new_frame(false);
    frame->t_ns = -1;
    assert_refused(writer, frame, -EINVAL, "r: frame 0: time does not rise");
    iso_frame_free(frame);
    sim_recording_writer_free(writer);
}

static void refuses_what_no_reader_would_accept(void **state)
{
    struct sim_recording_writer *writer = NULL;
    struct iso_recording_meta meta = pinhole();
    struct iso_fault fault;
    const char *path = scratch_path(*state, "r");
    assert_int_equal(sim_recording_writer_create(path, &meta, 0, &writer, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "r: png_level must be 1..9"));
    meta.unit_mm = 0.0;
    assert_int_equal(sim_recording_writer_create(path, &meta, 6, &writer, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "r: unit_mm must be"));
    meta = pinhole();
    meta.camera.fy_px = NAN;
    assert_int_equal(sim_recording_writer_create(path, &meta, 6, &writer, &fault), -EINVAL);
    meta = pinhole();
    meta.sensor[0] = '\0';
    assert_int_equal(sim_recording_writer_create(path, &meta, 6, &writer, &fault), -EINVAL);
    assert_false(scratch_exists(path));
    assert_null(writer);
}

static void takes_an_empty_directory_only(void **state)
{
    struct iso_recording_meta meta = pinhole();
    struct sim_recording_writer *writer = NULL;
    struct iso_fault fault;
    const char *path = scratch_path(*state, "r");
    scratch_mkdir(path);
    scratch_write_text(scratch_path(path, "x"), "x");
    assert_int_equal(sim_recording_writer_create(path, &meta, 6, &writer, &fault), -EEXIST);
    assert_non_null(strstr(fault.text, "r: is not empty"));
    assert_int_equal(remove(scratch_path(path, "x")), 0);
    assert_int_equal(sim_recording_writer_create(path, &meta, 6, &writer, NULL), 0);
    assert_int_equal(sim_recording_writer_finish(writer, &fault), -ENODATA);
    assert_non_null(strstr(fault.text, "r: no frames were written"));
    sim_recording_writer_free(writer);
    writer = NULL;
    path = scratch_path(*state, "no/parent");
    assert_int_equal(sim_recording_writer_create(path, &meta, 6, &writer, &fault), -ENOENT);
    assert_null(writer);
}

static void a_full_disk_is_reported(void **state)
{
    struct iso_recording_meta meta = pinhole();
    struct sim_recording_writer *writer = create(state, &meta);
    struct iso_frame *frame = new_frame(false);
    struct iso_fault fault = {.text = ""};
    struct rlimit unlimited, limit;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &unlimited), 0);
    limit = unlimited;
    limit.rlim_cur = 30;
    (void)signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
    int append_error = sim_recording_writer_append(writer, frame, &fault);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &unlimited), 0);
    assert_int_equal(append_error, -EFBIG);
    assert_non_null(strstr(fault.text, "r/depth/000000.png: File too large"));
    iso_frame_free(frame);
    sim_recording_writer_free(writer);
}

#define IN_SCRATCH(test) cmocka_unit_test_setup_teardown(test, scratch_setup, scratch_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        IN_SCRATCH(what_is_written_is_read_back),
        IN_SCRATCH(depths_are_rounded_to_the_unit),
        IN_SCRATCH(numbers_are_short),
        IN_SCRATCH(an_orthographic_camera_is_read_back),
        IN_SCRATCH(a_crop_moves_the_principal_point),
        IN_SCRATCH(the_same_frames_make_the_same_bytes),
        IN_SCRATCH(landmarks_are_read_back),
        IN_SCRATCH(refuses_bad_landmarks),
        IN_SCRATCH(refuses_frames_that_do_not_fit),
        IN_SCRATCH(refuses_time_before_zero),
        IN_SCRATCH(refuses_what_no_reader_would_accept),
        IN_SCRATCH(takes_an_empty_directory_only),
        IN_SCRATCH(a_full_disk_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

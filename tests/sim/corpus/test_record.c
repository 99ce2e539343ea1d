/* isotherm-sim record: the recording has the frames of the sensor; and the word that names a
 * sensor. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

#include "drivers/recording/recording.h"
#include "drivers/sensor/contract/sensor.h"
#include "sim/corpus/record.h"
#include "sim/corpus/sensor_word.h"
#include "sim/corpus/tape.h"
#include "tests/support/scratch.h"
#include "tests/support/stored_frames.h"

#define MS INT64_C(1000000)

enum { FRAMES = 5 };

static int64_t monotonic_ns(void *context)
{
    struct timespec now;
    (void)context;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * INT64_C(1000000000) + now.tv_nsec;
}

static const struct iso_clock real_clock = {monotonic_ns, NULL};

static int setup(void **state)
{
    const int error = scratch_setup(state);
    if (!error) {
        stored_frames_write_plain(scratch_path(*state, "seen"), FRAMES, 0.25, true);
    }
    return error;
}

/* Records from the sensor replay in real time. Intensity images are found by their time stamps. */
static int record(void **state, size_t frames, struct sim_record_result *result,
                  struct iso_fault *fault)
{
    const struct iso_option options[] = {{"path", scratch_path(*state, "seen")}};
    const struct sim_record_options wish = {scratch_path(*state, "made"), frames, 400 * MS};
    struct iso_sensor *sensor = NULL;
    assert_int_equal(iso_sensor_open("replay", options, 1, &real_clock, &sensor, NULL), 0);
    assert_int_equal(iso_sensor_start(sensor, NULL), 0);
    const int error = sim_record(sensor, &real_clock, &wish, result, fault);
    iso_sensor_close(sensor);
    return error;
}

static void expect_equal(void **state, size_t made_frame, size_t seen_frame)
{
    struct iso_recording *made = NULL, *seen = NULL;
    struct iso_frame *a = NULL, *b = NULL;
    assert_int_equal(iso_recording_open(scratch_path(*state, "made"), &made, NULL), 0);
    assert_int_equal(iso_recording_open(scratch_path(*state, "seen"), &seen, NULL), 0);
    assert_string_equal(iso_recording_meta(made)->sensor, iso_recording_meta(seen)->sensor);
    assert_true(iso_recording_meta(made)->unit_mm == iso_recording_meta(seen)->unit_mm);
    assert_true(iso_recording_meta(made)->camera.fy_px == iso_recording_meta(seen)->camera.fy_px);
    assert_true(iso_recording_meta(made)->camera.cx_px == iso_recording_meta(seen)->camera.cx_px);
    assert_int_equal(iso_recording_frame_new(made, &a), 0);
    assert_int_equal(iso_recording_frame_new(seen, &b), 0);
    assert_int_equal(iso_recording_read(made, made_frame, a, NULL), 0);
    assert_int_equal(iso_recording_read(seen, seen_frame, b, NULL), 0);
    const size_t bytes = (size_t)a->width_px * (size_t)a->height_px * sizeof(float);
    assert_memory_equal(a->depth_mm, b->depth_mm, bytes);
    assert_memory_equal(a->intensity, b->intensity, bytes);
    iso_frame_free(a);
    iso_frame_free(b);
    iso_recording_close(made);
    iso_recording_close(seen);
}

static size_t count_made(void **state)
{
    struct iso_recording *made = NULL;
    assert_int_equal(iso_recording_open(scratch_path(*state, "made"), &made, NULL), 0);
    const size_t n = iso_recording_frames(made);
    assert_int_equal(iso_recording_t_ns(made, 0), 0); /* time starts at the first frame */
    iso_recording_close(made);
    return n;
}

static void records_what_is_seen(void **state)
{
    struct sim_record_result result;
    struct iso_fault fault = {.text = ""};
    if (record(state, 4, &result, &fault)) {
        fail_msg("%s", fault.text);
    }
    assert_int_equal(result.frames, 4);
    assert_int_equal(result.damaged, 0);
    assert_true(result.span_ns > 0);
    assert_int_equal(count_made(state), 4);
    for (size_t i = 0; i < 4; i++) {
        expect_equal(state, i, i);
    }
}

static void keeps_its_frames_after_a_time_out(void **state)
{
    struct sim_record_result result;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(record(state, 99, &result, &fault), -ETIMEDOUT);
    assert_string_equal(fault.text, "sensor replay: no frame for 400 ms");
    assert_int_equal(result.frames, FRAMES);
    assert_int_equal(count_made(state), FRAMES);
}

static void counts_damaged_frames(void **state)
{
    struct sim_record_result result;
    scratch_write(scratch_path(*state, "seen/depth/000001.png"), "PNG", 3);
    assert_int_equal(record(state, FRAMES - 1, &result, NULL), 0);
    assert_int_equal(result.damaged, 1);
    assert_int_equal(result.health.lost, 1);
    assert_int_equal(count_made(state), FRAMES - 1);
    expect_equal(state, 1, 2);
}

static void writes_over_nothing(void **state)
{
    struct sim_record_result result;
    struct iso_fault fault = {.text = ""};
    scratch_mkdir(scratch_path(*state, "made"));
    scratch_write_text(scratch_path(*state, "made/precious"), "x");
    assert_int_equal(record(state, 1, &result, &fault), -EEXIST);
    assert_non_null(strstr(fault.text, "is not empty"));
    assert_int_equal(result.frames, 0);
}

/* A frame that cannot be written is reported with a later frame, or at the end. */
static void a_tape_reports_frames_that_cannot_be_written(void **state)
{
    const struct iso_camera camera = {.projection = ISO_PINHOLE,
                                      .width_px = 4,
                                      .height_px = 3,
                                      .fx_px = 100,
                                      .fy_px = 100,
                                      .cx_px = 1.5,
                                      .cy_px = 1};
    const struct iso_recording_meta meta = {.sensor = "s", .camera = camera, .unit_mm = 0.1};
    struct sim_recording_writer *writer = NULL;
    struct sim_tape *tape = NULL;
    struct iso_frame *frame = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(iso_frame_new(&camera, 4, 3, false, &frame), 0);
    assert_int_equal(
        sim_recording_writer_create(scratch_path(*state, "made"), &meta, 1, &writer, NULL), 0);
    assert_int_equal(sim_tape_new(writer, frame, &tape, NULL), 0);
    frame->depth_mm[5] = 7000; /* 70000 counts */
    assert_int_equal(sim_tape_put(tape, frame, NULL), 0);
    frame->width_px = 3;
    assert_int_equal(sim_tape_put(tape, frame, NULL), -EINVAL);
    assert_int_equal(sim_tape_finish(tape, &fault), -ERANGE);
    assert_non_null(strstr(fault.text, "does not fit 16 bits"));
    sim_recording_writer_free(writer);
    iso_frame_free(frame);
    assert_int_equal(sim_tape_finish(NULL, NULL), 0);
}

static void reads_a_sensor_in_a_word(void **state)
{
    struct sim_sensor_word word = {0};
    (void)state;
    assert_int_equal(sim_sensor_word_parse("replay:path=/a=b,pace=asap", &word, NULL), 0);
    assert_string_equal(word.type, "replay");
    assert_int_equal(word.n_options, 2);
    assert_string_equal(word.options[0].key, "path");
    assert_string_equal(word.options[0].value, "/a=b");
    assert_string_equal(word.options[1].key, "pace");
    assert_string_equal(word.options[1].value, "asap");
    assert_int_equal(sim_sensor_word_add(&word, "record", "x", NULL), 0);
    assert_int_equal(word.n_options, 3);
    sim_sensor_word_done(&word);
    assert_int_equal(sim_sensor_word_parse("openni2", &word, NULL), 0);
    assert_int_equal(word.n_options, 0);
    sim_sensor_word_done(&word);
}

static void refuses_words_that_name_no_sensor(void **state)
{
    static const char *const words[] = {"",
                                        ":path=x",
                                        "replay:",
                                        "replay:path",
                                        "replay:=x",
                                        "replay:path=x,",
                                        "r:a=,b=,c=,d=,e=,f=,g=,h=,i=,j=,k=,l=,m=,n=,o=,p=,q="};
    (void)state;
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        struct sim_sensor_word word = {0};
        struct iso_fault fault = {.text = ""};
        assert_int_equal(sim_sensor_word_parse(words[i], &word, &fault), -EINVAL);
        assert_true(strlen(fault.text) > 0);
        assert_null(word.text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(records_what_is_seen, setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(keeps_its_frames_after_a_time_out, setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(counts_damaged_frames, setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(writes_over_nothing, setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(a_tape_reports_frames_that_cannot_be_written, setup,
                                        scratch_teardown),
        cmocka_unit_test(reads_a_sensor_in_a_word),
        cmocka_unit_test(refuses_words_that_name_no_sensor),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

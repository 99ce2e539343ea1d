/* Import of public databases: the meaning of file names, and range images. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/file/png.h"
#include "drivers/recording/recording.h"
#include "sim/corpus/import.h"
#include "tests/sim/corpus/scan_files.h"
#include "tests/support/scratch.h"

static void write_scan(const char *directory, const char *file, scan_writer *write)
{
    size_t size;
    char *bytes = scan_file_bytes(write, &size);
    scratch_write(scratch_path(directory, file), bytes, size);
    free(bytes);
}

static struct sim_import_options import_options(const char *database, const char *directory)
{
    return (struct sim_import_options){
        .database = sim_database_find(database),
        .from = scratch_path(directory, "from"),
        .to = scratch_path(directory, "to"),
        .database_options = {0.32},
    };
}

static const struct sim_corpus_row *row_of(const struct sim_corpus *corpus, const char *recording)
{
    for (size_t i = 0; i < corpus->n_rows; i++) {
        if (strcmp(corpus->rows[i].recording, recording) == 0) {
            return &corpus->rows[i];
        }
    }
    fail_msg("no row of %s", recording);
    return NULL;
}

/* Three people of Bosphorus. One file is damaged, and one is of another kind. */
static void test_import(void **state)
{
    scratch_mkdir(scratch_path(*state, "from"));
    scratch_mkdir(scratch_path(*state, "from/bs001"));
    write_scan(*state, "from/bs001/bs001_E_HAPPY_0.bnt", scan_write_bnt);
    write_scan(*state, "from/bs001/bs001_N_N_0.bnt", scan_write_bnt);
    write_scan(*state, "from/bs000_YR_R10_0.bnt", scan_write_bnt);
    write_scan(*state, "from/bs002_O_EYE_0.bnt", scan_write_bnt);
    scratch_write_text(scratch_path(*state, "from/bs000_N_N_1.bnt"), "damaged");
    scratch_write_text(scratch_path(*state, "from/bs000_N_N_1.lm3"), "landmarks");
    struct sim_import_options options = import_options("bosphorus", *state);
    struct sim_import_report report;
    struct sim_corpus *corpus = NULL;
    struct iso_fault fault = {.text = ""};
    options.n_strangers = 1;
    assert_int_equal(sim_import(&options, &report, &fault), 0);
    assert_int_equal(report.scans, 4);
    assert_int_equal(report.people, 3);
    assert_int_equal(report.refused, 1);
    assert_int_equal(sim_corpus_read(options.to, &corpus, &fault), 0);
    assert_int_equal(corpus->n_rows, 4);
    const struct sim_corpus_row *row = row_of(corpus, "bs001_E_HAPPY_0");
    assert_int_equal(row->role, SIM_ROLE_PROBE);
    assert_string_equal(row->subject, "bs001");
    assert_string_equal(row->expression, "E-HAPPY");
    assert_int_equal(row_of(corpus, "bs001_N_N_0")->role, SIM_ROLE_GALLERY);
    row = row_of(corpus, "bs000_YR_R10_0"); /* the only recording of this person */
    assert_int_equal(row->role, SIM_ROLE_GALLERY);
    assert_string_equal(row->pose, "YR-R10");
    assert_int_equal(row_of(corpus, "bs002_O_EYE_0")->role, SIM_ROLE_IMPOSTOR);
    sim_corpus_free(corpus);
    struct iso_recording *recording = NULL;
    assert_int_equal(iso_recording_open(scratch_path(options.to, "bs001_N_N_0"), &recording, NULL),
                     0);
    assert_string_equal(iso_recording_meta(recording)->sensor, "bosphorus");
    assert_int_equal(iso_recording_meta(recording)->camera.width_px, 640);
    iso_recording_close(recording);
}

static void test_import_refusals(void **state)
{
    struct sim_import_report report;
    struct iso_fault fault = {.text = ""};
    struct sim_import_options options = import_options("frgc", *state);
    assert_int_equal(sim_import(&options, &report, &fault), -ENOENT);
    scratch_mkdir(scratch_path(*state, "from"));
    assert_int_equal(sim_import(&options, &report, &fault), -ENOENT);
    assert_non_null(strstr(fault.text, "no file has a name of the database frgc"));
    scratch_write_text(scratch_path(*state, "from/02463d652.abs"), "damaged");
    assert_int_equal(sim_import(&options, &report, &fault), -ENOENT);
    assert_non_null(strstr(fault.text, "can be read"));
    write_scan(*state, "from/02463d652.abs", scan_write_abs);
    options.n_strangers = 1;
    assert_int_equal(sim_import(&options, &report, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "none left to enrol"));
    scratch_mkdir(scratch_path(*state, "from/again"));
    write_scan(*state, "from/again/02463d652.abs", scan_write_abs);
    assert_int_equal(sim_import(&options, &report, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "the same name"));
}

static void test_names(void **state)
{
    (void)state;
    static const struct {
        const char *database, *file, *subject, *session, *what;
        bool neutral;
    } good[] = {
        {"texas", "Clean_0017_003_20050912220400_Range.png", "t0017", "s003", "", true},
        {"frgc", "04201d302.abs", "f04201", "s302", "", true},
        {"bosphorus", "bs104_LFAU_25_0.bnt", "bs104", "s0", "LFAU-25", false},
        {"bu3dfe", "F0001_AN04WH_F3D.wrl", "F0001", "AN04", "AN04", false},
        {"bu3dfe", "M0044_NE00BL_F3D.wrl", "M0044", "NE00", "neutral", true},
        {"gavab", "cara9_sonrisa.wrl", "g9", "sonrisa", "sonrisa", false},
        {"casia", "002-031.wrl", "c002", "s031", "", true},
    };
    static const struct {
        const char *database, *file;
    } others[] = {
        {"texas", "Clean_0017_003_20050912220400_Portrait.png"},
        {"texas", "Range.png"},
        {"frgc", "04201d302.ppm"},
        {"frgc", "04201d302.abs.gz"},
        {"bosphorus", "bs104_LFAU_25_0.lm3"},
        {"bu3dfe", "F0001_AN04WH_RAW.wrl"},
        {"gavab", "figura.wrl"},
        {"casia", "002-031.jpg"},
    };
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        struct sim_corpus_row row = {.count = 1};
        bool neutral = !good[i].neutral;
        assert_true(sim_database_find(good[i].database)->describe(good[i].file, &row, &neutral));
        assert_string_equal(row.subject, good[i].subject);
        assert_string_equal(row.session, good[i].session);
        assert_string_equal(row.expression, good[i].what);
        assert_int_equal(neutral, good[i].neutral);
    }
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        struct sim_corpus_row row = {.count = 1};
        bool neutral;
        assert_false(
            sim_database_find(others[i].database)->describe(others[i].file, &row, &neutral));
    }
    assert_null(sim_database_find("lfw"));
}

static void write_grey(const char *path, int width, uint8_t first)
{
    uint8_t samples[64];
    for (int i = 0; i < 64; i++) {
        samples[i] = (uint8_t)(i == 0 ? 0 : first + i);
    }
    const struct iso_image image = {
        .width_px = width, .height_px = 64 / width, .pixel = ISO_PIXEL_GREY8, .samples = samples};
    assert_int_equal(iso_png_write(path, &image, 6, NULL), 0);
}

static void test_range_images(void **state)
{
    const char *range = scratch_path(*state, "Clean_0001_001_2005_Range.png");
    const struct sim_database *texas = sim_database_find("texas");
    const struct sim_database_options options = {0.32};
    struct iso_frame *frame = NULL;
    struct iso_fault fault = {.text = ""};
    write_grey(range, 16, 100);
    assert_int_equal(texas->read(range, &options, &frame, &fault), 0);
    assert_null(frame->intensity);
    assert_int_equal(frame->width_px, 16);
    assert_int_equal(frame->height_px, 4);
    assert_float_equal(frame->camera.pitch_mm, 0.32, 0.0);
    assert_float_equal(frame->depth_mm[0], 0.0f, 0.0);
    /* The second row is level 117, which is 138 below the nearest one. */
    assert_float_equal((double)iso_frame_depth_at(frame, 1, 1), (600.0 + 138 * 0.32), 1e-3);
    iso_frame_free(frame);
    frame = NULL;
    const char *portrait = scratch_path(*state, "Clean_0001_001_2005_Portrait.png");
    write_grey(portrait, 16, 51);
    assert_int_equal(texas->read(range, &options, &frame, &fault), 0);
    assert_float_equal(frame->intensity[17], (68.0f / 255.0f), 1e-6);
    iso_frame_free(frame);
    frame = NULL;
    write_grey(portrait, 8, 51);
    assert_int_equal(texas->read(range, &options, &frame, &fault), -EBADMSG);
    assert_non_null(strstr(fault.text, "Range.png: "));
    scratch_write_text(portrait, "no picture");
    assert_int_equal(texas->read(range, &options, &frame, &fault), -EBADMSG);
    assert_null(frame);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_import, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(test_import_refusals, scratch_setup, scratch_teardown),
        cmocka_unit_test(test_names),
        cmocka_unit_test_setup_teardown(test_range_images, scratch_setup, scratch_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

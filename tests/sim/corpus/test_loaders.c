/* Readers of public databases, on small files written here in their formats. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/recording/recording.h"
#include "sim/corpus/import.h"
#include "sim/corpus/scan_file.h"
#include "sim/corpus/scan_view.h"
#include "tests/support/scratch.h"

enum { ROWS = 50, COLUMNS = 40, POINTS = ROWS * COLUMNS };

/* A dome of 1 mm pitch whose summit, z 30, is at (5, -8); one corner was not measured. */
static struct iso_vec3 dome(int row, int column)
{
    double x = column - COLUMNS / 2 + 5.0, y = ROWS / 2 - row - 8.0;
    return iso_vec3(x, y, 30.0 - 0.02 * ((x - 5.0) * (x - 5.0) + (y + 8.0) * (y + 8.0)));
}

static bool measured(int row, int column)
{
    return row > 5 || column > 7;
}

typedef void writer(FILE *out);

static char *written(writer *write, size_t *size)
{
    char *text = NULL;
    FILE *out = open_memstream(&text, size);
    assert_non_null(out);
    write(out);
    assert_int_equal(fclose(out), 0);
    return text;
}

static void write_abs(FILE *out)
{
    fprintf(out, "%d rows\n%d columns\npixels (flag X Y Z):\n", ROWS, COLUMNS);
    for (int plane = 0; plane < 4; plane++) {
        for (int i = 0; i < POINTS; i++) {
            struct iso_vec3 p = dome(i / COLUMNS, i % COLUMNS);
            bool good = measured(i / COLUMNS, i % COLUMNS);
            if (plane == 0) {
                fprintf(out, "%d ", good);
            } else {
                /* 1.5 m from the scanner */
                double value = plane == 1 ? p.x : plane == 2 ? p.y : p.z - 1500.0;
                fprintf(out, "%.6f ", good ? value : -999999.0);
            }
        }
        fputc('\n', out);
    }
}

static void put(FILE *out, const void *value, size_t size)
{
    assert_int_equal(fwrite(value, 1, size, out), size); /* little endian, as all we run on */
}

static void write_bnt(FILE *out)
{
    const uint16_t rows = ROWS, columns = COLUMNS, length = 9;
    const uint32_t n = 5 * POINTS;
    const double zmin = -1000000000.0;
    put(out, &rows, 2);
    put(out, &columns, 2);
    put(out, &zmin, 8);
    put(out, &length, 2);
    put(out, "bs000.png", 9);
    put(out, &n, 4);
    for (int plane = 0; plane < 5; plane++) {
        for (int i = 0; i < POINTS; i++) {
            struct iso_vec3 p = dome(i / COLUMNS, i % COLUMNS);
            double value = plane == 0 ? p.x : plane == 1 ? p.y : plane == 2 ? p.z : 0.5;
            value = measured(i / COLUMNS, i % COLUMNS) ? value : zmin;
            put(out, &value, 8);
        }
    }
}

/* The dome in squares (quads, or triangles), after points that are no coordinates. */
static void write_vrml(FILE *out)
{
    fputs("#VRML V2.0 utf8\n# a comment with point [ 1 2 3 ] and { in it\n"
          "Shape { appearance Appearance { texture ImageTexture { url \"a } b.bmp\" } }\n"
          "geometry IndexedFaceSet {\n texCoord TextureCoordinate { point [ 0 0, 1 1 ] }\n"
          " coord Coordinate { point [\n",
          out);
    for (int i = 0; i < POINTS; i++) {
        struct iso_vec3 p = dome(i / COLUMNS, i % COLUMNS);
        fprintf(out, "%.4f %.4f %.4f,\n", p.x, p.y, p.z);
    }
    fputs("] }\n coordIndex [\n", out);
    for (int row = 0; row + 1 < ROWS; row++) {
        for (int column = 0; column + 1 < COLUMNS; column++) {
            int a = row * COLUMNS + column, b = a + COLUMNS;
            if (measured(row, column) && row % 2 == 0) {
                fprintf(out, "%d, %d, %d, %d, -1,\n", a, b, b + 1, a + 1);
            } else if (measured(row, column)) {
                fprintf(out, "%d %d %d -1 %d %d %d -1\n", a, b, b + 1, a, b + 1, a + 1);
            }
        }
    }
    fputs("]\n texCoordIndex [ 0, 1, 0, -1 ]\n} }\n", out);
}

/* Depth at a pixel of the virtual camera where a point of the dome appears; 0: nothing there. */
static double depth_of(const struct iso_frame *frame, struct iso_vec3 shift, double x, double y)
{
    double z = 30.0 - 0.02 * ((x - 5.0) * (x - 5.0) + (y + 8.0) * (y + 8.0));
    struct iso_vec3 p = {x - shift.x, shift.y - y, 600.0 + shift.z - z};
    double u, v;
    assert_true(iso_camera_project(&frame->camera, p, &u, &v));
    return (double)iso_frame_depth_at(frame, (int)lround(u), (int)lround(v)) - p.z;
}

typedef int parser(const char *name, const char *bytes, size_t size, struct iso_mesh **out,
                   struct iso_fault *fault);

static const struct kind {
    const char *name;
    writer *write;
    parser *parse;
    double z_mm; /* that the format adds */
} kinds[] = {
    {"f.abs", write_abs, sim_scan_parse_abs, -1500.0},
    {"b.bnt", write_bnt, sim_scan_parse_bnt, 0.0},
    {"v.wrl", write_vrml, sim_scan_parse_vrml, 0.0},
};

static void test_scans_are_seen(void **state)
{
    (void)state;
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        size_t size;
        char *bytes = written(kinds[k].write, &size);
        struct iso_mesh *mesh = NULL;
        struct iso_fault fault = {.text = ""};
        if (kinds[k].parse(kinds[k].name, bytes, size, &mesh, &fault)) {
            fail_msg("%s", fault.text);
        }
        assert_in_range(mesh->n_triangles, 3700, 2 * (ROWS - 1) * (COLUMNS - 1));
        double highest = -1e9;
        for (int32_t i = 0; i < mesh->n_vertices; i++) {
            highest = fmax(highest, mesh->vertices_mm[i].z);
        }
        assert_float_equal(highest, (30.0 + kinds[k].z_mm), 1e-3);
        struct iso_frame *frame = NULL;
        assert_int_equal(sim_scan_view(mesh, &frame), 0);
        assert_int_equal(iso_frame_check(frame, NULL), 0);
        /* How it was shifted shows in a vertex: the last one is the grid's last point. */
        struct iso_vec3 last = mesh->vertices_mm[mesh->n_vertices - 1],
                        known = dome(ROWS - 1, COLUMNS - 1);
        struct iso_vec3 shift = {known.x - last.x, known.y + last.y, known.z + last.z - 600.0};
        for (double x = -12.0; x < 22.0; x += 5.5) {
            for (double y = -28.0; y < 8.0; y += 5.5) {
                assert_float_equal(depth_of(frame, shift, x, y), 0.0, 0.35);
            }
        }
        /* Not measured: the upper left corner. */
        assert_true(depth_of(frame, shift, -13.0, 16.0) < -100.0);
        iso_frame_free(frame);
        iso_mesh_free(mesh);
        free(bytes);
    }
}

static void refused(parser *parse, const char *bytes, size_t size, const char *words)
{
    struct iso_mesh *mesh = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(parse("file", bytes, size, &mesh, &fault), -EBADMSG);
    assert_null(mesh);
    if (!strstr(fault.text, words) || !strstr(fault.text, "file: ")) {
        fail_msg("'%s' does not say '%s'", fault.text, words);
    }
}

static void refused_text(parser *parse, const char *text, const char *words)
{
    refused(parse, text, strlen(text), words);
}

static void test_damaged_scans(void **state)
{
    (void)state;
    parser *abs = sim_scan_parse_abs, *bnt = sim_scan_parse_bnt, *vrml = sim_scan_parse_vrml;
    refused_text(abs, "", "rows");
    refused_text(abs, "3 columns", "how many rows");
    refused_text(abs, "3 rows\n2 rows", "how many columns");
    refused_text(abs, "3 rows\n2 columns\n1 1 1", "no pixels");
    refused_text(abs, "3 rows\n9999 columns\npixels (flag X Y Z):\n1", "9999 points");
    refused_text(abs, "2 rows\n2 columns\npixels:\n1 1 1 1 0 1 0 1 0 0 1 1 5 5 5", "in its z");
    refused_text(abs, "2 rows\n2 columns\npixels:\n1 1 1 1 0 nan 0 1", "in its x");
    refused_text(abs, "2 rows\n2 columns\npixels:\n0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0", "no surface");
    refused_text(vrml, "VRML", "not VRML");
    refused_text(vrml, "#VRML V2.0 utf8\nCoordinate { point [ 1 2 3 ] }", "no faces");
    refused_text(vrml, "#VRML V2.0 utf8\nCoordinate { point [ 1 2 ] }", "three coordinates");
    refused_text(vrml, "#VRML V2.0 utf8\nCoordinate { point [ 1 2 x ] }", "no number");
    refused_text(vrml, "#VRML V2.0 utf8\nCoordinate { point [ 1 2 1e9 ] }", "out of range");
    refused_text(vrml, "#VRML V2.0 utf8\nCoordinate { point 1 2 3 }", "begin with [");
    refused_text(vrml, "#VRML V2.0 utf8\nCoordinate { point [ 1 2 3", "list ends");
    refused_text(vrml, "#VRML V2.0 utf8\ncoordIndex [ 0 1 2 ]", "not among the points");
    refused_text(vrml,
                 "#VRML V2.0 utf8\nCoordinate { point [ 0 0 0 1 0 0 0 1 0 ] } coordIndex [ 0 1 3 ]",
                 "not among the points");
    size_t size;
    char *bytes = written(write_bnt, &size);
    refused(bnt, bytes, 13, "truncated");
    refused(bnt, bytes, size - 1, "does not hold");
    bytes[0] = 1; /* one row */
    refused(bnt, bytes, size, "1 rows");
    free(bytes);
}

/* VRML 1.0 calls it Coordinate3; two face sets count their points anew. */
static void test_vrml_nodes(void **state)
{
    (void)state;
    static const char text[] = "#VRML V1.0 ascii\nSeparator {\n"
                               "Coordinate3 { point [0 0 0, 1 0 0, 0 1 0] }\n"
                               "IndexedFaceSet { coordIndex [0,1,2,-1] }\n"
                               "Coordinate3 { point [0 0 5, 1 0 5, 0 1 5, 1 1 5] }\n"
                               "IndexedFaceSet { coordIndex [0,1,3,2,-1, 1,1,2] } }";
    struct iso_mesh *mesh = NULL;
    assert_int_equal(sim_scan_parse_vrml("two", text, sizeof text - 1, &mesh, NULL), 0);
    assert_int_equal(mesh->n_vertices, 7);
    assert_int_equal(mesh->n_triangles, 3); /* the last face has two corners only */
    assert_int_equal(mesh->triangles[2][0], 3);
    assert_int_equal(mesh->triangles[2][1], 6);
    assert_int_equal(mesh->triangles[2][2], 5);
    iso_mesh_free(mesh);
}

static void write_scan(const char *directory, const char *file, writer *write)
{
    size_t size;
    char *bytes = written(write, &size);
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

/* Three people of Bosphorus, one file damaged, one of another kind. */
static void test_import(void **state)
{
    scratch_mkdir(scratch_path(*state, "from"));
    scratch_mkdir(scratch_path(*state, "from/bs001"));
    write_scan(*state, "from/bs001/bs001_E_HAPPY_0.bnt", write_bnt);
    write_scan(*state, "from/bs001/bs001_N_N_0.bnt", write_bnt);
    write_scan(*state, "from/bs000_YR_R10_0.bnt", write_bnt);
    write_scan(*state, "from/bs002_O_EYE_0.bnt", write_bnt);
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
    row = row_of(corpus, "bs000_YR_R10_0"); /* the only one left of the person */
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
    assert_non_null(strstr(fault.text, "no file is named as those of frgc"));
    scratch_write_text(scratch_path(*state, "from/02463d652.abs"), "damaged");
    assert_int_equal(sim_import(&options, &report, &fault), -ENOENT);
    assert_non_null(strstr(fault.text, "can be read"));
    write_scan(*state, "from/02463d652.abs", write_abs);
    options.n_strangers = 1;
    assert_int_equal(sim_import(&options, &report, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "none left to enrol"));
    scratch_mkdir(scratch_path(*state, "from/again"));
    write_scan(*state, "from/again/02463d652.abs", write_abs);
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
    /* Level 117 in the second row, 138 below the nearest. */
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
        cmocka_unit_test(test_scans_are_seen),
        cmocka_unit_test(test_damaged_scans),
        cmocka_unit_test(test_vrml_nodes),
        cmocka_unit_test_setup_teardown(test_import, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(test_import_refusals, scratch_setup, scratch_teardown),
        cmocka_unit_test(test_names),
        cmocka_unit_test_setup_teardown(test_range_images, scratch_setup, scratch_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* ICT-FaceKit's own files become the head model that `generate` reads. The tests use a tiny kit
 * that they write, and files of the real kit if they are present. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <jansson.h>
#include <math.h>

#include "sim/world/face/ict_kit.h"
#include "sim/world/face/npy_writer.h"
#include "tests/support/near.h"
#include "tests/support/scratch.h"
#include "tests/support/shared_data.h"

/* ---- half-precision numbers ---- */

static void every_half_survives(void **state)
{
    (void)state;
    for (uint32_t half = 0; half < 0x10000; half++) {
        const float value = sim_npy_float_of_half((uint16_t)half);
        if (!isnan(value)) {
            assert_int_equal(sim_npy_half_of_double((double)value), half);
        }
    }
    assert_int_equal(sim_npy_half_of_double(1.0 + 0x1p-11), 0x3c00); /* ties to even: down */
    assert_int_equal(sim_npy_half_of_double(1.0 + 0x3p-11), 0x3c02); /* ... and up */
    assert_int_equal(sim_npy_half_of_double(1.0 + 0x1.1p-11), 0x3c01);
    assert_int_equal(sim_npy_half_of_double(0x1p-25), 0);
    assert_int_equal(sim_npy_half_of_double(0x1.8p-25), 1);
    assert_int_equal(sim_npy_half_of_double(65519.9), 0x7bff);
    assert_int_equal(sim_npy_half_of_double(-65520.0), 0xfc00);
    assert_true(isnan(sim_npy_float_of_half(sim_npy_half_of_double(NAN))));
}

/* ---- a tiny kit ---- */

/* Eight vertices. Vertices 4 and 5 are not kept. */
static const struct sim_ict_layout tiny = {
    .n_vertices = 8,
    .n_identity = 2,
    .n_landmarks = 3,
    .kept = {{0, 4}, {6, 8}},
};

static const char indices[] = "{\"expressions\": [\"smile\", \"frown\"],\n"
                              " \"idx_to_landmark_verts\": [7, 0, 3]}\n";

static const char faces[] = "f 1/1 2/2 3/3 4/4\n"   /* a quadrilateral becomes two triangles */
                            "f 3/1/1 4/2/2 5/3/3\n" /* has a corner that is not kept */
                            "f 8 7 1\n";

/* Vertex v is at (v, 2 v, 0), and `shift` moves it along z. */
static void write_obj(const char *kit, const char *name, double shift, const char *end)
{
    char text[1024] = "# a comment\nmtllib none\n", file[64];
    for (int v = 0; v < 8; v++) {
        const size_t n = strlen(text);
        (void)snprintf(text + n, sizeof text - n, "v %d %d %g\n", v, 2 * v, shift * v);
    }
    strcat(strcat(text, "vt 0 0\ng head\n"), end);
    (void)snprintf(file, sizeof file, "FaceXModel/%s.obj", name);
    scratch_write_text(scratch_path(kit, file), text);
}

static void write_kit(const char *kit)
{
    scratch_mkdir(scratch_path(kit, "FaceXModel"));
    scratch_write_text(scratch_path(kit, "FaceXModel/vertex_indices.json"), indices);
    write_obj(kit, "generic_neutral_mesh", 0, faces);
    write_obj(kit, "identity000", 0.5, faces);
    write_obj(kit, "identity001", -0.25, faces);
    write_obj(kit, "smile", 2, faces);
    write_obj(kit, "frown", 3, faces);
}

static int import(const char *kit, struct sim_ict_kit_report *report, struct iso_fault *fault)
{
    return sim_ict_import(kit, &tiny, scratch_path(kit, "out"), report, fault);
}

static float *floats(const char *kit, const char *file, int n_dimensions)
{
    struct sim_npy_shape shape = {.n_dimensions = 0};
    struct iso_fault fault = {.text = ""};
    float *values = NULL;
    if (sim_npy_read_floats(scratch_path(kit, file), &shape, &values, &fault)) {
        fail_msg("%s", fault.text);
    }
    assert_int_equal(shape.n_dimensions, n_dimensions);
    assert_int_equal(shape.size[n_dimensions - 1], 3);
    assert_int_equal(shape.size[n_dimensions - 2], 6);
    return values;
}

static void expect_text(const char *kit, const char *file, const char *expected)
{
    size_t size = 0;
    char *text = scratch_read(scratch_path(kit, file), &size);
    assert_int_equal(size, strlen(expected));
    assert_memory_equal(text, expected, size);
    free(text);
}

static void expect_numbers(const char *kit)
{
    static const int kept[6] = {0, 1, 2, 3, 6, 7};
    static const double identity_mm[2] = {5, -2.5},
                        expression_mm[2] = {30, 20}; /* sorted by name */
    float *mean = floats(kit, "out/mean.npy", 2), *identity = floats(kit, "out/identity.npy", 3);
    float *expression = floats(kit, "out/expression.npy", 3);
    for (int i = 0; i < 6; i++) {
        assert_near((double)mean[3 * i], 10 * kept[i], 0);
        assert_near((double)mean[3 * i + 1], 20 * kept[i], 0);
        for (int mode = 0; mode < 2; mode++) {
            const int at = 18 * mode + 3 * i;
            assert_near((double)identity[at], 0, 0);
            assert_near((double)identity[at + 2], identity_mm[mode] * kept[i], 0);
            assert_near((double)expression[at + 2], expression_mm[mode] * kept[i], 0);
        }
    }
    free(mean);
    free(identity);
    free(expression);
}

static void a_kit_becomes_a_head_model(void **state)
{
    static const uint32_t expected[9] = {0, 1, 2, 0, 2, 3, 5, 4, 0};
    const char *kit = *state;
    struct sim_ict_kit_report report;
    struct sim_npy_shape shape;
    struct iso_fault fault = {.text = ""};
    uint32_t *triangles = NULL;
    write_kit(kit);
    if (import(kit, &report, &fault)) {
        fail_msg("%s", fault.text);
    }
    assert_int_equal(report.n_vertices, 6);
    assert_int_equal(report.n_triangles, 3);
    assert_int_equal(report.n_identity, 2);
    assert_int_equal(report.n_expression, 2);
    expect_numbers(kit);
    assert_int_equal(
        sim_npy_read_u32(scratch_path(kit, "out/triangles.npy"), &shape, &triangles, NULL), 0);
    assert_int_equal(shape.size[0], 3);
    assert_memory_equal(triangles, expected, sizeof expected);
    free(triangles);
    expect_text(kit, "out/expression_names.txt", "frown\nsmile\n");
    expect_text(kit, "out/landmarks68.txt", "5\n0\n3\n");
    /* The path may name the folder with the files itself, and an output may exist already. */
    assert_int_equal(sim_ict_import(scratch_path(kit, "FaceXModel"), &tiny,
                                    scratch_path(kit, "out"), &report, &fault),
                     0);
    expect_numbers(kit);
}

/* Asserts that the import fails with a fault that has both texts. */
static void expect_fault(const char *kit, int error, const char *file, const char *what)
{
    struct sim_ict_kit_report report;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(import(kit, &report, &fault), error);
    if (!strstr(fault.text, file) || !strstr(fault.text, what)) {
        fail_msg("'%s' does not say '%s' and '%s'", fault.text, file, what);
    }
}

static void missing_files_are_named(void **state)
{
    const char *kit = *state;
    expect_fault(kit, -ENOENT, "no folder FaceXModel", "ICT-VGL/ICT-FaceKit");
    scratch_mkdir(scratch_path(kit, "FaceXModel"));
    expect_fault(kit, -ENOENT, "vertex_indices.json", "No such file");
    scratch_write_text(scratch_path(kit, "FaceXModel/vertex_indices.json"), indices);
    expect_fault(kit, -ENOENT, "FaceXModel/generic_neutral_mesh.obj is missing", ", and 4 more");
    write_obj(kit, "generic_neutral_mesh", 0, faces);
    write_obj(kit, "identity000", 0.5, faces);
    write_obj(kit, "smile", 2, faces);
    write_obj(kit, "frown", 3, faces);
    expect_fault(kit, -ENOENT, "FaceXModel/identity001.obj is missing", "");
    write_obj(kit, "identity001", -0.25, faces);
    struct sim_ict_kit_report report;
    assert_int_equal(import(kit, &report, NULL), 0);
}

static void damaged_files_are_named(void **state)
{
    static const char *const bad_indices[][2] = {
        {"{\"expressions\": 3, \"idx_to_landmark_verts\": [7, 0, 3]}", "'expressions'"},
        {"{\"expressions\": [\"../x\"], \"idx_to_landmark_verts\": [7, 0, 3]}", "'expressions'"},
        {"{\"expressions\": [\"smile\"], \"idx_to_landmark_verts\": [7, 0]}", "3 vertices"},
        {"{\"expressions\": [\"smile\"], \"idx_to_landmark_verts\": [7, 0, 5]}", "3 vertices"},
        {"{\"expressions\": [\"smile\"], \"idx_to_landmark_verts\": [7, 0, 8]}", "3 vertices"},
        {"{\"expressions\":", "json:1: "},
    };
    const char *kit = *state;
    write_kit(kit);
    write_obj(kit, "smile", 2, "v 1 2\n");
    expect_fault(kit, -EBADMSG, "smile.obj:13: ", "not a vertex");
    assert_false(scratch_exists(scratch_path(kit, "out/expression.npy"))); /* no part of a file */
    write_obj(kit, "smile", 2, "v 1 2 3\n");
    expect_fault(kit, -EBADMSG, "smile.obj", "9 vertices where the kit has 8");
    write_obj(kit, "smile", 2, "f 1 2 9\n");
    expect_fault(kit, -EBADMSG, "smile.obj:13: ", "not a face");
    write_obj(kit, "smile", 2, "f 1 2\n");
    expect_fault(kit, -EBADMSG, "smile.obj:13: ", "not a face");
    write_obj(kit, "smile", 2, "v 1 2 nan\n");
    expect_fault(kit, -EBADMSG, "smile.obj:13: ", "not a vertex");
    for (size_t i = 0; i < sizeof bad_indices / sizeof *bad_indices; i++) {
        scratch_write_text(scratch_path(kit, "FaceXModel/vertex_indices.json"), bad_indices[i][0]);
        expect_fault(kit, -EBADMSG, "vertex_indices.json", bad_indices[i][1]);
    }
}

/* ---- the real kit ---- */

static const char *const sample_shapes[] = {"browDown_L", "jawOpen", "mouthStretch_L"};
static const char *const sample_files[] = {
    "generic_neutral_mesh.obj", "identity000.obj", "identity001.obj",   "identity002.obj",
    "browDown_L.obj",           "jawOpen.obj",     "mouthStretch_L.obj"};

/* A kit with only the sample's files. The index file names no other expressions. */
static void copy_sample(const char *kit, const char *sample)
{
    scratch_mkdir(scratch_path(kit, "FaceXModel"));
    for (size_t i = 0; i < sizeof sample_files / sizeof *sample_files; i++) {
        char to[128];
        (void)snprintf(to, sizeof to, "FaceXModel/%s", sample_files[i]);
        size_t size = 0;
        void *bytes = scratch_read(scratch_path(sample, to), &size);
        scratch_write(scratch_path(kit, to), bytes, size);
        free(bytes);
    }
    json_t *all = json_load_file(scratch_path(sample, "FaceXModel/vertex_indices.json"), 0, NULL);
    assert_non_null(all);
    json_t *names = json_pack("[s, s, s]", sample_shapes[0], sample_shapes[1], sample_shapes[2]);
    assert_int_equal(json_object_set_new(all, "expressions", names), 0);
    assert_int_equal(
        json_dump_file(all, scratch_path(kit, "FaceXModel/vertex_indices.json"), JSON_COMPACT), 0);
    json_decref(all);
}

/* Compares `n` bytes of two files, from these positions on. */
static void expect_same(const char *a, size_t at_a, const char *b, size_t at_b, size_t n)
{
    size_t size_a = 0, size_b = 0;
    char *bytes_a = scratch_read(a, &size_a), *bytes_b = scratch_read(b, &size_b);
    assert_true(at_a + n <= size_a && at_b + n <= size_b);
    assert_memory_equal(bytes_a + at_a, bytes_b + at_b, n);
    free(bytes_a);
    free(bytes_b);
}

static size_t line_of(const char *path, const char *name)
{
    char line[64];
    size_t n = 0;
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    while (fscanf(file, "%63s", line) == 1 && strcmp(line, name) != 0) {
        n++;
    }
    (void)fclose(file);
    return n;
}

/* The bytes equal those of the head model in data/ict-face. */
static void the_real_files_give_the_known_model(void **state)
{
    enum { HEADER = 128, MODE = 17202 * 3 * 2 };
    const char *kit = *state;
    const char *sample = shared_data("data/ict-facekit-sample"),
               *known = shared_data("data/ict-face");
    struct sim_ict_layout layout = sim_ict_kit_layout;
    struct sim_ict_kit_report report;
    struct iso_fault fault = {.text = ""};
    if (!scratch_exists(sample) || !scratch_exists(known)) {
        print_message("no sample of ICT-FaceKit, or no head model: %s, %s\n", sample, known);
        skip();
    }
    copy_sample(kit, sample);
    layout.n_identity = 3;
    if (sim_ict_import(kit, &layout, scratch_path(kit, "out"), &report, &fault)) {
        fail_msg("%s", fault.text);
    }
    expect_same(scratch_path(kit, "out/mean.npy"), 0, scratch_path(known, "mean.npy"), 0,
                HEADER + 17202 * 3 * 4);
    assert_int_equal(report.n_triangles, 34332);
    expect_same(scratch_path(kit, "out/triangles.npy"), 0, scratch_path(known, "triangles.npy"), 0,
                HEADER + 34332 * 3 * 4);
    expect_same(scratch_path(kit, "out/identity.npy"), HEADER, scratch_path(known, "identity.npy"),
                HEADER, 3 * MODE);
    for (size_t i = 0; i < 3; i++) {
        const size_t row = line_of(scratch_path(known, "expression_names.txt"), sample_shapes[i]);
        expect_same(scratch_path(kit, "out/expression.npy"), HEADER + i * MODE,
                    scratch_path(known, "expression.npy"), HEADER + row * MODE, MODE);
    }
    expect_same(scratch_path(kit, "out/landmarks68.txt"), 0, scratch_path(known, "landmarks68.txt"),
                0, 332);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, scratch_setup, scratch_teardown)
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_half_survives),
        TEST(a_kit_becomes_a_head_model),
        TEST(missing_files_are_named),
        TEST(damaged_files_are_named),
        TEST(the_real_files_give_the_known_model),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* Crops of stored frames as a corpus of shapes. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "sim/shapes/make/crops.h"
#include "sim/shapes/make/manifest.h"
#include "sim/shapes/mesh/mesh_file.h"
#include "tests/support/scratch.h"
#include "tests/support/stored_corpus.h"

static const char rows[] = STORED_CORPUS_HEADER "p01-v1,1,1,p01,s3,probe,,,\n"
                                                "x01-v1,0,1,none,s1,impostor,,,wall\n"
                                                "p02-v1,0,2,p02,s5,probe,,,\n";

static int setup(void **state)
{
    int error = scratch_setup(state);
    if (!error) {
        const char *directory = scratch_path(*state, "corpus");
        scratch_mkdir(directory);
        stored_corpus_make(directory, rows);
    }
    return error;
}

static void cut(const char *directory, size_t n_rows, int32_t expected)
{
    struct sim_crops_options options = {
        .corpora = {1, {scratch_path(directory, "corpus")}},
        .out = scratch_path(directory, "crops"),
        .rows = n_rows,
    };
    struct iso_fault fault = {.text = ""};
    int32_t n = -1, n_empty = -1;
    if (sim_crops_write(&options, &n, &n_empty, &fault)) {
        fail_msg("%s", fault.text);
    }
    assert_int_equal(n, expected);
    assert_int_equal(n_empty, 0);
}

/* Asserts that a crop is a piece of at most 200 mm (a little more where the surface is slanted). */
static void check_crop(const char *path)
{
    struct iso_coloured_mesh crop;
    struct iso_fault fault = {.text = ""};
    struct iso_vec3 low = {INFINITY, INFINITY, INFINITY}, high = {-INFINITY, -INFINITY, -INFINITY};
    assert_int_equal(iso_mesh_file_read(path, &crop, &fault), 0);
    for (int32_t i = 0; i < crop.mesh->n_vertices; i++) {
        struct iso_vec3 p = crop.mesh->vertices_mm[i];
        low = iso_vec3(fmin(low.x, p.x), fmin(low.y, p.y), fmin(low.z, p.z));
        high = iso_vec3(fmax(high.x, p.x), fmax(high.y, p.y), fmax(high.z, p.z));
    }
    print_message("%d vertices, %.0f x %.0f x %.0f mm\n", crop.mesh->n_vertices, high.x - low.x,
                  high.y - low.y, high.z - low.z);
    assert_in_range(crop.mesh->n_vertices, 500, 4000);
    assert_true(high.x - low.x > 60.0 && high.x - low.x < 240.0);
    assert_true(high.y - low.y > 60.0 && high.y - low.y < 240.0);
    assert_true(high.z < -200.0); /* z points towards the sensor */
    iso_coloured_mesh_done(&crop);
}

static void crops_are_a_corpus_of_shapes(void **state)
{
    struct sim_shape_manifest *manifest = NULL;
    struct iso_fault fault = {.text = ""};
    cut(*state, 0, 3);
    const char *crops = scratch_path(*state, "crops");
    assert_int_equal(sim_shape_manifest_read(crops, &manifest, &fault), 0);
    assert_int_equal(manifest->n, 3);
    assert_int_equal(manifest->n_classes, 2);
    assert_string_equal(manifest->rows[0].file, "0-p01-v1-1.off");
    assert_string_equal(manifest->rows[0].class_name, "face");
    assert_string_equal(manifest->rows[1].class_name, "not-face");
    assert_string_equal(manifest->rows[2].class_name, "face");
    for (int32_t i = 0; i < manifest->n; i++) {
        check_crop(scratch_path(crops, manifest->rows[i].file));
    }
    sim_shape_manifest_free(manifest);
    cut(*state, 2, 2); /* the first and the second, at 0 and 3/2 */
}

static void missing_corpora_are_named(void **state)
{
    struct sim_crops_options options = {.out = scratch_path(*state, "none")};
    struct iso_fault fault = {.text = ""};
    int32_t n = -1, n_empty = -1;
    assert_int_equal(sim_crops_write(&options, &n, &n_empty, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "corpora"));
    options.corpora.n = 1;
    options.corpora.text[0] = scratch_path(*state, "nowhere");
    assert_int_equal(sim_crops_write(&options, &n, &n_empty, &fault), -ENOENT);
    assert_non_null(strstr(fault.text, "nowhere"));
    assert_int_equal(n, -1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(crops_are_a_corpus_of_shapes, setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(missing_corpora_are_named, setup, scratch_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

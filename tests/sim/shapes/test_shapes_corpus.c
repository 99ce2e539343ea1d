/* Folders of one's own: without a manifest, with bad meshes, a second time, and indexed. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "sim/shapes/describe/cache.h"
#include "sim/shapes/describe/corpus.h"
#include "sim/shapes/describe/description_file.h"
#include "sim/shapes/make/generate.h"
#include "sim/shapes/make/thin.h"
#include "sim/shapes/search/query.h"
#include "sim/shapes/study/study.h"
#include "tests/support/near.h"
#include "tests/support/scratch.h"

/* Three men and three dogs of 400 vertices, each kind in a folder of its own below `directory`. */
static void make_folders(const char *directory)
{
    const char *flat = scratch_path(directory, "flat"), *all = scratch_path(directory, "all");
    const struct sim_shapes_options options = {.preset = "plain",
                                               .out = flat,
                                               .seed = 3,
                                               .classes = 3,
                                               .shapes = 9,
                                               .vertices = 400,
                                               .threads = 2};
    struct iso_fault fault = {.text = ""};
    static const char *const kinds[] = {"man", "dog"};
    int32_t n = 0;
    if (sim_shapes_generate(&options, &n, &fault)) {
        fail_msg("%s", fault.text);
    }
    scratch_mkdir(all);
    for (size_t k = 0; k < 2; k++) {
        scratch_mkdir(scratch_path(all, kinds[k]));
        for (int i = 1; i <= 3; i++) {
            char name[64];
            (void)snprintf(name, sizeof name, "%s-%02d.off", kinds[k], i);
            assert_int_equal(
                rename(scratch_path(flat, name), scratch_path(scratch_path(all, kinds[k]), name)),
                0);
        }
    }
}

static void folders_are_classes(void **state)
{
    struct sim_shape_manifest *manifest = NULL;
    struct iso_fault fault = {.text = ""};
    static const char *const files[] = {"a.OFF",         "b/x.XYZ",       "b/c/y.stl",
                                        "b/c/notes.txt", "b/.hidden.off", "z.obj"};
    const char *top = scratch_path(*state, "top");
    scratch_mkdir(top);
    scratch_mkdir(scratch_path(top, "b"));
    scratch_mkdir(scratch_path(top, "b/c"));
    scratch_mkdir(scratch_path(top, "empty"));
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        scratch_write_text(scratch_path(top, files[i]), "");
    }
    assert_int_equal(sim_shape_manifest_read(top, &manifest, &fault), 0);
    assert_int_equal(manifest->n, 4);
    assert_int_equal(manifest->n_classes, 3);
    assert_int_equal(manifest->n_wider, 2);
    assert_string_equal(manifest->rows[0].file, "a.OFF");
    assert_string_equal(manifest->rows[0].class_name, "top");
    assert_string_equal(manifest->rows[1].file, "b/c/y.stl");
    assert_string_equal(manifest->rows[1].class_name, "b/c");
    assert_string_equal(manifest->rows[2].class_name, "b");
    assert_int_equal(manifest->wider_of[1], manifest->wider_of[2]);
    assert_int_equal(manifest->class_of[3], manifest->class_of[0]);
    const uint8_t keep[] = {0, 1, 0, 1};
    sim_shape_manifest_keep(manifest, keep);
    assert_int_equal(manifest->n, 2);
    assert_int_equal(manifest->n_classes, 2);
    assert_string_equal(manifest->class_name[1], "top");
    sim_shape_manifest_free(manifest);
    manifest = NULL;
    assert_int_equal(sim_shape_manifest_read(scratch_path(top, "empty"), &manifest, &fault),
                     -ENOENT);
    assert_non_null(strstr(fault.text, "no manifest.csv, and no mesh or cloud"));
    assert_int_equal(sim_shape_manifest_read(scratch_path(top, "none"), &manifest, &fault),
                     -ENOENT);
    assert_null(manifest);
}

static int run(struct sim_shapes_study_options *options, char **printed, struct iso_fault *fault)
{
    size_t size;
    FILE *out = open_memstream(printed, &size);
    const int error = sim_shapes_study(options, out, fault);
    (void)fclose(out);
    return error;
}

/* A bad mesh is left out; with `strict` it ends the study. A second run finds the descriptions of
 * the first one and measures the same; a mesh that changed is described again. */
static void a_bad_mesh_is_left_out_and_a_second_run_is_cached(void **state)
{
    make_folders(*state);
    const char *all = scratch_path(*state, "all"), *out = scratch_path(*state, "deep/er/out");
    struct sim_shapes_study_options options = {.corpus = all,
                                               .out = out,
                                               .methods = {2, {"cp-hk-plain,cp-hk", "shape-dna"}},
                                               .classifiers = {2, {"nn-l1", "nn-l2"}},
                                               .seed = 1,
                                               .threads = 2};
    struct iso_fault fault = {.text = ""};
    char *printed = NULL;
    scratch_write_text(scratch_path(all, "dog/bad.off"), "OFF\n5 1 0\n0 0 0\n");
    if (run(&options, &printed, &fault)) {
        fail_msg("%s", fault.text);
    }
    assert_non_null(strstr(printed, "6 shapes of 2 classes"));
    assert_non_null(strstr(printed, "0 of 18 descriptions were in the cache"));
    free(printed);
    char *meshes = scratch_read_text(scratch_path(out, "meshes.csv"));
    assert_non_null(strstr(meshes, "\ndog/bad.off,dog,left out,"));
    assert_non_null(strstr(meshes, "\nman/man-02.off,man,used,400,796,1,0,0,0,0,0,0\n"));
    free(meshes);
    char *first = scratch_read_text(scratch_path(out, "cp-hk-nn-l2/distances.csv"));
    assert_int_equal(run(&options, &printed, &fault), 0);
    assert_non_null(strstr(printed, "18 of 18 descriptions were in the cache"));
    free(printed);
    char *second = scratch_read_text(scratch_path(out, "cp-hk-nn-l2/distances.csv"));
    assert_string_equal(first, second);
    free(second);
    options.cache = ""; /* what is described anew is the same */
    assert_int_equal(run(&options, &printed, &fault), 0);
    assert_non_null(strstr(printed, "0 of 18 descriptions were in the cache"));
    free(printed);
    second = scratch_read_text(scratch_path(out, "cp-hk-nn-l2/distances.csv"));
    assert_string_equal(first, second);
    free(second);
    free(first);
    options.cache = NULL;
    options.smooth = 1; /* other shapes */
    assert_int_equal(run(&options, &printed, &fault), 0);
    assert_non_null(strstr(printed, "0 of 18 descriptions were in the cache"));
    free(printed);
    options.strict = true;
    assert_int_equal(run(&options, &printed, &fault), -EBADMSG);
    assert_non_null(strstr(fault.text, "bad.off: ends within the vertices"));
    free(printed);
}

static void one_class_is_refused_at_once(void **state)
{
    make_folders(*state);
    struct sim_shapes_study_options options = {.corpus = scratch_path(*state, "all/dog"),
                                               .out = scratch_path(*state, "out"),
                                               .seed = 1,
                                               .threads = 1};
    struct iso_fault fault = {.text = ""};
    char *printed = NULL;
    assert_int_equal(run(&options, &printed, &fault), -ENODATA);
    assert_non_null(strstr(fault.text, "all 3 shapes are of one class, 'dog'"));
    assert_false(scratch_exists(options.out));
    free(printed);
    assert_int_equal(unlink(scratch_path(*state, "all/dog/dog-01.off")), 0);
    assert_int_equal(unlink(scratch_path(*state, "all/dog/dog-02.off")), 0);
    assert_int_equal(run(&options, &printed, &fault), -ENODATA);
    assert_non_null(strstr(fault.text, "one shape; nothing can be retrieved"));
    free(printed);
    options.methods = (struct sim_option_texts){1, {"runes"}};
    assert_int_equal(run(&options, &printed, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "'runes' is unknown; known: shape-dna, td, cp-td"));
    free(printed);
}

static void descriptions_come_back(void **state)
{
    float local[] = {1.5f, -2.0f, 3.25f, 0.0f, 7.0f, -0.125f}, weight[] = {0.25f, 0.75f},
          whole[] = {9.0f, 8.0f, 7.5f};
    const struct iso_shape_description given = {.n_bags = 1,
                                                .n_points = 2,
                                                .n_values = 3,
                                                .local = local,
                                                .weight = weight,
                                                .n_parts = 2,
                                                .part_size = {1, 2},
                                                .whole = whole};
    struct iso_shape_description *back = NULL;
    struct iso_fault fault = {.text = ""};
    int32_t n_vertices = 0;
    size_t size = 0;
    const char *path = scratch_path(*state, "x.description");
    assert_int_equal(sim_description_write(*state, "x.description", 77, &given, &fault), 0);
    assert_int_equal(sim_description_read(path, &n_vertices, &back, &fault), 0);
    assert_int_equal(n_vertices, 77);
    assert_int_equal(back->n_points, 2);
    assert_memory_equal(back->part_size, given.part_size, sizeof given.part_size);
    assert_memory_equal(back->local, local, sizeof local);
    assert_memory_equal(back->weight, weight, sizeof weight);
    assert_memory_equal(back->whole, whole, sizeof whole);
    iso_shape_description_free(back);
    back = NULL;
    uint8_t *bytes = scratch_read(path, &size);
    for (size_t i = 0; i < size; i++) { /* every damaged byte is noticed, and every missing one */
        bytes[i] ^= 0x10;
        scratch_write(path, bytes, size);
        assert_int_equal(sim_description_read(path, &n_vertices, &back, &fault), -EBADMSG);
        bytes[i] ^= 0x10;
        scratch_write(path, bytes, i);
        assert_int_equal(sim_description_read(path, &n_vertices, &back, &fault), -EBADMSG);
    }
    free(bytes);
    assert_null(back);
}

/* Nothing that a description depends on is missing from its key. */
static void keys_differ(void **state)
{
    const struct sim_distortion noise = {SIM_DISTORTION_WHITE, 2};
    const struct sim_source_options plain = {.seed = 1}, thinned = {.vertices = 9},
                                    smooth = {.smooth = 2}, wide = {.neighbours = 40},
                                    noisy = {.distortion = &noise, .seed = 1},
                                    noisier = {.distortion = &noise, .seed = 2};
    const struct sim_cache_subject subjects[] = {
        {{1}, "a", &plain, 0, false, {0}},         {{2}, "a", &plain, 0, false, {0}},
        {{1}, "a", &thinned, 0, false, {0}},       {{1}, "a", &smooth, 0, false, {0}},
        {{1}, "a", &noisy, 0, false, {0}},         {{1}, "a", &noisier, 0, false, {0}},
        {{1}, "b", &noisy, 0, false, {0}},         {{1}, "a", &plain, 50, false, {0}},
        {{1}, "a", &plain, 0, true, {0}},          {{1}, "a", &wide, 0, false, {0}},
        {{1}, "a", &plain, 0, false, {64, 0, 0}},  {{1}, "a", &plain, 0, false, {0, 0.1, 0}},
        {{1}, "a", &plain, 0, false, {0, 0, 0.1}},
    };
    enum { N = sizeof subjects / sizeof *subjects };
    char name[N + 1][SIM_CACHE_NAME_SIZE], other[SIM_CACHE_NAME_SIZE];
    (void)state;
    for (int i = 0; i < N; i++) {
        sim_cache_name(&subjects[i], iso_shape_method_find("td"), name[i]);
    }
    sim_cache_name(&subjects[0], iso_shape_method_find("cp-td"), name[N]);
    for (int i = 0; i <= N; i++) {
        for (int j = 0; j < i; j++) {
            assert_string_not_equal(name[i], name[j]);
        }
    }
    /* Without a distortion neither the file's name nor the seed matters. */
    const struct sim_source_options seeded = {.seed = 5};
    const struct sim_cache_subject renamed = {{1}, "b", &seeded, 0, false, {0}};
    sim_cache_name(&renamed, iso_shape_method_find("td"), other);
    assert_string_equal(other, name[0]);
}

/* The pole of a globe has 90 triangles. */
static void a_vertex_of_many_triangles_is_thinned(void **state)
{
    enum { AROUND = 90, RINGS = 11 };
    struct iso_coloured_mesh globe = {NULL, NULL};
    (void)state;
    assert_int_equal(iso_mesh_new(2 + RINGS * AROUND, 2 * RINGS * AROUND, &globe.mesh), 0);
    struct iso_mesh *mesh = globe.mesh;
    mesh->vertices_mm[mesh->n_vertices++] = iso_vec3(0, 0, 10);
    mesh->vertices_mm[mesh->n_vertices++] = iso_vec3(0, 0, -10);
    for (int i = 0; i < RINGS; i++) {
        const double theta = M_PI * (i + 1.0) / (RINGS + 1.0);
        for (int j = 0; j < AROUND; j++) {
            const double phi = 2.0 * M_PI * j / AROUND;
            mesh->vertices_mm[mesh->n_vertices++] = iso_vec3(
                10 * sin(theta) * cos(phi), 10 * sin(theta) * sin(phi), 10 * cos(theta));
        }
    }
    for (int j = 0; j < AROUND; j++) {
        const int next = (j + 1) % AROUND, last = 2 + (RINGS - 1) * AROUND;
        const int32_t caps[2][3] = {{0, 2 + j, 2 + next}, {1, last + next, last + j}};
        memcpy(mesh->triangles[mesh->n_triangles++], caps[0], sizeof caps[0]);
        memcpy(mesh->triangles[mesh->n_triangles++], caps[1], sizeof caps[1]);
        for (int i = 0; i + 1 < RINGS; i++) {
            const int32_t a = 2 + i * AROUND + j, b = 2 + i * AROUND + next;
            const int32_t pair[2][3] = {{a, a + AROUND, b}, {b, a + AROUND, b + AROUND}};
            memcpy(mesh->triangles[mesh->n_triangles++], pair[0], sizeof pair[0]);
            memcpy(mesh->triangles[mesh->n_triangles++], pair[1], sizeof pair[1]);
        }
    }
    assert_int_equal(sim_thin(&globe, 300), 0);
    assert_int_equal(mesh->n_vertices, 300);
    assert_int_equal(mesh->n_triangles, 2 * 300 - 4); /* still a closed surface (Euler) */
    assert_near(iso_mesh_area(mesh) / (4.0 * M_PI * 100.0), 1.0, 0.05);
    iso_coloured_mesh_done(&globe);
}

static void an_index_is_searched(void **state)
{
    make_folders(*state);
    const char *all = scratch_path(*state, "all"), *out = scratch_path(*state, "a/index");
    static const char *const methods[] = {"cp-hk", "srcp-td", "shape-google"};
    struct iso_fault fault = {.text = ""};
    const char *query = scratch_path(*state, "other-name.off");
    assert_int_equal(rename(scratch_path(all, "dog/dog-02.off"), query), 0);
    for (size_t m = 0; m < 3; m++) {
        const struct sim_index_options make = {
            .corpus = all, .out = out, .method = methods[m], .threads = 2};
        const struct sim_query_options ask = {.meshes = {1, {query}},
                                              .index = out,
                                              .out = scratch_path(*state, "answers"),
                                              .matches = 3};
        char *printed = NULL;
        size_t size;
        FILE *stream = open_memstream(&printed, &size);
        if (sim_shapes_index(&make, stream, &fault) || sim_shapes_query(&ask, stream, &fault)) {
            fail_msg("%s", fault.text);
        }
        (void)fclose(stream);
        assert_non_null(strstr(printed, "5 shapes by "));
        free(printed);
        char *csv = scratch_read_text(scratch_path(*state, "answers/other-name.csv"));
        double first = 0.0, second = 0.0;
        char rest[3][64] = {""};
        assert_int_equal(sscanf(csv, "rank,distance,file,class\n1,%lf,%63s\n2,%lf,%63s\n3,%*f,%63s",
                                &first, rest[0], &second, rest[1], rest[2]),
                         5);
        assert_true(first > 0.0 && first <= second);
        assert_non_null(strstr(rest[0], ",dog"));
        assert_non_null(strstr(rest[1], ",dog"));
        assert_non_null(strstr(rest[2], ",man"));
        free(csv);
        assert_true(scratch_exists(scratch_path(*state, "answers/other-name.png")));
    }
}

static void a_damaged_index_is_refused(void **state)
{
    make_folders(*state);
    const char *out = scratch_path(*state, "index");
    struct sim_index_options make = {
        .corpus = scratch_path(*state, "all"), .out = out, .method = "shape-dna", .threads = 2};
    struct sim_index *index = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(sim_index_open(out, &index, &fault), -ENOENT);
    assert_int_equal(sim_shapes_index(&make, stderr, &fault), 0);
    assert_int_equal(sim_index_open(out, &index, &fault), 0);
    assert_int_equal(index->n, 6);
    assert_string_equal(index->class_name[0], "dog");
    sim_index_close(index);
    index = NULL;
    scratch_write_text(scratch_path(out, "3.description"), "isoshp01 but no more");
    assert_int_equal(sim_index_open(out, &index, &fault), -EBADMSG);
    assert_non_null(strstr(fault.text, "3.description: damaged"));
    scratch_write_text(scratch_path(out, "index.json"), "{\"format\": \"a song\"}");
    assert_int_equal(sim_index_open(out, &index, &fault), -EBADMSG);
    assert_non_null(strstr(fault.text, "no index of shapes"));
    assert_null(index);
    make.method = "runes";
    assert_int_equal(sim_shapes_index(&make, stderr, &fault), -EINVAL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(folders_are_classes, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(a_bad_mesh_is_left_out_and_a_second_run_is_cached,
                                        scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(one_class_is_refused_at_once, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(descriptions_come_back, scratch_setup, scratch_teardown),
        cmocka_unit_test(keys_differ),
        cmocka_unit_test(a_vertex_of_many_triangles_is_thinned),
        cmocka_unit_test_setup_teardown(an_index_is_searched, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(a_damaged_index_is_refused, scratch_setup,
                                        scratch_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

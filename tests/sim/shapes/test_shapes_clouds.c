/* Clouds of points, alone and beside meshes: in a folder that is studied or indexed, as a query,
 * and on either side of a match. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "sim/shapes/make/generate.h"
#include "sim/shapes/match/match.h"
#include "sim/shapes/mesh/mesh_file.h"
#include "sim/shapes/search/query.h"
#include "sim/shapes/study/study.h"
#include "tests/sim/shapes/creatures.h"
#include "tests/support/scratch.h"

enum { POINTS = 800, APART = 160, NEIGHBOURS = 12 };

static const char *const kinds[] = {"man", "dog", "horse"};

/* Writes the vertices of a mesh as points, in their order, and the first `n_apart` of them once
 * more, smaller and far away. */
static void write_cloud(const char *mesh_path, const char *cloud_path, int32_t n_apart)
{
    struct iso_coloured_mesh mesh = {NULL, NULL};
    struct iso_fault fault = {.text = ""};
    if (iso_mesh_file_read(mesh_path, &mesh, &fault)) {
        fail_msg("%s", fault.text);
    }
    FILE *out = fopen(cloud_path, "we");
    assert_non_null(out);
    for (int32_t i = 0; i < mesh.mesh->n_vertices + n_apart; i++) {
        const bool apart = i >= mesh.mesh->n_vertices;
        const struct iso_vec3 *p = &mesh.mesh->vertices_mm[i % mesh.mesh->n_vertices];
        const double scale = apart ? 0.2 : 1.0, shift = apart ? 1e4 : 0.0;
        fprintf(out, "%.9g %.9g %.9g\n", scale * p->x + shift, scale * p->y, scale * p->z);
    }
    assert_int_equal(fclose(out), 0);
    iso_coloured_mesh_done(&mesh);
}

/* Once for all tests: three bodies of each kind in `flat`, with their places on the body at rest.
 */
static int make_bodies(void **state)
{
    const int error = scratch_setup(state);
    if (error) {
        return error;
    }
    const struct sim_shapes_options options = {.preset = "plain",
                                               .out = scratch_path(*state, "flat"),
                                               .seed = 1,
                                               .classes = 4,
                                               .shapes = 12,
                                               .vertices = POINTS,
                                               .rest = true,
                                               .threads = 2};
    struct iso_fault fault = {.text = ""};
    int32_t n = 0;
    return sim_shapes_generate(&options, &n, &fault);
}

/* A folder for each kind below `all`, with a mesh and two clouds. */
static void make_folders(const char *flat, const char *all)
{
    scratch_mkdir(all);
    for (size_t k = 0; k < 3; k++) {
        const char *folder = scratch_path(all, kinds[k]);
        scratch_mkdir(folder);
        for (int i = 1; i <= 3; i++) {
            char off[64], xyz[64];
            (void)snprintf(off, sizeof off, "%s-%02d.off", kinds[k], i);
            (void)snprintf(xyz, sizeof xyz, "%s-%02d.xyz", kinds[k], i);
            if (i == 1) {
                char *mesh = scratch_read_text(scratch_path(flat, off));
                scratch_write_text(scratch_path(folder, off), mesh);
                free(mesh);
            } else {
                write_cloud(scratch_path(flat, off), scratch_path(folder, xyz), 0);
            }
        }
    }
}

static int run(const struct sim_shapes_study_options *options, char **printed,
               struct iso_fault *fault)
{
    size_t size;
    free(*printed);
    FILE *out = open_memstream(printed, &size);
    const int error = sim_shapes_study(options, out, fault);
    (void)fclose(out);
    return error;
}

static void expect_text(const char *directory, const char *name, const char *text)
{
    char *read = scratch_read_text(scratch_path(directory, name));
    if (!strstr(read, text)) {
        fail_msg("%s lacks '%s': %s", name, text, read);
    }
    free(read);
}

/* Every body finds its kind first, mesh or cloud. Of two bad clouds each is named and left out. */
static void clouds_are_studied_beside_meshes(void **state)
{
    const char *all = scratch_path(*state, "studied"), *out = scratch_path(*state, "out");
    make_folders(scratch_path(*state, "flat"), all);
    struct sim_shapes_study_options options = {.corpus = all,
                                               .out = out,
                                               .methods = {1, {"cp-hk"}},
                                               .classifiers = {1, {"nn-l1"}},
                                               .seed = 1,
                                               .pictures = 2,
                                               .neighbours = NEIGHBOURS,
                                               .threads = 2};
    struct iso_fault fault = {.text = ""};
    char *printed = NULL;
    scratch_write_text(scratch_path(all, "dog/bad.xyz"), "1 2 3\n4 5\n");
    write_cloud(scratch_path(*state, "flat/dog-02.off"), scratch_path(all, "dog/torn.xyz"), APART);
    if (run(&options, &printed, &fault)) {
        fail_msg("%s", fault.text);
    }
    assert_non_null(strstr(printed, "9 shapes of 3 classes, 800 vertices in the mean"));
    expect_text(out, "measures.csv", "\ncp-hk,nn-l1,9,1.000000,1.000000,");
    expect_text(out, "meshes.csv", "\ndog/bad.xyz,dog,left out,");
    expect_text(out, "meshes.csv", "\ndog/torn.xyz,dog,left out,");
    expect_text(out, "meshes.csv", "\nman/man-02.xyz,man,used,800,0,1,0,0,0,0,0,0\n");
    expect_text(out, "meshes.csv", "\nman/man-01.off,man,used,800,1596,1,0,0,0,0,0,0\n");
    assert_true(scratch_exists(scratch_path(out, "cp-hk-nn-l1/matches.png")));
    assert_int_equal(run(&options, &printed, &fault), 0);
    assert_non_null(strstr(printed, "9 of 9 descriptions were in the cache"));
    options.neighbours = NEIGHBOURS + 1; /* other matrices */
    assert_int_equal(run(&options, &printed, &fault), 0);
    assert_non_null(strstr(printed, "0 of 9 descriptions were in the cache"));
    options.neighbours = NEIGHBOURS;
    options.mend = true;
    assert_int_equal(run(&options, &printed, &fault), 0);
    assert_non_null(strstr(printed, "10 shapes of 3 classes"));
    expect_text(out, "meshes.csv", "\ndog/torn.xyz,dog,used,800,0,");
    expect_text(out, "meshes.csv", ",160,0.166667,0,0,0,0\n");
    options.mend = false;
    options.strict = true;
    assert_int_equal(run(&options, &printed, &fault), -EBADMSG);
    assert_non_null(strstr(fault.text, "dog/bad.xyz:2: 2 numbers of a point"));
    assert_int_equal(unlink(scratch_path(all, "dog/bad.xyz")), 0);
    assert_int_equal(run(&options, &printed, &fault), -EBADMSG);
    assert_non_null(strstr(fault.text, "dog/torn.xyz: 160 of its 960 points are not joined"));
    options.neighbours = 5;
    assert_int_equal(run(&options, &printed, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "--neighbours: 5 is not in 6..200"));
    free(printed);
}

/* A cloud is not distorted, thinned or smoothed: it is left out, or ends the study. */
static void clouds_are_not_changed(void **state)
{
    const char *all = scratch_path(*state, "unchanged"), *out = scratch_path(*state, "out-2");
    make_folders(scratch_path(*state, "flat"), all);
    struct sim_shapes_study_options options = {.corpus = all,
                                               .out = out,
                                               .methods = {1, {"td"}},
                                               .classifiers = {1, {"nn-l1"}},
                                               .seed = 1,
                                               .neighbours = NEIGHBOURS,
                                               .cache = "",
                                               .distortion = {SIM_DISTORTION_WHITE, 1},
                                               .threads = 2};
    struct iso_fault fault = {.text = ""};
    char *printed = NULL;
    if (run(&options, &printed, &fault)) {
        fail_msg("%s", fault.text);
    }
    assert_non_null(strstr(printed, "9 shapes of 3 classes"));
    expect_text(out, "measures.csv", "\ntd,nn-l1,3,");
    options.strict = true;
    options.threads = 1;
    assert_int_equal(run(&options, &printed, &fault), -ENOTSUP);
    assert_non_null(strstr(fault.text, "a cloud of points, which cannot be distorted"));
    options.distortion.level = 0;
    options.vertices = 500;
    assert_int_equal(run(&options, &printed, &fault), -ENOTSUP);
    assert_non_null(strstr(fault.text, "a cloud of points, which cannot be thinned"));
    free(printed);
}

static int ask(const struct sim_query_options *options, char **printed, struct iso_fault *fault)
{
    size_t size;
    free(*printed);
    FILE *out = open_memstream(printed, &size);
    const int error = sim_shapes_query(options, out, fault);
    (void)fclose(out);
    return error;
}

/* A cloud and a mesh find their kind in an index of clouds and meshes. */
static void clouds_are_looked_for(void **state)
{
    const char *all = scratch_path(*state, "all"), *index = scratch_path(*state, "all.index");
    make_folders(scratch_path(*state, "flat"), all);
    const char *cloud = scratch_path(*state, "cloud.xyz"), *mesh = scratch_path(*state, "mesh.off"),
               *torn = scratch_path(*state, "torn.xyz");
    struct sim_index_options make = {
        .corpus = all, .method = "cp-hk", .neighbours = NEIGHBOURS, .threads = 2};
    struct sim_query_options query = {.meshes = {2, {cloud, mesh}},
                                      .index = index,
                                      .out = scratch_path(*state, "answers"),
                                      .matches = 3};
    struct iso_fault fault = {.text = ""};
    char *printed = NULL;
    assert_int_equal(rename(scratch_path(all, "dog/dog-02.xyz"), cloud), 0);
    assert_int_equal(rename(scratch_path(all, "man/man-01.off"), mesh), 0);
    write_cloud(scratch_path(*state, "flat/dog-02.off"), torn, APART);
    if (sim_shapes_index(&make, stderr, &fault) || ask(&query, &printed, &fault)) {
        fail_msg("%s", fault.text);
    }
    expect_text(*state, "all.index/index.json", "\"neighbours\": 12");
    expect_text(*state, "answers/cloud.csv", ",dog\n2,");
    expect_text(*state, "answers/mesh.csv", ",man\n2,");
    assert_true(scratch_exists(scratch_path(*state, "answers/cloud.png")));
    query.meshes = (struct sim_option_texts){1, {torn}};
    assert_int_equal(ask(&query, &printed, &fault), -EBADMSG);
    assert_non_null(strstr(fault.text, "torn.xyz: 160 of its 960 points are not joined"));
    make.mend = true;
    assert_int_equal(sim_shapes_index(&make, stderr, &fault), 0);
    assert_int_equal(ask(&query, &printed, &fault), 0);
    assert_non_null(strstr(printed, "torn.xyz, by cp-hk; 160 points left out:\n"));
    expect_text(*state, "answers/torn.csv", ",dog\n2,");

    char *list = scratch_read_text(scratch_path(index, "index.json"));
    char *number = strstr(list, "\"neighbours\": 12");
    number[strlen("\"neighbours\": ")] = ' ';
    number[strlen("\"neighbours\": 1")] = '5';
    scratch_write_text(scratch_path(index, "index.json"), list);
    assert_int_equal(ask(&query, &printed, &fault), -EBADMSG);
    assert_non_null(strstr(fault.text, "index.json: no index of shapes"));
    free(list);
    make.neighbours = 201;
    assert_int_equal(sim_shapes_index(&make, stderr, &fault), -EINVAL);
    free(printed);
}

/* The points of a cloud keep the order of the mesh that they were taken from, whose places on the
 * body at rest are the truth. */
static void clouds_are_matched(void **state)
{
    const char *flat = scratch_path(*state, "flat"), *out = scratch_path(*state, "out-3");
    const char *mesh = scratch_path(flat, "gorilla-02.off"),
               *cloud = scratch_path(flat, "gorilla-02.xyz"),
               *other = scratch_path(flat, "gorilla-03.xyz"),
               *torn = scratch_path(*state, "torn.xyz");
    write_cloud(mesh, cloud, 0);
    write_cloud(scratch_path(flat, "gorilla-03.off"), other, 0);
    write_cloud(mesh, torn, APART);
    struct sim_match_options options = {.meshes = {2, {cloud, cloud}},
                                        .out = out,
                                        .pairs = 60,
                                        .first_pairs = 20,
                                        .step = 5,
                                        .weight = 0.01,
                                        .neighbours = NEIGHBOURS};
    assert_true(match_error(&options, NULL) < 1e-9);
    options.meshes.text[1] = mesh;
    assert_true(match_error(&options, NULL) < 0.05);
    expect_text(out, "match.json", "\"to_cloud\": null");
    options.meshes.text[0] = mesh;
    options.meshes.text[1] = cloud;
    assert_true(match_error(&options, NULL) < 0.05);
    expect_text(out, "match.json", "\"from_cloud\": null");
    options.meshes.text[0] = cloud;
    options.meshes.text[1] = other;
    assert_true(match_error(&options, NULL) < 0.15);
    assert_true(scratch_exists(scratch_path(out, "match.png")));

    struct iso_fault fault = {.text = ""};
    options.meshes.text[1] = torn;
    assert_int_equal(sim_shapes_match(&options, stderr, &fault), -EBADMSG);
    assert_non_null(strstr(fault.text, "torn.xyz: 160 of its 960 points are not joined"));
    options.mend = true;
    if (sim_shapes_match(&options, stderr, &fault)) {
        fail_msg("%s", fault.text);
    }
    expect_text(out, "match.json", "\"points_left_out\": 160,\n    \"neighbours\": 12");
    options.neighbours = 5;
    assert_int_equal(sim_shapes_match(&options, stderr, &fault), -EINVAL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(clouds_are_studied_beside_meshes),
        cmocka_unit_test(clouds_are_not_changed),
        cmocka_unit_test(clouds_are_looked_for),
        cmocka_unit_test(clouds_are_matched),
    };
    return cmocka_run_group_tests(tests, make_bodies, scratch_teardown);
}

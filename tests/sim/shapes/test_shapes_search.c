/* Shapes that are looked for in an index: one of which a part is missing, and by other times of
 * heat. */
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

#include "sim/shapes/make/distort.h"
#include "sim/shapes/make/generate.h"
#include "sim/shapes/make/manifest.h"
#include "sim/shapes/mesh/mesh_writer.h"
#include "sim/shapes/search/query.h"
#include "tests/sim/shapes/creatures.h"
#include "tests/support/scratch.h"

enum { KINDS = 6, SHAPES = 18, QUERIES = 6, PER_KIND = SHAPES / KINDS };

static void make_index(const struct sim_index_options *options)
{
    struct iso_fault fault = {.text = ""};
    char *printed = NULL;
    size_t size;
    FILE *out = open_memstream(&printed, &size);
    const int error = sim_shapes_index(options, out, &fault);
    (void)fclose(out);
    free(printed);
    if (error) {
        fail_msg("%s", fault.text);
    }
}

static void ask(const struct sim_query_options *options)
{
    struct iso_fault fault = {.text = ""};
    char *printed = NULL;
    size_t size;
    FILE *out = open_memstream(&printed, &size);
    const int error = sim_shapes_query(options, out, &fault);
    (void)fclose(out);
    free(printed);
    if (error) {
        fail_msg("%s", fault.text);
    }
}

/* Writes a mesh of which a fifth is cut away. */
static void cut(const char *from, const char *to, uint64_t seed)
{
    const struct sim_distortion fifth = {SIM_DISTORTION_MISSING, 3};
    struct iso_coloured_mesh mesh = {NULL, NULL};
    struct iso_fault fault = {.text = ""};
    struct sim_random random = sim_random_seeded(seed, 0, 0);
    assert_int_equal(iso_mesh_file_read(from, &mesh, &fault), 0);
    const double area = iso_mesh_area(mesh.mesh);
    assert_int_equal(sim_distort(fifth, &random, &mesh), 0);
    assert_true(iso_mesh_area(mesh.mesh) < 0.82 * area);
    assert_int_equal(sim_mesh_write(to, &mesh, &fault), 0);
    iso_coloured_mesh_done(&mesh);
}

/* Writes a man whose neck is missing, so that the head is a part of its own. */
static void tear(const char *from, const char *to)
{
    struct iso_coloured_mesh torn = {NULL, NULL};
    struct iso_fault fault = {.text = ""};
    assert_int_equal(iso_mesh_file_read(from, &torn, &fault), 0);
    struct iso_mesh *mesh = torn.mesh;
    double low = INFINITY, high = -INFINITY;
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        low = fmin(low, mesh->vertices_mm[v].y);
        high = fmax(high, mesh->vertices_mm[v].y);
    }
    int32_t kept = 0;
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        const double y = mesh->vertices_mm[mesh->triangles[t][0]].y;
        if (fabs((y - low) / (high - low) - 0.85) > 0.06) {
            memmove(mesh->triangles[kept++], mesh->triangles[t], sizeof *mesh->triangles);
        }
    }
    mesh->n_triangles = kept;
    assert_int_equal(sim_mesh_write(to, &torn, &fault), 0);
    iso_coloured_mesh_done(&torn);
}

/* How many of the first `most` shapes of a ranking, without the file `own`, are of a class. */
static int of_class(const char *csv, const char *own, const char *class_name, int most)
{
    char *text = scratch_read_text(csv), *next = text;
    int n = 0, right = 0;
    for (char *line = strsep(&next, "\n"); line && n < most; line = strsep(&next, "\n")) {
        char file[64], kind[64];
        if (sscanf(line, "%*d,%*f,%63[^,],%63s", file, kind) == 2 && strcmp(file, own) != 0) {
            n++;
            right += strcmp(kind, class_name) == 0;
        }
    }
    free(text);
    assert_int_equal(n, most);
    return right;
}

/* Every query lacks a fifth of its surface. The shape from which it was cut does not count. The
 * whole shapes' descriptor finds fewer. */
static void a_part_is_looked_for_in_an_index(void **state)
{
    static const char *const methods[] = {"local-heat", "cp-hk"};
    const char *corpus = scratch_path(*state, "c"), *answers = scratch_path(*state, "answers");
    const struct sim_shapes_options creatures = {.preset = "plain",
                                                 .out = corpus,
                                                 .seed = 3,
                                                 .classes = KINDS,
                                                 .shapes = SHAPES,
                                                 .vertices = 500,
                                                 .threads = 2};
    struct sim_shape_manifest *manifest = NULL;
    struct iso_fault fault = {.text = ""};
    int32_t n = 0;
    int nearest[2] = {0, 0}, tier[2] = {0, 0};
    assert_int_equal(sim_shapes_generate(&creatures, &n, &fault), 0);
    assert_int_equal(sim_shape_manifest_read(corpus, &manifest, &fault), 0);
    assert_int_equal(manifest->n, SHAPES);
    for (int m = 0; m < 2; m++) {
        const char *index = scratch_path(*state, methods[m]);
        make_index(&(struct sim_index_options){
            .corpus = corpus, .out = index, .method = methods[m], .threads = 2});
        for (int q = 0; q < QUERIES; q++) {
            const struct sim_shape_row *row = &manifest->rows[q * PER_KIND];
            const char *part = scratch_path(*state, "part.off");
            cut(scratch_path(corpus, row->file), part, 5 + (uint64_t)q);
            ask(&(struct sim_query_options){
                .meshes = {1, {part}}, .index = index, .out = answers, .matches = 3, .mend = true});
            const char *csv = scratch_path(answers, "part.csv");
            nearest[m] += of_class(csv, row->file, row->class_name, 1);
            tier[m] += of_class(csv, row->file, row->class_name, PER_KIND - 1);
        }
        print_message("%s: %d of %d, %d of %d\n", methods[m], nearest[m], QUERIES, tier[m],
                      QUERIES * (PER_KIND - 1));
    }
    assert_int_equal(nearest[0], QUERIES);
    assert_true(tier[0] >= QUERIES * (PER_KIND - 1) - 2);
    assert_true(tier[0] > tier[1]);
    sim_shape_manifest_free(manifest);
}

/* Replaces a part of a text by another one of the same length. */
static void replace(char *text, const char *from, const char *to)
{
    char *at = strstr(text, from);
    assert_non_null(at);
    assert_int_equal(strlen(from), strlen(to));
    for (size_t i = 0; to[i]; i++) {
        at[i] = to[i];
    }
}

/* The distance of the first shape of a ranking. */
static double first_distance(const char *csv)
{
    char *text = scratch_read_text(csv);
    double distance = -1.0;
    assert_int_equal(sscanf(text, "rank,distance,file,class\n1,%lf,", &distance), 1);
    free(text);
    return distance;
}

/* A shape of the index finds itself at distance 0, so it is described at the index's times, which
 * are the same to the bit. */
static void an_index_keeps_its_times(void **state)
{
    const char *corpus = scratch_path(*state, "corpus"), *index = scratch_path(*state, "index");
    const char *answers = scratch_path(*state, "answers"),
               *csv = scratch_path(answers, "dog-02.csv"),
               *list = scratch_path(index, "index.json");
    const struct sim_query_options query = {.meshes = {1, {scratch_path(corpus, "dog-02.off")}},
                                            .index = index,
                                            .out = answers,
                                            .matches = 3};
    struct sim_index_options make = {
        .corpus = corpus, .out = index, .method = "cp-hk", .threads = 2};
    make_creatures(corpus, "plain", NULL, 3, 2);
    make_index(&make);
    ask(&query);
    char *own = scratch_read_text(csv);
    assert_true(first_distance(csv) == 0.0);
    make.times = (struct iso_describe_times){.n = 50, .first = 1.0 / 300.0};
    make_index(&make);
    ask(&query);
    char *other = scratch_read_text(csv);
    assert_true(first_distance(csv) == 0.0);
    assert_string_not_equal(own, other);
    free(own);
    free(other);

    char *told = scratch_read_text(list);
    replace(told, "\"number\": 50", "\"number\": 60");
    scratch_write_text(list, told);
    ask(&query);
    assert_true(first_distance(csv) > 0.0); /* the query is described at the times of the list */
    replace(told, "\"number\": 60", "\"number\":  9");
    scratch_write_text(list, told);
    struct iso_fault fault = {.text = ""};
    assert_int_equal(sim_shapes_query(&query, stderr, &fault), -EBADMSG);
    assert_non_null(strstr(fault.text, "index.json: no index of shapes"));
    free(told);
}

/* An index of the first format has no times, and those of the method are used. An index of the
 * second format without times is refused. */
static void an_index_without_times_is_read(void **state)
{
    const char *corpus = scratch_path(*state, "corpus"), *index = scratch_path(*state, "index");
    const char *list = scratch_path(index, "index.json"),
               *answers = scratch_path(*state, "answers");
    struct iso_fault fault = {.text = ""};
    make_creatures(corpus, "plain", NULL, 3, 2);
    make_index(&(struct sim_index_options){
        .corpus = corpus, .out = index, .method = "cp-hk", .threads = 2});
    char *told = scratch_read_text(list);
    replace(told, "times_in_areas", "some_other_key");
    scratch_write_text(list, told);
    struct sim_index *opened = NULL;
    assert_int_equal(sim_index_open(index, &opened, &fault), -EBADMSG); /* the second format */
    replace(told, "shapes index 2", "shapes index 1");
    scratch_write_text(list, told);
    ask(&(struct sim_query_options){.meshes = {1, {scratch_path(corpus, "dog-02.off")}},
                                    .index = index,
                                    .out = answers,
                                    .matches = 3});
    assert_true(first_distance(scratch_path(answers, "dog-02.csv")) == 0.0);
    replace(told, "shapes index 1", "shapes index 3");
    scratch_write_text(list, told);
    assert_int_equal(sim_index_open(index, &opened, &fault), -EBADMSG);
    free(told);
}

static void expect_refused(const struct sim_index_options *options, const char *sentence)
{
    struct iso_fault fault = {.text = ""};
    assert_int_equal(sim_shapes_index(options, stderr, &fault), -EINVAL);
    assert_string_equal(fault.text, sentence);
    assert_false(scratch_exists(options->out));
}

static void times_that_a_method_cannot_have_are_refused(void **state)
{
    const char *corpus = scratch_path(*state, "corpus"), *index = scratch_path(*state, "index");
    struct sim_index_options make = {
        .corpus = corpus, .out = index, .method = "cp-hk", .times = {.n = 39}, .threads = 2};
    make_creatures(corpus, "plain", NULL, 3, 2);
    expect_refused(&make,
                   "--times, --time-first, --time-last: cp-hk cannot have 39 times from 0.0025 to "
                   "4 areas; 40 to 1000 times are allowed, the first above 0, the last above the "
                   "first");
    make.method = "local-heat";
    make.times = (struct iso_describe_times){.last = 2.0};
    expect_refused(&make,
                   "--times, --time-first, --time-last: the times of local-heat cannot be chosen");
}

/* A cut has left two parts of a man: the message says what helps, and it helps. */
static void a_query_of_two_parts_is_mended(void **state)
{
    const char *corpus = scratch_path(*state, "corpus"), *index = scratch_path(*state, "index");
    const char *torn = scratch_path(*state, "torn.off");
    const char *answers = scratch_path(*state, "answers");
    struct sim_query_options query = {
        .meshes = {1, {torn}}, .index = index, .out = answers, .matches = 3};
    struct iso_fault fault = {.text = ""};
    make_creatures(corpus, "plain", NULL, 3, 2);
    make_index(&(struct sim_index_options){
        .corpus = corpus, .out = index, .method = "local-heat", .threads = 2});
    tear(scratch_path(corpus, "man-01.off"), torn);
    assert_int_equal(sim_shapes_query(&query, stderr, &fault), -EBADMSG);
    assert_non_null(strstr(fault.text, "torn.off: of its 2 parts only the largest is used"));
    assert_non_null(strstr(fault.text, "--mend accepts this"));
    query.mend = true;
    ask(&query);
    char *found = scratch_read_text(scratch_path(answers, "torn.csv"));
    int rank = 0;
    double distance;
    char file[64] = "";
    assert_int_equal(
        sscanf(found, "rank,distance,file,class\n%d,%lf,%63[^,]", &rank, &distance, file), 3);
    assert_int_equal(rank, 1);
    assert_memory_equal(file, "man-", 4);
    free(found);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_part_is_looked_for_in_an_index, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(an_index_keeps_its_times, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(an_index_without_times_is_read, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(a_query_of_two_parts_is_mended, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(times_that_a_method_cannot_have_are_refused, scratch_setup,
                                        scratch_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

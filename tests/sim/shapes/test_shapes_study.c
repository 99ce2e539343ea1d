/* Corpora of shapes: manifest, generator and study, on a few small creatures. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "sim/shapes/make/generate.h"
#include "sim/shapes/make/manifest.h"
#include "sim/shapes/mesh/mesh_file.h"
#include "sim/shapes/mesh/mesh_writer.h"
#include "sim/shapes/study/study.h"
#include "tests/sim/shapes/creatures.h"
#include "tests/support/near.h"
#include "tests/support/scratch.h"

static void reads_manifests(void **state)
{
    struct sim_shape_manifest *manifest = NULL;
    struct iso_fault fault = {.text = ""};
    (void)state;
    assert_int_equal(sim_shape_manifest_parse("m",
                                              "file,class\na/b.off,dog/spots\nc.off,cat\n"
                                              "d.off,dog/plain\ne.off,dog/spots\n",
                                              &manifest, &fault),
                     0);
    assert_int_equal(manifest->n, 4);
    assert_int_equal(manifest->n_classes, 3);
    assert_int_equal(manifest->n_wider, 2);
    assert_int_equal(manifest->class_of[3], manifest->class_of[0]);
    assert_int_not_equal(manifest->class_of[2], manifest->class_of[0]);
    assert_int_equal(manifest->wider_of[2], manifest->wider_of[0]);
    assert_string_equal(manifest->class_name[2], "dog/plain");
    sim_shape_manifest_free(manifest);
    static const struct {
        const char *text, *words;
    } wrong[] = {
        {"file;class\n", "m:1: header"},
        {"file,class\n", "m: no rows"},
        {"file,class\na\n", "m:2: 1 fields"},
        {"file,class\na,b,c\n", "m:2: 3 fields"},
        {"file,class\n../a,b\n", "m:2: bad file '../a'"},
        {"file,class\na/../b,b\n", "m:2: bad file"},
        {"file,class\na,\n", "m:2: bad class"},
        {"file,class\na,b\na,c\n", "'a' is listed twice"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        manifest = NULL;
        assert_int_equal(sim_shape_manifest_parse("m", wrong[i].text, &manifest, &fault), -EBADMSG);
        assert_non_null(strstr(fault.text, wrong[i].words));
        assert_null(manifest);
    }
}

/* Two triangles of four vertices; the colours are compared if there are any. */
static void expect_same(const struct iso_coloured_mesh *back, const struct iso_coloured_mesh *mesh,
                        bool coloured)
{
    assert_int_equal(back->mesh->n_vertices, 4);
    assert_memory_equal(back->mesh->vertices_mm, mesh->mesh->vertices_mm,
                        4 * sizeof(struct iso_vec3));
    assert_memory_equal(back->mesh->triangles, mesh->mesh->triangles, 2 * sizeof(int32_t[3]));
    assert_true((back->colour != NULL) == coloured);
    for (int v = 0; back->colour && v < 4; v++) {
        assert_near(back->colour[v].channel[2], mesh->colour[v].channel[2], 1e-6);
    }
}

static void writes_what_is_read(void **state)
{
    struct iso_fault fault = {.text = ""};
    static const char *const names[] = {"a.off", "a.ply", "a.vert"};
    struct iso_coloured_mesh mesh = {NULL, NULL}, back = {NULL, NULL};
    scratch_write_text(scratch_path(*state, "in.off"),
                       "COFF\n4 2 0\n0 0 0 255 0 3 255\n1.5 0 0 0 9 0 255\n1 1.25 0 0 0 8 255\n"
                       "0 1 -7 1 2 3 255\n3 0 1 2\n3 0 2 3\n");
    assert_int_equal(iso_mesh_file_read(scratch_path(*state, "in.off"), &mesh, &fault), 0);
    for (size_t i = 0; i < 3; i++) {
        const char *path = scratch_path(*state, names[i]);
        assert_int_equal(sim_mesh_write(path, &mesh, &fault), 0);
        assert_int_equal(iso_mesh_file_read(path, &back, &fault), 0);
        expect_same(&back, &mesh, i < 2);
        iso_coloured_mesh_done(&back);
    }
    assert_int_equal(sim_mesh_write(scratch_path(*state, "a.stl"), &mesh, &fault), -ENOTSUP);
    assert_int_equal(sim_mesh_write(scratch_path(*state, "no/a.off"), &mesh, &fault), -ENOENT);
    iso_coloured_mesh_done(&mesh);
}

static void generates_the_same_whatever_the_threads(void **state)
{
    const char *one = scratch_path(*state, "one"), *two = scratch_path(*state, "two");
    static const char *const files[] = {"manifest.csv", "man-01.off", "dog-03.off"};
    make_creatures(one, "plain", NULL, 3, 1);
    make_creatures(two, "plain", NULL, 3, 3);
    for (size_t i = 0; i < 3; i++) {
        char *a = scratch_read_text(scratch_path(one, files[i])),
             *b = scratch_read_text(scratch_path(two, files[i]));
        assert_string_equal(a, b);
        free(a);
        free(b);
    }
}

static void refuses_bad_requests(void **state)
{
    struct sim_shapes_options options = {.preset = "round", .out = *state, .threads = 1};
    struct iso_fault fault = {.text = ""};
    int32_t n = 77;
    assert_int_equal(sim_shapes_generate(&options, &n, &fault), -EINVAL);
    options.preset = "textured";
    options.format = "vert";
    assert_int_equal(sim_shapes_generate(&options, &n, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "--format: 'vert' is none of off, ply"));
    options.format = NULL;
    options.vertices = 100;
    assert_int_equal(sim_shapes_generate(&options, &n, &fault), -EINVAL);
    options.vertices = 400;
    options.out = scratch_path(*state, "file/below");
    scratch_write_text(scratch_path(*state, "file"), "not a directory");
    assert_int_equal(sim_shapes_generate(&options, &n, &fault), -ENOTDIR);
    assert_int_equal(n, 77);
    options.out = scratch_path(*state, "a/b/c");
    options.preset = "plain";
    options.shapes = 1;
    assert_int_equal(sim_shapes_generate(&options, &n, &fault), 0);
    assert_true(scratch_exists(scratch_path(*state, "a/b/c/manifest.csv")));
    assert_int_equal(n, 1);
}

/* Corpora in TOSCA's files, with common defects: a hole, a fin on an edge, a second piece. */
static void retrieves_from_tosca_files(void **state)
{
    const char *corpus = scratch_path(*state, "tosca"), *out = scratch_path(*state, "out");
    struct iso_fault fault = {.text = ""};
    char *printed = NULL;
    make_creatures(corpus, "plain", "vert", 3, 2);
    char *tri = scratch_read_text(scratch_path(corpus, "dog-01.tri")),
         *vert = scratch_read_text(scratch_path(corpus, "dog-01.vert"));
    char *longer = NULL, *hole = strchr(strchr(tri, '\n') + 1, '\n') + 1;
    assert_true(asprintf(&longer, "%s1 1 2\n1 2 401\n1 402 403\n402 403 404\n1 2 3\n", hole) > 0);
    scratch_write_text(scratch_path(corpus, "dog-01.tri"), longer);
    free(longer);
    assert_true(asprintf(&longer, "%s500 0 0\n600 0 0\n600 1 0\n600 0 1\n9 9 9\n", vert) > 0);
    scratch_write_text(scratch_path(corpus, "dog-01.vert"), longer);
    free(longer);
    free(tri);
    free(vert);
    const struct sim_shapes_study_options options = {.corpus = corpus,
                                                     .out = out,
                                                     .threads = 2,
                                                     .methods = {1, {"shape-dna"}},
                                                     .seed = 1,
                                                     .pictures = 3};
    if (run_study(&options, &printed, &fault)) {
        fail_msg("%s", fault.text);
    }
    assert_non_null(strstr(printed, "9 shapes of 3 classes"));
    free(printed);
    char *measures = scratch_read_text(scratch_path(out, "measures.csv"));
    double nn = 0.0;
    assert_int_equal(sscanf(strchr(measures, '\n') + 1, "shape-dna,nn-l%*d,9,%lf", &nn), 1);
    assert_true(nn > 0.7);
    free(measures);
    assert_true(scratch_exists(scratch_path(out, "shapes.png")));
    assert_true(scratch_exists(scratch_path(out, "precision-recall.png")));
}

static struct sim_shapes_study_options cp_hk_options(const char *corpus, const char *out)
{
    return (struct sim_shapes_study_options){.corpus = corpus,
                                             .out = out,
                                             .threads = 2,
                                             .methods = {1, {"cp-hk"}},
                                             .classifiers = {1, {"nn-l2"}},
                                             .seed = 1,
                                             .distortion = {SIM_DISTORTION_SCALE, 3}};
}

static void distances_leave_nothing_out(void **state)
{
    const char *corpus = scratch_path(*state, "c"), *out = scratch_path(*state, "o");
    const struct sim_shapes_study_options options = cp_hk_options(corpus, out);
    struct iso_fault fault = {.text = ""};
    char *printed = NULL;
    make_creatures(corpus, "plain", NULL, 3, 2);
    assert_int_equal(run_study(&options, &printed, &fault), 0);
    free(printed);
    char *text = scratch_read_text(scratch_path(scratch_path(out, "cp-hk-nn-l2"), "distances.csv")),
         *rest = text;
    int lines = 0;
    for (char *line = strsep(&rest, "\n"); line && *line; line = strsep(&rest, "\n"), lines++) {
        int commas = 0;
        for (const char *c = line; *c; c++) {
            commas += *c == ',';
        }
        assert_int_equal(commas, 9);
    }
    assert_int_equal(lines, 10);
    free(text);
    int told = 0, a = 0, b = 0, c = 0;
    text = scratch_read_text(scratch_path(scratch_path(out, "cp-hk-nn-l2"), "confusion.csv"));
    rest = strchr(text, '\n') + 1;
    for (char *line = strsep(&rest, "\n"); line && *line; line = strsep(&rest, "\n")) {
        assert_int_equal(sscanf(strchr(line, ',') + 1, "%d,%d,%d", &a, &b, &c), 3);
        assert_int_equal(a + b + c, 3);
        told += a + b + c;
    }
    assert_int_equal(told, 9);
    free(text);
}

/* A study of the nearest neighbours by CP-HK with so many queries: its distances, to be freed, and
 * the share of queries whose nearest shape is of their class. */
static char *distances_of(const char *corpus, const char *out, size_t queries, double *nearest)
{
    struct sim_shapes_study_options options = cp_hk_options(corpus, out);
    struct iso_fault fault = {.text = ""};
    char *printed = NULL;
    size_t counted = 0;
    options.distortion.level = 0;
    options.queries = queries;
    if (run_study(&options, &printed, &fault)) {
        fail_msg("%s", fault.text);
    }
    free(printed);
    char *text = scratch_read_text(scratch_path(out, "measures.csv"));
    assert_int_equal(sscanf(strchr(text, '\n') + 1, "cp-hk,nn-l2,%zu,%lf", &counted, nearest), 2);
    assert_int_equal(counted, queries ? queries : 9);
    free(text);
    return scratch_read_text(scratch_path(scratch_path(out, "cp-hk-nn-l2"), "distances.csv"));
}

/* Whether the nearest shape besides the query itself is of its class, which file names begin with.
 * Both lines are of one distances.csv; the header names the shapes. */
static bool nearest_is_right(const char *header, const char *line)
{
    char query[32], name[32], best[32] = "";
    double distance = 0.0, least = INFINITY;
    assert_int_equal(sscanf(line, "%31[^,]", query), 1);
    while ((header = strchr(header, ',')) && (line = strchr(line, ','))) {
        header++;
        line++;
        assert_int_equal(sscanf(header, "%31[^,\n]", name), 1);
        assert_int_equal(sscanf(line, "%lf", &distance), 1);
        if (strcmp(name, query) != 0 && distance < least) {
            least = distance;
            memcpy(best, name, sizeof best);
        }
    }
    return strncmp(best, query, strcspn(query, "-")) == 0;
}

/* Some shapes are looked for among all: the first of every class in turn. Their distances to all
 * shapes are those of a study that looks for every shape. */
static void some_shapes_are_looked_for_among_all(void **state)
{
    const char *corpus = scratch_path(*state, "c");
    static const char *const expected[] = {"man-01.off,", "gorilla-01.off,", "dog-01.off,",
                                           "man-02.off,"};
    enum { QUERIES = sizeof expected / sizeof *expected };
    double nearest = 0.0, of_all = 0.0;
    int right = 0, n = 0;
    make_creatures(corpus, "plain", NULL, 3, 2);
    char *all = distances_of(corpus, scratch_path(*state, "all"), 0, &of_all);
    char *some = distances_of(corpus, scratch_path(*state, "some"), QUERIES, &nearest),
         *rest = some;
    const char *header = strsep(&rest, "\n");
    assert_memory_equal(all, header, strlen(header));
    for (char *line = strsep(&rest, "\n"); line && *line; line = strsep(&rest, "\n"), n++) {
        assert_true(n < QUERIES);
        assert_memory_equal(line, expected[n], strlen(expected[n]));
        char *same = NULL;
        assert_true(asprintf(&same, "\n%s\n", line) > 0);
        assert_non_null(strstr(all, same));
        free(same);
        right += nearest_is_right(header, line);
    }
    assert_int_equal(n, QUERIES);
    assert_near(nearest, (double)right / QUERIES, 1e-6);
    free(some);
    free(all);
}

static void the_reason_of_a_failed_study_is_named(void **state)
{
    const char *corpus = scratch_path(*state, "c"), *out = scratch_path(*state, "o");
    struct sim_shapes_study_options options = cp_hk_options(corpus, out);
    struct iso_fault fault = {.text = ""};
    char *printed = NULL;
    make_creatures(corpus, "plain", NULL, 3, 2);
    options.methods.text[0] = "w-hks2"; /* this method needs colours */
    assert_int_equal(run_study(&options, &printed, &fault), -ENODATA);
    assert_non_null(strstr(fault.text, ".off: a method needs colours, and the file has none"));
    free(printed);
    options.methods.text[0] = "astrology";
    assert_int_equal(run_study(&options, &printed, &fault), -EINVAL);
    free(printed);
    options.methods.text[0] = "cp-hk";
    options.classifiers.text[0] = "oracle";
    assert_int_equal(run_study(&options, &printed, &fault), -EINVAL);
    free(printed);
    scratch_write_text(scratch_path(corpus, "dog-01.off"), "OFF\n1 0 0\n");
    options.classifiers.n = 0;
    options.strict = true;
    assert_int_equal(run_study(&options, &printed, &fault), -EBADMSG);
    assert_non_null(strstr(fault.text, "dog-01.off: ends within the vertices"));
    free(printed);
    options.corpus = scratch_path(*state, "nowhere");
    assert_int_equal(run_study(&options, &printed, &fault), -ENOENT);
    free(printed);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_manifests),
        cmocka_unit_test_setup_teardown(writes_what_is_read, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(generates_the_same_whatever_the_threads, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(refuses_bad_requests, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(retrieves_from_tosca_files, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(distances_leave_nothing_out, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(some_shapes_are_looked_for_among_all, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(the_reason_of_a_failed_study_is_named, scratch_setup,
                                        scratch_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

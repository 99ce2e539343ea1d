/* Corresponding points of two shapes, against the generator's truth. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "sim/shapes/make/generate.h"
#include "sim/shapes/match/match.h"
#include "tests/sim/shapes/creatures.h"
#include "tests/support/near.h"
#include "tests/support/scratch.h"

/* A shape is matched with itself point by point; with another pose far better than by chance. The
 * gorilla is one of the bodies that are matched well (sim/results/shapes.md has others). */
static void poses_are_matched(void **state)
{
    const char *corpus = scratch_path(*state, "c"), *out = scratch_path(*state, "out");
    const struct sim_shapes_options make = {.preset = "plain",
                                            .out = corpus,
                                            .seed = 1,
                                            .classes = 4,
                                            .shapes = 12,
                                            .vertices = 1500,
                                            .rest = true,
                                            .threads = 2};
    const char *first = scratch_path(corpus, "gorilla-02.off"),
               *second = scratch_path(corpus, "gorilla-03.off");
    struct sim_match_options options = {.meshes = {2, {first, first}},
                                        .out = out,
                                        .pairs = 100,
                                        .first_pairs = 20,
                                        .step = 5,
                                        .weight = 0.01};
    struct iso_fault fault = {.text = ""};
    int32_t n = 0;
    double within = 0.0;
    assert_int_equal(sim_shapes_generate(&make, &n, &fault), 0);
    assert_true(match_error(&options, &within) < 1e-9);
    assert_near(within, 100.0, 0.01);
    options.meshes.text[1] = second;
    assert_true(match_error(&options, &within) < 0.1);
    assert_true(within > 80.0);
    static const char *const files[] = {"point.npy", "map.npy", "to_vertices.npy", "match.json",
                                        "match.png"};
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        assert_true(scratch_exists(scratch_path(out, files[i])));
    }
    options.meshes.n = 1;
    assert_int_equal(sim_shapes_match(&options, stderr, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "two meshes are needed, 1 are given"));
    options.meshes.n = 2;
    options.weight = 0.0;
    assert_int_equal(sim_shapes_match(&options, stderr, &fault), -EINVAL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(poses_are_matched, scratch_setup, scratch_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* The tables of the dissertation, on a few small creatures. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "sim/shapes/study/tables.h"
#include "tests/sim/shapes/creatures.h"
#include "tests/support/scratch.h"

/* Runs the tables. The caller frees what was printed. */
static int run_tables(const struct sim_tables_options *options, char **printed,
                      struct iso_fault *fault)
{
    size_t size;
    FILE *out = open_memstream(printed, &size);
    const int error = sim_shapes_tables(options, out, fault);
    (void)fclose(out);
    return error;
}

static void tables_have_both_sides(void **state)
{
    const char *plain = scratch_path(*state, "p"), *textured = scratch_path(*state, "t");
    const char *out = scratch_path(*state, "tables");
    const struct sim_tables_options options = {
        .corpus = plain, .textured = textured, .out = out, .queries = 3, .seed = 1, .threads = 2};
    struct iso_fault fault = {.text = ""};
    char *printed = NULL;
    make_creatures(plain, "plain", NULL, 3, 2);
    make_creatures(textured, "textured", NULL, 1, 2);
    if (run_tables(&options, &printed, &fault)) {
        fail_msg("%s", fault.text);
    }
    assert_non_null(strstr(printed, "/p: 9 shapes of 3 classes"));
    static const char *const numbers[] = {"4.1.", "4.5.", "4.8.", "4.10.", "4.13.", "5.1.", "5.2."};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        char title[32];
        (void)snprintf(title, sizeof title, "Table %s ", numbers[i]);
        assert_non_null(strstr(printed, title));
    }
    free(printed);
    char *csv = scratch_read_text(scratch_path(out, "tables.csv"));
    assert_non_null(strstr(csv, "\n4.8,shape-dna,nn-l2,0,white,3,3,NN,"));
    assert_non_null(strstr(csv, "\n5.2,PHOG,,0,,0,0,NN,,0.951\n"));
    free(csv);
}

/* Runs the tables: tables.csv, to be freed; of `all` descriptions `known` were in the cache. */
static char *tables_of(const struct sim_tables_options *options, int *known, int *all)
{
    struct iso_fault fault = {.text = ""};
    char *printed = NULL;
    if (run_tables(options, &printed, &fault)) {
        fail_msg("%s", fault.text);
    }
    assert_non_null(strstr(printed, "/p: 8 shapes of 3 classes"));
    assert_int_equal(sscanf(strstr(printed, " MB; "), " MB; %d of %d descriptions", known, all), 2);
    free(printed);
    return scratch_read_text(scratch_path(options->out, "tables.csv"));
}

static void tables_leave_a_bad_mesh_out_and_are_cached(void **state)
{
    const char *plain = scratch_path(*state, "p"), *changed = scratch_path(plain, "dog-02.off");
    struct sim_tables_options options = {.corpus = plain,
                                         .out = scratch_path(*state, "tables"),
                                         .queries = 2,
                                         .seed = 1,
                                         .threads = 2};
    int known = 0, all = 0;
    make_creatures(plain, "plain", NULL, 3, 2);
    scratch_write_text(scratch_path(plain, "dog-01.off"), "OFF\n5 1 0\n0 0 0\n");
    char *first = tables_of(&options, &known, &all);
    assert_true(known == 0 && all >= 8);
    char *second = tables_of(&options, &known, &all); /* all from the cache */
    assert_int_equal(known, all);
    assert_string_equal(second, first);
    free(second);
    /* A mesh gets other contents, which are those of another mesh, so that the cache has all
     * descriptions. The tables are others, and those that are measured without a cache. */
    char *other = scratch_read_text(scratch_path(plain, "man-03.off"));
    scratch_write_text(changed, other);
    free(other);
    second = tables_of(&options, &known, &all);
    assert_int_equal(known, all);
    assert_string_not_equal(second, first);
    free(first);
    options.cache = "";
    options.out = scratch_path(*state, "anew");
    first = tables_of(&options, &known, &all);
    assert_int_equal(known, 0);
    assert_string_equal(second, first);
    free(first);
    free(second);
    struct iso_fault fault = {.text = ""};
    char *printed = NULL;
    options.strict = true;
    assert_int_equal(run_tables(&options, &printed, &fault), -EBADMSG);
    assert_non_null(strstr(fault.text, "dog-01.off: ends within the vertices"));
    free(printed);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(tables_have_both_sides, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(tables_leave_a_bad_mesh_out_and_are_cached, scratch_setup,
                                        scratch_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

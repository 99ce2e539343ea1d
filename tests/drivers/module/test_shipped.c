/* How a program finds the shipped data files from its own path. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "drivers/base/shipped.h"
#include "tests/support/scratch.h"

static const char *directory_of(const char *root, const char *program)
{
    static char directory[PATH_MAX];
    char *root_path = realpath(root, NULL);
    assert_non_null(root_path);
    iso_shipped_directory(scratch_path(root_path, program), directory);
    free(root_path);
    return directory;
}

static void a_build_tree_has_a_link_to_the_source(void **state)
{
    const char *root = *state;
    scratch_mkdir(scratch_path(root, "source"));
    scratch_mkdir(scratch_path(root, "build"));
    assert_int_equal(symlink("../source", scratch_path(root, "build/" ISO_SHIPPED_LINK)), 0);
    char *source = realpath(scratch_path(root, "source"), NULL);
    assert_string_equal(directory_of(root, "build/sim/isotherm-sim"), source);
    assert_string_equal(directory_of(root, "build/tests/sim/test_x"), source);
    assert_string_equal(directory_of(root, "build/tests/sim/deep/test_x"), source);
    /* A program beside the link, or too far below it, does not belong to the build. */
    assert_string_equal(directory_of(root, "build/isotherm-sim"), ISOTHERM_DATA_DIR);
    assert_string_equal(directory_of(root, "build/1/2/3/4/isotherm-sim"), ISOTHERM_DATA_DIR);
    free(source);
}

static void any_other_program_takes_the_installed_files(void **state)
{
    const char *root = *state;
    char directory[PATH_MAX], endless[PATH_MAX + 10];
    scratch_mkdir(scratch_path(root, "build"));
    assert_int_equal(symlink("gone", scratch_path(root, "build/" ISO_SHIPPED_LINK)), 0);
    assert_string_equal(directory_of(root, "build/sim/isotherm-sim"), ISOTHERM_DATA_DIR);
    assert_string_equal(directory_of(root, "usr/bin/isotherm-sim"), ISOTHERM_DATA_DIR);
    memset(endless, 'x', sizeof endless - 1);
    endless[0] = '/';
    endless[sizeof endless - 1] = '\0';
    const char *const odd[] = {"", "/", "isotherm-sim", "/isotherm-sim", endless};
    for (size_t i = 0; i < sizeof odd / sizeof *odd; i++) {
        iso_shipped_directory(odd[i], directory);
        assert_string_equal(directory, ISOTHERM_DATA_DIR);
    }
}

/* This test itself is a program of a build tree. */
static void a_test_finds_the_files_of_the_source(void **state)
{
    (void)state;
    assert_string_equal(iso_shipped_model(), ISOTHERM_SOURCE_DIR "/core/data/head.model");
    assert_string_equal(iso_shipped_metric(), ISOTHERM_SOURCE_DIR "/core/data/face.metric");
    assert_string_equal(iso_shipped_cohort(), ISOTHERM_SOURCE_DIR "/core/data/cohort.templates");
    assert_int_equal(access(iso_shipped_model(), R_OK), 0);
    assert_int_equal(access(iso_shipped_metric(), R_OK), 0);
    assert_int_equal(access(iso_shipped_cohort(), R_OK), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_build_tree_has_a_link_to_the_source, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(any_other_program_takes_the_installed_files, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test(a_test_finds_the_files_of_the_source),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

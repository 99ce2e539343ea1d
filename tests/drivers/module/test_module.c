/* The loader of modules. It uses a valid module, and reports each kind of fault in one line. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "tests/drivers/module/fake_module.h"
#include "tests/support/scratch.h"

/* Returns the path of one of the built modules. */
static const char *built(const char *kind)
{
    static char path[PATH_MAX];
    (void)snprintf(path, sizeof path, ISOTHERM_FAKE_MODULES "/fake-%s.so", kind);
    return path;
}

static int read_fake(const char *path, const struct iso_module **table, struct iso_fault *fault)
{
    return iso_module_read(path, "fake", sizeof(struct fake_module), table, fault);
}

static void expect_refusal(const char *path, int error, const char *what)
{
    const struct iso_module *table = NULL;
    struct iso_fault fault = {.text = ""};
    const int got = read_fake(path, &table, &fault);
    if (got != error || !strstr(fault.text, what) || !strstr(fault.text, path) ||
        strchr(fault.text, '\n')) {
        fail_msg("%s: %d: '%s', not '%s'", path, got, fault.text, what);
    }
    assert_null(table);
}

static void copy(const char *from, const char *to)
{
    size_t size = 0;
    void *bytes = scratch_read(from, &size);
    scratch_write(to, bytes, size);
    assert_int_equal(chmod(to, 0644), 0);
    free(bytes);
}

/* ---- from a file ---- */

static void a_sound_module_is_used(void **state)
{
    const struct iso_module *table = NULL;
    struct iso_fault fault = {.text = ""};
    (void)state;
    if (read_fake(built("sound"), &table, &fault)) {
        fail_msg("%s", fault.text);
    }
    assert_int_equal(((const struct fake_module *)table)->answer(), FAKE_ANSWER);
}

static void files_that_are_not_plain_are_refused(void **state)
{
    const char *missing = scratch_path(*state, "missing.so");
    const char *link = scratch_path(*state, "link.so"), *open = scratch_path(*state, "open.so");
    expect_refusal(missing, -ENOENT, "is missing: install the package isotherm-fake");
    expect_refusal(*state, -EBADMSG, "is not a regular file");
    assert_int_equal(symlink(built("sound"), link), 0);
    expect_refusal(link, -EBADMSG, "is not a regular file");
    copy(built("sound"), open);
    assert_int_equal(chmod(open, 0646), 0);
    expect_refusal(open, -EBADMSG, "may be written by anybody");
}

static void files_that_cannot_be_loaded_are_refused(void **state)
{
    const char *garbage = scratch_path(*state, "garbage.so");
    scratch_write_text(garbage, "This is no shared object, but it is long enough for a header of "
                                "one, which has 64 bytes.\n");
    expect_refusal(garbage, -EBADMSG, "cannot be loaded: invalid ELF header");
    scratch_write_text(garbage, "");
    expect_refusal(garbage, -EBADMSG, "cannot be loaded: file too short");
    expect_refusal(
        built("unresolved"), -EBADMSG,
        "cannot be loaded: undefined symbol: fake_function_of_a_library_that_is_missing");
}

static void other_modules_are_refused(void **state)
{
    char version[64];
    (void)state;
    (void)snprintf(version, sizeof version, "has version 0.0.9; this program has %s",
                   ISOTHERM_VERSION);
    expect_refusal(built("old"), -EBADMSG, version);
    expect_refusal(built("interface"), -EBADMSG, "has interface 99, not 1");
    expect_refusal(built("other"), -EBADMSG, "is 'other', not 'fake'");
    expect_refusal(built("size"), -EBADMSG, "has a table of 8 bytes, not ");
    expect_refusal(built("stranger"), -EBADMSG, "is not a module of Isotherm");
}

/* ---- by name ---- */

/* The module is beside the library that the test runs. The environment does not matter. */
static void lies_beside_the_library(void **state)
{
    char path[PATH_MAX], real[PATH_MAX], expected[PATH_MAX + 64];
    (void)state;
    assert_non_null(realpath(ISOTHERM_BINARY_DIR, real));
    (void)snprintf(expected, sizeof expected, "%s/core/isotherm/isotherm-stereo.so", real);
    assert_int_equal(iso_module_path("stereo", path, NULL), 0);
    assert_string_equal(path, expected);
}

/* A module that appears after the first call is not loaded, because the process may be confined by
 * then. */
static void the_disk_is_asked_once(void **state)
{
    struct iso_module_slot slot = {.name = "fake", .size_bytes = sizeof(struct fake_module)};
    struct iso_module_slot next = slot;
    struct iso_fault fault = {.text = ""}, again = {.text = ""};
    char path[PATH_MAX];
    (void)state;
    assert_int_equal(iso_module_path("fake", path, NULL), 0);
    (void)unlink(path);
    assert_int_equal(iso_module_load(&slot, &fault), -ENOENT);
    assert_non_null(strstr(fault.text, "install the package isotherm-fake"));
    copy(built("sound"), path);
    assert_int_equal(iso_module_load(&slot, &again), -ENOENT);
    assert_string_equal(again.text, fault.text);
    assert_null(slot.table);

    assert_int_equal(iso_module_load(&next, NULL), 0); /* another user of the module finds it */
    assert_int_equal(unlink(path), 0);
    const struct iso_module *table = next.table;
    assert_int_equal(iso_module_load(&next, NULL), 0);
    assert_ptr_equal(next.table, table);
    assert_int_equal(((const struct fake_module *)table)->answer(), FAKE_ANSWER);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sound_module_is_used),
        cmocka_unit_test_setup_teardown(files_that_are_not_plain_are_refused, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(files_that_cannot_be_loaded_are_refused, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test(other_modules_are_refused),
        cmocka_unit_test(lies_beside_the_library),
        cmocka_unit_test(the_disk_is_asked_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* `isotherm version`: the versions of an image and of another machine, and the program itself. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/utsname.h>

#include "enroll/cli/image/versions.h"
#include "tests/enroll/rigs/cli.h"
#include "tests/support/scratch.h"

/* The list of an image has three more columns, and packages with similar names. */
static const char packages[] = "libcamera-base0.0.3\t9.9\tamd64\tlibcamera\t9.9\n"
                               "libcamera0.0.3\t0.0.3-6\tamd64\tlibcamera\t0.0.3-6\n"
                               "libcholmod3\t1:5.12.0+dfsg-2\tamd64\tsuitesparse\t1:5.12.0+dfsg-2\n"
                               "libgpiod2\t1.6.3-1+b3\tamd64\tlibgpiod\t1.6.3-1\n"
                               "libopencv-core-dev\t9.9\tamd64\topencv\t9.9\n"
                               "libopencv-core406\t4.6.0+dfsg-12\tamd64\topencv\t4.6.0+dfsg-12\n";

static struct cli_image_places places_in(const char *scratch)
{
    return (struct cli_image_places){.os_release = scratch_path(scratch, "os-release"),
                                     .slot = scratch_path(scratch, "slot"),
                                     .packages = scratch_path(scratch, "packages"),
                                     .dpkg_query = scratch_path(scratch, "dpkg-query")};
}

static char *text_of(const struct cli_versions *versions)
{
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);

    assert_non_null(out);
    cli_versions_print(versions, out);
    assert_int_equal(fclose(out), 0);
    return text;
}

static void an_image_names_all_its_parts(void **state)
{
    const struct cli_image_places places = places_in(*state);
    struct cli_versions versions;
    struct utsname kernel;
    char expected[1024];

    scratch_write_text(places.os_release, "PRETTY_NAME=\"Debian GNU/Linux 12 (bookworm)\"\n"
                                          "IMAGE_ID=isotherm-pc-usb\nIMAGE_VERSION=2.0.0\n");
    scratch_write_text(places.slot, "SLOT=b\n");
    scratch_write_text(places.packages, packages);
    cli_versions_read(&places, &versions);
    (void)snprintf(versions.daemon, sizeof versions.daemon, "0.0.9");
    (void)snprintf(versions.bundle, sizeof versions.bundle, "2.0.0");
    assert_int_equal(uname(&kernel), 0);
    (void)snprintf(expected, sizeof expected,
                   "isotherm    " ISOTHERM_VERSION "\n"
                   "isothermd   0.0.9\n"
                   "libcamera   0.0.3-6\n"
                   "OpenNI2     not installed\n"
                   "OpenCV      4.6.0+dfsg-12\n"
                   "SuiteSparse 1:5.12.0+dfsg-2\n"
                   "libgpiod    1.6.3-1+b3\n"
                   "kernel      %s %s\n"
                   "system      Debian GNU/Linux 12 (bookworm)\n"
                   "image       isotherm-pc-usb 2.0.0\n"
                   "slot        b\n"
                   "update      2.0.0\n",
                   kernel.release, kernel.version);
    char *text = text_of(&versions);
    assert_string_equal(text, expected);
    free(text);

    json_t *document = cli_versions_json(&versions);
    const json_t *libraries = json_object_get(document, "libraries");
    assert_string_equal(json_string_value(json_object_get(libraries, "OpenCV")), "4.6.0+dfsg-12");
    assert_true(json_is_null(json_object_get(libraries, "OpenNI2")));
    assert_string_equal(json_string_value(json_object_get(document, "slot")), "b");
    assert_string_equal(json_string_value(json_object_get(document, "bundle")), "2.0.0");
    json_decref(document);
}

/* Without the list of an image dpkg-query is asked. It complains about what is not installed. */
static void another_machine_asks_dpkg(void **state)
{
    const struct cli_image_places places = places_in(*state);
    struct cli_versions versions;

    scratch_write_text(places.dpkg_query,
                       "#!/bin/sh\n"
                       "[ \"$1 $4\" = '--show libopenni2-[0-9]*' ] || exit 2\n"
                       "printf 'libgpiod2\\t1.6.3-1+b3\\nlibopenni2-0\\t2.2.0.33+dfsg-15\\n'\n"
                       "echo 'dpkg-query: no packages found' >&2\nexit 1\n");
    assert_int_equal(chmod(places.dpkg_query, 0700), 0);
    cli_versions_read(&places, &versions);
    char *text = text_of(&versions);
    assert_non_null(strstr(text, "\nlibgpiod    1.6.3-1+b3\n"));
    assert_non_null(strstr(text, "\nOpenNI2     2.2.0.33+dfsg-15\n"));
    assert_non_null(strstr(text, "\nisothermd   does not answer\n"));
    assert_non_null(strstr(text, "\nimage       none: this is not an image of the appliance\n"));
    assert_null(strstr(text, "\nslot"));
    free(text);
}

static void the_program_shows_its_own_version(void **state)
{
    struct cli_result result = cli_run(NULL, "version");

    (void)state;
    cli_expect_exit(&result, 0);
    assert_string_equal(result.out, "isotherm " ISOTHERM_VERSION "\n");
    result = cli_run(NULL, "version --json");
    json_t *document = cli_json(&result);
    assert_int_equal(json_object_size(document), 1);
    json_decref(document);
}

static void the_program_asks_the_daemon(void **state)
{
    struct cli_result result = cli_run(&cli_two_people, "version --all --json");
    json_t *document = cli_json(&result);
    struct utsname kernel;

    (void)state;
    cli_expect_exit(&result, 0);
    assert_true(json_is_string(json_object_get(document, "isothermd")));
    assert_int_equal(uname(&kernel), 0);
    assert_int_equal(strncmp(json_string_value(json_object_get(document, "kernel")), kernel.release,
                             strlen(kernel.release)),
                     0);
    json_decref(document);
    result = cli_run(NULL, "version --all");
    cli_expect_exit(&result, 0);
    assert_non_null(strstr(result.out, "\nisothermd   does not answer\n"));
}

int main(void)
{
#define IN_SCRATCH(test) cmocka_unit_test_setup_teardown(test, scratch_setup, scratch_teardown)
    const struct CMUnitTest tests[] = {
        IN_SCRATCH(an_image_names_all_its_parts),
        IN_SCRATCH(another_machine_asks_dpkg),
        cmocka_unit_test(the_program_shows_its_own_version),
        cmocka_unit_test(the_program_asks_the_daemon),
    };

    return cli_find_bus() ? cmocka_run_group_tests(tests, NULL, cli_teardown) : TEST_SKIPPED;
}

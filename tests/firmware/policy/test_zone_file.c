/* Zones from the files of the system, and names and files that are none. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/policy/zones/zone_file.h"
#include "tests/support/scratch.h"

static void zones_of_the_system(void **state)
{
    (void)state;
    static struct iso_zone zone;
    static const char *const names[] = {"UTC", "Europe/Berlin", "America/Argentina/Buenos_Aires",
                                        "Etc/GMT+5"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        struct iso_fault fault = {0};
        if (iso_zone_file_read((void *)ISO_ZONE_FOLDER, names[i], &zone, &fault) != 0) {
            fail_msg("%s", fault.text);
        }
        assert_string_equal(zone.name, names[i]);
    }
    assert_int_equal(iso_zone_offset_s(&zone, 0), -5 * 3600);
}

static void names_that_are_none(void **state)
{
    (void)state;
    static const char *const names[] = {"",
                                        "/etc/passwd",
                                        "../passwd",
                                        "Europe/../UTC",
                                        "Europe/",
                                        "Europe//Rome",
                                        "UTC\n",
                                        "a b",
                                        "Europe\\Rome",
                                        ".",
                                        "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        struct iso_fault fault = {0};
        static struct iso_zone zone = {.name = "before"};
        assert_false(iso_zone_name_is_right(names[i]));
        assert_int_equal(iso_zone_file_read((void *)ISO_ZONE_FOLDER, names[i], &zone, &fault),
                         -EINVAL);
        assert_string_equal(zone.name, "before");
        assert_true(fault.text[0] != '\0');
    }
}

static int read_from(const char *folder, const char *name, struct iso_fault *fault)
{
    static struct iso_zone zone;
    return iso_zone_file_read((void *)folder, name, &zone, fault);
}

static void files_that_are_none(void **state)
{
    const char *folder = *state;
    struct iso_fault fault = {0};
    assert_int_equal(read_from(folder, "Mars", &fault), -ENOENT);
    assert_string_equal(fault.text, "there is no time zone \"Mars\"");
    assert_int_equal(mkfifo(scratch_path(folder, "Moon"), 0600), 0);
    assert_int_equal(read_from(folder, "Moon", &fault), -EMEDIUMTYPE);
    scratch_mkdir(scratch_path(folder, "Sun"));
    assert_int_equal(read_from(folder, "Sun", &fault), -EISDIR);
    scratch_write_text(scratch_path(folder, "Pluto"), "not a zone");
    assert_int_equal(read_from(folder, "Pluto", &fault), -EBADMSG);
    assert_int_equal(truncate(scratch_path(folder, "Pluto"), (1 << 16) + 1), 0);
    assert_int_equal(read_from(folder, "Pluto", &fault), -EFBIG);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(zones_of_the_system),
        cmocka_unit_test(names_that_are_none),
        cmocka_unit_test_setup_teardown(files_that_are_none, scratch_setup, scratch_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

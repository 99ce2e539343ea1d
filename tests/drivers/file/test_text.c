/* Text files and their parts. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/base/path.h"
#include "drivers/file/text.h"
#include "tests/support/scratch.h"

static void reads_a_file_whole(void **state)
{
    const char *path = scratch_path(*state, "t");
    char *text = NULL, large[10000];
    memset(large, 'x', sizeof large);
    large[sizeof large - 1] = '\0';
    scratch_write_text(path, large);
    assert_int_equal(iso_text_read(path, sizeof large, &text, NULL), 0);
    assert_string_equal(text, large);
    free(text);
}

static void reads_sizes_around_its_buffer(void **state)
{
    const char *path = scratch_path(*state, "t");
    for (size_t size = 4094; size <= 4097; size++) {
        char *text = NULL, *bytes = malloc(size);
        assert_non_null(bytes);
        memset(bytes, 'y', size);
        scratch_write(path, bytes, size);
        assert_int_equal(iso_text_read(path, size, &text, NULL), 0);
        assert_int_equal(strlen(text), size);
        free(text);
        free(bytes);
    }
}

static void refuses_a_longer_file(void **state)
{
    struct iso_fault fault;
    char *text = NULL;
    const char *path = scratch_path(*state, "t");
    scratch_write_text(path, "12345");
    assert_int_equal(iso_text_read(path, 4, &text, &fault), -EFBIG);
    assert_non_null(strstr(fault.text, "t: longer than 4 bytes"));
    assert_null(text);
}

static void refuses_a_nul_byte(void **state)
{
    struct iso_fault fault;
    char *text = NULL;
    const char *path = scratch_path(*state, "t");
    scratch_write(path, "a\0b", 3);
    assert_int_equal(iso_text_read(path, 10, &text, &fault), -EBADMSG);
    assert_non_null(strstr(fault.text, "NUL"));
}

static void refuses_what_is_no_file(void **state)
{
    struct iso_fault fault;
    char *text = NULL;
    assert_int_equal(iso_text_read(scratch_path(*state, "none"), 10, &text, &fault), -ENOENT);
    assert_non_null(strstr(fault.text, "none: No such file"));
    assert_int_equal(iso_text_read(*state, 10, &text, NULL), -EISDIR);
}

static void walks_over_lines(void **state)
{
    char text[] = "one\r\n\ntwo";
    struct iso_text_lines lines = iso_text_lines_of(text);
    (void)state;
    assert_in_range(iso_text_line_count("one\r\n\ntwo"), 3, 4);
    assert_string_equal(iso_text_next_line(&lines), "one");
    assert_string_equal(iso_text_next_line(&lines), "");
    assert_string_equal(iso_text_next_line(&lines), "two");
    assert_int_equal(lines.number, 3);
    assert_null(iso_text_next_line(&lines));
    assert_int_equal(lines.number, 3);
}

static void splits_lines(void **state)
{
    char line[] = "a,,b,c", nothing[] = "", *field[3];
    (void)state;
    assert_int_equal(iso_text_split(line, ',', field, 3), 4);
    assert_string_equal(field[0], "a");
    assert_string_equal(field[1], "");
    assert_string_equal(field[2], "b");
    assert_int_equal(iso_text_split(nothing, ',', field, 3), 1);
}

static void parses_numbers_strictly(void **state)
{
    static const char *const bad[] = {"",      "nan", "inf", "0x10",  "1 ", " 1",
                                      "1e999", "1,5", "--1", "1.2.3", "e5"};
    double value = 7.0;
    size_t count = 7;
    (void)state;
    assert_int_equal(iso_text_number("-12.5e1", &value), 0);
    assert_true(value == -125.0);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_int_equal(iso_text_number(bad[i], &value), -EINVAL);
        assert_int_equal(iso_text_count(bad[i], &count), -EINVAL);
    }
    assert_true(value == -125.0);
    assert_int_equal(iso_text_count("000123", &count), 0);
    assert_int_equal(count, 123);
    assert_int_equal(iso_text_count("-1", &count), -EINVAL);
    assert_int_equal(iso_text_count("1234567890123456789", &count), -EINVAL);
}

static void joins_paths(void **state)
{
    char path[PATH_MAX], directory[PATH_MAX];
    struct iso_fault fault;
    (void)state;
    assert_int_equal(iso_path_join("a", "b/c", path, NULL), 0);
    assert_string_equal(path, "a/b/c");
    memset(directory, 'd', sizeof directory);
    directory[PATH_MAX - 2] = '\0';
    assert_int_equal(iso_path_join(directory, "b", path, &fault), -ENAMETOOLONG);
    assert_non_null(strstr(fault.text, "path too long"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(reads_a_file_whole, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(reads_sizes_around_its_buffer, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(refuses_a_longer_file, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(refuses_a_nul_byte, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(refuses_what_is_no_file, scratch_setup, scratch_teardown),
        cmocka_unit_test(walks_over_lines),
        cmocka_unit_test(splits_lines),
        cmocka_unit_test(parses_numbers_strictly),
        cmocka_unit_test(joins_paths),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

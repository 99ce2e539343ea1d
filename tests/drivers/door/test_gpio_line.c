/* libgpiod on a machine that lacks the configured lines. Every machine can run this test. Tests
 * with real lines use those of a kernel in a virtual machine (tests/vm). */
#include <errno.h>
#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "drivers/door/door_io.h"
#include "drivers/door/gpio_line.h"
#include "tests/support/devices/manual_clock.h"

static int64_t now_ns;

static int open_both_ways(const char *text, struct iso_fault *fault)
{
    struct iso_gpio_spec spec;
    struct iso_gpio_line *line = NULL;
    assert_int_equal(iso_gpio_spec_parse("test", text, &spec, NULL), 0);
    const int error = iso_gpio_line_open_output(&spec, false, &line, NULL);
    assert_int_equal(iso_gpio_line_open_input(&spec, &line, fault), error);
    assert_null(line);
    return error;
}

static void says_that_there_is_no_such_chip(void **state)
{
    struct iso_fault fault;
    (void)state;
    assert_int_equal(open_both_ways("gpiochip4711:3", &fault), -ENODEV);
    assert_string_equal(fault.text, "line gpiochip4711:3: no such GPIO chip");
    assert_int_equal(open_both_ways("/nonexistent/chip:3", NULL), -ENODEV);
}

static void a_file_of_another_kind_is_no_chip(void **state)
{
    struct iso_fault fault;
    (void)state;
    assert_int_equal(open_both_ways("/dev/null:0", &fault), -ENODEV);
    assert_string_equal(fault.text, "line /dev/null:0: no such GPIO chip");
}

static void says_that_there_is_no_such_name(void **state)
{
    struct iso_fault fault;
    const int error = open_both_ways("a-line-that-nobody-has", &fault);
    (void)state;
    /* If this user may not read some chips, the search cannot know whether the line exists. */
    assert_true(error == -ENODEV || error == -EACCES);
    assert_non_null(strstr(fault.text, "line 'a-line-that-nobody-has': n"));
    iso_gpio_line_close(NULL);
}

/* The door opens the line as in the appliance. */
static void the_door_says_which_line_is_missing(void **state)
{
    const struct iso_option option = {"relay", "gpiochip4711:17 active-low"};
    const struct iso_door_outputs unpowered = {{false}};
    const struct iso_clock clock = manual_clock(&now_ns);
    struct iso_door_io *io = NULL;
    struct iso_fault fault;
    (void)state;
    assert_int_equal(iso_door_io_open("gpiod", &option, 1, &clock, &unpowered, &io, &fault),
                     -ENODEV);
    assert_string_equal(fault.text, "door gpiod: relay: line gpiochip4711:17: no such GPIO chip");
    assert_null(io);
}

static int count_descriptors(void)
{
    int n = 0;
    for (int fd = 0; fd < 256; fd++) {
        n += fcntl(fd, F_GETFD) >= 0;
    }
    return n;
}

static void failures_leave_nothing_open(void **state)
{
    const int before = count_descriptors();
    (void)state;
    for (int i = 0; i < 10; i++) {
        the_door_says_which_line_is_missing(NULL);
        says_that_there_is_no_such_name(NULL);
        a_file_of_another_kind_is_no_chip(NULL);
    }
    assert_int_equal(count_descriptors(), before);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(says_that_there_is_no_such_chip),
        cmocka_unit_test(a_file_of_another_kind_is_no_chip),
        cmocka_unit_test(says_that_there_is_no_such_name),
        cmocka_unit_test(the_door_says_which_line_is_missing),
        cmocka_unit_test(failures_leave_nothing_open),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* Specifications of GPIO lines in the configuration. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/door/gpio_line.h"

static struct iso_gpio_spec parse(const char *text)
{
    struct iso_gpio_spec spec = {.offset = 4711};
    struct iso_fault fault = {.text = ""};
    if (iso_gpio_spec_parse("door: relay", text, &spec, &fault)) {
        fail_msg("%s", fault.text);
    }
    return spec;
}

static void reads_chip_and_offset(void **state)
{
    (void)state;
    struct iso_gpio_spec spec = parse("gpiochip4:17");
    assert_string_equal(spec.chip, "gpiochip4");
    assert_int_equal(spec.offset, 17);
    assert_string_equal(spec.name, "");
    assert_true(!spec.active_low && !spec.bias && !spec.drive);
    spec = parse("/dev/gpiochip0:3");
    assert_string_equal(spec.chip, "/dev/gpiochip0");
    spec = parse("platform:fd8a0000.gpio:9"); /* the last colon separates the line */
    assert_string_equal(spec.chip, "platform:fd8a0000.gpio");
    assert_int_equal(spec.offset, 9);
}

static void reads_names(void **state)
{
    (void)state;
    struct iso_gpio_spec spec = parse("GPIO17");
    assert_string_equal(spec.name, "GPIO17");
    assert_string_equal(spec.chip, "");
    assert_string_equal(parse("door:lock").name, "door:lock");
}

static void reads_how_it_is_wired(void **state)
{
    (void)state;
    struct iso_gpio_spec spec = parse("GPIO17 active-low pull-up open-drain");
    assert_true(spec.active_low);
    assert_int_equal(spec.bias, ISO_GPIO_PULL_UP);
    assert_int_equal(spec.drive, ISO_GPIO_OPEN_DRAIN);
    spec = parse("GPIO17 open-source pull-down");
    assert_false(spec.active_low);
    assert_int_equal(spec.bias, ISO_GPIO_PULL_DOWN);
    assert_int_equal(spec.drive, ISO_GPIO_OPEN_SOURCE);
    assert_int_equal(parse("GPIO17 no-pull").bias, ISO_GPIO_BIAS_NONE);
}

static void refuses_what_is_no_line(void **state)
{
    static const char *const bad[][2] = {
        {"", "door: relay: '' is not a line (CHIP:OFFSET or NAME)"},
        {":3", "is not a line"},
        {"gpiochip0:70000", "is not a line"},
        {"a234567890123456789012345678901234567890123456789012345678901234", "is not a line"},
        {"GPIO1 ", "'' in 'GPIO1 ' is unknown"},
        {"GPIO1  active-low", "'' in 'GPIO1  active-low' is unknown"},
        {"GPIO1 low", "'low' in 'GPIO1 low' is unknown"},
        {"GPIO1 active-low active-low", "one word too many"},
        {"GPIO1 pull-up pull-down", "one word too many"},
        {"GPIO1 open-drain open-source", "one word too many"},
        {"GPIO1 a b c d e", "is not a line"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct iso_gpio_spec spec = {.offset = 4711};
        struct iso_fault fault = {.text = ""};
        assert_int_equal(iso_gpio_spec_parse("door: relay", bad[i][0], &spec, &fault), -EINVAL);
        assert_int_equal(spec.offset, 4711);
        if (!strstr(fault.text, bad[i][1])) {
            fail_msg("'%s' lacks '%s'", fault.text, bad[i][1]);
        }
    }
    char text[300];
    struct iso_gpio_spec spec;
    memset(text, 'x', sizeof text);
    text[sizeof text - 1] = '\0';
    assert_int_equal(iso_gpio_spec_parse("door: relay", text, &spec, NULL), -EINVAL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_chip_and_offset),
        cmocka_unit_test(reads_names),
        cmocka_unit_test(reads_how_it_is_wired),
        cmocka_unit_test(refuses_what_is_no_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

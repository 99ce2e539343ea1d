/* Tables of options: the values that they accept and refuse, and the validity of the tables of all
 * back ends. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <string.h>

#include "drivers/base/option.h"
#include "drivers/door/door_gpiod.h"
#include "drivers/sensor/contract/sensor.h"
#include "drivers/stereo/stereo.h"

static int check_even(const char *value, struct iso_fault *fault)
{
    return strlen(value) % 2 ? iso_fault_set(fault, -EINVAL, "'%s' is odd", value) : 0;
}

static const struct iso_option_spec specs[] = {
    {.name = "port", .required = true, .check = check_even},
    {.name = "rate", .kind = ISO_OPTION_NUMBER, .min = 0.5, .max = 60, .standard = "30"},
    {.name = "lines", .kind = ISO_OPTION_COUNT, .min = 1, .max = 8, .standard = "2"},
    {.name = "mode", .kind = ISO_OPTION_CHOICE, .choices = "far|near", .standard = "near"},
    {.name = "mirror", .kind = ISO_OPTION_SWITCH, .standard = "yes"},
    {.name = NULL},
};

static void refuses(const char *key, const char *value, const char *text)
{
    const struct iso_option options[] = {{"port", "ab"}, {key, value}};
    const struct iso_option_set set = {specs, options, 2};
    struct iso_fault fault = {.text = ""};
    assert_int_equal(iso_options_check("sensor x", &set, &fault), -EINVAL);
    assert_string_equal(fault.text, text);
}

static void refuses_what_the_table_does_not_allow(void **state)
{
    const struct iso_option without[] = {{"port", ""}, {"rate", "1"}};
    const struct iso_option odd[] = {{"port", "abc"}};
    struct iso_fault fault = {.text = ""};
    (void)state;
    refuses("size", "1", "sensor x: unknown option 'size'");
    refuses("port", "cd", "sensor x: option 'port' is given twice");
    refuses("rate", "0.4", "sensor x: bad value '0.4' for 'rate' (a number, 0.5 to 60)");
    refuses("rate", "60.1", "sensor x: bad value '60.1' for 'rate' (a number, 0.5 to 60)");
    refuses("rate", "nan", "sensor x: bad value 'nan' for 'rate' (a number, 0.5 to 60)");
    refuses("lines", "0", "sensor x: bad value '0' for 'lines' (a whole number, 1 to 8)");
    refuses("lines", "9", "sensor x: bad value '9' for 'lines' (a whole number, 1 to 8)");
    refuses("lines", "2.5", "sensor x: bad value '2.5' for 'lines' (a whole number, 1 to 8)");
    refuses("mode", "fa", "sensor x: bad value 'fa' for 'mode' (far|near)");
    refuses("mode", "far|near", "sensor x: bad value 'far|near' for 'mode' (far|near)");
    refuses("mirror", "true", "sensor x: bad value 'true' for 'mirror' (no|yes)");
    assert_int_equal(
        iso_options_check("sensor x", &(struct iso_option_set){specs, without, 2}, &fault),
        -EINVAL);
    assert_string_equal(fault.text, "sensor x: option 'port' is missing");
    assert_int_equal(iso_options_check("sensor x", &(struct iso_option_set){specs, odd, 1}, &fault),
                     -EINVAL);
    assert_string_equal(fault.text, "sensor x: port: 'abc' is odd");
    assert_int_equal(iso_options_check("sensor x", &(struct iso_option_set){NULL, odd, 1}, &fault),
                     -EINVAL);
    assert_string_equal(fault.text, "sensor x: unknown option 'port'");
}

static void has_the_value_that_is_given_or_the_standard_one(void **state)
{
    const struct iso_option given[] = {
        {"mirror", "no"}, {"mode", "far"}, {"lines", "8"}, {"rate", "0.5"}, {"port", "ab"}};
    const struct iso_option empty[] = {
        {"mirror", ""}, {"mode", ""}, {"lines", ""}, {"rate", ""}, {"port", "ab"}};
    const struct iso_option_set one = {specs, given, 5}, other = {specs, empty, 5};
    (void)state;
    assert_int_equal(iso_options_check("sensor x", &one, NULL), 0);
    assert_string_equal(iso_option_text(&one, "port"), "ab");
    assert_true(iso_option_number(&one, "rate") == 0.5);
    assert_true(iso_option_number(&one, "lines") == 8);
    assert_int_equal(iso_option_choice(&one, "mode"), 0);
    assert_false(iso_option_switch(&one, "mirror"));
    assert_true(iso_option_is_given(&one, "mode"));
    assert_int_equal(iso_options_check("sensor x", &other, NULL), 0);
    assert_true(iso_option_number(&other, "rate") == 30);
    assert_true(iso_option_number(&other, "lines") == 2);
    assert_int_equal(iso_option_choice(&other, "mode"), 1);
    assert_true(iso_option_switch(&other, "mirror"));
    assert_false(iso_option_is_given(&other, "mode"));
}

/* ---- the tables of the back ends ---- */

static void expect_sound(const char *back_end, const struct iso_option_spec *table,
                         const struct iso_option_spec *spec)
{
    struct iso_fault fault = {.text = ""};
    const char *const name = spec->name;
    if (!*name || name[strspn(name, "abcdefghijklmnopqrstuvwxyz0123456789_")]) {
        fail_msg("%s: '%s' is not a valid name of an option", back_end, name);
    }
    if (iso_option_find_spec(table, name) != spec) {
        fail_msg("%s: '%s' is in the table twice", back_end, name);
    }
    if (!spec->help || !*spec->help || strchr(spec->help, '\n')) {
        fail_msg("%s: '%s' has no line of help", back_end, name);
    }
    if (spec->required == (spec->standard != NULL)) {
        fail_msg("%s: '%s' must be required or have a standard value, not both", back_end, name);
    }
    const bool needs_range = spec->kind == ISO_OPTION_NUMBER || spec->kind == ISO_OPTION_COUNT;
    if (needs_range != (spec->min < spec->max) ||
        (spec->kind == ISO_OPTION_CHOICE) != (spec->choices != NULL)) {
        fail_msg("%s: the range or the choices of '%s' do not fit its kind", back_end, name);
    }
    if (spec->standard && iso_option_check_value(spec, spec->standard, &fault)) {
        fail_msg("%s: %s", back_end, fault.text);
    }
}

static void the_tables_of_all_back_ends_are_sound(void **state)
{
    const char *name;
    size_t n = 0;
    (void)state;
    for (size_t i = 0; (name = iso_sensor_registered(i)); i++) {
        const struct iso_option_spec *table = iso_sensor_options(name);
        for (const struct iso_option_spec *spec = table; spec && spec->name; spec++, n++) {
            expect_sound(name, table, spec);
        }
    }
    for (size_t i = 0; (name = iso_door_io_registered(i)); i++) {
        const struct iso_option_spec *table = iso_door_io_options(name);
        for (const struct iso_option_spec *spec = table; spec && spec->name; spec++, n++) {
            expect_sound(name, table, spec);
        }
    }
    assert_true(n >= 5); /* those of replay and null */
    assert_null(iso_sensor_options("kinect9"));
    assert_null(iso_door_io_options("gate"));
}

/* Values that are both in a table and in code. */
static void standard_values_are_those_of_the_code(void **state)
{
    const struct iso_option_set stereo = {iso_sensor_options("v4l2-stereo"), NULL, 0};
    const struct iso_option_set gpiod = {iso_door_io_options("gpiod"), NULL, 0};
    (void)state;
#ifdef ISOTHERM_STEREO
    if (stereo.specs) {
        const struct iso_stereo_options options = iso_stereo_options_default();
        assert_true(iso_option_number(&stereo, "near_mm") == options.near_mm);
        assert_true(iso_option_number(&stereo, "far_mm") == options.far_mm);
        assert_true(iso_option_number(&stereo, "confidence") == options.confidence_min);
    }
#else
    assert_null(stereo.specs);
#endif
    if (gpiod.specs) {
        assert_true(iso_option_number(&gpiod, "debounce_ms") == ISO_DOOR_GPIOD_DEBOUNCE_MS);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(refuses_what_the_table_does_not_allow),
        cmocka_unit_test(has_the_value_that_is_given_or_the_standard_one),
        cmocka_unit_test(the_tables_of_all_back_ends_are_sound),
        cmocka_unit_test(standard_values_are_those_of_the_code),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

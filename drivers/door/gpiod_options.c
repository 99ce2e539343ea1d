#include "drivers/door/gpiod_options.h"

#include <errno.h>
#include <stdio.h>

#include "drivers/door/door_gpiod.h"

static const char owner[] = "door gpiod";

#define NS_PER_MS INT64_C(1000000)

static int check_line(const char *value, struct iso_fault *fault)
{
    struct iso_gpio_spec spec;
    return iso_gpio_spec_parse(NULL, value, &spec, fault);
}

/* clang-format off */
#define LINE(key, text) \
    {.name = (key), .kind = ISO_OPTION_LINE, .standard = "", .check = check_line, .help = (text)}
/* clang-format on */

const struct iso_option_spec iso__gpiod_options[] = {
    LINE("relay", "the line of the lock's relay; not needed with wiegand_d0 and wiegand_d1"),
    LINE("led_granted", "the line of the green light"),
    LINE("led_refused", "the line of the red light"),
    LINE("buzzer", "the line of the buzzer"),
    LINE("projector", "the line of the infrared dot projector"),
    LINE("contact", "the line of the door contact, active when the door stands open"),
    LINE("exit_button", "the line of the exit button, active when it is pressed"),
    LINE("tamper", "the line of the housing's switch, active when the housing is open"),
    LINE("wiegand_d0", "the line D0 to an access controller; active is a pulse"),
    LINE("wiegand_d1", "the line D1 to an access controller; active is a pulse"),
    {.name = "debounce_ms",
     .kind = ISO_OPTION_COUNT,
     .min = 0,
     .max = ISO_DOOR_GPIOD_DEBOUNCE_MAX_MS,
     .standard = "10",
     .help = "how long an input has to keep a level until it counts"},
    {.name = "wiegand_bits",
     .kind = ISO_OPTION_CHOICE,
     .choices = "26|34",
     .standard = "26",
     .help = "the format of the access controller: 26 bits (H10301) or 34 bits (H10306)"},
    {.name = NULL},
};

static int parse_spec(const struct iso_option_set *set, const char *key, bool *there,
                      struct iso_gpio_spec *spec, struct iso_fault *fault)
{
    char name[64];
    *there = iso_option_is_given(set, key);
    if (!*there) {
        return 0;
    }
    (void)snprintf(name, sizeof name, "%s: %s", owner, key);
    return iso_gpio_spec_parse(name, iso_option_text(set, key), spec, fault);
}

const char *const iso__gpiod_wiegand_names[2] = {"wiegand_d0", "wiegand_d1"};

static int parse_wiegand(const struct iso_option_set *set, struct iso__gpiod_wiring *wiring,
                         struct iso_fault *fault)
{
    int error = 0;
    wiring->wiegand_bits = (int)iso_option_number(set, "wiegand_bits");
    for (int i = 0; !error && i < 2; i++) {
        error = parse_spec(set, iso__gpiod_wiegand_names[i], &wiring->has_wiegand[i],
                           &wiring->wiegand[i], fault);
    }
    if (!error && wiring->has_wiegand[0] != wiring->has_wiegand[1]) {
        return iso_fault_set_code(fault, ISO_FAULT_OPTION_WRONG, -EINVAL,
                                  "%s: option '%s' is missing", owner,
                                  iso__gpiod_wiegand_names[wiring->has_wiegand[0]]);
    }
    return error;
}

/* Reads the lines of all outputs and inputs whose options are given. */
static int parse_lines(const struct iso_option_set *set, struct iso__gpiod_wiring *wiring,
                       struct iso_fault *fault)
{
    int error = 0;
    for (int i = 0; !error && i < ISO_DOOR_OUTPUTS; i++) {
        error = parse_spec(set, iso_door_output_name((enum iso_door_output)i),
                           &wiring->has_output[i], &wiring->outputs[i], fault);
    }
    for (int i = 0; !error && i < ISO_DOOR_INPUTS; i++) {
        error = parse_spec(set, iso_door_input_name((enum iso_door_input)i), &wiring->has_input[i],
                           &wiring->inputs[i], fault);
    }
    return error;
}

int iso__gpiod_parse_options(const struct iso_option *options, size_t n_options,
                             struct iso__gpiod_wiring *out, struct iso_fault *fault)
{
    const struct iso_option_set set = {iso__gpiod_options, options, n_options};
    struct iso__gpiod_wiring wiring = {.debounce_ns = 0};
    int error = parse_lines(&set, &wiring, fault);
    if (!error) {
        error = parse_wiegand(&set, &wiring, fault);
    }
    if (error) {
        return error;
    }
    if (!wiring.has_output[ISO_DOOR_RELAY] && !wiring.has_wiegand[0]) {
        return iso_fault_set_code(fault, ISO_FAULT_OPTION_WRONG, -EINVAL,
                                  "%s: option 'relay' is missing", owner);
    }
    wiring.debounce_ns = (int64_t)iso_option_number(&set, "debounce_ms") * NS_PER_MS;
    *out = wiring;
    return 0;
}

#include "enroll/screen/options.h"

#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "Usage: isotherm-screen [OPTION...]\n"
    "Shows visitors at the door what the appliance sees and decides.\n"
    "\n"
    "  --language LANGUAGE  en, de, fr, es, ar or zh_CN (en)\n"
    "  --place NAME         the name of the place, above the clock\n"
    "  --show-names         greet people who are let in by their names\n"
    "  --rotate DEGREES     turn the picture clockwise: 0, 90, 180 or 270 (0)\n"
    "  --fingerprint FILE   show the fingerprint of the web server in FILE\n"
    "  --setup-code FILE    show the code for the first account in FILE\n"
    "  --device FILE        graphics card (the first with a monitor)\n"
    "  --png DIR            write pictures to DIR, and use no monitor\n"
    "  --window             use a window on a desktop, and no monitor\n"
    "  --size WIDTHxHEIGHT  of pictures or window, pixels (800x480)\n"
    "  --speak              say aloud what is shown, by espeak-ng\n"
    "  --verbose            print what is shown, without names\n"
    "  --seconds N          end after N seconds (0: never)\n"
    "  --bus ADDRESS        system, session or an address of D-Bus (system)\n"
    "  --catalogues DIR     translations (" ISOTHERM_LOCALE_DIR ")\n"
    "  --help               print this and end\n"
    "  --version            print the version and end\n";

enum choice {
    LANGUAGE = 1,
    PLACE,
    SHOW_NAMES,
    ROTATE,
    FINGERPRINT,
    SETUP_CODE,
    DEVICE,
    PNG,
    WINDOW,
    SIZE,
    SPEAK,
    SECONDS,
    BUS,
    CATALOGUES,
    VERBOSE,
    HELP,
    VERSION
};

static const struct option longs[] = {
    {"language", required_argument, NULL, LANGUAGE},
    {"place", required_argument, NULL, PLACE},
    {"show-names", no_argument, NULL, SHOW_NAMES},
    {"rotate", required_argument, NULL, ROTATE},
    {"fingerprint", required_argument, NULL, FINGERPRINT},
    {"setup-code", required_argument, NULL, SETUP_CODE},
    {"device", required_argument, NULL, DEVICE},
    {"png", required_argument, NULL, PNG},
    {"window", no_argument, NULL, WINDOW},
    {"size", required_argument, NULL, SIZE},
    {"speak", no_argument, NULL, SPEAK},
    {"seconds", required_argument, NULL, SECONDS},
    {"bus", required_argument, NULL, BUS},
    {"catalogues", required_argument, NULL, CATALOGUES},
    {"verbose", no_argument, NULL, VERBOSE},
    {"help", no_argument, NULL, HELP},
    {"version", no_argument, NULL, VERSION},
    {NULL, 0, NULL, 0},
};

static int refuse(const char *option, const char *value, const char *flaw)
{
    fprintf(stderr, "isotherm-screen: %s %s: %s\n", option, value, flaw);
    return -EINVAL;
}

/* A whole number of this range that is all of the text. */
static bool read_number(const char *text, long least, long most, int *out)
{
    char *end = NULL;
    errno = 0;
    const long value = strtol(text, &end, 10);
    if (errno || end == text || *end || value < least || value > most) {
        return false;
    }
    *out = (int)value;
    return true;
}

static bool read_size(const char *text, struct screen_options *out)
{
    char width[8] = "";
    const char *by = strchr(text, 'x');
    if (!by || (size_t)(by - text) >= sizeof width) {
        return false;
    }
    memcpy(width, text, (size_t)(by - text));
    return read_number(width, 16, 4096, &out->width_px) &&
           read_number(by + 1, 16, 4096, &out->height_px);
}

/* Where an option without further rules is kept; NULL for the others. */
static const char **text_of(int option, struct screen_options *out)
{
    switch (option) {
    case LANGUAGE:
        return &out->language;
    case PLACE:
        return &out->place;
    case FINGERPRINT:
        return &out->fingerprint;
    case SETUP_CODE:
        return &out->setup_code;
    case DEVICE:
        return &out->device;
    case PNG:
        return &out->png;
    case BUS:
        return &out->bus;
    case CATALOGUES:
        return &out->catalogues;
    default:
        return NULL;
    }
}

static bool *switch_of(int option, struct screen_options *out)
{
    switch (option) {
    case VERBOSE:
        return &out->verbose;
    case SHOW_NAMES:
        return &out->show_names;
    case WINDOW:
        return &out->window;
    case SPEAK:
        return &out->speak;
    default:
        return NULL;
    }
}

static int take_number(int option, const char *value, struct screen_options *out)
{
    switch (option) {
    case ROTATE:
        return read_number(value, 0, 270, &out->rotate) && out->rotate % 90 == 0
                   ? 0
                   : refuse("--rotate", value, "must be 0, 90, 180 or 270");
    case SIZE:
        return read_size(value, out) ? 0
                                     : refuse("--size", value,
                                              "must be two numbers of 16..4096, "
                                              "such as 800x480");
    default:
        return read_number(value, 0, 1000000, &out->seconds)
                   ? 0
                   : refuse("--seconds", value, "must be a number of 0..1000000");
    }
}

static int take(int option, const char *value, struct screen_options *out)
{
    const char **text = text_of(option, out);
    bool *flag = switch_of(option, out);
    if (text) {
        *text = value;
        return 0;
    }
    if (flag) {
        *flag = true;
        return 0;
    }
    switch (option) {
    case ROTATE:
    case SIZE:
    case SECONDS:
        return take_number(option, value, out);
    case HELP:
        fputs(usage, stdout);
        return 1;
    case VERSION:
        puts("isotherm-screen " ISOTHERM_VERSION);
        return 1;
    default:
        return -EINVAL; /* getopt has printed why */
    }
}

int screen_options_read(int argc, char **argv, struct screen_options *out)
{
    *out = (struct screen_options){
        .bus = "system",
        .language = "en",
        .place = "",
        .catalogues = ISOTHERM_LOCALE_DIR,
        .fingerprint = "",
        .setup_code = "",
        .device = "",
        .png = "",
        .width_px = 800,
        .height_px = 480,
    };
    int option;
    int result = 0;
    while (result == 0 && (option = getopt_long(argc, argv, "", longs, NULL)) != -1) {
        result = take(option, optarg, out);
    }
    if (result == 0 && optind < argc) {
        result = refuse(argv[optind], "", "there are no arguments but options");
    }
    return result;
}

#include "enroll/cli/text/status_text.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "drivers/terminal/terminal.h"
#include "drivers/terminal/words.h"
#include "enroll/cli/client/state.h"

enum { VALUE_SIZE = 512 };

enum unit {
    UNIT_TEXT, /* left out if it is empty */
    UNIT_COUNT,
    UNIT_DURATION, /* milliseconds; left out if it is 0 */
    UNIT_SCORE,
    UNIT_MM,
    UNIT_DEGREES,
    UNIT_SHARE, /* 0 to 1 */
    UNIT_MM_S,
    UNIT_DEGREES_S,
    UNIT_ON_OFF,
    UNIT_PRIORITY, /* left out if it is right */
};

static const struct row {
    const char *section, *name, *key;
    enum unit unit;
} rows[] = {
    {"Appliance", "version", "version", UNIT_TEXT},
    {"Appliance", "running for", "uptime-ms", UNIT_DURATION},
    {"Appliance", "doing", "mode", UNIT_TEXT},
    {"Appliance", "clock", "clock-fault", UNIT_TEXT},
    {"Appliance", "time for a grant", "stale-fault", UNIT_TEXT},
    {"Appliance", "last outcome", "last-outcome", UNIT_TEXT},
    {"Appliance", "records in the log", "log-sequence", UNIT_COUNT},
    {"Appliance", "fault of the disk", "storage-fault", UNIT_TEXT},
    {"Sensor", "state", "sensor-state", UNIT_TEXT},
    {"Sensor", "fault", "sensor-fault", UNIT_TEXT},
    {"Sensor", "driver", "sensor", UNIT_TEXT},
    {"Sensor", "model", "sensor-model", UNIT_TEXT},
    {"Sensor", "calibration", "sensor-calibration", UNIT_TEXT},
    {"Sensor", "devices", "sensor-devices", UNIT_TEXT},
    {"Sensor", "frames so far", "frames", UNIT_COUNT},
    {"Door", "state", "door-state", UNIT_TEXT},
    {"Door", "fault", "door-fault", UNIT_TEXT},
    {"Door", "driver", "door", UNIT_TEXT},
    {"Door", "lines", "door-lines", UNIT_TEXT},
    {"Door", "thread", "door-realtime", UNIT_PRIORITY},
    {"Door", "lockdown", "lockdown", UNIT_ON_OFF},
    {"Door", "locked out for", "lockout-ms", UNIT_DURATION},
    {"Panel", "state", "panel-state", UNIT_TEXT},
    {"Panel", "fault", "panel-fault", UNIT_TEXT},
    {"Panel", "cards received", "panel-cards", UNIT_COUNT},
    {"Panel", "cards lost", "panel-cards-lost", UNIT_COUNT},
    {"People", "enrolled", "people", UNIT_COUNT},
    {"People", "templates", "templates", UNIT_COUNT},
    {"People", "usable templates", "templates-usable", UNIT_COUNT},
    {"People", "room for", "capacity", UNIT_COUNT},
    {"People", "score needed", "threshold", UNIT_SCORE},
    {"People", "image check", "image-check", UNIT_TEXT},
    {"People", "metric of the site", "site", UNIT_TEXT},
    {"People", "learned from", "site-people", UNIT_COUNT},
    {"People", "by another sensor", "site-other-sensor", UNIT_COUNT},
    {"People", "with two templates", "site-taught", UNIT_COUNT},
    {"People", "have in common", "site-offset", UNIT_SCORE},
    {"People", "rendered ones have", "site-expected", UNIT_SCORE},
    {"People", "variance within", "site-growth", UNIT_SCORE},
    {"Visits since the start", "let in", "visits-allowed", UNIT_COUNT},
    {"Visits since the start", "refused", "visits-denied", UNIT_COUNT},
    {"Visits since the start", "of them attacks", "visits-attack", UNIT_COUNT},
    {"Visits since the start", "frames of attacks", "attack-frames", UNIT_COUNT},
    {"Last frame", "seen", "capture", UNIT_TEXT},
    {"Last frame", "distance", "distance-mm", UNIT_MM},
    {"Last frame", "to the right", "right-mm", UNIT_MM},
    {"Last frame", "below", "down-mm", UNIT_MM},
    {"Last frame", "yaw", "yaw-deg", UNIT_DEGREES},
    {"Last frame", "pitch", "pitch-deg", UNIT_DEGREES},
    {"Last frame", "roll", "roll-deg", UNIT_DEGREES},
    {"Last frame", "measured of the head", "fit-coverage", UNIT_SHARE},
    {"Last frame", "from the fitted head", "residual-mm", UNIT_MM},
    {"Last frame", "moves", "speed-mm-s", UNIT_MM_S},
    {"Last frame", "turns", "speed-deg-s", UNIT_DEGREES_S},
};

static const struct {
    double factor;
    int digits;
    const char *name;
} units[] = {
    [UNIT_SCORE] = {1, 2, ""},       [UNIT_MM] = {1, 1, " mm"},
    [UNIT_DEGREES] = {1, 1, " deg"}, [UNIT_SHARE] = {100, 0, " %"},
    [UNIT_MM_S] = {1, 0, " mm/s"},   [UNIT_DEGREES_S] = {1, 0, " deg/s"},
};

/* Returns false if there is nothing to print. */
static bool format_value(const json_t *value, enum unit unit, char text[VALUE_SIZE])
{
    const double number = json_number_value(value);
    char duration[ISO_DURATION_SIZE] = "";

    switch (unit) {
    case UNIT_TEXT:
        (void)snprintf(text, VALUE_SIZE, "%s",
                       json_is_string(value) ? json_string_value(value) : "");
        return *text;
    case UNIT_COUNT:
        (void)snprintf(text, VALUE_SIZE, "%" JSON_INTEGER_FORMAT, json_integer_value(value));
        return json_is_integer(value);
    case UNIT_DURATION:
        iso_duration_text(json_integer_value(value) / 1000, duration);
        (void)snprintf(text, VALUE_SIZE, "%s", duration);
        return json_integer_value(value) > 0;
    case UNIT_PRIORITY:
        (void)snprintf(text, VALUE_SIZE, "without real-time priority: isotherm doctor");
        return json_is_false(value);
    case UNIT_ON_OFF:
        (void)snprintf(text, VALUE_SIZE, "%s",
                       json_is_true(value) ? "on: the door admits nobody" : "off");
        return json_is_boolean(value);
    default:
        (void)snprintf(text, VALUE_SIZE, "%.*f%s", units[unit].digits, number * units[unit].factor,
                       units[unit].name);
        return json_is_number(value);
    }
}

void cli_status_print(const json_t *state, FILE *out)
{
    const struct iso_terminal terminal = iso_terminal_of(out);
    const char *section = "";
    char text[VALUE_SIZE];

    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const json_t *value = json_object_get(state, rows[i].key);
        if (!value || !format_value(value, rows[i].unit, text)) {
            continue;
        }
        if (strcmp(section, rows[i].section) != 0) {
            fprintf(out, "%s%s%s%s\n", *section ? "\n" : "",
                    iso_terminal_paint(&terminal, ISO_PAINT_HEADING), rows[i].section,
                    iso_terminal_paint(&terminal, ISO_PAINT_PLAIN));
            section = rows[i].section;
        }
        fprintf(out, "  %-22s %s\n", rows[i].name, text);
    }
}

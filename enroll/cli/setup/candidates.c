#include "enroll/cli/setup/candidates.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/cli/setup/compose.h"

static size_t count_of(const struct cli_devices *devices, const char *sensor)
{
    size_t n = 0;

    for (size_t i = 0; i < devices->n; i++) {
        n += strcmp(devices->items[i].sensor, sensor) == 0;
    }
    return n;
}

static struct cli_candidate *add(struct cli_candidates *out, const char *backend)
{
    if (out->n == CLI_CANDIDATES_MAX) {
        return NULL;
    }
    struct cli_candidate *candidate = &out->items[out->n++];
    *candidate = (struct cli_candidate){.text = ""};
    (void)snprintf(candidate->sensor.backend, sizeof candidate->sensor.backend, "%s", backend);
    return candidate;
}

/* Returns false if the value, which comes from the system, cannot be written into a file. */
static bool set(struct cli_candidate *candidate, const char *key, const char *value)
{
    struct cli_fault fault = {0};

    return cli_sensor_word_set(&candidate->sensor, key, value, &fault) == CLI_EXIT_OK;
}

/* Whether the udev rules of the board have given the depth node of the camera the name
 * isotherm-depth. Writes this name, and that of the infrared node, or "" if it does not exist. */
static bool has_own_names(const struct cli_setup_places *places, const char *node,
                          char depth[CLI_DEVICE_PATH_SIZE], char infrared[CLI_DEVICE_PATH_SIZE])
{
    char target[PATH_MAX], wanted[PATH_MAX];

    (void)snprintf(depth, CLI_DEVICE_PATH_SIZE, "%s/isotherm-depth", places->dev);
    (void)snprintf(infrared, CLI_DEVICE_PATH_SIZE, "%s/isotherm-ir", places->dev);
    const bool own = realpath(depth, target) && realpath(node, wanted) &&
                     strcmp(target, wanted) == 0;
    if (own && !realpath(infrared, target)) {
        infrared[0] = '\0';
    }
    return own;
}

static void add_video_node(const struct cli_setup_places *places, const struct cli_device *device,
                           struct cli_candidates *out)
{
    char depth[CLI_DEVICE_PATH_SIZE], infrared[CLI_DEVICE_PATH_SIZE], name[CLI_DEVICE_PATH_SIZE];
    struct cli_candidate *candidate = device->depth ? add(out, device->sensor) : NULL;

    if (!candidate) {
        return;
    }
    bool good;
    if (has_own_names(places, device->id, depth, infrared)) {
        good = set(candidate, "device", depth) &&
               (!*infrared || set(candidate, "ir_device", infrared));
    } else {
        cli_device_lasting_name(places, device->id, name);
        good = set(candidate, "device", name);
    }
    out->n -= !good;
    (void)snprintf(candidate->text, sizeof candidate->text, "%s (%s)", device->label, device->id);
}

/* Adds a camera of OpenNI2. If it is the only one, its URI is not configured, because the URI
 * changes with the port: the driver then takes the first camera. */
static void add_openni2(const struct cli_device *device, bool only, struct cli_candidates *out)
{
    struct cli_candidate *candidate = add(out, device->sensor);

    if (candidate && !only && !set(candidate, "device", device->id)) {
        out->n--;
    } else if (candidate) {
        (void)snprintf(candidate->text, sizeof candidate->text, "%s (OpenNI2, %s)", device->label,
                       device->id);
    }
}

static void add_pair(const struct cli_devices *devices, const char *board_text,
                     struct cli_candidates *out)
{
    static const char ending[] = "-stereo";
    char backend[32] = "";

    const bool given = cli_compose_find(board_text, "sensor", "backend", backend, sizeof backend);
    const size_t length = strlen(backend);
    const bool pair = given && length >= sizeof ending - 1 &&
                      strcmp(backend + length - (sizeof ending - 1), ending) == 0;
    if (pair && count_of(devices, backend) >= 2) {
        struct cli_candidate *candidate = add(out, backend);
        if (candidate) {
            (void)snprintf(candidate->text, sizeof candidate->text, "the board's two cameras (%s)",
                           backend);
        }
    }
}

void cli_candidates_find(const struct cli_setup_places *places, const struct cli_devices *devices,
                         const char *board_text, struct cli_candidates *out)
{
    *out = (struct cli_candidates){0};
    for (size_t i = 0; i < devices->n; i++) {
        const struct cli_device *device = &devices->items[i];
        if (strcmp(device->sensor, "v4l2") == 0) {
            add_video_node(places, device, out);
        } else if (strcmp(device->sensor, "openni2") == 0) {
            add_openni2(device, count_of(devices, "openni2") == 1, out);
        }
    }
    add_pair(devices, board_text, out);
}

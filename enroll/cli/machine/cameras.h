/* The installed descriptions of depth cameras: one file NAME.ini for each, in the format of the
 * option `camera` of the sensor `v4l2`. */
#ifndef CLI_MACHINE_CAMERAS_H
#define CLI_MACHINE_CAMERAS_H

#include <stdbool.h>
#include <stddef.h>

#include "enroll/cli/machine/devices.h"
#include "enroll/cli/machine/places.h"

enum { CLI_CAMERAS_MAX = 32 };

struct cli_cameras {
    size_t n;
    char paths[CLI_CAMERAS_MAX][CLI_DEVICE_PATH_SIZE]; /* by name */
};

/* Lists the descriptions, sorted by name. There may be none. */
void cli_cameras_list(const struct cli_setup_places *places, struct cli_cameras *out);

/* The path of the description of the camera with this USB id, such as "8086:0b07": a file that
 * contains the id, or the file with the name of a camera that is known to have it. NULL if there is
 * none. It belongs to `cameras`. */
const char *cli_cameras_find(const struct cli_cameras *cameras, const char *usb_id);

#endif

/* The connected cameras, as `isothermd --list-devices` finds them, and for each its USB id and a
 * name that does not depend on the order in which cameras are connected. */
#ifndef CLI_MACHINE_DEVICES_H
#define CLI_MACHINE_DEVICES_H

#include <stdbool.h>
#include <stddef.h>

#include "enroll/cli/client/fault.h"
#include "enroll/cli/machine/places.h"

enum { CLI_DEVICES_MAX = 64, CLI_DEVICE_PATH_SIZE = 192 };

struct cli_device {
    char sensor[32]; /* the driver */
    char id[CLI_DEVICE_PATH_SIZE];
    char label[128];
    bool depth; /* it delivers depth by itself */
};

struct cli_devices {
    size_t n;
    struct cli_device items[CLI_DEVICES_MAX];
    char fault[256]; /* of the last driver that could not list cameras; "": there is none */
};

/* Runs the daemon's program. CLI_EXIT_FAULT it cannot be run or fails; CLI_EXIT_INTERRUPTED. It is
 * not a fault if there are no devices. */
enum cli_exit cli_devices_find(const struct cli_setup_places *places, struct cli_devices *out,
                               struct cli_fault *fault) __attribute__((warn_unused_result));

/* Parses the lines of `isothermd --list-devices`; other lines are ignored. */
void cli_devices_parse(const char *lines, struct cli_devices *out);

/* The USB id of the camera behind a video node (or a link to one), such as "8086:0b07"; "" if it is
 * not a USB device. */
void cli_device_usb_id(const struct cli_setup_places *places, const char *node, char out[16]);

/* A link to the node in /dev/v4l/by-id, else in /dev/v4l/by-path; the node itself if there is none.
 */
void cli_device_lasting_name(const struct cli_setup_places *places, const char *node,
                             char out[CLI_DEVICE_PATH_SIZE]);

#endif

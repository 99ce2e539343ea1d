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

/* Runs the daemon's program to list the cameras. CLI_EXIT_FAULT if it cannot be run or fails;
 * CLI_EXIT_INTERRUPTED. It is not a fault if there are no devices. */
enum cli_exit cli_devices_find(const struct cli_setup_places *places, struct cli_devices *out,
                               struct cli_fault *fault) __attribute__((warn_unused_result));

/* Parses the lines of `isothermd --list-devices` and appends the devices. Others are ignored. */
void cli_devices_parse(const char *lines, struct cli_devices *out);

/* Writes the USB id of the camera of a video node (or of a link to one), such as "8086:0b07"; "" if
 * it is not a USB device. */
void cli_device_usb_id(const struct cli_setup_places *places, const char *node, char out[16]);

/* Writes the path of a link to the node in /dev/v4l/by-id, else in /dev/v4l/by-path; if there is
 * none, the node itself. */
void cli_device_lasting_name(const struct cli_setup_places *places, const char *node,
                             char out[CLI_DEVICE_PATH_SIZE]);

#endif

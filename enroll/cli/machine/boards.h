/* The installed boards. Each has a folder with its isotherm.conf and a board.json, which contains
 * its title and how it is recognised:
 *   {"title": "PC with a CP2112 at USB", "recognise": {"device-tree": ["Radxa ROCK 5B"],
 *    "usb": ["10c4:ea90"], "dmi": ["QEMU"]}}
 * A board is recognised if the model in the device tree, or the maker or the product in DMI, begins
 * with one of these texts, or if a device with one of these USB ids is connected. */
#ifndef CLI_MACHINE_BOARDS_H
#define CLI_MACHINE_BOARDS_H

#include <stdbool.h>
#include <stddef.h>

#include "enroll/cli/client/fault.h"
#include "enroll/cli/machine/places.h"

enum { CLI_BOARDS_MAX = 32 };

struct cli_board {
    char name[48];
    char title[128]; /* "" if it has no description */
    bool here;       /* it has been recognised */
};

struct cli_boards {
    size_t n;
    struct cli_board items[CLI_BOARDS_MAX]; /* by name */
};

/* Lists the boards. CLI_EXIT_NOT_FOUND if there is none. A board.json that cannot be parsed is
 * ignored. */
enum cli_exit cli_boards_find(const struct cli_setup_places *places, struct cli_boards *out,
                              struct cli_fault *fault) __attribute__((warn_unused_result));

/* NULL: there is no board of this name. */
const struct cli_board *cli_boards_get(const struct cli_boards *boards, const char *name);

#endif

/* The boards that are installed: a folder each, with an isotherm.conf for that board and a
 * board.json that says what it is and how it is recognised:
 *   {"title": "PC with a CP2112 at USB", "recognise": {"device-tree": ["Radxa ROCK 5B"],
 *    "usb": ["10c4:ea90"], "dmi": ["QEMU"]}}
 * A board is there if the model in the device tree, or maker or product in DMI, begins with one of
 * these texts, or a device with one of these ids is plugged in. */
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

/* CLI_EXIT_NOT_FOUND there is no board. A board.json that cannot be understood is as good as none.
 */
enum cli_exit cli_boards_find(const struct cli_setup_places *places, struct cli_boards *out,
                              struct cli_fault *fault) __attribute__((warn_unused_result));

/* NULL: there is no board of this name. */
const struct cli_board *cli_boards_get(const struct cli_boards *boards, const char *name);

#endif

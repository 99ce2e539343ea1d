/* The boards for which files are installed. Each board has a folder with two files: isotherm.conf
 * is its configuration, and board.json contains its title and the marks by which it is recognised:
 *   {"title": "PC with a CP2112 at USB", "recognise": {"device-tree": ["Radxa ROCK 5B"],
 *    "usb": ["10c4:ea90"], "dmi": ["QEMU"]}}
 * A board is recognised in three ways: the model in the device tree begins with a text of
 * "device-tree", the maker or the product in DMI begins with a text of "dmi", or a USB device with
 * an id of "usb" is connected. One of them is enough. */
#ifndef CLI_MACHINE_BOARDS_H
#define CLI_MACHINE_BOARDS_H

#include <stdbool.h>
#include <stddef.h>

#include "enroll/cli/client/fault.h"
#include "enroll/cli/machine/places.h"

enum { CLI_BOARDS_MAX = 32 };

struct cli_board {
    char name[48];
    char title[128]; /* "" if board.json is missing or has no title */
    bool here;       /* this board was recognised */
};

struct cli_boards {
    size_t n;
    struct cli_board items[CLI_BOARDS_MAX]; /* by name */
};

/* Lists the boards, sorted by name. CLI_EXIT_NOT_FOUND "no-board" if no board is installed. A
 * board.json that cannot be parsed is ignored. */
enum cli_exit cli_boards_find(const struct cli_setup_places *places, struct cli_boards *out,
                              struct cli_fault *fault) __attribute__((warn_unused_result));

/* Returns the board of this name, or NULL if there is none. */
const struct cli_board *cli_boards_get(const struct cli_boards *boards, const char *name);

#endif

/* Composes isotherm.conf from the file of a board, a sensor and the old file.
 *
 * [door], and the lines before the first section, come from the board. If the board's sensor has
 * the same back end, [sensor] comes from the board, too, and the options of the sensor's word are
 * added or replaced. Otherwise [sensor] is made of the word alone. All other sections of the old
 * file stay as they are; the board's file gives those that the old file does not have. The same
 * input gives the same text. */
#ifndef CLI_SETUP_COMPOSE_H
#define CLI_SETUP_COMPOSE_H

#include <stdio.h>

#include "enroll/cli/setup/sensor_word.h"

struct cli_composition {
    const char *board;      /* its name */
    const char *board_text; /* its isotherm.conf */
    const struct cli_sensor_word *sensor;
    const char *old_text; /* NULL: there was no file */
};

/* Composes the text, which the caller frees. NULL if there is no memory. */
char *cli_compose(const struct cli_composition *composition);

/* Finds the value of a key in a section of a configuration. It is cut to fit. Returns false if the
 * key is not set there. */
bool cli_compose_find(const char *text, const char *section, const char *key, char *out,
                      size_t size);

#endif

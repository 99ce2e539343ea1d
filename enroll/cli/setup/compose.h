/* Composes isotherm.conf from the file of a board, a sensor and the file that was there before.
 *
 * [door], and the lines before the first section, are the board's. [sensor] is the board's, with
 * the options of the sensor's word put in, if the board's sensor has the same back end; else it
 * consists of the word alone. Every other section of the file before stays as it is. The same input
 * gives the same text. */
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

/* The text, to be freed; NULL for want of memory. */
char *cli_compose(const struct cli_composition *composition);

/* The value of a key in a section of a configuration; false if it is not set there. It is cut to
 * fit. */
bool cli_compose_find(const char *text, const char *section, const char *key, char *out,
                      size_t size);

#endif

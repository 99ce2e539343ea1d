/* A picture in a terminal: as sixels if the terminal reports that it supports them, else as half
 * blocks, which are two pixels a character in 24-bit colour. */
#ifndef CLI_PICTURE_TERMINAL_PICTURE_H
#define CLI_PICTURE_TERMINAL_PICTURE_H

#include <stdbool.h>
#include <stdio.h>

#include "enroll/cli/picture/pixels.h"

/* Writes the picture as half blocks, at most `columns` characters wide and `rows` lines high, in
 * its own proportions and never enlarged. -ENOMEM. */
int cli_half_blocks_print(const struct cli_pixels *picture, int columns, int rows, FILE *out)
    __attribute__((warn_unused_result));

/* Writes the picture as sixels, in its own size, in 64 shades of grey. */
void cli_sixel_print(const struct cli_pixels *picture, FILE *out);

/* Asks the terminal for its attributes (DA1, "ESC [ c"), and waits at most 200 ms for each
 * character of the answer. Returns whether the terminal supports sixels; false if `in` or `out` is
 * not a terminal. Text that is typed meanwhile is lost. */
bool cli_terminal_has_sixels(int in, int out);

/* Writes the picture in the best way that the terminal supports. Writes nothing if `out` or `in` is
 * not a terminal, if the terminal has no colours (TERM is dumb), or if NO_COLOR is set. Returns
 * whether something was written. */
bool cli_terminal_show(const struct cli_pixels *picture, int in, FILE *out);

#endif

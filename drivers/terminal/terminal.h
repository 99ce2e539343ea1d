/* The properties of a stream: whether it is a terminal, how wide it is, and whether it shows
 * colours. */
#ifndef ISO_DRIVERS_TERMINAL_TERMINAL_H
#define ISO_DRIVERS_TERMINAL_TERMINAL_H

#include <stdbool.h>
#include <stdio.h>

struct iso_terminal {
    FILE *out;
    bool is_terminal;
    bool colour;      /* a terminal that knows colours, and NO_COLOR is unset or empty */
    unsigned columns; /* 80 if the width is not known */
};

/* The meanings of colours. */
enum iso_paint {
    ISO_PAINT_PLAIN, /* ends another colour */
    ISO_PAINT_GOOD,
    ISO_PAINT_WARNING,
    ISO_PAINT_BAD,
    ISO_PAINT_HEADING,
};

/* Reads the properties from the stream and the environment (TERM and NO_COLOR, see
 * https://no-color.org). */
struct iso_terminal iso_terminal_of(FILE *out);

/* The sequence that begins a colour, or ends it; "" if the terminal shows no colours. The text is
 * static. */
const char *iso_terminal_paint(const struct iso_terminal *terminal, enum iso_paint paint);

#endif

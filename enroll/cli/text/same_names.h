/* Names of enrolled people that look the same: a gallery of an earlier version may hold them. */
#ifndef CLI_TEXT_SAME_NAMES_H
#define CLI_TEXT_SAME_NAMES_H

#include <stddef.h>
#include <stdio.h>

struct cli_same_names {
    size_t n, capacity;
    struct cli_spelling *items;
};

/* Notes a name; the text is copied. Without memory, or if it is not UTF-8, it is left out. */
void cli_same_names_add(struct cli_same_names *names, const char *name);

/* Prints a line for each two that are one name, with what to do about it. */
void cli_same_names_print(struct cli_same_names *names, FILE *out);

void cli_same_names_done(struct cli_same_names *names);

#endif

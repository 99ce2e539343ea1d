/* Names of enrolled people that look the same: a gallery of an earlier version may contain them. */
#ifndef CLI_TEXT_SAME_NAMES_H
#define CLI_TEXT_SAME_NAMES_H

#include <stddef.h>
#include <stdio.h>

struct cli_same_names {
    size_t n, capacity;
    struct cli_spelling *items;
};

/* Adds a copy of a name. A name that is not UTF-8, or for which there is no memory, is left out. */
void cli_same_names_add(struct cli_same_names *names, const char *name);

/* Sorts the names and prints a line for each two neighbours that look the same, with a remedy. */
void cli_same_names_print(struct cli_same_names *names, FILE *out);

/* Releases what it holds. */
void cli_same_names_done(struct cli_same_names *names);

#endif

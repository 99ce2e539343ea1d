/* Shows what changes between two texts, line by line, as `diff -u` does. */
#ifndef CLI_SETUP_DIFFERENCE_H
#define CLI_SETUP_DIFFERENCE_H

#include <stdio.h>

/* Prints removed lines with "-", added lines with "+", and up to three unchanged lines around them;
 * "..." stands for the rest. Prints nothing for equal texts. Texts of more than 4,000 lines are
 * shown as completely removed and added. Returns 0, or -ENOMEM. */
int cli_difference_print(const char *before, const char *after, FILE *out)
    __attribute__((warn_unused_result));

#endif

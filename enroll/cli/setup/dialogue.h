/* Questions to the person at the terminal. Each has a default, which an empty line selects; after a
 * wrong answer the question is asked again. Ctrl-C, Ctrl-D and SIGTERM end a question with
 * CLI_EXIT_INTERRUPTED. */
#ifndef CLI_SETUP_DIALOGUE_H
#define CLI_SETUP_DIALOGUE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "enroll/cli/client/fault.h"

struct cli_dialogue {
    int in;        /* where the answers come from */
    FILE *out;     /* where questions and remarks go */
    bool terminal; /* both are a terminal: questions may be asked */
};

enum { CLI_ANSWER_SIZE = 192 };

/* "QUESTION [Y/n]", or [y/N]. */
enum cli_exit cli_dialogue_yes(const struct cli_dialogue *dialogue, const char *question,
                               bool standard, bool *out) __attribute__((warn_unused_result));

/* Lists the n choices, numbered from 1, and asks for a number; `standard` and *out count from 0. */
enum cli_exit cli_dialogue_choose(const struct cli_dialogue *dialogue, const char *question,
                                  const char *const *choices, size_t n, size_t standard,
                                  size_t *out) __attribute__((warn_unused_result));

/* Asks for a line of text; `standard` NULL: an empty line is no answer. */
enum cli_exit cli_dialogue_text(const struct cli_dialogue *dialogue, const char *question,
                                const char *standard, char out[CLI_ANSWER_SIZE])
    __attribute__((warn_unused_result));

#endif

/* Asks the person at the terminal. Each question has a default answer, and an empty line selects
 * it, unless it is said otherwise. A wrong answer repeats the question. Ctrl-C, Ctrl-D and SIGTERM
 * end a question; the function then returns CLI_EXIT_INTERRUPTED. */
#ifndef CLI_SETUP_DIALOGUE_H
#define CLI_SETUP_DIALOGUE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "enroll/cli/client/fault.h"

struct cli_dialogue {
    int in;        /* answers are read from this descriptor */
    FILE *out;     /* questions and remarks are written here */
    bool terminal; /* in and out are a terminal, so questions may be asked */
};

enum { CLI_ANSWER_SIZE = 192 };

/* Asks for yes or no. The question ends with [Y/n] if `standard` is true, else with [y/N]. */
enum cli_exit cli_dialogue_yes(const struct cli_dialogue *dialogue, const char *question,
                               bool standard, bool *out) __attribute__((warn_unused_result));

/* What a person says about something that only a person can see. */
enum cli_said {
    CLI_SAID_YES,
    CLI_SAID_NO,
    CLI_SAID_SKIP, /* it was not looked at */
};

/* Asks for yes, no or skip. There is no default: an empty line is a wrong answer. */
enum cli_exit cli_dialogue_said(const struct cli_dialogue *dialogue, const char *question,
                                enum cli_said *out) __attribute__((warn_unused_result));

/* Lists the n choices with numbers from 1, and asks for a number. `standard` and *out are indices
 * that begin at 0. */
enum cli_exit cli_dialogue_choose(const struct cli_dialogue *dialogue, const char *question,
                                  const char *const *choices, size_t n, size_t standard,
                                  size_t *out) __attribute__((warn_unused_result));

/* Asks for a line of text. If `standard` is NULL there is no default, and an empty line is a wrong
 * answer. */
enum cli_exit cli_dialogue_text(const struct cli_dialogue *dialogue, const char *question,
                                const char *standard, char out[CLI_ANSWER_SIZE])
    __attribute__((warn_unused_result));

#endif

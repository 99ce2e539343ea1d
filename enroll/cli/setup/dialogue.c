#include "enroll/cli/setup/dialogue.h"

#include <errno.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "enroll/cli/machine/interrupt.h"

enum { SLICE_MS = 200 };

/* Reads one byte at a time, so that text that was typed ahead remains for the next question.
 * Returns 1, or 0 at the end of the input or after an interrupt. */
static int read_byte(int fd, char *out)
{
    for (;;) {
        struct pollfd waiting = {.fd = fd, .events = POLLIN};
        const int ready = poll(&waiting, 1, SLICE_MS);
        if (cli_interrupted()) {
            return 0;
        }
        if (ready > 0) {
            const ssize_t n = read(fd, out, 1);
            if (n >= 0 || errno != EINTR) {
                return n == 1;
            }
        }
    }
}

/* Reads a line and removes blanks at both ends. A line that is too long is cut. */
static enum cli_exit read_answer(const struct cli_dialogue *dialogue, char out[CLI_ANSWER_SIZE])
{
    char line[CLI_ANSWER_SIZE];
    size_t length = 0;
    char byte;

    (void)fflush(dialogue->out);
    do {
        if (read_byte(dialogue->in, &byte) != 1) {
            fputc('\n', dialogue->out);
            return CLI_EXIT_INTERRUPTED;
        }
        if (byte != '\n' && length < sizeof line - 1) {
            line[length++] = byte;
        }
    } while (byte != '\n');
    while (length > 0 && strchr(" \t\r", line[length - 1])) {
        length--;
    }
    line[length] = '\0';
    (void)snprintf(out, CLI_ANSWER_SIZE, "%s", line + strspn(line, " \t"));
    return CLI_EXIT_OK;
}

enum cli_exit cli_dialogue_yes(const struct cli_dialogue *dialogue, const char *question,
                               bool standard, bool *out)
{
    char answer[CLI_ANSWER_SIZE];

    for (;;) {
        fprintf(dialogue->out, "%s [%s] ", question, standard ? "Y/n" : "y/N");
        const enum cli_exit exit = read_answer(dialogue, answer);
        if (exit) {
            return exit;
        }
        const bool yes = strcasecmp(answer, "y") == 0 || strcasecmp(answer, "yes") == 0;
        const bool no = strcasecmp(answer, "n") == 0 || strcasecmp(answer, "no") == 0;
        if (yes || no || !*answer) {
            *out = *answer ? yes : standard;
            return CLI_EXIT_OK;
        }
        fputs("Please answer y or n.\n", dialogue->out);
    }
}

enum cli_exit cli_dialogue_said(const struct cli_dialogue *dialogue, const char *question,
                                enum cli_said *out)
{
    static const struct {
        const char *letter, *word;
        enum cli_said said;
    } words[] = {
        {"y", "yes", CLI_SAID_YES},
        {"n", "no", CLI_SAID_NO},
        {"s", "skip", CLI_SAID_SKIP},
    };
    char answer[CLI_ANSWER_SIZE];

    for (;;) {
        fprintf(dialogue->out, "%s [y/n/skip] ", question);
        const enum cli_exit exit = read_answer(dialogue, answer);
        if (exit) {
            return exit;
        }
        for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
            if (strcasecmp(answer, words[i].letter) == 0 ||
                strcasecmp(answer, words[i].word) == 0) {
                *out = words[i].said;
                return CLI_EXIT_OK;
            }
        }
        fputs("Please answer y, n or skip.\n", dialogue->out);
    }
}

enum cli_exit cli_dialogue_choose(const struct cli_dialogue *dialogue, const char *question,
                                  const char *const *choices, size_t n, size_t standard,
                                  size_t *out)
{
    char answer[CLI_ANSWER_SIZE], *end;

    for (size_t i = 0; i < n; i++) {
        fprintf(dialogue->out, "  %zu  %s\n", i + 1, choices[i]);
    }
    for (;;) {
        fprintf(dialogue->out, "%s [%zu] ", question, standard + 1);
        const enum cli_exit exit = read_answer(dialogue, answer);
        if (exit) {
            return exit;
        }
        const unsigned long number = *answer ? strtoul(answer, &end, 10) : standard + 1;
        if (!*answer || (end != answer && !*end && number >= 1 && number <= n)) {
            *out = number - 1;
            return CLI_EXIT_OK;
        }
        fprintf(dialogue->out, "Please answer with a number from 1 to %zu.\n", n);
    }
}

enum cli_exit cli_dialogue_text(const struct cli_dialogue *dialogue, const char *question,
                                const char *standard, char out[CLI_ANSWER_SIZE])
{
    char answer[CLI_ANSWER_SIZE];

    do {
        fprintf(dialogue->out, "%s%s%s%s ", question, standard ? " [" : "",
                standard ? standard : "", standard ? "]" : "");
        const enum cli_exit exit = read_answer(dialogue, answer);
        if (exit) {
            return exit;
        }
    } while (!*answer && !standard);
    (void)snprintf(out, CLI_ANSWER_SIZE, "%s", *answer ? answer : standard);
    return CLI_EXIT_OK;
}

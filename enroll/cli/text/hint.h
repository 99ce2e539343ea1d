/* The words of the bus in plain words: what a person in front of the sensor should do. */
#ifndef CLI_TEXT_HINT_H
#define CLI_TEXT_HINT_H

#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>

/* "too-far" -> "come closer". Knows every word of isotherm/capture.h; NULL for any other word. */
const char *cli_hint_text(const char *capture_word);

/* Tells whether `result` is `prefix` + "-retry-" + a word, and if so points *capture_word into
 * `result` at the word. For "enroll-retry-too-far" with the prefix "enroll": "too-far". */
bool cli_hint_is_retry(const char *result, const char *prefix, const char **capture_word);

/* Hints on their way to a person, and to a program that reads the result. */
struct cli_hints {
    FILE *out;
    char last[32]; /* the word said last; "" to have the next one said in any case */
    json_t *said;  /* array of the words that were said, in order; NULL: none */
};

/* Prints the hint on a line of its own, unless it is the one said last: the daemon repeats one that
 * goes on. A word that is not known is printed as it is. */
void cli_hints_say(struct cli_hints *hints, const char *capture_word);

/* Hands the array of words over: the caller's to release; NULL for want of memory. */
json_t *cli_hints_take(struct cli_hints *hints);

#endif

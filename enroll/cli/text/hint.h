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
    char last[32]; /* the last word that was printed; "": the next one is printed in any case */
    json_t *said;  /* array of the printed words, in order; NULL: none */
};

/* Prints the hint on a line of its own, unless it is the same as the last one: the daemon repeats a
 * hint that still holds. An unknown word is printed as it is. */
void cli_hints_say(struct cli_hints *hints, const char *capture_word);

/* Returns the array of words, which the caller releases; NULL if there is no memory. */
json_t *cli_hints_take(struct cli_hints *hints);

#endif

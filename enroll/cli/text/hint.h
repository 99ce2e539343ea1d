/* Hints: plain texts for the words of the bus. They say what a person in front of the sensor should
 * do. */
#ifndef CLI_TEXT_HINT_H
#define CLI_TEXT_HINT_H

#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>

#include "enroll/cli/text/hint_text.h"

/* Whether `result` is `prefix` + "-retry-" + a word. Then *capture_word points to the word within
 * `result`. For "enroll-retry-too-far" with the prefix "enroll" it is "too-far". */
bool cli_hint_is_retry(const char *result, const char *prefix, const char **capture_word);

/* Hints that are printed for a person, and collected for the JSON result. */
struct cli_hints {
    FILE *out;
    char last[32];   /* the last word that was printed; "": the next one is printed in any case */
    double turn_deg; /* with a word to turn, how far; 0: not known */
    double last_deg; /* the same of the last hint that was printed */
    json_t *said;    /* array of the printed words, in order; NULL: none was printed */
};

/* Prints the hint on a line of its own, unless it is the same as the last one, because the daemon
 * repeats a hint that is still valid. A hint to turn is printed again if its angle differs by more
 * than 5 degrees from the printed one. An unknown word is printed as it is. */
void cli_hints_say(struct cli_hints *hints, const char *capture_word);

/* Returns the array of words, which the caller releases, and begins a new one. NULL if there is no
 * memory. */
json_t *cli_hints_take(struct cli_hints *hints);

#endif

/* Plain texts for the words of hints, for programs that need nothing else of the command line. */
#ifndef CLI_TEXT_HINT_TEXT_H
#define CLI_TEXT_HINT_TEXT_H

/* The text of a word of isotherm/capture.h: "come closer" for "too-far". A constant; NULL for any
 * other word. */
const char *cli_hint_text(const char *capture_word);

#endif

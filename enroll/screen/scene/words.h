/* The words for people: what a hint, a refusal and a state of the door are called on the screen.
 * The texts are English and are the keys of the catalogues (enroll/screen/po): who draws them
 * passes them through gettext(). */
#ifndef ENROLL_SCREEN_SCENE_WORDS_H
#define ENROLL_SCREEN_SCENE_WORDS_H

#include <stddef.h>

/* Marks a text for the catalogues, and leaves it as it is. */
#define N_(text) text

/* What is drawn beside the words. Every state has a shape of its own, so that colour is never the
 * only difference. */
enum screen_symbol {
    SCREEN_NO_SYMBOL = 0,
    SCREEN_TICK,
    SCREEN_CROSS,
    SCREEN_PADLOCK,
    SCREEN_CLOCK,
    SCREEN_WRENCH, /* out of service */
    SCREEN_LEFT,   /* arrows, as the person before the screen sees them */
    SCREEN_RIGHT,
    SCREEN_UP,
    SCREEN_DOWN,
    SCREEN_NEARER,
    SCREEN_FARTHER,
    SCREEN_HAND, /* something covers the face, or moves */
    SCREEN_PERSON,
    SCREEN_SYMBOLS
};

struct screen_words {
    const char *word;   /* of the bus */
    const char *title;  /* a few words */
    const char *advice; /* a short sentence; NULL: none */
    enum screen_symbol symbol;
};

/* The words of a hint (isotherm/capture.h), with a title only. NULL: this word is no hint ("ok",
 * "nobody", "no-face"), or it is unknown. */
const struct screen_words *screen_hint_words(const char *capture_word);

/* The words of a refusal (firmware/visit/decision.h). A reason that is unknown gets those of a
 * fault. */
const struct screen_words *screen_refusal_words(const char *reason);

/* The words of what the policy wants besides (ISO_CONTRACT_WANTED_... of status_keys.h). NULL: the
 * word is unknown. */
const struct screen_words *screen_wanted_words(const char *what);

/* The tables, for the tests; *n receives the length. */
const struct screen_words *screen_all_wanted(size_t *n);
const struct screen_words *screen_all_hints(size_t *n);
const struct screen_words *screen_all_refusals(size_t *n);

#endif

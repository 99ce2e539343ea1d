#include "enroll/screen/scene/words.h"

#include <string.h>

static const struct screen_words hints[] = {
    {"too-far", N_("Come closer"), NULL, SCREEN_NEARER},
    {"too-close", N_("Step back a little"), NULL, SCREEN_FARTHER},
    {"move-left", N_("Move a little to your left"), NULL, SCREEN_LEFT},
    {"move-right", N_("Move a little to your right"), NULL, SCREEN_RIGHT},
    {"move-up", N_("Come up a little"), NULL, SCREEN_UP},
    {"move-down", N_("Come down a little"), NULL, SCREEN_DOWN},
    {"turn-left", N_("Turn your head to the left"), NULL, SCREEN_LEFT},
    {"turn-right", N_("Turn your head to the right"), NULL, SCREEN_RIGHT},
    {"look-up", N_("Raise your chin"), NULL, SCREEN_UP},
    {"look-down", N_("Lower your chin"), NULL, SCREEN_DOWN},
    {"too-few-points", N_("Keep hair and hands off your face"), NULL, SCREEN_HAND},
    {"covered-brow", N_("Show your forehead"), NULL, SCREEN_HAND},
    {"covered-eyes", N_("Take off your glasses"), NULL, SCREEN_HAND},
    {"covered-nose", N_("Show your nose"), NULL, SCREEN_HAND},
    {"covered-mouth", N_("Take off your mask or scarf"), NULL, SCREEN_HAND},
    {"covered-left", N_("Show the left side of your face"), NULL, SCREEN_HAND},
    {"covered-right", N_("Show the right side of your face"), NULL, SCREEN_HAND},
    {"several-faces", N_("One person at a time"), NULL, SCREEN_PERSON},
    {"not-a-face", N_("Look straight at the camera"), NULL, SCREEN_PERSON},
    {"no-face-in-image", N_("Look straight at the camera"), NULL, SCREEN_PERSON},
    {"moving", N_("Hold still"), NULL, SCREEN_HAND},
    {"expression", N_("Close your mouth and look calm"), NULL, SCREEN_PERSON},
    {"flat", N_("Show your own face"), NULL, SCREEN_CROSS},
    {"bent", N_("Show your own face"), NULL, SCREEN_CROSS},
    {"screen", N_("Show your own face"), NULL, SCREEN_CROSS},
    {"wrong-size", N_("Show your own face"), NULL, SCREEN_CROSS},
    {"eyes-cut", N_("Show your own face"), NULL, SCREEN_CROSS},
    {"still", N_("Show your own face"), NULL, SCREEN_CROSS},
};

static const char use_card[] = N_("Please use your card or ask for help");
static const char try_later[] = N_("Please try again later");
static const char ask[] = N_("Please ask for help");

static const struct screen_words refusals[] = {
    {"unknown", N_("Not recognised"), use_card, SCREEN_CROSS},
    {"not-valid", N_("Not at this time"), N_("You may enter at other times"), SCREEN_CLOCK},
    {"attack", N_("Not accepted"), N_("Please show your own face"), SCREEN_CROSS},
    {"locked-out", N_("Locked"), N_("Too many attempts. Please wait"), SCREEN_PADLOCK},
    {"lockdown", N_("Closed"), N_("Nobody is let in at the moment"), SCREEN_PADLOCK},
    {"left", N_("Not finished"), N_("Please stay before the camera"), SCREEN_PERSON},
    {"stale", N_("Please try again"), N_("Look at the camera once more"), SCREEN_PERSON},
    {"none", N_("Please try again"), N_("Look at the camera once more"), SCREEN_PERSON},
    {"unlogged", N_("Out of order"), try_later, SCREEN_WRENCH},
    {"no-gallery", N_("Out of order"), try_later, SCREEN_WRENCH},
    {"no-lockout", N_("Out of order"), try_later, SCREEN_WRENCH},
    {"not-on-record", N_("Out of order"), try_later, SCREEN_WRENCH},
    {"no-policy", N_("Out of order"), try_later, SCREEN_WRENCH},
    {"no-lease", N_("Out of order"), try_later, SCREEN_WRENCH},
    {"not-approved", N_("Not at this door"), ask, SCREEN_CROSS},
    {"disabled", N_("Access is suspended"), ask, SCREEN_CROSS},
    {"not-here", N_("Not at this door"), ask, SCREEN_CROSS},
    {"not-now", N_("Not at this time"), N_("You may enter at other times"), SCREEN_CLOCK},
    {"not-enough", N_("Not finished"), N_("Please show everything in time"), SCREEN_CLOCK},
    {"wrong-factor", N_("Wrong card or PIN"), N_("Please try again"), SCREEN_CROSS},
    {"antipassback", N_("You are inside already"), ask, SCREEN_CROSS},
    {"no-pair", N_("You cannot enter together"), ask, SCREEN_CROSS},
};

static const struct screen_words wanted[] = {
    {"face", N_("Look at the camera"), N_("Your face is needed, too"), SCREEN_PERSON},
    {"card", N_("Show your card"), N_("Hold it to the reader"), SCREEN_HAND},
    {"pin", N_("Type your PIN"), N_("End it with the # key"), SCREEN_HAND},
    {"person", N_("Two people are needed"), N_("The second one looks at the camera now"),
     SCREEN_PERSON},
};

enum {
    HINTS = sizeof hints / sizeof *hints,
    REFUSALS = sizeof refusals / sizeof *refusals,
    WANTED = sizeof wanted / sizeof *wanted
};

static const struct screen_words *find(const struct screen_words *words, size_t n, const char *word)
{
    for (size_t i = 0; i < n; i++) {
        if (strcmp(words[i].word, word) == 0) {
            return &words[i];
        }
    }
    return NULL;
}

const struct screen_words *screen_hint_words(const char *capture_word)
{
    return find(hints, HINTS, capture_word);
}

const struct screen_words *screen_refusal_words(const char *reason)
{
    const struct screen_words *words = find(refusals, REFUSALS, reason);
    return words ? words : find(refusals, REFUSALS, "unlogged");
}

const struct screen_words *screen_wanted_words(const char *what)
{
    return find(wanted, WANTED, what);
}

const struct screen_words *screen_all_wanted(size_t *n)
{
    *n = WANTED;
    return wanted;
}

const struct screen_words *screen_all_hints(size_t *n)
{
    *n = HINTS;
    return hints;
}

const struct screen_words *screen_all_refusals(size_t *n)
{
    *n = REFUSALS;
    return refusals;
}

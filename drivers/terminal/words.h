/* Small texts for the output of programs: singular or plural, durations, and suggestions for
 * mistyped words. */
#ifndef ISO_DRIVERS_TERMINAL_WORDS_H
#define ISO_DRIVERS_TERMINAL_WORDS_H

#include <stddef.h>
#include <stdint.h>

/* `one` for 1, else `many`. */
const char *iso_plural(uint64_t n, const char *one, const char *many);

enum { ISO_DURATION_SIZE = 32 };

/* The two largest units: "12 s", "2 min 5 s", "3 h 20 min", "4 d 1 h". Less than 0 counts as 0. */
void iso_duration_text(int64_t seconds, char text[ISO_DURATION_SIZE]);

/* The known word that was probably meant, or NULL. `next` gives the known words one by one, from
 * index 0 on, and then NULL. A word is near if it differs from the typed word in at most a third of
 * its letters (in one letter if it has fewer than six): a letter can be missing, superfluous, wrong
 * or swapped with its neighbour. A word is also near if it begins with the typed word and that has
 * at least three letters. */
typedef const char *iso_words_fn(size_t index, const void *context);
const char *iso_words_nearest(const char *typed, iso_words_fn *next, const void *context);

#endif

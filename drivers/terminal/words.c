#include "drivers/terminal/words.h"

#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

enum { WORD_MAX = 32, BEGINNING_MIN = 3 };

const char *iso_plural(uint64_t n, const char *one, const char *many)
{
    return n == 1 ? one : many;
}

void iso_duration_text(int64_t seconds, char text[ISO_DURATION_SIZE])
{
    static const struct {
        int64_t seconds;
        const char *name;
    } units[] = {{86400, "d"}, {3600, "h"}, {60, "min"}, {1, "s"}};
    const size_t last = sizeof units / sizeof *units - 1;
    size_t i = 0;

    seconds = seconds < 0 ? 0 : seconds;
    while (i < last && seconds < units[i].seconds) {
        i++;
    }
    const int64_t whole = seconds / units[i].seconds;
    const int64_t rest = i < last ? seconds % units[i].seconds / units[i + 1].seconds : 0;
    if (rest > 0) {
        (void)snprintf(text, ISO_DURATION_SIZE, "%" PRId64 " %s %" PRId64 " %s", whole,
                       units[i].name, rest, units[i + 1].name);
    } else {
        (void)snprintf(text, ISO_DURATION_SIZE, "%" PRId64 " %s", whole, units[i].name);
    }
}

static size_t least(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* The number of letters that have to be inserted, deleted, changed or swapped with a neighbour (the
 * restricted distance of Damerau 1964, by the recurrence of Wagner and Fischer 1974). */
static size_t distance(const char *a, size_t n, const char *b, size_t m)
{
    size_t rows[WORD_MAX + 1][WORD_MAX + 1];

    for (size_t i = 0; i <= n; i++) {
        for (size_t j = 0; j <= m; j++) {
            if (i == 0 || j == 0) {
                rows[i][j] = i + j;
                continue;
            }
            const size_t change = rows[i - 1][j - 1] + (a[i - 1] != b[j - 1]);
            rows[i][j] = least(least(rows[i - 1][j], rows[i][j - 1]) + 1, change);
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
                rows[i][j] = least(rows[i][j], rows[i - 2][j - 2] + 1);
            }
        }
    }
    return rows[n][m];
}

const char *iso_words_nearest(const char *typed, iso_words_fn *next, const void *context)
{
    const size_t length = strlen(typed);
    const char *best = NULL, *word;
    size_t best_distance = WORD_MAX;

    if (length == 0 || length > WORD_MAX) {
        return NULL;
    }
    for (size_t i = 0; (word = next(i, context)); i++) {
        const size_t n = strlen(word);
        if (n > WORD_MAX) {
            continue;
        }
        const bool begins = length >= BEGINNING_MIN && strncmp(word, typed, length) == 0;
        const size_t apart = begins ? 1 : distance(typed, length, word, n);
        const size_t near = n < 2 * 3 ? 1 : n / 3;
        if (apart <= near && apart < n && apart < best_distance) {
            best = word;
            best_distance = apart;
        }
    }
    return best;
}

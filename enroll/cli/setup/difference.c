#include "enroll/cli/setup/difference.h"

#include <errno.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { LINES_MAX = 4000, CONTEXT = 3 };

struct lines {
    size_t n;
    const char **at; /* [n] */
};

/* One line of the result. */
struct step {
    char mark; /* ' ', '-' or '+' */
    const char *line;
};

static size_t count_lines(const char *text)
{
    size_t n = 0;

    for (const char *at = text; *at; at += strcspn(at, "\n"), at += *at == '\n') {
        n++;
    }
    return n;
}

static int split(const char *text, struct lines *out)
{
    out->n = 0;
    out->at = calloc(count_lines(text) + 1, sizeof *out->at);
    if (!out->at) {
        return -ENOMEM;
    }
    for (const char *at = text; *at; at += strcspn(at, "\n"), at += *at == '\n') {
        out->at[out->n++] = at;
    }
    return 0;
}

static bool same(const char *a, const char *b)
{
    const size_t length = strcspn(a, "\n");

    return length == strcspn(b, "\n") && memcmp(a, b, length) == 0;
}

/* common[i * (b->n + 1) + j] is the length of the longest common subsequence of the lines of a from
 * i on and the lines of b from j on. */
static uint16_t *measure(const struct lines *a, const struct lines *b)
{
    const size_t width = b->n + 1;
    uint16_t *common = calloc((a->n + 1) * width, sizeof *common);

    for (size_t i = a->n; common && i-- > 0;) {
        for (size_t j = b->n; j-- > 0;) {
            const uint16_t down = common[(i + 1) * width + j], right = common[i * width + j + 1];
            uint16_t *length = &common[i * width + j];
            if (same(a->at[i], b->at[j])) {
                *length = (uint16_t)(common[(i + 1) * width + j + 1] + 1);
            } else {
                *length = down >= right ? down : right;
            }
        }
    }
    return common;
}

/* Finds the steps from a to b in that table. If `common` is NULL, all lines of a are removed and
 * all lines of b are added. */
static size_t walk(const struct lines *a, const struct lines *b, const uint16_t *common,
                   struct step *steps)
{
    const size_t width = b->n + 1;
    size_t i = 0, j = 0, n = 0;

    while (i < a->n || j < b->n) {
        if (common && i < a->n && j < b->n && same(a->at[i], b->at[j])) {
            steps[n++] = (struct step){' ', b->at[j]};
            i++, j++;
        } else if (i < a->n && (j == b->n || !common ||
                                common[(i + 1) * width + j] >= common[i * width + j + 1])) {
            steps[n++] = (struct step){'-', a->at[i++]};
        } else {
            steps[n++] = (struct step){'+', b->at[j++]};
        }
    }
    return n;
}

static bool near_change(const struct step *steps, size_t n, size_t i)
{
    const size_t first = i > CONTEXT ? i - CONTEXT : 0;

    for (size_t k = first; k < n && k <= i + CONTEXT; k++) {
        if (steps[k].mark != ' ') {
            return true;
        }
    }
    return false;
}

static void print(const struct step *steps, size_t n, FILE *out)
{
    bool skipping = false, changed = false;

    for (size_t i = 0; i < n; i++) {
        changed = changed || steps[i].mark != ' ';
    }
    for (size_t i = 0; changed && i < n; i++) {
        const bool shown = near_change(steps, n, i);
        if (shown) {
            fprintf(out, "%c %.*s\n", steps[i].mark, (int)strcspn(steps[i].line, "\n"),
                    steps[i].line);
        } else if (!skipping) {
            fputs("...\n", out);
        }
        skipping = !shown;
    }
}

int cli_difference_print(const char *before, const char *after, FILE *out)
{
    struct lines a = {0}, b = {0};
    int error = split(before, &a);

    if (!error) {
        error = split(after, &b);
    }
    const bool small = a.n <= LINES_MAX && b.n <= LINES_MAX;
    struct step *steps = error ? NULL : calloc(a.n + b.n + 1, sizeof *steps);
    uint16_t *common = !error && small ? measure(&a, &b) : NULL;
    if (!steps || (small && !common)) {
        error = -ENOMEM;
    } else {
        print(steps, walk(&a, &b, common, steps), out);
    }
    free(common);
    free(steps);
    free(a.at);
    free(b.at);
    return error;
}

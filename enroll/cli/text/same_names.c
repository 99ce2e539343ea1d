#include "enroll/cli/text/same_names.h"

#include <stdlib.h>
#include <string.h>

#include "enroll/cli/text/name.h"
#include "firmware/contract/name_folding.h"

struct cli_spelling {
    char *name, *folded;
};

void cli_same_names_add(struct cli_same_names *names, const char *name)
{
    struct cli_spelling spelling = {.name = strdup(name)};

    if (iso_name_fold(name, &spelling.folded)) {
        spelling.folded = NULL;
    }
    if (names->n == names->capacity) {
        const size_t capacity = 2 * names->capacity + 64;
        struct cli_spelling *grown = realloc(names->items, capacity * sizeof *grown);
        if (grown) {
            names->items = grown;
            names->capacity = capacity;
        }
    }
    if (!spelling.name || !spelling.folded || names->n == names->capacity) {
        free(spelling.name);
        free(spelling.folded);
        return;
    }
    names->items[names->n++] = spelling;
}

static int by_folded(const void *a, const void *b)
{
    const struct cli_spelling *one = a, *other = b;
    const int order = strcmp(one->folded, other->folded);

    return order ? order : strcmp(one->name, other->name);
}

void cli_same_names_print(struct cli_same_names *names, FILE *out)
{
    if (names->n > 1) {
        qsort(names->items, names->n, sizeof *names->items, by_folded);
    }
    for (size_t i = 1; i < names->n; i++) {
        const struct cli_spelling *one = &names->items[i - 1], *other = &names->items[i];
        if (strcmp(one->folded, other->folded) == 0) {
            fputs("isotherm: ", out);
            cli_name_print(out, one->name);
            fputs(" and ", out);
            cli_name_print(out, other->name);
            fputs(" look the same; give one of them another name (isotherm rename)\n", out);
        }
    }
}

void cli_same_names_done(struct cli_same_names *names)
{
    for (size_t i = 0; i < names->n; i++) {
        free(names->items[i].name);
        free(names->items[i].folded);
    }
    free(names->items);
    *names = (struct cli_same_names){0};
}

#include "tests/support/programs/prometheus_text.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NAME_SIZE = 128, FAMILIES_MOST = 256, SERIES_MOST = 4096 };

struct reading {
    char families[FAMILIES_MOST][NAME_SIZE];
    size_t n_families;
    char helped[NAME_SIZE]; /* the family whose HELP was last */
    bool is_counter, is_typed;
    char *series[SERIES_MOST];
    size_t n_series;
};

static bool is_name(const char *text, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        if (!isalpha((unsigned char)text[i]) && text[i] != '_' && text[i] != ':' &&
            !(i > 0 && isdigit((unsigned char)text[i]))) {
            return false;
        }
    }
    return n > 0 && n < NAME_SIZE;
}

static void take_help(struct reading *r, const char *line)
{
    const char *name = line + strlen("# HELP ");
    const size_t n = strcspn(name, " ");

    if (!is_name(name, n) || strlen(name + n) < 2) {
        fail_msg("no help: %s", line);
    }
    (void)snprintf(r->helped, sizeof r->helped, "%.*s", (int)n, name);
    for (size_t i = 0; i < r->n_families; i++) {
        if (strcmp(r->families[i], r->helped) == 0) {
            fail_msg("%s comes twice", r->helped);
        }
    }
    assert_true(r->n_families < FAMILIES_MOST);
    (void)strcpy(r->families[r->n_families++], r->helped);
    r->is_typed = false;
}

static void take_type(struct reading *r, const char *line)
{
    char name[NAME_SIZE] = "", type[16] = "";
    const size_t total = strlen("_total");

    if (sscanf(line, "# TYPE %127s %15s", name, type) != 2 || strcmp(name, r->helped) != 0 ||
        r->is_typed || (strcmp(type, "counter") != 0 && strcmp(type, "gauge") != 0)) {
        fail_msg("no type: %s", line);
    }
    r->is_typed = true;
    r->is_counter = strcmp(type, "counter") == 0;
    const bool has_total = strlen(name) > total &&
                           strcmp(name + strlen(name) - total, "_total") == 0;
    if (has_total != r->is_counter) {
        fail_msg("a counter, and nothing else, ends with _total: %s", line);
    }
}

/* `at` points to the labels of a series: {name="value",...}. Returns the text behind them, or NULL
 * if the labels are not written in this way. */
static const char *labels_end(const char *at)
{
    do {
        at++;
        const size_t n = strcspn(at, "=");
        if (!is_name(at, n) || at[n] != '=' || at[n + 1] != '"') {
            return NULL;
        }
        at += n + 2;
        while (*at && *at != '"') {
            if (*at == '\\' && !strchr("\\\"n", at[1])) {
                return NULL;
            }
            at += *at == '\\' ? 2 : 1;
        }
        if (*at != '"') {
            return NULL;
        }
        at++;
    } while (*at == ',');
    return *at == '}' ? at + 1 : NULL;
}

static void take_series(struct reading *r, char *line)
{
    const size_t n = strcspn(line, "{ ");
    const char *at = line[n] == '{' ? labels_end(line + n) : line + n;
    char *end = NULL;

    if (strlen(r->helped) != n || strncmp(line, r->helped, n) != 0 || !r->is_typed || !at ||
        *at != ' ') {
        fail_msg("no series of %s: %s", r->helped, line);
        return;
    }
    const double value = strtod(at + 1, &end);
    if (end == at + 1 || *end || (r->is_counter && value < 0)) {
        fail_msg("no value: %s", line);
    }
    line[at - line] = '\0';
    for (size_t i = 0; i < r->n_series; i++) {
        if (strcmp(r->series[i], line) == 0) {
            fail_msg("%s comes twice", line);
        }
    }
    assert_true(r->n_series < SERIES_MOST);
    r->series[r->n_series++] = line;
}

void prometheus_text_check(const char *text)
{
    struct reading *r = calloc(1, sizeof *r);
    char *copy = strdup(text), *rest = NULL;

    assert_non_null(r);
    assert_true(*text && text[strlen(text) - 1] == '\n');
    for (char *line = strtok_r(copy, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest)) {
        if (strncmp(line, "# HELP ", 7) == 0) {
            take_help(r, line);
        } else if (strncmp(line, "# TYPE ", 7) == 0) {
            take_type(r, line);
        } else {
            take_series(r, line);
        }
    }
    assert_true(r->n_series > 0);
    free(copy);
    free(r);
}

double prometheus_text_value(const char *text, const char *series)
{
    const size_t n = strlen(series);

    for (const char *line = text; *line; line += strcspn(line, "\n") + 1) {
        if (strncmp(line, series, n) == 0 && line[n] == ' ') {
            return strtod(line + n, NULL);
        }
    }
    fail_msg("there is no %s", series);
    return 0;
}

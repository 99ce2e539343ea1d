#include "core/base/text.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct iso_text_lines iso_text_lines_of(char *text)
{
    return (struct iso_text_lines){.rest = text, .number = 0};
}

char *iso_text_next_line(struct iso_text_lines *lines)
{
    char *line = lines->rest;
    if (!line || !*line) {
        return NULL;
    }
    char *end = strchrnul(line, '\n');
    lines->rest = *end ? end + 1 : end;
    if (end > line && *end && end[-1] == '\r') {
        end--;
    }
    *end = '\0';
    lines->number++;
    return line;
}

size_t iso_text_line_count(const char *text)
{
    size_t n = 1;
    for (; *text; text++) {
        n += *text == '\n';
    }
    return n;
}

size_t iso_text_split(char *line, char separator, char **fields, size_t max)
{
    size_t n = 0;
    for (char *field = line; field; n++) {
        char *end = strchr(field, separator);
        if (end) {
            *end++ = '\0';
        }
        if (n < max) {
            fields[n] = field;
        }
        field = end;
    }
    return n;
}

size_t iso_text_words(char *line, char **words, size_t max)
{
    size_t n = 0;
    for (char *at = line + strspn(line, " \t"); *at; n++) {
        char *end = at + strcspn(at, " \t");
        if (n < max) {
            words[n] = at;
        }
        at = end + strspn(end, " \t");
        *end = '\0';
    }
    return n;
}

int iso_text_number(const char *text, double *out)
{
    char *end;
    if (!*text || text[strspn(text, "0123456789+-.eE")]) {
        return -EINVAL;
    }
    const double value = strtod(text, &end);
    if (*end || !isfinite(value)) {
        return -EINVAL;
    }
    *out = value;
    return 0;
}

int iso_text_count(const char *text, size_t *out)
{
    const size_t digits = strspn(text, "0123456789");
    if (digits < 1 || digits > 18 || text[digits]) {
        return -EINVAL;
    }
    *out = strtoul(text, NULL, 10);
    return 0;
}

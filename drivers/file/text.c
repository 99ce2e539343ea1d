#include "drivers/file/text.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/file/file.h"

int iso_text_read(const char *path, size_t max_bytes, char **text, struct iso_fault *fault)
{
    char *bytes = NULL;
    size_t size = 0;
    const int error = iso_file_read(path, max_bytes, &bytes, &size, fault);
    if (!error && memchr(bytes, 0, size)) {
        free(bytes);
        return iso_fault_set(fault, -EBADMSG, "%s: not a text file (it holds a NUL byte)", path);
    }
    if (!error) {
        *text = bytes;
    }
    return error;
}

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

void iso_text_copy_end(const char *text, char *to, size_t size)
{
    const size_t length = strlen(text);
    const bool fits = length < size;
    (void)snprintf(to, size, "%s%s", fits ? "" : "...", fits ? text : text + length - (size - 4));
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

int iso_text_find_long_line(const char *text, size_t max_bytes)
{
    int line = 1;
    for (const char *end; *text; text = *end ? end + 1 : end, line++) {
        end = strchrnul(text, '\n');
        if ((size_t)(end - text) > max_bytes) {
            return line;
        }
    }
    return 0;
}

void iso_text_print_number(FILE *stream, const char *key, double value)
{
    char text[32];
    for (int digits = 15; digits <= 17; digits++) {
        (void)snprintf(text, sizeof text, "%.*g", digits, value);
        if (strtod(text, NULL) == value) {
            break;
        }
    }
    (void)fprintf(stream, "%s = %s\n", key, text);
}

#include "enroll/hub/scim/scim_filter.h"

#include <ctype.h>
#include <errno.h>
#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789:._-$";

int scim_attribute_take(const char *name, size_t length, char out[SCIM_TEXT_SIZE])
{
    static const char *const cores[] = {"urn:ietf:params:scim:schemas:core:2.0:user:",
                                        "urn:ietf:params:scim:schemas:core:2.0:group:"};
    for (size_t i = 0; i < sizeof cores / sizeof *cores; i++) {
        const size_t n = strlen(cores[i]);
        if (length > n && strncasecmp(name, cores[i], n) == 0) {
            name += n;
            length -= n;
        }
    }
    if (length >= SCIM_TEXT_SIZE) {
        return -ENAMETOOLONG;
    }
    for (size_t i = 0; i < length; i++) {
        out[i] = (char)tolower((unsigned char)name[i]);
    }
    out[length] = '\0';
    return 0;
}

/* ---- pieces of a text; each moves *at behind itself ---- */

static void skip_blanks(const char **at)
{
    *at += strspn(*at, " ");
}

static bool take_attribute(const char **at, char out[SCIM_TEXT_SIZE])
{
    const size_t n = strspn(*at, letters);
    if (n == 0 || scim_attribute_take(*at, n, out)) {
        return false;
    }
    *at += n;
    return true;
}

static bool take_word(const char **at, const char *word)
{
    const size_t n = strlen(word);
    if (strncasecmp(*at, word, n) != 0 || (*at)[n] != ' ') {
        return false;
    }
    *at += n;
    skip_blanks(at);
    return true;
}

/* A text of JSON. */
static bool take_text(const char **at, char out[SCIM_TEXT_SIZE])
{
    size_t n = 1;
    while ((*at)[n] && (*at)[n] != '"') {
        n += (*at)[n] == '\\' && (*at)[n + 1] ? 2 : 1;
    }
    json_t *text = (*at)[n] == '"' ? json_loadb(*at, n + 1, JSON_DECODE_ANY, NULL) : NULL;
    const bool fits = text && json_string_length(text) < SCIM_TEXT_SIZE;
    if (fits) {
        (void)snprintf(out, SCIM_TEXT_SIZE, "%s", json_string_value(text));
        *at += n + 1;
    }
    json_decref(text);
    return fits;
}

static bool take_value(const char **at, char out[SCIM_TEXT_SIZE])
{
    const size_t n = strspn(*at, letters);
    if (**at == '"') {
        return take_text(at, out);
    }
    if (n == 0 || n >= SCIM_TEXT_SIZE) {
        return false;
    }
    (void)snprintf(out, SCIM_TEXT_SIZE, "%.*s", (int)n, *at);
    *at += n;
    return true;
}

/* Comparisons up to a character that ends them. */
static bool take_terms(const char **at, char end, struct scim_filter *out)
{
    struct scim_filter filter = {.n = 0};
    do {
        struct scim_term *term = &filter.terms[filter.n];
        skip_blanks(at);
        if (filter.n == SCIM_TERMS_MOST || !take_attribute(at, term->attribute)) {
            return false;
        }
        skip_blanks(at);
        if (!take_word(at, "eq") || !take_value(at, term->value)) {
            return false;
        }
        filter.n++;
        skip_blanks(at);
    } while (take_word(at, "and"));
    if (**at != end) {
        return false;
    }
    *out = filter;
    return true;
}

int scim_filter_read(const char *text, struct scim_filter *out, struct iso_fault *fault)
{
    return take_terms(&text, '\0', out)
               ? 0
               : iso_fault_set(fault, -EDOM,
                               "a filter has to be ATTRIBUTE eq VALUE, at most %d of them with and",
                               SCIM_TERMS_MOST);
}

static bool take_path(const char *at, struct scim_path *path)
{
    char sub[SCIM_TEXT_SIZE];
    if (!take_attribute(&at, path->attribute)) {
        return false;
    }
    if (*at == '[') {
        at++;
        if (!take_terms(&at, ']', &path->filter)) {
            return false;
        }
        at++;
        const size_t n = strlen(path->attribute);
        if (*at == '.' && take_attribute(&at, sub)) {
            if (n + strlen(sub) >= SCIM_TEXT_SIZE) {
                return false;
            }
            strcpy(path->attribute + n, sub);
        }
    }
    return *at == '\0';
}

int scim_path_read(const char *text, struct scim_path *out, struct iso_fault *fault)
{
    struct scim_path path = {.attribute = ""};
    if (!take_path(text, &path)) {
        return iso_fault_set(fault, -ENXIO, "the path of an operation cannot be read");
    }
    *out = path;
    return 0;
}

#include "firmware/contract/json_member.h"

#include <string.h>

/* Reads a text in quotes, in which a quote may be escaped. `at` is the place of the opening quote.
 * Returns the place after the closing quote, or NULL if one of the two is missing. */
static const char *read_text(const char *at, const char **begin, size_t *length)
{
    if (*at != '"') {
        return NULL;
    }
    *begin = ++at;
    while (*at && *at != '"') {
        at += at[0] == '\\' && at[1] ? 2 : 1;
    }
    *length = (size_t)(at - *begin);
    return *at ? at + 1 : NULL;
}

bool iso_json_member(const char *text, const char *name, char *value, size_t size)
{
    const char *key = NULL, *found = NULL;
    size_t key_length = 0, length = 0;
    const char *at = *text == '{' ? text + 1 : NULL;
    while (at && (at = read_text(at, &key, &key_length)) && *at == ':') {
        const bool is_text = *++at == '"';
        const char *end = is_text ? read_text(at, &found, &length) : at + strcspn(at, ",}");
        if (!end || (*end != ',' && *end != '}')) {
            return false;
        }
        if (key_length == strlen(name) && memcmp(key, name, key_length) == 0) {
            if (!is_text || length >= size) {
                return false;
            }
            memcpy(value, found, length);
            value[length] = '\0';
            return true;
        }
        at = *end == ',' ? end + 1 : NULL;
    }
    return false;
}

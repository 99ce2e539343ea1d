#include "enroll/web/http/percent.h"

#include <string.h>

#include "drivers/base/utf8.h"

/* The value of a hexadecimal digit; -1: it is none. */
static int digit(char c)
{
    if (c >= '0' && c <= '9') {
        return c - '0';
    }
    if (c >= 'a' && c <= 'f') {
        return c - 'a' + 10;
    }
    return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

bool web_percent_decode(char *text, bool is_form)
{
    const char *from = text;
    char *to = text;

    while (*from) {
        if (*from != '%') {
            *to++ = *from == '+' && is_form ? ' ' : *from;
            from++;
            continue;
        }
        const int high = digit(from[1]), low = high < 0 ? -1 : digit(from[2]);
        if (low < 0 || (high == 0 && low == 0)) {
            return false;
        }
        *to++ = (char)(high << 4 | low);
        from += 3;
    }
    *to = '\0';
    return iso_utf8_is_valid(text);
}

bool web_query_read(char *text, struct web_query *out)
{
    struct web_query query = {0};
    char *rest = text, *part;

    while ((part = strsep(&rest, "&"))) {
        char *value = part;
        const char *name = strsep(&value, "=");
        if (!*part && !value) {
            continue;
        }
        value = value ? value : part + strlen(part);
        if (query.n == WEB_QUERY_MOST || !web_percent_decode(part, true) ||
            (*value && !web_percent_decode(value, true)) || web_query_find(&query, name)) {
            return false;
        }
        query.items[query.n].name = name;
        query.items[query.n].value = value;
        query.n++;
    }
    *out = query;
    return true;
}

const char *web_query_find(const struct web_query *query, const char *name)
{
    for (size_t i = 0; i < query->n; i++) {
        if (strcmp(query->items[i].name, name) == 0) {
            return query->items[i].value;
        }
    }
    return NULL;
}

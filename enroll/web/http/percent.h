/* Percent-encoding of paths and queries (RFC 3986, section 2.1). Pure. */
#ifndef WEB_HTTP_PERCENT_H
#define WEB_HTTP_PERCENT_H

#include <stdbool.h>
#include <stddef.h>

/* Decodes a text in place. With `is_form`, '+' means a blank, as in the queries that browsers send.
 * Returns false if a '%' is not followed by two hexadecimal digits, or if the result has a NUL or
 * is not UTF-8; the text is then undefined. */
bool web_percent_decode(char *text, bool is_form) __attribute__((warn_unused_result));

enum { WEB_QUERY_MOST = 16 };

/* The parameters of a query, in their order. */
struct web_query {
    size_t n;
    struct {
        const char *name, *value;
    } items[WEB_QUERY_MOST];
};

/* Reads "a=1&b=2" in place: *out points into `text`. A parameter without '=' has the value "".
 * Returns false, with *out unchanged, if there are too many parameters, if two of them have the
 * same name, or if one cannot be decoded. */
bool web_query_read(char *text, struct web_query *out) __attribute__((warn_unused_result));

/* The value of a parameter, or NULL. */
const char *web_query_find(const struct web_query *query, const char *name);

#endif

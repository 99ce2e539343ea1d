#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/web/http/exchange.h"

bool web_exchange_number(struct web_exchange *exchange, const char *name, int64_t least,
                         int64_t most, int64_t otherwise, int64_t *out)
{
    const char *text = web_exchange_query(exchange, name);
    char *end = NULL, detail[128];

    if (!text) {
        *out = otherwise;
        return true;
    }
    errno = 0;
    const long long value = strtoll(text, &end, 10);
    if (errno || end == text || *end || strspn(text, "-0123456789") != strlen(text) ||
        value < least || value > most) {
        (void)snprintf(detail, sizeof detail, "%s has to be a whole number from %lld to %lld", name,
                       (long long)least, (long long)most);
        web_exchange_problem(exchange, 400, "invalid-parameter", detail);
        return false;
    }
    *out = value;
    return true;
}

#include <stdio.h>

#include "enroll/web/http/exchange.h"

const char *web_exchange_member(struct web_exchange *exchange, const char *member, size_t most)
{
    const json_t *value = json_object_get(web_exchange_body(exchange), member);
    char detail[96];

    if (json_is_string(value) && json_string_length(value) > 0 &&
        json_string_length(value) <= most) {
        return json_string_value(value);
    }
    (void)snprintf(detail, sizeof detail, "%s has to be a text of 1 to %zu bytes", member, most);
    web_exchange_problem(exchange, 400, "invalid-member", detail);
    return NULL;
}

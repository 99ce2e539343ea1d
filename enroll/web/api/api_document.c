/* The description of the API. */
#include "enroll/web/api/api.h"

void web_api_get_document(void *context, struct web_exchange *exchange)
{
    const struct web_api *api = context;

    web_exchange_json(exchange, 200, json_loads(api->document, JSON_REJECT_DUPLICATES, NULL));
}

/* The description of the API. */
#include <string.h>

#include "enroll/web/api/api.h"

void web_api_get_document(void *context, struct web_exchange *exchange)
{
    const struct web_api *api = context;

    web_exchange_text(exchange, 200, strdup(api->document), strlen(api->document));
}

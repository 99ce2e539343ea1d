#include "enroll/web/api/access/access.h"

#include "enroll/web/api/api.h"
#include "firmware/contract/contract.h"

void web__access_problem(struct web_exchange *exchange, const sd_bus_error *error,
                         const char *invalid)
{
    const char *detail = error->message ? error->message : "the daemon has refused this";
    if (sd_bus_error_has_name(error, ISO_CONTRACT_ERROR_INVALID_ARGUMENT)) {
        web_exchange_problem(exchange, 400, invalid, detail);
    } else if (sd_bus_error_has_name(error, ISO_CONTRACT_ERROR_CONFLICT)) {
        web_exchange_problem(exchange, 409, "policy-changed", detail);
    } else if (sd_bus_error_has_name(error, ISO_CONTRACT_ERROR_NAME_IN_USE)) {
        web_exchange_problem(exchange, 409, "card-in-use", detail);
    } else {
        web_api_daemon_problem(exchange, error);
    }
}

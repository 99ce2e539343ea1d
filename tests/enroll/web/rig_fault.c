/* The answers to errors of the daemon, for tests that do not link the whole API. */
#include <string.h>

#include "enroll/web/api/api.h"
#include "firmware/contract/contract.h"

void web_api_daemon_problem(struct web_exchange *exchange, const sd_bus_error *error)
{
    static const struct {
        const char *name;
        unsigned status;
        const char *code;
    } known[] = {
        {ISO_CONTRACT_ERROR_ALREADY_IN_USE, 409, "camera-in-use"},
        {ISO_CONTRACT_ERROR_NO_SUCH_PERSON, 404, "no-such-person"},
        {ISO_CONTRACT_ERROR_NAME_IN_USE, 409, "name-in-use"},
        {ISO_CONTRACT_ERROR_INVALID_NAME, 400, "invalid-name"},
        {ISO_CONTRACT_ERROR_GALLERY_FULL, 409, "gallery-full"},
        {ISO_CONTRACT_ERROR_LOCKED_OUT, 423, "locked-out"},
        {ISO_CONTRACT_ERROR_STORAGE, 507, "storage"},
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        if (strcmp(error->name, known[i].name) == 0) {
            web_exchange_problem(exchange, known[i].status, known[i].code, error->message);
            return;
        }
    }
    web_exchange_problem(exchange, 503, "no-daemon", error->message);
}

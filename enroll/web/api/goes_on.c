/* Whether an act that is on record may still be done. */
#include "enroll/web/api/api.h"
#include "enroll/web/http/now.h"

bool web_api_goes_on(const struct web_api *api, struct web_exchange *exchange)
{
    if (web_session_goes_on(api->sessions, web_exchange_session(exchange), web_now_ns())) {
        return true;
    }
    web_exchange_problem(exchange, 401, "login-required", "the session has ended");
    return false;
}

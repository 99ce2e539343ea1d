/* Whether a session goes on: in a file of its own for tests with stand-ins of exchanges. */
#include "enroll/web/http/now.h"
#include "enroll/web/login/login.h"

bool web_login_goes_on(const struct web_login *login, struct web_exchange *exchange)
{
    if (web_session_goes_on(login->sessions, web_exchange_session(exchange), web_now_ns())) {
        return true;
    }
    web_exchange_problem(exchange, 401, "login-required", "the session has ended");
    return false;
}

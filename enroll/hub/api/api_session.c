/* Who is logged in, and the first account. */
#include <sodium.h>
#include <stdio.h>
#include <systemd/sd-daemon.h>
#include <time.h>

#include "enroll/hub/api/api_inner.h"
#include "enroll/web/account/setup_code.h"
#include "enroll/web/http/now.h"

enum { CODE_MOST_BYTES = 64 };

/* Everybody who tries codes shares this delay; it is no name of an account. */
static const char setup_name[] = "#setup";

static json_t *session_json(const char *account, enum web_role role)
{
    return json_pack("{s:s, s:s}", "account", account, "role", web_role_word(role));
}

void hub__api_get_session(void *context, struct web_exchange *exchange)
{
    const struct hub_api *api = context;

    if (web_exchange_session(exchange) != 0) {
        web_exchange_json(
            exchange, 200,
            session_json(web_exchange_account(exchange), web_exchange_role(exchange)));
        return;
    }
    json_t *problem = web_problem_json(401, "login-required", "log in first");
    if (problem && json_object_set_new(problem, "setup",
                                       json_boolean(web_accounts_count(api->accounts) == 0))) {
        json_decref(problem);
        problem = NULL;
    }
    web_exchange_json(exchange, 401, problem);
}

/* Answers 429 and returns true if this account may not be tried now. */
static bool must_wait(struct hub_api *api, struct web_exchange *exchange, const char *account)
{
    const int64_t now_ns = web_now_ns();
    const int64_t wait_ns = web_guess_wait_ns(&api->guess, account, web_exchange_address(exchange),
                                              now_ns);
    char seconds[16];

    if (wait_ns == 0 && hub_bucket_take(&api->logins, 1e-9 * (double)now_ns)) {
        return false;
    }
    (void)snprintf(seconds, sizeof seconds, "%lld", (long long)(wait_ns / 1000000000 + 1));
    web_exchange_header(exchange, "Retry-After", seconds);
    web_exchange_problem(exchange, 429, "wait", "there were too many attempts; try again later");
    return true;
}

static void begin_session(struct hub_api *api, struct web_exchange *exchange,
                          const struct web_account *account)
{
    char token[WEB_SESSION_TOKEN_SIZE], cookie[WEB_SESSION_SET_COOKIE_SIZE];

    web_session_end(&api->sessions, web_exchange_session(exchange));
    (void)web_session_begin(&api->sessions, account, web_now_ns(), token);
    web_exchange_header(exchange, "Set-Cookie", web_session_set_cookie(token, cookie));
    web_exchange_json(exchange, 201, session_json(account->name, account->role));
    sodium_memzero(token, sizeof token);
    sodium_memzero(cookie, sizeof cookie);
}

void hub__api_login(void *context, struct web_exchange *exchange)
{
    struct hub_api *api = context;
    const char *name = hub__api_text(exchange, "account", WEB_ACCOUNT_NAME_SIZE - 1);
    const char *password = name ? hub__api_text(exchange, "password", WEB_PASSWORD_MOST_BYTES)
                                : NULL;

    if (!password || must_wait(api, exchange, name)) {
        return;
    }
    const struct web_account *account = web_accounts_find(api->accounts, name);
    /* Takes as long for an account that does not exist. */
    if (!web_password_is(password, account ? account->hash : NULL)) {
        web_guess_failed(&api->guess, name, web_exchange_address(exchange), web_now_ns());
        web_exchange_problem(exchange, 401, "wrong-password",
                             "the account or the password is wrong");
        return;
    }
    web_guess_passed(&api->guess, name);
    fprintf(stderr, SD_NOTICE "isotherm-hub: %s has logged in\n", name);
    begin_session(api, exchange, account);
}

void hub__api_logout(void *context, struct web_exchange *exchange)
{
    struct hub_api *api = context;
    char cookie[WEB_SESSION_SET_COOKIE_SIZE];

    web_session_end(&api->sessions, web_exchange_session(exchange));
    web_exchange_header(exchange, "Set-Cookie", web_session_set_cookie(NULL, cookie));
    web_exchange_done(exchange);
}

/* The code is used up before the account is added, so that it never makes two. */
static void set_up(struct hub_api *api, struct web_exchange *exchange, const char *code,
                   const char *name, const char *password)
{
    struct iso_fault fault = {.text = ""};
    int r = 0;

    if (!web_setup_code_is(api->setup_code, time(NULL), code)) {
        web_guess_failed(&api->guess, setup_name, web_exchange_address(exchange), web_now_ns());
        web_exchange_problem(exchange, 401, "wrong-code", "the code is wrong or has ended");
        return;
    }
    if (web_accounts_find(api->accounts, name)) {
        web_exchange_problem(exchange, 409, "account-exists", "there is an account of this name");
        return;
    }
    r = web_setup_code_use(api->setup_code, time(NULL), code, &fault);
    r = r < 0 ? r : web_accounts_add(api->accounts, name, password, WEB_ROLE_ADMINISTRATOR, &fault);
    if (r < 0) {
        hub__api_problem(exchange, r, &fault);
        return;
    }
    fprintf(stderr, SD_NOTICE "isotherm-hub: %s has become an administrator by a code\n", name);
    begin_session(api, exchange, web_accounts_find(api->accounts, name));
}

void hub__api_setup(void *context, struct web_exchange *exchange)
{
    struct hub_api *api = context;
    const char *code = hub__api_text(exchange, "code", CODE_MOST_BYTES);
    const char *name = code ? hub__api_text(exchange, "account", WEB_ACCOUNT_NAME_SIZE - 1) : NULL;
    const char *password = name ? hub__api_text(exchange, "password", WEB_PASSWORD_MOST_BYTES)
                                : NULL;

    if (!password || must_wait(api, exchange, setup_name)) {
        return;
    }
    if (web_account_name_flaw(name)) {
        web_exchange_problem(exchange, 400, "invalid-account", web_account_name_flaw(name));
    } else if (web_password_flaw(name, password)) {
        web_exchange_problem(exchange, 400, "invalid-password", web_password_flaw(name, password));
    } else {
        set_up(api, exchange, code, name, password);
    }
}

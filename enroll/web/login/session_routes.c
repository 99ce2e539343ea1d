/* Who is logged in, and the first account. */
#include <sodium.h>

#include "enroll/web/account/setup_code.h"
#include "enroll/web/http/now.h"
#include "enroll/web/login/inner.h"
#include "enroll/web/login/turns.h"

enum { CODE_MOST_BYTES = 64 }; /* with blanks and hyphens as a person types it */

/* Everybody who tries codes shares this delay; it is no name of an account. */
static const char setup_name[] = "#setup";

/* Answers with a problem that also says whether there is no account yet. */
static void ask_for_login(const struct web_login *login, struct web_exchange *exchange)
{
    json_t *problem = web_problem_json(401, "login-required", "log in first");

    if (problem && json_object_set_new(problem, "setup",
                                       json_boolean(web_accounts_count(login->accounts) == 0))) {
        json_decref(problem);
        problem = NULL;
    }
    web_exchange_json(exchange, 401, problem);
}

void web_login_get_session(void *context, struct web_exchange *exchange)
{
    if (web_exchange_session(exchange) == 0) {
        ask_for_login(context, exchange);
        return;
    }
    web_exchange_json(
        exchange, 200,
        web__login_session_json(web_exchange_account(exchange), web_exchange_role(exchange)));
}

/* Ends the session of the request, if it has one. */
static void end_session(struct web_login *login, const struct web_exchange *exchange)
{
    web_session_end(login->sessions, web_exchange_session(exchange));
    web__login_end_streams(login);
}

/* Begins a session and answers with it. */
static void begin_session(struct web_login *login, struct web_exchange *exchange,
                          const struct web_account *account)
{
    char token[WEB_SESSION_TOKEN_SIZE], cookie[WEB_SESSION_SET_COOKIE_SIZE];

    if (web_exchange_session(exchange) != 0) {
        end_session(login, exchange);
    }
    (void)web_session_begin(login->sessions, account, web_now_ns(), token);
    web_exchange_header(exchange, "Set-Cookie", web_session_set_cookie(token, cookie));
    web_exchange_json(exchange, 201, web__login_session_json(account->name, account->role));
    sodium_memzero(token, sizeof token);
    sodium_memzero(cookie, sizeof cookie);
}

/* A text of the body that was checked before. */
static const char *text_of(const struct web_exchange *exchange, const char *member)
{
    return json_string_value(json_object_get(web_exchange_body(exchange), member));
}

/* Those who had their turn before may have failed: so the delay is looked at now. */
static void log_in(struct web_login *login, struct web_exchange *exchange)
{
    const char *name = text_of(exchange, "account"), *password = text_of(exchange, "password");
    const struct web_account *account = web_accounts_find(login->accounts, name);
    const struct web_problem *busy = login->recorder->hindrance(login->recorder_context);

    if (web__login_must_wait(login, exchange, name)) {
        return;
    }
    if (busy) {
        web_exchange_problem(exchange, busy->status, busy->code, busy->detail);
        return;
    }
    /* Takes as long for an account that does not exist. */
    if (!web_password_is(password, account ? account->hash : NULL)) {
        web_guess_failed(login->guess, name, web_exchange_address(exchange), web_now_ns());
        web_exchange_problem(exchange, 401, "wrong-password",
                             "the account or the password is wrong");
        return;
    }
    web_guess_passed(login->guess, name);
    web__login_note(login, account->name, "login");
    begin_session(login, exchange, account);
}

void web_login_log_in(void *context, struct web_exchange *exchange)
{
    struct web_login *login = context;

    if (web_exchange_member(exchange, "account", WEB_ACCOUNT_NAME_SIZE - 1) &&
        web_exchange_member(exchange, "password", WEB_PASSWORD_MOST_BYTES)) {
        web_turns_wait(login->turns, exchange, log_in);
    }
}

void web_login_log_out(void *context, struct web_exchange *exchange)
{
    struct web_login *login = context;
    char cookie[WEB_SESSION_SET_COOKIE_SIZE];

    if (web_exchange_session(exchange) != 0) {
        web__login_note(login, web_exchange_account(exchange), "logout");
        end_session(login, exchange);
    }
    web_exchange_header(exchange, "Set-Cookie", web_session_set_cookie(NULL, cookie));
    web_exchange_done(exchange);
}

static void set_own_password(struct web_login *login, struct web_exchange *exchange)
{
    const char *name = web_exchange_account(exchange);
    const char *password = text_of(exchange, "new");
    struct iso_fault fault = {.text = ""};

    if (!web_login_goes_on(login, exchange)) {
        return;
    }
    const int r = web_accounts_set_password(login->accounts, name, password, &fault);

    if (r < 0) {
        web__login_account_problem(exchange, r, &fault);
        return;
    }
    web_session_end_account(login->sessions, name, web_exchange_session(exchange));
    web__login_end_streams(login);
    web_exchange_done(exchange);
}

/* The new password is hashed in a turn of its own. */
static void set_own_password_in_turn(struct web_login *login, struct web_exchange *exchange)
{
    web_turns_wait(login->turns, exchange, set_own_password);
}

/* Compares the old password, and puts on record that there will be a new one. */
static void check_own_password(struct web_login *login, struct web_exchange *exchange)
{
    const char *name = web_exchange_account(exchange);
    const struct web_account *account = web_accounts_find(login->accounts, name);
    const char *flaw;

    if (!web_login_goes_on(login, exchange) || web__login_must_wait(login, exchange, name)) {
        return;
    }
    if (!web_password_is(text_of(exchange, "old"), account ? account->hash : NULL)) {
        web_guess_failed(login->guess, name, web_exchange_address(exchange), web_now_ns());
        web_exchange_problem(exchange, 401, "wrong-password", "the old password is wrong");
        return;
    }
    flaw = web_password_flaw(name, text_of(exchange, "new"));
    if (flaw) {
        web_exchange_problem(exchange, 400, "invalid-password", flaw);
        return;
    }
    web_guess_passed(login->guess, name);
    web__login_act(login, exchange, "password-change", "", set_own_password_in_turn);
}

void web_login_set_own_password(void *context, struct web_exchange *exchange)
{
    struct web_login *login = context;

    if (web_exchange_member(exchange, "old", WEB_PASSWORD_MOST_BYTES) &&
        web_exchange_member(exchange, "new", WEB_PASSWORD_MOST_BYTES)) {
        web_turns_wait(login->turns, exchange, check_own_password);
    }
}

/* What hinders an account of this name; answers it. It is told only to who knows the code. */
static bool is_refused(struct web_login *login, struct web_exchange *exchange, const char *name)
{
    if (web_accounts_find(login->accounts, name)) {
        web_exchange_problem(exchange, 409, "account-exists", "there is an account of this name");
        return true;
    }
    if (web_accounts_count(login->accounts) == WEB_ACCOUNTS_MOST) {
        web_exchange_problem(exchange, 409, "too-many-accounts", "there are too many accounts");
        return true;
    }
    return false;
}

/* The code is used up before the account is added, so that it never makes two. */
static void set_up(struct web_login *login, struct web_exchange *exchange, const char *code,
                   const char *name, const char *password)
{
    struct iso_fault fault = {.text = ""};
    int r = web_setup_code_use(login->setup_code, web__login_now_s(), code, &fault);

    if (r == 0) {
        web__login_note(login, name, "setup");
        r = web_accounts_add(login->accounts, name, password, WEB_ROLE_ADMINISTRATOR, &fault);
    }
    if (r < 0) {
        web__login_account_problem(exchange, r, &fault);
        return;
    }
    begin_session(login, exchange, web_accounts_find(login->accounts, name));
}

/* Those who had their turn before may have failed, or may have used the code. */
static void set_up_in_turn(struct web_login *login, struct web_exchange *exchange)
{
    const char *code = text_of(exchange, "code"), *name = text_of(exchange, "account");

    if (web__login_must_wait(login, exchange, setup_name)) {
        return;
    }
    if (!web_setup_code_is(login->setup_code, web__login_now_s(), code)) {
        web_guess_failed(login->guess, setup_name, web_exchange_address(exchange), web_now_ns());
        web_exchange_problem(exchange, 401, "wrong-code", "the code is wrong or has ended");
    } else if (!is_refused(login, exchange, name)) {
        set_up(login, exchange, code, name, text_of(exchange, "password"));
    }
}

void web_login_set_up(void *context, struct web_exchange *exchange)
{
    struct web_login *login = context;
    const char *code = web_exchange_member(exchange, "code", CODE_MOST_BYTES);
    const char *name = code ? web_exchange_member(exchange, "account", WEB_ACCOUNT_NAME_SIZE - 1)
                            : NULL;
    const char *password = name ? web_exchange_member(exchange, "password", WEB_PASSWORD_MOST_BYTES)
                                : NULL;

    if (!password) {
        return;
    }
    if (web_account_name_flaw(name)) {
        web_exchange_problem(exchange, 400, "invalid-account", web_account_name_flaw(name));
    } else if (web_password_flaw(name, password)) {
        web_exchange_problem(exchange, 400, "invalid-password", web_password_flaw(name, password));
    } else {
        web_turns_wait(login->turns, exchange, set_up_in_turn);
    }
}

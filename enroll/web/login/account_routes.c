/* The accounts, for administrators. Every change is on record before it is made. */
#include <string.h>

#include "enroll/web/login/inner.h"
#include "enroll/web/login/turns.h"

void web_login_list_accounts(void *context, struct web_exchange *exchange)
{
    const struct web_login *login = context;
    json_t *list = json_array();
    bool ok = list != NULL;

    for (size_t i = 0; ok && i < web_accounts_count(login->accounts); i++) {
        ok = json_array_append_new(
                 list, web__login_account_json(web_accounts_at(login->accounts, i))) == 0;
    }
    web_exchange_json(exchange, 200, ok ? json_pack("{s:O}", "accounts", list) : NULL);
    json_decref(list);
}

/* A text of the body that was checked before, or NULL. */
static const char *text_of(const struct web_exchange *exchange, const char *member)
{
    return json_string_value(json_object_get(web_exchange_body(exchange), member));
}

static bool has(const struct web_exchange *exchange, const char *member)
{
    return json_object_get(web_exchange_body(exchange), member) != NULL;
}

/* Reads the role and the password of the body as far as it has them. Returns false after answering
 * that one is not allowed. */
static bool are_allowed(struct web_exchange *exchange, const char *name)
{
    const char *role = has(exchange, "role") ? web_exchange_member(exchange, "role", 32) : "";
    const char *password;

    if (!role) {
        return false;
    }
    if (*role && web_role_of(role) == WEB_ROLE_NONE) {
        web_exchange_problem(exchange, 400, "invalid-role", "there is no such role");
        return false;
    }
    password = has(exchange, "password")
                   ? web_exchange_member(exchange, "password", WEB_PASSWORD_MOST_BYTES)
                   : "";
    if (!password) {
        return false;
    }
    if (*password && web_password_flaw(name, password)) {
        web_exchange_problem(exchange, 400, "invalid-password", web_password_flaw(name, password));
        return false;
    }
    return true;
}

static void add(struct web_login *login, struct web_exchange *exchange)
{
    const char *name = text_of(exchange, "name");
    struct iso_fault fault = {.text = ""};

    if (!web_login_goes_on(login, exchange)) {
        return;
    }
    const int r = web_accounts_add(login->accounts, name, text_of(exchange, "password"),
                                   web_role_of(text_of(exchange, "role")), &fault);

    if (r < 0) {
        web__login_account_problem(exchange, r, &fault);
        return;
    }
    web_exchange_json(exchange, 201,
                      web__login_account_json(web_accounts_find(login->accounts, name)));
}

/* The password is hashed when it is the request's turn. */
static void add_in_turn(struct web_login *login, struct web_exchange *exchange)
{
    web_turns_wait(login->turns, exchange, add);
}

void web_login_add_account(void *context, struct web_exchange *exchange)
{
    struct web_login *login = context;
    const char *name = web_exchange_member(exchange, "name", WEB_ACCOUNT_NAME_SIZE - 1);

    if (!name || !web_exchange_member(exchange, "password", WEB_PASSWORD_MOST_BYTES) ||
        !web_exchange_member(exchange, "role", 32)) {
        return;
    }
    if (web_account_name_flaw(name)) {
        web_exchange_problem(exchange, 400, "invalid-account", web_account_name_flaw(name));
    } else if (!are_allowed(exchange, name)) {
        return;
    } else if (web_accounts_find(login->accounts, name)) {
        web_exchange_problem(exchange, 409, "account-exists", "there is an account of this name");
    } else if (web_accounts_count(login->accounts) == WEB_ACCOUNTS_MOST) {
        web_exchange_problem(exchange, 409, "too-many-accounts", "there are too many accounts");
    } else {
        web__login_act(login, exchange, "account-add", name, add_in_turn);
    }
}

/* The account of the path, or NULL after an answer. `loses` says whether the request takes the role
 * of an administrator away. */
static const struct web_account *find_account(const struct web_login *login,
                                              struct web_exchange *exchange, bool loses)
{
    const struct web_account *account = web_accounts_find(login->accounts,
                                                          web_exchange_part(exchange));
    size_t administrators = 0;

    if (!account) {
        web_exchange_problem(exchange, 404, "no-such-account", "there is no account of this name");
        return NULL;
    }
    for (size_t i = 0; i < web_accounts_count(login->accounts); i++) {
        administrators += web_accounts_at(login->accounts, i)->role == WEB_ROLE_ADMINISTRATOR;
    }
    if (loses && administrators == 1 && account->role == WEB_ROLE_ADMINISTRATOR) {
        web_exchange_problem(exchange, 409, "last-administrator", "this is the last administrator");
        return NULL;
    }
    return account;
}

/* The new role is made valid first: it is what could be refused. */
static void change(struct web_login *login, struct web_exchange *exchange)
{
    const char *name = web_exchange_part(exchange);
    struct iso_fault fault = {.text = ""};
    int r = 0;

    if (!web_login_goes_on(login, exchange)) {
        return;
    }
    if (has(exchange, "role")) {
        r = web_accounts_set_role(login->accounts, name, web_role_of(text_of(exchange, "role")),
                                  &fault);
    }
    if (r == 0) {
        web_session_end_account(login->sessions, name, 0);
        web__login_end_streams(login);
    }
    if (r == 0 && has(exchange, "password")) {
        r = web_accounts_set_password(login->accounts, name, text_of(exchange, "password"), &fault);
    }
    if (r < 0) {
        web__login_account_problem(exchange, r, &fault);
        return;
    }
    web_exchange_json(exchange, 200,
                      web__login_account_json(web_accounts_find(login->accounts, name)));
}

/* A password is hashed when it is the request's turn. */
static void change_in_turn(struct web_login *login, struct web_exchange *exchange)
{
    if (has(exchange, "password")) {
        web_turns_wait(login->turns, exchange, change);
    } else {
        change(login, exchange);
    }
}

void web_login_change_account(void *context, struct web_exchange *exchange)
{
    struct web_login *login = context;
    const char *role = text_of(exchange, "role");
    const bool loses = role && web_role_of(role) != WEB_ROLE_ADMINISTRATOR;

    if (!has(exchange, "role") && !has(exchange, "password")) {
        web_exchange_problem(exchange, 400, "invalid-member", "there is no role and no password");
    } else if (are_allowed(exchange, web_exchange_part(exchange)) &&
               find_account(login, exchange, loses)) {
        web__login_act(login, exchange, "account-change", web_exchange_part(exchange),
                       change_in_turn);
    }
}

static void remove_account(struct web_login *login, struct web_exchange *exchange)
{
    const char *name = web_exchange_part(exchange);
    struct iso_fault fault = {.text = ""};
    const int r = web_accounts_remove(login->accounts, name, &fault);

    if (r < 0) {
        web__login_account_problem(exchange, r, &fault);
        return;
    }
    web_session_end_account(login->sessions, name, 0);
    web__login_end_streams(login);
    web_exchange_done(exchange);
}

void web_login_remove_account(void *context, struct web_exchange *exchange)
{
    struct web_login *login = context;

    if (find_account(login, exchange, true)) {
        web__login_act(login, exchange, "account-remove", web_exchange_part(exchange),
                       remove_account);
    }
}

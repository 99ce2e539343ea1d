/* The accounts, for administrators. Every change is on record before it is made. */
#include <string.h>

#include "enroll/web/api/act.h"
#include "enroll/web/api/turns.h"

void web_api_list_accounts(void *context, struct web_exchange *exchange)
{
    const struct web_api *api = context;
    json_t *list = json_array();
    bool ok = list != NULL;

    for (size_t i = 0; ok && i < web_accounts_count(api->accounts); i++) {
        ok = json_array_append_new(list,
                                   web__api_account_json(web_accounts_at(api->accounts, i))) == 0;
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
    const char *role = has(exchange, "role") ? web_api_text(exchange, "role", 32) : "";
    const char *password;

    if (!role) {
        return false;
    }
    if (*role && web_role_of(role) == WEB_ROLE_NONE) {
        web_exchange_problem(exchange, 400, "invalid-role", "there is no such role");
        return false;
    }
    password = has(exchange, "password")
                   ? web_api_text(exchange, "password", WEB_PASSWORD_MOST_BYTES)
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

static void add(struct web_api *api, struct web_exchange *exchange)
{
    const char *name = text_of(exchange, "name");
    struct iso_fault fault = {.text = ""};

    if (!web_api_goes_on(api, exchange)) {
        return;
    }
    const int r = web_accounts_add(api->accounts, name, text_of(exchange, "password"),
                                   web_role_of(text_of(exchange, "role")), &fault);

    if (r < 0) {
        web__api_account_problem(exchange, r, &fault);
        return;
    }
    web_exchange_json(exchange, 201, web__api_account_json(web_accounts_find(api->accounts, name)));
}

/* The password is hashed when it is the request's turn. */
static void add_in_turn(struct web_api *api, struct web_exchange *exchange)
{
    web_turns_wait(api->turns, exchange, add);
}

void web_api_add_account(void *context, struct web_exchange *exchange)
{
    struct web_api *api = context;
    const char *name = web_api_text(exchange, "name", WEB_ACCOUNT_NAME_SIZE - 1);

    if (!name || !web_api_text(exchange, "password", WEB_PASSWORD_MOST_BYTES) ||
        !web_api_text(exchange, "role", 32)) {
        return;
    }
    if (web_account_name_flaw(name)) {
        web_exchange_problem(exchange, 400, "invalid-account", web_account_name_flaw(name));
    } else if (!are_allowed(exchange, name)) {
        return;
    } else if (web_accounts_find(api->accounts, name)) {
        web_exchange_problem(exchange, 409, "account-exists", "there is an account of this name");
    } else if (web_accounts_count(api->accounts) == WEB_ACCOUNTS_MOST) {
        web_exchange_problem(exchange, 409, "too-many-accounts", "there are too many accounts");
    } else {
        web__api_act(api, exchange, "account-add", name, add_in_turn);
    }
}

/* The account of the path, or NULL after an answer. `loses` says whether the request takes the role
 * of an administrator away. */
static const struct web_account *find_account(const struct web_api *api,
                                              struct web_exchange *exchange, bool loses)
{
    const struct web_account *account = web_accounts_find(api->accounts,
                                                          web_exchange_part(exchange));
    size_t administrators = 0;

    if (!account) {
        web_exchange_problem(exchange, 404, "no-such-account", "there is no account of this name");
        return NULL;
    }
    for (size_t i = 0; i < web_accounts_count(api->accounts); i++) {
        administrators += web_accounts_at(api->accounts, i)->role == WEB_ROLE_ADMINISTRATOR;
    }
    if (loses && administrators == 1 && account->role == WEB_ROLE_ADMINISTRATOR) {
        web_exchange_problem(exchange, 409, "last-administrator", "this is the last administrator");
        return NULL;
    }
    return account;
}

/* The new role is made valid first: it is what could be refused. */
static void change(struct web_api *api, struct web_exchange *exchange)
{
    const char *name = web_exchange_part(exchange);
    struct iso_fault fault = {.text = ""};
    int r = 0;

    if (!web_api_goes_on(api, exchange)) {
        return;
    }
    if (has(exchange, "role")) {
        r = web_accounts_set_role(api->accounts, name, web_role_of(text_of(exchange, "role")),
                                  &fault);
    }
    if (r == 0) {
        web_session_end_account(api->sessions, name, 0);
        web__api_end_streams(api);
    }
    if (r == 0 && has(exchange, "password")) {
        r = web_accounts_set_password(api->accounts, name, text_of(exchange, "password"), &fault);
    }
    if (r < 0) {
        web__api_account_problem(exchange, r, &fault);
        return;
    }
    web_exchange_json(exchange, 200, web__api_account_json(web_accounts_find(api->accounts, name)));
}

/* A password is hashed when it is the request's turn. */
static void change_in_turn(struct web_api *api, struct web_exchange *exchange)
{
    if (has(exchange, "password")) {
        web_turns_wait(api->turns, exchange, change);
    } else {
        change(api, exchange);
    }
}

void web_api_change_account(void *context, struct web_exchange *exchange)
{
    struct web_api *api = context;
    const char *role = text_of(exchange, "role");
    const bool loses = role && web_role_of(role) != WEB_ROLE_ADMINISTRATOR;

    if (!has(exchange, "role") && !has(exchange, "password")) {
        web_exchange_problem(exchange, 400, "invalid-member", "there is no role and no password");
    } else if (are_allowed(exchange, web_exchange_part(exchange)) &&
               find_account(api, exchange, loses)) {
        web__api_act(api, exchange, "account-change", web_exchange_part(exchange), change_in_turn);
    }
}

static void remove_account(struct web_api *api, struct web_exchange *exchange)
{
    const char *name = web_exchange_part(exchange);
    struct iso_fault fault = {.text = ""};
    const int r = web_accounts_remove(api->accounts, name, &fault);

    if (r < 0) {
        web__api_account_problem(exchange, r, &fault);
        return;
    }
    web_session_end_account(api->sessions, name, 0);
    web__api_end_streams(api);
    web_exchange_done(exchange);
}

void web_api_remove_account(void *context, struct web_exchange *exchange)
{
    struct web_api *api = context;

    if (find_account(api, exchange, true)) {
        web__api_act(api, exchange, "account-remove", web_exchange_part(exchange), remove_account);
    }
}

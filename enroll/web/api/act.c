#include "enroll/web/api/act.h"

#include <errno.h>
#include <stdio.h>
#include <time.h>

#include "enroll/web/http/now.h"
#include "firmware/contract/contract.h"

int64_t web__api_now_s(void)
{
    return time(NULL);
}

static void on_noted(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    (void)reply;
    if (error) {
        fprintf(stderr, "isotherm-web: %s is not on record: %s\n", (const char *)context,
                error->message ? error->message : error->name);
    }
}

void web__api_note(struct web_api *api, const char *account, const char *act)
{
    char text[ISO_CONTRACT_ACT_BYTES + 1];
    uint32_t left_out = 0;

    if (!web_note_limit_take(&api->notes, account, web_now_ns(), &left_out)) {
        return;
    }
    (void)snprintf(text, sizeof text, "%s", act);
    if (left_out > 0) {
        (void)snprintf(text, sizeof text, "%s-after-%u", act, (unsigned)left_out);
    }
    web_daemon_record(api->daemon, account, text, "", on_noted, (void *)(uintptr_t)act);
}

void web__api_account_problem(struct web_exchange *exchange, int error,
                              const struct iso_fault *fault)
{
    static const struct {
        int error;
        unsigned status;
        const char *code;
    } problems[] = {
        {-EEXIST, 409, "account-exists"},   {-ENOSPC, 409, "too-many-accounts"},
        {-ENOENT, 404, "no-such-account"},  {-EBUSY, 409, "last-administrator"},
        {-EINVAL, 400, "invalid-password"}, {-ENOMEM, 500, "internal"},
    };

    for (size_t i = 0; i < sizeof problems / sizeof *problems; i++) {
        /* The disk has errors of the same numbers; its faults have codes. */
        if (problems[i].error == error && (fault->code == ISO_FAULT_NONE || error == -ENOMEM)) {
            web_exchange_problem(exchange, problems[i].status, problems[i].code, fault->text);
            return;
        }
    }
    web_exchange_problem(exchange, 507, "storage", fault->text);
}

bool web__api_must_wait(struct web_api *api, struct web_exchange *exchange, const char *account)
{
    const int64_t wait_ns = web_guess_wait_ns(api->guess, account, web_exchange_address(exchange),
                                              web_now_ns());
    char seconds[24];

    if (wait_ns == 0) {
        return false;
    }
    (void)snprintf(seconds, sizeof seconds, "%lld",
                   (long long)((wait_ns + 999999999) / 1000000000));
    web_exchange_header(exchange, "Retry-After", seconds);
    web_exchange_problem(exchange, 429, "too-many-attempts", "there were too many wrong attempts");
    return true;
}

void web__api_end_streams(struct web_api *api)
{
    if (api->server) {
        web_server_end_stale_streams(api->server);
    }
}

json_t *web__api_session_json(const char *account, enum web_role role)
{
    return json_pack("{s:s, s:s}", "account", account, "role", web_role_word(role));
}

json_t *web__api_account_json(const struct web_account *account)
{
    return json_pack("{s:s, s:s}", "name", account->name, "role", web_role_word(account->role));
}

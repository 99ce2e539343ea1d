/* What the handlers of sessions and accounts share. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "enroll/web/http/now.h"
#include "enroll/web/login/inner.h"

enum { ACT_SIZE = 32 };

int64_t web__login_now_s(void)
{
    return time(NULL);
}

struct act {
    struct web_login *login;
    struct web_exchange *exchange;
    void (*go)(struct web_login *login, struct web_exchange *exchange);
};

static void on_recorded(void *context, const struct web_problem *problem)
{
    const struct act act = *(struct act *)context;

    free(context);
    if (problem) {
        web_exchange_problem(act.exchange, problem->status, problem->code, problem->detail);
    } else if (web_login_goes_on(act.login, act.exchange)) {
        act.go(act.login, act.exchange);
    }
}

void web__login_act(struct web_login *login, struct web_exchange *exchange, const char *act,
                    const char *concerned,
                    void (*go)(struct web_login *login, struct web_exchange *exchange))
{
    struct act *context = malloc(sizeof *context);

    if (!context) {
        web_exchange_problem(exchange, 500, "internal", "there is no memory for this");
        return;
    }
    *context = (struct act){.login = login, .exchange = exchange, .go = go};
    login->recorder->record(login->recorder_context, web_exchange_account(exchange), act, concerned,
                            on_recorded, context);
}

struct note {
    const char *program, *act;
};

static void on_noted(void *context, const struct web_problem *problem)
{
    struct note *note = context;

    if (problem) {
        fprintf(stderr, "%s: %s is not on record: %s\n", note->program, note->act, problem->detail);
    }
    free(note);
}

void web__login_note(struct web_login *login, const char *account, const char *act)
{
    struct note *note = malloc(sizeof *note);
    char text[ACT_SIZE];
    uint32_t left_out = 0;

    if (!note || !web_note_limit_take(&login->notes, account, web_now_ns(), &left_out)) {
        free(note);
        return;
    }
    (void)snprintf(text, sizeof text, "%s", act);
    if (left_out > 0) {
        (void)snprintf(text, sizeof text, "%s-after-%u", act, (unsigned)left_out);
    }
    *note = (struct note){.program = login->recorder->program, .act = act};
    login->recorder->record(login->recorder_context, account, text, "", on_noted, note);
}

void web__login_account_problem(struct web_exchange *exchange, int error,
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

bool web__login_must_wait(struct web_login *login, struct web_exchange *exchange,
                          const char *account)
{
    const int64_t wait_ns = web_guess_wait_ns(login->guess, account, web_exchange_address(exchange),
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

void web__login_end_streams(struct web_login *login)
{
    if (login->server) {
        web_server_end_stale_streams(login->server);
    }
}

json_t *web__login_session_json(const char *account, enum web_role role)
{
    return json_pack("{s:s, s:s}", "account", account, "role", web_role_word(role));
}

json_t *web__login_account_json(const struct web_account *account)
{
    return json_pack("{s:s, s:s}", "name", account->name, "role", web_role_word(account->role));
}

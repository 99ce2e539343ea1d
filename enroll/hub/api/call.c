#include "enroll/hub/api/call.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <systemd/sd-daemon.h>

/* What the errors of the store are for a program. */
static const struct {
    int error;
    unsigned status;
    const char *code;
} problems[] = {
    {-EEXIST, 409, "name-in-use"},   {-EINVAL, 400, "invalid-value"},
    {-EALREADY, 409, "done-before"}, {-EACCES, 409, "door-expelled"},
    {-ESRCH, 409, "other-rollout"},  {-ESTALE, 409, "zone-behind"},
    {-EFBIG, 400, "invalid-value"},  {-ENOTCONN, 503, "no-database"},
    {-EAGAIN, 503, "no-database"},   {-ENOSPC, 507, "storage"},
};

static bool may(void *context)
{
    struct hub_call *call = context;

    if (web_login_goes_on(&call->api->login, call->exchange)) {
        return true;
    }
    free(call);
    return false;
}

/* In the thread. */
static void work(void *context, struct hub_store *store)
{
    struct hub_call *call = context;

    (void)snprintf(store->actor, sizeof store->actor, "%s", web_exchange_account(call->request));
    call->error = call->work(call, store, &call->fault);
    if (call->error == 0 && call->json) {
        call->text = json_dumps(call->json, JSON_COMPACT);
        call->error = call->text ? 0 : iso_fault_set(&call->fault, -ENOMEM, "out of memory");
    }
    json_decref(call->json);
    call->json = NULL;
}

static struct web_problem problem_of(const struct hub_call *call)
{
    if (call->refusal.status) {
        return call->refusal;
    }
    if (call->error == -ENOENT) {
        return (struct web_problem){404, call->absent ? call->absent : "no-such-thing", NULL};
    }
    for (size_t i = 0; i < sizeof problems / sizeof *problems; i++) {
        if (problems[i].error == call->error) {
            return (struct web_problem){problems[i].status, problems[i].code, NULL};
        }
    }
    return (struct web_problem){500, "internal", NULL};
}

static void refuse(struct hub_call *call)
{
    const struct web_problem problem = problem_of(call);

    if (problem.status == 503) {
        web_exchange_header(call->exchange, "Retry-After", "5");
    }
    if (problem.status == 500) {
        fprintf(stderr, SD_ERR "isotherm-hub: API: %s\n", call->fault.text);
    }
    web_exchange_problem(call->exchange, problem.status, problem.code, call->fault.text);
}

static void done(void *context, bool is_done)
{
    struct hub_call *call = context;

    if (!is_done) {
        web_exchange_problem(call->exchange, 503, "busy", "the hub ends");
    } else if (call->error) {
        refuse(call);
    } else if (call->text) {
        web_exchange_text(call->exchange, call->status, call->text, strlen(call->text));
        call->text = NULL;
    } else {
        web_exchange_done(call->exchange);
    }
    free(call->text);
    free(call);
}

void hub__call(void *context, struct web_exchange *exchange, enum hub_lane lane, hub_call_work what)
{
    struct hub_api *api = context;
    struct hub_call *call = calloc(1, sizeof *call);
    const struct hub_task task = {.may = may, .work = work, .done = done, .context = call};

    if (!call) {
        web_exchange_problem(exchange, 500, "internal", "there is no memory for this");
        return;
    }
    *call = (struct hub_call){
        .api = api, .request = exchange, .exchange = exchange, .status = 200, .work = what};
    if (hub_worker_do(api->worker, lane, &task)) {
        web_exchange_problem(exchange, 503, "busy", "the hub has too much to do");
        free(call);
    }
}

int hub__call_refuse(struct hub_call *call, struct iso_fault *fault, unsigned status,
                     const char *code, const char *detail)
{
    call->refusal = (struct web_problem){status, code, NULL};
    return iso_fault_set(fault, -ECANCELED, "%s", detail);
}

static int bad_member(struct hub_call *call, const char *member, const char *what,
                      struct iso_fault *fault)
{
    char detail[128];

    (void)snprintf(detail, sizeof detail, "%s has to be %s", member, what);
    return hub__call_refuse(call, fault, 400, "invalid-member", detail);
}

static const json_t *member_of(const struct hub_call *call, const char *member)
{
    return json_object_get(web_exchange_body(call->request), member);
}

const char *hub__call_text(struct hub_call *call, const char *member, size_t most, int *error,
                           struct iso_fault *fault)
{
    const json_t *value = member_of(call, member);
    char what[64];

    if (json_is_string(value) && json_string_length(value) > 0 &&
        json_string_length(value) <= most) {
        return json_string_value(value);
    }
    (void)snprintf(what, sizeof what, "a text of 1 to %zu bytes", most);
    *error = bad_member(call, member, what, fault);
    return NULL;
}

int hub__call_flag(struct hub_call *call, const char *member, bool *has, bool *out,
                   struct iso_fault *fault)
{
    const json_t *value = member_of(call, member);

    *has = value != NULL;
    if (value && !json_is_boolean(value)) {
        return bad_member(call, member, "true or false", fault);
    }
    *out = value ? json_is_true(value) : *out;
    return 0;
}

int hub__call_number(struct hub_call *call, const char *member, int64_t most, bool *has,
                     int64_t *out, struct iso_fault *fault)
{
    const json_t *value = member_of(call, member);
    char what[64];

    *has = value != NULL;
    if (value && (!json_is_integer(value) || json_integer_value(value) < 0 ||
                  json_integer_value(value) > most)) {
        (void)snprintf(what, sizeof what, "a whole number from 0 to %lld", (long long)most);
        return bad_member(call, member, what, fault);
    }
    *out = value ? json_integer_value(value) : *out;
    return 0;
}

int hub__call_count(struct hub_call *call, const char *name, uint32_t most, uint32_t otherwise,
                    uint32_t *out, struct iso_fault *fault)
{
    const char *text = web_exchange_query(call->request, name);
    char *end = NULL, detail[96];

    *out = otherwise;
    if (!text) {
        return 0;
    }
    const unsigned long value = strtoul(text, &end, 10);
    if (*text < '0' || *text > '9' || *end || value < 1 || value > most) {
        (void)snprintf(detail, sizeof detail, "%s has to be a whole number from 1 to %u", name,
                       most);
        return hub__call_refuse(call, fault, 400, "invalid-parameter", detail);
    }
    *out = (uint32_t)value;
    return 0;
}

bool hub__call_asks(const struct hub_call *call, const char *name)
{
    const char *text = web_exchange_query(call->request, name);

    return text && strcmp(text, "0") != 0;
}

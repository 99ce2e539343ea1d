/* The audit log. */
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>

#include "enroll/cli/client/state.h"
#include "enroll/web/api/api.h"
#include "firmware/contract/contract.h"

enum { RECORDS_MOST = 1000, RECORDS_USUAL = 100 };

/* The check reads every record, which takes minutes for a long log. A daemon that goes away answers
 * at once. */
static const uint64_t verify_us = UINT64_C(3600) * 1000000;

/* ---- reading ---- */

struct query {
    const struct web_api *api;
    struct web_exchange *exchange;
    int64_t before, from, most; /* from 0: not given */
    int64_t last;               /* of the log */
};

/* Writes the records with a number below `before`. A negative errno: -EBADMSG for a record that is
 * no JSON object. */
static int write_records(const struct query *query, sd_bus_message *reply, FILE *out)
{
    const char *line;
    bool first = true;
    int r = sd_bus_message_enter_container(reply, 'a', "s");
    (void)fprintf(out, "{\"last\":%" PRId64 ",\"records\":[", query->last);
    while (r >= 0 && (r = sd_bus_message_read_basic(reply, 's', &line)) > 0) {
        json_t *record = json_loads(line, 0, NULL);
        const json_int_t number = cli_state_number(record, "sequence", -1);
        json_decref(record);
        if (number < 0) {
            return -EBADMSG;
        }
        if (number < query->before) {
            (void)fprintf(out, "%s%s", first ? "" : ",", line);
            first = false;
        }
    }
    (void)fputs("]}", out);
    return r;
}

static void on_records(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    struct query *query = context;
    char *text = NULL;
    size_t size = 0;
    if (error) {
        web_api_daemon_problem(query->exchange, error);
        free(query);
        return;
    }
    FILE *out = open_memstream(&text, &size);
    const int r = out ? write_records(query, reply, out) : -ENOMEM;
    if (!out || fclose(out) != 0 || r < 0) {
        free(text);
        text = NULL;
    }
    web_exchange_text(query->exchange, 200, text, size);
    free(query);
}

/* Asks for the records, once the number of the last one is known. */
static void ask_records(struct query *query)
{
    struct web_daemon *daemon = query->api->daemon;
    query->before = query->before <= query->last ? query->before : query->last + 1;
    if (query->from == 0) {
        query->from = query->before > query->most ? query->before - query->most : 1;
    }
    const int64_t n = query->before - query->from;
    if (n <= 0) {
        web_exchange_json(query->exchange, 200,
                          json_pack("{s:I, s:[]}", "last", (json_int_t)query->last, "records"));
        free(query);
        return;
    }
    sd_bus_message *call = web_daemon_message(daemon, ISO_CONTRACT_READ_LOG);
    if (call && sd_bus_message_append(call, "tu", (uint64_t)query->from,
                                      (uint32_t)(n < query->most ? n : query->most)) < 0) {
        call = sd_bus_message_unref(call);
    }
    web_daemon_send(daemon, call, 0, on_records, query);
}

static void on_status(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    struct query *query = context;
    json_t *status = NULL;
    if (error) {
        web_api_daemon_problem(query->exchange, error);
        free(query);
        return;
    }
    if (cli_state_read(reply, &status) < 0) {
        web_exchange_json(query->exchange, 500, NULL);
        free(query);
        return;
    }
    query->last = cli_state_number(status, "log-sequence", 0);
    json_decref(status);
    ask_records(query);
}

void web_api_read_log(void *context, struct web_exchange *exchange)
{
    const struct web_api *api = context;
    int64_t before, from, most;
    if (!web_exchange_number(exchange, "before", 1, INT64_MAX, INT64_MAX, &before) ||
        !web_exchange_number(exchange, "from", 1, INT64_MAX, 0, &from) ||
        !web_exchange_number(exchange, "max", 1, RECORDS_MOST, RECORDS_USUAL, &most)) {
        return;
    }
    struct query *query = malloc(sizeof *query);
    if (!query) {
        web_exchange_json(exchange, 500, NULL);
        return;
    }
    *query = (struct query){api, exchange, before, from, most, 0};
    web_daemon_send(api->daemon, web_daemon_message(api->daemon, ISO_CONTRACT_GET_STATUS), 0,
                    on_status, query);
}

/* ---- verification ---- */

struct verification {
    const struct web_api *api;
    struct web_exchange *exchange;
};

static void on_verified(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    struct verification *verification = context;
    struct web_exchange *exchange = verification->exchange;
    const char *head, *flaw;
    uint64_t first, last, flaw_at;
    int sound;
    if (error) {
        web_api_daemon_problem(exchange, error);
    } else if (sd_bus_message_read(reply, "bttsts", &sound, &first, &last, &head, &flaw_at, &flaw) <
               0) {
        web_exchange_json(exchange, 500, NULL);
    } else {
        web_exchange_json(exchange, 200,
                          json_pack("{s:b, s:I, s:I, s:s, s:I, s:s}", "sound", sound, "first",
                                    (json_int_t)first, "last", (json_int_t)last, "head", head,
                                    "flaw_at", (json_int_t)flaw_at, "flaw", flaw));
    }
    free(verification);
}

static void on_recorded(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    struct verification *verification = context;
    struct web_daemon *daemon = verification->api->daemon;
    if (error) {
        on_verified(context, reply, error);
        return;
    }
    if (!web_api_goes_on(verification->api, verification->exchange)) {
        free(verification);
        return;
    }
    sd_bus_message *call = web_daemon_message(daemon, ISO_CONTRACT_VERIFY_LOG);
    if (call && sd_bus_message_append(call, "ts", UINT64_C(0), "") < 0) {
        call = sd_bus_message_unref(call);
    }
    web_daemon_send(daemon, call, verify_us, on_verified, context);
}

void web_api_verify_log(void *context, struct web_exchange *exchange)
{
    const struct web_api *api = context;
    struct verification *verification = malloc(sizeof *verification);
    if (!verification) {
        web_exchange_json(exchange, 500, NULL);
        return;
    }
    *verification = (struct verification){api, exchange};
    web_daemon_record(api->daemon, web_exchange_account(exchange), "log-verify", "", on_recorded,
                      verification);
}

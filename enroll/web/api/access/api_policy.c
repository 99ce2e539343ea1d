/* The policy: who may enter where and when. */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "enroll/web/api/access/access.h"
#include "enroll/web/api/act.h"
#include "enroll/web/api/api.h"
#include "firmware/contract/contract.h"

/* ---- reading and storing ---- */

static void on_policy(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    struct web_exchange *exchange = context;
    const char *document;
    uint64_t revision;
    char *text = NULL;
    if (error) {
        web_api_daemon_problem(exchange, error);
        return;
    }
    if (sd_bus_message_read(reply, "st", &document, &revision) < 0 ||
        asprintf(&text, "{\"revision\":%" PRIu64 ",\"document\":%s}", revision,
                 *document ? document : "null") < 0) {
        text = NULL;
    }
    web_exchange_text(exchange, 200, text, text ? strlen(text) : 0);
}

void web_api_get_policy(void *context, struct web_exchange *exchange)
{
    const struct web_api *api = context;
    web_daemon_send(api->daemon, web_daemon_message(api->daemon, ISO_CONTRACT_GET_POLICY), 0,
                    on_policy, exchange);
}

/* Reads a list of sentences. NULL if it cannot be read. */
static json_t *sentences(sd_bus_message *reply)
{
    const char *sentence;
    json_t *list = json_array();
    int r = sd_bus_message_enter_container(reply, 'a', "s");
    while (r >= 0 && (r = sd_bus_message_read_basic(reply, 's', &sentence)) > 0) {
        r = json_array_append_new(list, json_string(sentence));
    }
    if (r < 0) {
        json_decref(list);
        return NULL;
    }
    return list;
}

static void on_stored(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    struct web_exchange *exchange = context;
    uint64_t revision;
    if (error) {
        web__access_problem(exchange, error, "invalid-policy");
    } else if (sd_bus_message_read(reply, "t", &revision) < 0) {
        web_exchange_json(exchange, 500, NULL);
    } else {
        web_exchange_json(
            exchange, 200,
            json_pack("{s:I, s:o}", "revision", (json_int_t)revision, "remarks", sentences(reply)));
    }
}

static void store(struct web_api *api, struct web_exchange *exchange)
{
    struct web_access_change change = {.document = NULL};
    sd_bus_message *call = NULL;
    if (!web__access_change_read(web_exchange_body(exchange), &change)) {
        call = web_daemon_message(api->daemon, ISO_CONTRACT_SET_POLICY);
    }
    if (call && sd_bus_message_append(call, "st", change.document, change.revision) < 0) {
        call = sd_bus_message_unref(call);
    }
    free(change.document);
    web_daemon_send(api->daemon, call, 0, on_stored, exchange);
}

void web_api_set_policy(void *context, struct web_exchange *exchange)
{
    struct web_access_change change = {.document = NULL};
    const char *flaw = web__access_change_read(web_exchange_body(exchange), &change);
    if (flaw && *flaw) {
        web_exchange_problem(exchange, 400, "invalid-member", flaw);
        return;
    }
    if (flaw) {
        web_exchange_json(exchange, 500, NULL);
        return;
    }
    const char *act = *change.document ? "policy" : "policy-remove";
    free(change.document);
    web__api_act(context, exchange, act, "", store);
}

static void on_findings(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    struct web_exchange *exchange = context;
    if (error) {
        web_api_daemon_problem(exchange, error);
    } else {
        web_exchange_json(exchange, 200, json_pack("{s:o}", "findings", sentences(reply)));
    }
}

void web_api_get_findings(void *context, struct web_exchange *exchange)
{
    const struct web_api *api = context;
    web_daemon_send(api->daemon, web_daemon_message(api->daemon, ISO_CONTRACT_CHECK_POLICY), 0,
                    on_findings, exchange);
}

/* ---- what the door would decide ---- */

/* Reads a dictionary of TestAccess, whose only list is "wanted". */
static json_t *read_answer(sd_bus_message *reply)
{
    json_t *answer = json_object();
    int r = sd_bus_message_enter_container(reply, 'a', "{sv}");
    while (r >= 0 && (r = sd_bus_message_enter_container(reply, 'e', "sv")) > 0) {
        const char *key = NULL, *type = NULL, *text = NULL;
        json_t *value = NULL;
        int flag = 0;
        r = sd_bus_message_read(reply, "s", &key);
        r = r < 0 ? r : sd_bus_message_peek_type(reply, NULL, &type);
        r = r < 0 ? r : sd_bus_message_enter_container(reply, 'v', type);
        if (r >= 0 && strcmp(type, "as") == 0) {
            value = sentences(reply);
            r = sd_bus_message_exit_container(reply);
        } else if (r >= 0 && *type == 'b') {
            r = sd_bus_message_read(reply, "b", &flag);
            value = json_boolean(flag);
        } else if (r >= 0) {
            r = sd_bus_message_read(reply, "s", &text);
            value = r < 0 ? NULL : json_string(text);
        }
        /* The names of the API have underscores. */
        const bool point = key && strcmp(key, ISO_CONTRACT_ACCESS_POINT) == 0;
        if (r >= 0 && json_object_set_new(answer, point ? "access_point" : key, value) < 0) {
            r = -1;
        }
        for (int i = 0; r >= 0 && i < 2; i++) {
            r = sd_bus_message_exit_container(reply);
        }
    }
    if (r < 0) {
        json_decref(answer);
        return NULL;
    }
    return answer;
}

static void on_tested(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    struct web_exchange *exchange = context;
    if (error) {
        web__access_problem(exchange, error, "invalid-parameter");
    } else {
        web_exchange_json(exchange, 200, read_answer(reply));
    }
}

static int append_shown(sd_bus_message *call, const bool shown[WEB_ACCESS_METHODS])
{
    int r = sd_bus_message_open_container(call, 'a', "s");
    for (int i = 0; r >= 0 && i < WEB_ACCESS_METHODS; i++) {
        r = shown[i] ? sd_bus_message_append(call, "s", web__access_methods[i]) : r;
    }
    return r < 0 ? r : sd_bus_message_close_container(call);
}

void web_api_test_access(void *context, struct web_exchange *exchange)
{
    const struct web_api *api = context;
    const char *person = web_exchange_query(exchange, "person");
    const char *point = web_exchange_query(exchange, "access_point");
    const char *words = web_exchange_query(exchange, "shown");
    bool shown[WEB_ACCESS_METHODS] = {false};
    int64_t time_s;
    if (!person || !*person) {
        web_exchange_problem(exchange, 400, "invalid-parameter", "the parameter person is missing");
        return;
    }
    if (!web__access_shown_read(words ? words : "", shown)) {
        web_exchange_problem(exchange, 400, "invalid-parameter",
                             "shown is a list of the words face, card and pin, with commas");
        return;
    }
    if (!web_exchange_number(exchange, "time", 0, INT64_C(253402300799), time(NULL), &time_s)) {
        return;
    }
    sd_bus_message *call = web_daemon_message(api->daemon, ISO_CONTRACT_TEST_ACCESS);
    if (call && (sd_bus_message_append(call, "ssx", person, point ? point : "", time_s) < 0 ||
                 append_shown(call, shown) < 0)) {
        call = sd_bus_message_unref(call);
    }
    web_daemon_send(api->daemon, call, 0, on_tested, exchange);
}

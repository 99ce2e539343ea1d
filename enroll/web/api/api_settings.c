/* The settings of the daemon, and their change while it runs. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/web/api/api.h"
#include "enroll/web/daemon/json_text.h"
#include "firmware/contract/contract.h"

enum {
    NAME_SIZE = 64,       /* of a section or a key, with the NUL */
    VALUE_MOST_BYTES = 64 /* the daemon knows what is allowed */
};

/* ---- the list ---- */

/* Writes the settings of a reply. A negative errno of sd-bus. */
static int write_settings(sd_bus_message *reply, FILE *out)
{
    static const char *const members[] = {"section", "key",  "value",     "default",
                                          "range",   "help", "configured"};
    enum { TEXTS = sizeof members / sizeof *members };
    const char *texts[TEXTS];
    bool first = true;
    int changeable = 0;
    int r = sd_bus_message_enter_container(reply, 'a', "(ssssssbs)");
    (void)fputs("{\"settings\":[", out);
    while (r >= 0 &&
           (r = sd_bus_message_read(reply, "(ssssssbs)", &texts[0], &texts[1], &texts[2], &texts[3],
                                    &texts[4], &texts[5], &changeable, &texts[6])) > 0) {
        (void)fputs(first ? "{" : ",{", out);
        first = false;
        for (int i = 0; i < TEXTS; i++) {
            (void)fprintf(out, "\"%s\":", members[i]);
            web_json_text(out, texts[i]);
            (void)fputc(',', out);
        }
        (void)fprintf(out, "\"changeable\":%s}", changeable ? "true" : "false");
    }
    (void)fputs("]}", out);
    return r;
}

static void on_settings(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    struct web_exchange *exchange = context;
    char *text = NULL;
    size_t size = 0;
    if (error) {
        web_api_daemon_problem(exchange, error);
        return;
    }
    FILE *out = open_memstream(&text, &size);
    const int r = out ? write_settings(reply, out) : -ENOMEM;
    if (!out || fclose(out) != 0 || r < 0) {
        free(text);
        text = NULL;
    }
    web_exchange_text(exchange, 200, text, size);
}

void web_api_get_settings(void *context, struct web_exchange *exchange)
{
    const struct web_api *api = context;
    web_daemon_send(api->daemon, web_daemon_message(api->daemon, ISO_CONTRACT_GET_SETTINGS), 0,
                    on_settings, exchange);
}

/* ---- a change ---- */

struct change {
    const struct web_api *api;
    struct web_exchange *exchange;
    char section[NAME_SIZE], key[NAME_SIZE];
    const char *value; /* of the body; NULL: back to the configuration file */
};

static void refuse(struct change *change, const sd_bus_error *error)
{
    if (sd_bus_error_has_name(error, ISO_CONTRACT_ERROR_INVALID_ARGUMENT)) {
        web_exchange_problem(change->exchange, 400, "invalid-setting", error->message);
    } else {
        web_api_daemon_problem(change->exchange, error);
    }
    free(change);
}

static void on_changed(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    struct change *change = context;
    const char *value = NULL;
    if (error) {
        refuse(change, error);
        return;
    }
    web_exchange_json(change->exchange, 200,
                      sd_bus_message_read(reply, "s", &value) > 0
                          ? json_pack("{s:s, s:s, s:s}", "section", change->section, "key",
                                      change->key, "value", value)
                          : NULL);
    free(change);
}

static void on_recorded(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    struct change *change = context;
    struct web_daemon *daemon = change->api->daemon;
    (void)reply;
    if (error) {
        refuse(change, error);
        return;
    }
    if (!web_api_goes_on(change->api, change->exchange)) {
        free(change);
        return;
    }
    sd_bus_message *call = web_daemon_message(daemon, change->value ? ISO_CONTRACT_SET_SETTING
                                                                    : ISO_CONTRACT_RESET_SETTING);
    int r = call ? sd_bus_message_append(call, "ss", change->section, change->key) : 0;
    if (call && r >= 0 && change->value) {
        r = sd_bus_message_append(call, "s", change->value);
    }
    if (r < 0) {
        call = sd_bus_message_unref(call);
    }
    web_daemon_send(daemon, call, 0, on_changed, change);
}

/* Reads "section.key" of the path. Returns false after answering that there is no such setting. */
static bool read_name(struct web_exchange *exchange, struct change *change)
{
    const char *name = web_exchange_part(exchange), *dot = strchr(name, '.');
    const size_t n = dot ? (size_t)(dot - name) : 0;
    if (n == 0 || n >= NAME_SIZE || !dot[1] || strlen(dot + 1) >= NAME_SIZE) {
        web_exchange_problem(exchange, 404, "no-such-setting",
                             "a setting has a name such as decision.level");
        return false;
    }
    memcpy(change->section, name, n);
    (void)snprintf(change->key, sizeof change->key, "%s", dot + 1);
    return true;
}

static void begin(const struct web_api *api, struct web_exchange *exchange, const char *act,
                  const char *value)
{
    struct change *change = calloc(1, sizeof *change);
    if (!change) {
        web_exchange_json(exchange, 500, NULL);
        return;
    }
    change->api = api;
    change->exchange = exchange;
    change->value = value;
    if (!read_name(exchange, change)) {
        free(change);
        return;
    }
    web_daemon_record(api->daemon, web_exchange_account(exchange), act, "", on_recorded, change);
}

void web_api_set_setting(void *context, struct web_exchange *exchange)
{
    const char *value = web_exchange_member(exchange, "value", VALUE_MOST_BYTES);
    if (value) {
        begin(context, exchange, "setting-set", value);
    }
}

void web_api_reset_setting(void *context, struct web_exchange *exchange)
{
    begin(context, exchange, "setting-reset", NULL);
}

/* A change of a person: another name, other limits, or both. If both are given, the person is
 * renamed first. If the limits are refused then, the answer says that the name has been changed. */
#include <stdlib.h>
#include <string.h>

#include "enroll/web/api/api.h"
#include "enroll/web/api/parts.h"
#include "enroll/web/api/person.h"
#include "enroll/web/daemon/last_seen.h"
#include "enroll/web/http/now.h"
#include "firmware/contract/contract.h"
#include "firmware/contract/person_name.h"

struct request {
    const struct web_api *api;
    struct web_exchange *exchange;
    char person[ISO_PERSON_NAME_SIZE]; /* whom it concerns now */
    char name[ISO_PERSON_NAME_SIZE];   /* the new name; "": it stays */
    struct web_api_limits limits;
    bool renamed;
    char remark[256]; /* of the daemon about the new name; "": none */
};

/* ---- the answer of a change: the person as it is now ---- */

/* Answers with the person, if the reply of ListPeople has it. */
static bool answer_person(const struct request *request, sd_bus_message *reply)
{
    struct iso_person_name_key wanted, found;
    struct web_api_person person;
    char *text = NULL;
    size_t size = 0;
    if (iso_person_name_key(request->person, &wanted) ||
        sd_bus_message_enter_container(reply, 'a', "(sxxxu)") < 0) {
        return false;
    }
    while (web__api_person_read(reply, &person) > 0) {
        const bool is_it = strcmp(person.name, request->person) == 0 ||
                           (iso_person_name_key(person.name, &found) == 0 &&
                            iso_person_name_key_is_same(&wanted, &found));
        FILE *out = is_it ? open_memstream(&text, &size) : NULL;
        if (out) {
            web__api_person_write(out, request->api->last_seen, &person, request->remark);
            (void)fclose(out);
        }
        if (is_it) {
            web_exchange_text(request->exchange, 200, text, size);
            return true;
        }
    }
    return false;
}

static void on_person(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    struct request *request = context;
    if (error) {
        web__api_limits_problem(request->exchange, error, "The change was made. ");
    } else if (!answer_person(request, reply)) {
        web_exchange_problem(request->exchange, 404, "no-such-person",
                             "The change was made. Since then the person has been removed.");
    }
    free(request);
}

static void ask_person(struct request *request)
{
    struct web_daemon *daemon = request->api->daemon;
    web_daemon_send(daemon, web_daemon_message(daemon, ISO_CONTRACT_LIST_PEOPLE), 0, on_person,
                    request);
}

/* ---- another name, then other limits ---- */

enum { DONE_SIZE = ISO_PERSON_NAME_SIZE + 96 };

/* What has been done already, to be set before what is wrong; "": nothing. */
static void say_done(const struct request *request, char *done, size_t size)
{
    done[0] = '\0';
    if (request->renamed) {
        (void)snprintf(
            done, size,
            "The person was renamed to \"%s\", but the limits were not changed: ", request->name);
    }
}

static void refuse(struct request *request, const sd_bus_error *error)
{
    char done[DONE_SIZE];
    say_done(request, done, sizeof done);
    web__api_limits_problem(request->exchange, error, done);
    free(request);
}

/* Whether what was put on record may be done: there was no error, and the session goes on. If not,
 * the request has been answered and freed. */
static bool may_act(struct request *request, const sd_bus_error *error)
{
    if (error) {
        refuse(request, error);
        return false;
    }
    if (!web_session_goes_on(request->api->login.sessions, web_exchange_session(request->exchange),
                             web_now_ns())) {
        char detail[DONE_SIZE + 32];
        say_done(request, detail, sizeof detail);
        (void)strncat(detail, "the session has ended", sizeof detail - strlen(detail) - 1);
        web_exchange_problem(request->exchange, 401, "login-required", detail);
        free(request);
        return false;
    }
    return true;
}

/* Takes over the name as the gallery spells it. */
static void on_limits(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    struct request *request = context;
    const char *name;
    if (error) {
        refuse(request, error);
        return;
    }
    if (sd_bus_message_read(reply, "sxx", &name, NULL, NULL) > 0) {
        (void)snprintf(request->person, sizeof request->person, "%s", name);
    }
    ask_person(request);
}

static int append_limits(sd_bus_message *call, const struct request *request)
{
    const struct web_api_limits *limits = &request->limits;
    int r = sd_bus_message_append(call, "s", request->person);
    if (r >= 0) {
        r = sd_bus_message_open_container(call, 'a', "{sv}");
    }
    if (r >= 0 && limits->names_from) {
        r = sd_bus_message_append(call, "{sv}", ISO_CONTRACT_VALID_FROM, "x", limits->from_s);
    }
    if (r >= 0 && limits->names_until) {
        r = sd_bus_message_append(call, "{sv}", ISO_CONTRACT_VALID_UNTIL, "x", limits->until_s);
    }
    if (r >= 0 && limits->expired) {
        r = sd_bus_message_append(call, "{sv}", ISO_CONTRACT_EXPIRED, "b", 1);
    }
    return r < 0 ? r : sd_bus_message_close_container(call);
}

static void on_limits_recorded(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    struct request *request = context;
    struct web_daemon *daemon = request->api->daemon;
    (void)reply;
    if (!may_act(request, error)) {
        return;
    }
    sd_bus_message *call = web_daemon_message(daemon, ISO_CONTRACT_SET_VALIDITY);
    if (call && append_limits(call, request) < 0) {
        call = sd_bus_message_unref(call);
    }
    web_daemon_send(daemon, call, 0, on_limits, request);
}

static bool names_limits(const struct request *request)
{
    return request->limits.names_from || request->limits.names_until;
}

static void record(struct request *request, const char *act, web_daemon_reply_fn on_recorded)
{
    web_daemon_record(request->api->daemon, web_exchange_account(request->exchange), act,
                      web__api_name_on_record(request->person), on_recorded, request);
}

static void on_renamed(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    struct request *request = context;
    const char *remark = "";
    if (error) {
        refuse(request, error);
        return;
    }
    if (sd_bus_message_read(reply, "s", &remark) > 0) {
        (void)snprintf(request->remark, sizeof request->remark, "%s", remark);
    }
    web_last_seen_rename(request->api->last_seen, request->person, request->name);
    request->renamed = true;
    memcpy(request->person, request->name, sizeof request->person);
    if (names_limits(request)) {
        record(request, "validity", on_limits_recorded);
    } else {
        ask_person(request);
    }
}

static void on_rename_recorded(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    struct request *request = context;
    struct web_daemon *daemon = request->api->daemon;
    (void)reply;
    if (!may_act(request, error)) {
        return;
    }
    sd_bus_message *call = web_daemon_message(daemon, ISO_CONTRACT_RENAME_PERSON);
    if (call && sd_bus_message_append(call, "ss", request->person, request->name) < 0) {
        call = sd_bus_message_unref(call);
    }
    web_daemon_send(daemon, call, 0, on_renamed, request);
}

/* Reads what is to be changed. Returns false after answering what is wrong with it. */
static bool read_change(struct web_exchange *exchange, struct request *request)
{
    const json_t *name = json_object_get(web_exchange_body(exchange), "name");
    const char *flaw = !name                  ? NULL
                       : json_is_string(name) ? iso_person_name_flaw(json_string_value(name))
                                              : "the member 'name' is no text";
    if (flaw) {
        web_exchange_problem(exchange, 400, "invalid-name", flaw);
        return false;
    }
    if (!web__api_limits(exchange, true, &request->limits)) {
        return false;
    }
    if (!name && !names_limits(request)) {
        web_exchange_problem(exchange, 400, "invalid-member", "No name and no limit is given.");
        return false;
    }
    (void)snprintf(request->name, sizeof request->name, "%s", name ? json_string_value(name) : "");
    return true;
}

void web_api_change_person(void *context, struct web_exchange *exchange)
{
    struct request *request = calloc(1, sizeof *request);
    if (!request) {
        web_exchange_json(exchange, 500, NULL);
        return;
    }
    request->api = context;
    request->exchange = exchange;
    if (!web__api_person_of_path(exchange, request->person) || !read_change(exchange, request)) {
        free(request);
    } else if (*request->name) {
        record(request, "rename", on_rename_recorded);
    } else {
        record(request, "validity", on_limits_recorded);
    }
}

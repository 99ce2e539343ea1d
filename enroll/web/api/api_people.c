/* The list of people, and their removal. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/web/api/api.h"
#include "enroll/web/api/parts.h"
#include "enroll/web/api/person.h"
#include "enroll/web/daemon/last_seen.h"
#include "firmware/contract/contract.h"
#include "firmware/contract/person_name.h"

struct request {
    const struct web_api *api;
    struct web_exchange *exchange;
    char person[ISO_PERSON_NAME_SIZE]; /* whom it concerns */
    struct web_api_cards *cards;       /* of the list for administrators; else NULL */
};

static struct request *new_request(const struct web_api *api, struct web_exchange *exchange)
{
    struct request *request = calloc(1, sizeof *request);
    if (!request) {
        web_exchange_json(exchange, 500, NULL);
        return NULL;
    }
    request->api = api;
    request->exchange = exchange;
    return request;
}

/* ---- the list ---- */

static int by_name(const void *a, const void *b)
{
    const char *first = ((const struct web_api_person *)a)->name;
    const char *second = ((const struct web_api_person *)b)->name;
    const int order = strcasecmp(first, second);
    return order ? order : strcmp(first, second);
}

/* Reads all people, sorted by name. The caller frees *out. A negative errno of sd-bus. */
static int read_people(sd_bus_message *reply, struct web_api_person **out, size_t *n_out)
{
    struct web_api_person *people = NULL;
    size_t n = 0, room = 0;
    int r = sd_bus_message_enter_container(reply, 'a', "(sxxxu)");
    while (r >= 0) {
        if (n == room) {
            room = room ? 2 * room : 64;
            struct web_api_person *more = realloc(people, room * sizeof *people);
            if (!more) {
                free(people);
                return -ENOMEM;
            }
            people = more;
        }
        r = web__api_person_read(reply, &people[n]);
        if (r == 0) {
            break;
        }
        n += r > 0;
    }
    if (r < 0) {
        free(people);
        return r;
    }
    qsort(people, n, sizeof *people, by_name);
    *out = people;
    *n_out = n;
    return 0;
}

static void write_people(FILE *out, const struct web_last_seen *seen,
                         const struct web_api_person *people, size_t n)
{
    (void)fprintf(out, "{\"log_read\":%s,\"people\":[",
                  web_last_seen_is_read(seen) ? "true" : "false");
    for (size_t i = 0; i < n; i++) {
        if (i > 0) {
            (void)fputc(',', out);
        }
        web__api_person_write(out, seen, &people[i], "");
    }
    (void)fputs("]}", out);
}

static void free_list(struct request *request)
{
    web__api_cards_free(request->cards);
    free(request);
}

static void add_cards(const struct web_api_cards *cards, struct web_api_person *people, size_t n)
{
    for (size_t i = 0; cards && i < n; i++) {
        people[i].cards = web__api_cards_of(cards, people[i].name);
    }
}

static void on_list(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    struct request *request = context;
    struct web_api_person *people = NULL;
    char *text = NULL;
    size_t n = 0, size = 0;
    if (error) {
        web_api_daemon_problem(request->exchange, error);
        free_list(request);
        return;
    }
    FILE *out = read_people(reply, &people, &n) < 0 ? NULL : open_memstream(&text, &size);
    if (out) {
        add_cards(request->cards, people, n);
        write_people(out, request->api->last_seen, people, n);
        if (fclose(out) != 0) {
            free(text);
            text = NULL;
        }
    }
    free(people);
    web_exchange_text(request->exchange, 200, text, size);
    free_list(request);
}

static void ask_list(struct request *request)
{
    struct web_daemon *daemon = request->api->daemon;
    web_daemon_send(daemon, web_daemon_message(daemon, ISO_CONTRACT_LIST_PEOPLE), 0, on_list,
                    request);
}

static void on_cards(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    struct request *request = context;
    if (error) {
        web_api_daemon_problem(request->exchange, error);
        free_list(request);
    } else if (web__api_cards_read(reply, &request->cards) < 0) {
        web_exchange_json(request->exchange, 500, NULL);
        free_list(request);
    } else {
        ask_list(request);
    }
}

/* Only administrators see cards, by the rights of the daemon and by those of the accounts. */
void web_api_list_people(void *context, struct web_exchange *exchange)
{
    const struct web_api *api = context;
    struct request *request = new_request(api, exchange);
    if (!request) {
        return;
    }
    if (web_exchange_role(exchange) < WEB_ROLE_ADMINISTRATOR) {
        ask_list(request);
        return;
    }
    web_daemon_send(api->daemon, web_daemon_message(api->daemon, ISO_CONTRACT_LIST_CREDENTIALS), 0,
                    on_cards, request);
}

/* ---- removal ---- */

static void on_removed(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    struct request *request = context;
    (void)reply;
    if (error) {
        web_api_daemon_problem(request->exchange, error);
    } else {
        web_exchange_done(request->exchange);
    }
    free(request);
}

static void on_removal_recorded(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    struct request *request = context;
    struct web_daemon *daemon = request->api->daemon;
    if (error) {
        on_removed(context, reply, error);
        return;
    }
    if (!web_api_goes_on(request->api, request->exchange)) {
        free(request);
        return;
    }
    sd_bus_message *call = web_daemon_message(daemon, ISO_CONTRACT_DELETE_PERSON);
    if (call && sd_bus_message_append(call, "s", request->person) < 0) {
        call = sd_bus_message_unref(call);
    }
    web_daemon_send(daemon, call, 0, on_removed, request);
}

void web_api_remove_person(void *context, struct web_exchange *exchange)
{
    struct request *request = new_request(context, exchange);
    if (!request) {
        return;
    }
    if (web__api_person_of_path(exchange, request->person)) {
        web_daemon_record(request->api->daemon, web_exchange_account(exchange), "remove",
                          web__api_name_on_record(request->person), on_removal_recorded, request);
    } else {
        free(request);
    }
}

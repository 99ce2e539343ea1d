/* The enrolment of a person. */
#include <stdio.h>
#include <stdlib.h>

#include "enroll/web/api/api.h"
#include "enroll/web/api/parts.h"
#include "enroll/web/daemon/enrolment.h"

void web_api_get_enrolment(void *context, struct web_exchange *exchange)
{
    const struct web_api *api = context;
    web_exchange_json(exchange, 200,
                      web_enrolment_json(api->enrolment, web_exchange_session(exchange)));
}

struct beginning {
    const struct web_api *api;
    struct web_exchange *exchange;
};

static void on_begun(void *context, const sd_bus_error *error)
{
    const struct beginning *beginning = context;
    struct web_exchange *exchange = beginning->exchange;
    if (error) {
        web__api_limits_problem(exchange, error, "");
    } else {
        web_exchange_json(
            exchange, 201,
            web_enrolment_json(beginning->api->enrolment, web_exchange_session(exchange)));
    }
    free(context);
}

/* Reads the request. Returns false after answering what is wrong with it. */
static bool read_request(struct web_exchange *exchange, struct web_enrolment_request *request)
{
    struct web_api_limits limits;
    bool consent = false;
    const char *person = json_string_value(json_object_get(web_exchange_body(exchange), "person"));
    const char *flaw = person ? iso_person_name_flaw(person) : "the member 'person' is no text";
    if (flaw) {
        web_exchange_problem(exchange, 400, "invalid-name", flaw);
        return false;
    }
    if (!web__api_flag(exchange, "consent", false, &consent) ||
        !web__api_flag(exchange, "poses", true, &request->poses) ||
        !web__api_flag(exchange, "allow_duplicate", false, &request->allow_duplicate) ||
        !web__api_limits(exchange, false, &limits)) {
        return false;
    }
    if (!consent) {
        web_exchange_problem(exchange, 400, "consent-required",
                             "Nobody is enrolled without a consent.");
        return false;
    }
    (void)snprintf(request->person, sizeof request->person, "%s", person);
    (void)snprintf(request->account, sizeof request->account, "%s", web_exchange_account(exchange));
    request->session = web_exchange_session(exchange);
    request->names_from = limits.names_from;
    request->names_until = limits.names_until;
    request->valid_from_s = limits.from_s;
    request->valid_until_s = limits.until_s;
    return true;
}

void web_api_begin_enrolment(void *context, struct web_exchange *exchange)
{
    const struct web_api *api = context;
    struct web_enrolment_request request = {.session = 0};
    if (!read_request(exchange, &request)) {
        return;
    }
    if (web_enrolment_is_busy(api->enrolment)) {
        web_exchange_problem(exchange, 409, "enrolment-running", "Somebody is being enrolled.");
        return;
    }
    struct beginning *beginning = malloc(sizeof *beginning);
    if (!beginning) {
        web_exchange_json(exchange, 500, NULL);
        return;
    }
    *beginning = (struct beginning){api, exchange};
    web_enrolment_begin(api->enrolment, &request, on_begun, beginning);
}

static void on_ended(void *context)
{
    web_exchange_done(context);
}

void web_api_end_enrolment(void *context, struct web_exchange *exchange)
{
    const struct web_api *api = context;
    if (!web_enrolment_end(api->enrolment, web_exchange_session(exchange), on_ended, exchange)) {
        web_exchange_problem(exchange, 409, "no-enrolment", "This session enrols nobody.");
    }
}

#include "enroll/web/api/parts.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

#include "firmware/contract/contract.h"
#include "firmware/contract/person_name.h"

/* Reads a limit. Returns false if the member is there and is no time since 1970. */
static bool read_limit(const json_t *body, const char *member, bool *names, int64_t *out_s)
{
    const json_t *value = json_object_get(body, member);
    *names = value != NULL;
    *out_s = json_integer_value(value);
    return !value || (json_is_integer(value) && *out_s >= 0);
}

/* What is wrong with limits; NULL: nothing that can be said without those that are stored. */
static const char *flaw_of(const struct web_api_limits *limits)
{
    if (limits->names_until && limits->until_s != 0 && limits->names_from &&
        limits->until_s <= limits->from_s) {
        return "The end is not after the beginning.";
    }
    if (limits->names_until && limits->until_s != 0 && limits->until_s < time(NULL) &&
        !limits->expired) {
        return "The end is in the past.";
    }
    return NULL;
}

bool web__api_limits(struct web_exchange *exchange, bool may_expire, struct web_api_limits *out)
{
    const json_t *body = web_exchange_body(exchange);
    struct web_api_limits limits = {.expired = false};
    const char *flaw = NULL;
    if (may_expire && !web__api_flag(exchange, "expired", false, &limits.expired)) {
        return false;
    }
    if (!read_limit(body, "valid_from_s", &limits.names_from, &limits.from_s) ||
        !read_limit(body, "valid_until_s", &limits.names_until, &limits.until_s)) {
        flaw = "A limit is a whole number of seconds since 1970, or 0 for no limit.";
    } else {
        flaw = flaw_of(&limits);
    }
    if (flaw) {
        web_exchange_problem(exchange, 400, "invalid-limits", flaw);
        return false;
    }
    *out = limits;
    return true;
}

bool web__api_flag(struct web_exchange *exchange, const char *member, bool otherwise, bool *out)
{
    const json_t *value = json_object_get(web_exchange_body(exchange), member);
    char text[96];
    if (value && !json_is_boolean(value)) {
        (void)snprintf(text, sizeof text, "The member '%s' is true or false.", member);
        web_exchange_problem(exchange, 400, "invalid-member", text);
        return false;
    }
    *out = value ? json_is_true(value) : otherwise;
    return true;
}

bool web__api_person_of_path(struct web_exchange *exchange, char person[ISO_PERSON_NAME_SIZE])
{
    const char *name = web_exchange_part(exchange);
    if (strlen(name) >= ISO_PERSON_NAME_SIZE) {
        web_exchange_problem(exchange, 404, "no-such-person", "Nobody has this name.");
        return false;
    }
    (void)snprintf(person, ISO_PERSON_NAME_SIZE, "%s", name);
    return true;
}

const char *web__api_name_on_record(const char *name)
{
    return iso_person_name_flaw(name) ? "" : name;
}

void web__api_limits_problem(struct web_exchange *exchange, const sd_bus_error *error,
                             const char *done)
{
    sd_bus_error whole = SD_BUS_ERROR_NULL;
    (void)sd_bus_error_setf(&whole, error->name, "%s%s", done, error->message);
    if (sd_bus_error_has_name(error, ISO_CONTRACT_ERROR_INVALID_ARGUMENT)) {
        web_exchange_problem(exchange, 400, "invalid-limits", whole.message);
    } else {
        web_api_daemon_problem(exchange, &whole);
    }
    sd_bus_error_free(&whole);
}

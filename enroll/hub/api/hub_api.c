#include "enroll/hub/api/hub_api.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>
#include <systemd/sd-daemon.h>
#include <time.h>

#include "enroll/hub/api/api_inner.h"
#include "enroll/web/account/setup_code.h"

_Static_assert(HUB_API_CODE_SIZE == (int)WEB_SETUP_CODE_SIZE, "the size of a code");

/* The store finds a request and a person by a name or an id, so "{id}" is either. */
const struct web_route hub_api_routes[] = {
    {"GET", "/session", WEB_ROLE_NONE, hub__api_get_session},
    {"POST", "/session", WEB_ROLE_NONE, hub__api_login},
    {"DELETE", "/session", WEB_ROLE_NONE, hub__api_logout},
    {"POST", "/setup", WEB_ROLE_NONE, hub__api_setup},
    {"GET", "/zones", WEB_ROLE_OBSERVER, hub__api_list_zones},
    {"PUT", "/zones/{name}/lockdown", WEB_ROLE_ADMINISTRATOR, hub__api_zone_lockdown},
    {"PUT", "/lockdown", WEB_ROLE_ADMINISTRATOR, hub__api_lockdown},
    {"GET", "/doors", WEB_ROLE_OBSERVER, hub__api_list_doors},
    {"GET", "/people", WEB_ROLE_ENROLLER, hub__api_list_people},
    {"DELETE", "/people/{id}", WEB_ROLE_ADMINISTRATOR, hub__api_revoke_person},
    {"GET", "/requests", WEB_ROLE_ENROLLER, hub__api_list_requests},
    {"POST", "/requests/{id}/approve", WEB_ROLE_ADMINISTRATOR, hub__api_approve},
    {"POST", "/requests/{id}/reject", WEB_ROLE_ADMINISTRATOR, hub__api_reject},
    {"GET", "/events", WEB_ROLE_ADMINISTRATOR, hub__api_list_events},
    {"GET", "/acts", WEB_ROLE_ADMINISTRATOR, hub__api_list_acts},
    {NULL, NULL, WEB_ROLE_NONE, NULL},
};

static int path_of(char path[PATH_MAX], const char *folder, const char *name,
                   struct iso_fault *fault)
{
    if (snprintf(path, PATH_MAX, "%s/%s", folder, name) >= PATH_MAX) {
        return iso_fault_set(fault, -ENAMETOOLONG, "%.64s...: the path is too long", folder);
    }
    return 0;
}

int hub_api_open(struct hub_api *api, struct hub_store *store, const char *folder,
                 struct iso_fault *fault)
{
    char path[PATH_MAX];
    int r = path_of(path, folder, "accounts.json", fault);

    r = r < 0 ? r : path_of(api->setup_code, folder, "setup.code", fault);
    r = r < 0 ? r : web_accounts_open(path, &api->accounts, fault);
    if (r < 0) {
        return r;
    }
    api->store = store;
    api->logins = hub_bucket_of(5, 1);
    web_guess_init(&api->guess);
    return 0;
}

void hub_api_close(struct hub_api *api)
{
    web_accounts_close(api->accounts);
    sodium_memzero(api, sizeof *api);
}

int hub_api_make_code(const char *folder, char code[HUB_API_CODE_SIZE], struct iso_fault *fault)
{
    char path[PATH_MAX];
    const int r = path_of(path, folder, "setup.code", fault);

    return r < 0 ? r : web_setup_code_make(path, time(NULL), code, fault);
}

/* ---- for all handlers ---- */

static const struct {
    int error;
    unsigned status;
    const char *code;
} problems[] = {
    {-ENOENT, 404, "no-such-thing"}, {-EEXIST, 409, "name-in-use"},
    {-EALREADY, 409, "decided"},     {-EINVAL, 400, "invalid-value"},
    {-ESTALE, 409, "zone-behind"},   {-ENOTCONN, 503, "no-database"},
    {-EAGAIN, 503, "busy"},          {-ENOTUNIQ, 409, "not-unique"},
};

void hub__api_problem(struct web_exchange *exchange, int error, const struct iso_fault *fault)
{
    for (size_t i = 0; i < sizeof problems / sizeof *problems; i++) {
        if (problems[i].error == error) {
            web_exchange_problem(exchange, problems[i].status, problems[i].code, fault->text);
            return;
        }
    }
    fprintf(stderr, SD_ERR "isotherm-hub: the API: %s\n", fault->text);
    web_exchange_problem(exchange, 500, "internal", "the hub could not do it; its log says why");
}

void hub__api_list(struct web_exchange *exchange, const char *name, json_t *list, int error,
                   const struct iso_fault *fault)
{
    if (error && error != -ENOMEM) {
        json_decref(list);
        hub__api_problem(exchange, error, fault);
        return;
    }
    json_t *answer = list && !error ? json_pack("{s:O}", name, list) : NULL;
    json_decref(list);
    char *text = answer ? json_dumps(answer, JSON_COMPACT) : NULL;
    json_decref(answer);
    web_exchange_text(exchange, 200, text, text ? strlen(text) : 0);
}

void hub__api_act(struct hub_api *api, const struct web_exchange *exchange,
                  struct hub__api_actor *actor)
{
    memcpy(actor->before, api->store->actor, sizeof actor->before);
    (void)snprintf(api->store->actor, sizeof api->store->actor, "%s",
                   web_exchange_account(exchange));
}

void hub__api_acted(struct hub_api *api, const struct hub__api_actor *actor)
{
    memcpy(api->store->actor, actor->before, sizeof actor->before);
}

const char *hub__api_text(struct web_exchange *exchange, const char *member, size_t most)
{
    const json_t *value = json_object_get(web_exchange_body(exchange), member);
    const char *text = json_string_value(value);
    char detail[96];

    if (text && json_string_length(value) > 0 && json_string_length(value) <= most &&
        strlen(text) == json_string_length(value)) {
        return text;
    }
    (void)snprintf(detail, sizeof detail, "%s has to be a text of at most %zu bytes", member, most);
    web_exchange_problem(exchange, 400, "invalid-member", detail);
    return NULL;
}

json_t *hub__api_id(const struct iso_fleet_id *id)
{
    char text[ISO_FLEET_ID_TEXT_SIZE];

    return json_string(iso_fleet_id_text(id, text));
}

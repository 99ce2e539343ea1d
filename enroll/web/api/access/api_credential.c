/* The credential of a person: cards, PIN, profiles and flags. No answer has a PIN. */
#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/web/api/access/access.h"
#include "enroll/web/api/act.h"
#include "enroll/web/api/api.h"
#include "enroll/web/api/parts.h"
#include "firmware/contract/contract.h"

static void on_credential(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    struct web_exchange *exchange = context;
    const char *credential;
    if (error) {
        web__access_problem(exchange, error, "invalid-credential");
    } else if (sd_bus_message_read(reply, "s", &credential) < 0) {
        web_exchange_json(exchange, 500, NULL);
    } else {
        web_exchange_text(exchange, 200, strdup(credential), strlen(credential));
    }
}

void web_api_get_credential(void *context, struct web_exchange *exchange)
{
    const struct web_api *api = context;
    char person[ISO_PERSON_NAME_SIZE];
    if (!web__api_person_of_path(exchange, person)) {
        return;
    }
    sd_bus_message *call = web_daemon_message(api->daemon, ISO_CONTRACT_GET_CREDENTIAL);
    if (call && sd_bus_message_append(call, "s", person) < 0) {
        call = sd_bus_message_unref(call);
    }
    web_daemon_send(api->daemon, call, 0, on_credential, exchange);
}

/* The change may contain a PIN, so every copy of its text is wiped. */
static void change(struct web_api *api, struct web_exchange *exchange)
{
    char *patch = json_dumps(web_exchange_body(exchange), JSON_COMPACT);
    sd_bus_message *call = patch ? web_daemon_message(api->daemon, ISO_CONTRACT_SET_CREDENTIAL)
                                 : NULL;
    if (call && (sd_bus_message_sensitive(call) < 0 ||
                 sd_bus_message_append(call, "ss", web_exchange_part(exchange), patch) < 0)) {
        call = sd_bus_message_unref(call);
    }
    if (patch) {
        sodium_memzero(patch, strlen(patch));
    }
    free(patch);
    web_daemon_send(api->daemon, call, 0, on_credential, exchange);
}

void web_api_change_credential(void *context, struct web_exchange *exchange)
{
    char person[ISO_PERSON_NAME_SIZE];
    if (!web__api_person_of_path(exchange, person)) {
        return;
    }
    if (json_object_size(web_exchange_body(exchange)) == 0) {
        web_exchange_problem(exchange, 400, "invalid-member", "No member to change is given.");
        return;
    }
    web__api_act(context, exchange, "credential", web__api_name_on_record(person), change);
}

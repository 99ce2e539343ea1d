#include "enroll/cli/policy/policy_store.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/cli/client/state.h"
#include "firmware/contract/contract.h"
#include "firmware/policy/zones/zone_file.h"

static enum cli_exit no_memory(struct cli_fault *fault)
{
    return cli_fault_set(fault, CLI_EXIT_FAULT, "internal", "out of memory");
}

enum cli_exit cli_policy_read(const char *json, struct iso_policy_document **out,
                              struct cli_fault *fault)
{
    const struct iso_zone_source zones = {iso_zone_file_read, (void *)ISO_ZONE_FOLDER};
    struct iso_fault why = {0};
    const int error = iso_policy_document_read(json, strlen(json), &zones, out, &why);

    if (error == 0) {
        return CLI_EXIT_OK;
    }
    return error == -ENOMEM
               ? no_memory(fault)
               : cli_fault_set(fault, CLI_EXIT_USAGE, "invalid-policy", "%s", why.text);
}

enum cli_exit cli_policy_fetch(struct cli_daemon *daemon, char **document, uint64_t *revision,
                               struct cli_fault *fault)
{
    sd_bus_message *reply = NULL;
    const char *text;
    uint64_t number;
    enum cli_exit exit = cli_daemon_call(daemon, ISO_CONTRACT_GET_POLICY, &reply, fault);

    if (exit) {
        return exit;
    }
    const int r = sd_bus_message_read(reply, "st", &text, &number);
    char *copy = r < 0 ? NULL : strdup(text);
    if (r < 0) {
        exit = cli_daemon_bad_reply(r, ISO_CONTRACT_GET_POLICY, fault);
    } else if (!copy) {
        exit = no_memory(fault);
    } else {
        *document = copy;
        *revision = number;
    }
    sd_bus_message_unref(reply);
    return exit;
}

enum cli_exit cli_policy_store(struct cli_daemon *daemon, const char *document, uint64_t *revision,
                               json_t **remarks, struct cli_fault *fault)
{
    sd_bus_message *call = NULL, *reply = NULL;
    enum cli_exit exit = cli_daemon_message(daemon, ISO_CONTRACT_SET_POLICY, &call, fault);

    if (exit) {
        return exit;
    }
    int r = sd_bus_message_append(call, "st", document, *revision);
    if (r < 0) {
        sd_bus_message_unref(call);
        return cli_fault_set(fault, CLI_EXIT_FAULT, "internal", "the policy cannot be sent: %s",
                             strerror(-r));
    }
    exit = cli_daemon_send(daemon, call, &reply, fault);
    if (exit) {
        return exit;
    }
    uint64_t number;
    r = sd_bus_message_read(reply, "t", &number);
    if (r >= 0) {
        r = cli_state_read_texts(reply, remarks);
    }
    sd_bus_message_unref(reply);
    if (r < 0) {
        return cli_daemon_bad_reply(r, ISO_CONTRACT_SET_POLICY, fault);
    }
    *revision = number;
    return CLI_EXIT_OK;
}

static int add_change(void *context, const char *kind, const char *token, const char *before,
                      const char *after)
{
    const char *change = !*before ? "added" : !*after ? "removed" : "changed";

    return json_array_append_new(context, json_pack("{s:s, s:s, s:s}", "kind", kind, "token", token,
                                                    "change", change)) == 0
               ? 0
               : -ENOMEM;
}

json_t *cli_policy_changes(const struct iso_policy_document *before,
                           const struct iso_policy_document *after)
{
    json_t *changes = json_array();

    if (changes && iso_policy_document_compare(before, after, add_change, changes) != 0) {
        json_decref(changes);
        changes = NULL;
    }
    return changes;
}

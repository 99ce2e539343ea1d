/* key: changes the keys of the appliance. */
#include <string.h>

#include "enroll/cli/client/long_call.h"
#include "enroll/cli/commands/commands.h"
#include "enroll/cli/text/report.h"
#include "firmware/contract/contract.h"

/* Returns the only text of a reply. It is valid until the reply is released. */
static enum cli_exit read_text(sd_bus_message *reply, const char *method, const char **text,
                               struct cli_fault *fault)
{
    const int r = sd_bus_message_read(reply, "s", text);
    return r < 0 ? cli_daemon_bad_reply(r, method, fault) : CLI_EXIT_OK;
}

static enum cli_exit rotate(struct cli_daemon *daemon, bool json, struct cli_fault *fault)
{
    sd_bus_message *call = NULL, *reply = NULL;
    const char *remark = "";
    enum cli_exit exit = cli_daemon_message(daemon, ISO_CONTRACT_ROTATE_KEYS, &call, fault);
    if (!exit) {
        exit = cli_long_call(daemon, call, "sealing gallery and log anew", &reply, fault);
    }
    if (!exit) {
        exit = read_text(reply, ISO_CONTRACT_ROTATE_KEYS, &remark, fault);
    }
    if (!exit && json) {
        exit = cli_report_json(json_pack("{s:b, s:s}", "rotated", 1, "remark", remark));
    } else if (!exit) {
        printf("Gallery and log are sealed with new keys%s%s.\n", *remark ? "; " : "", remark);
    }
    sd_bus_message_unref(reply);
    return exit;
}

static enum cli_exit show_address(struct cli_daemon *daemon, bool json, struct cli_fault *fault)
{
    sd_bus_message *reply = NULL;
    const char *address = "";
    enum cli_exit exit = cli_daemon_call(daemon, ISO_CONTRACT_GET_ADDRESS, &reply, fault);
    if (!exit) {
        exit = read_text(reply, ISO_CONTRACT_GET_ADDRESS, &address, fault);
    }
    if (!exit && json) {
        exit = cli_report_json(json_pack("{s:s}", "address", address));
    } else if (!exit) {
        puts(address);
    }
    sd_bus_message_unref(reply);
    return exit;
}

enum cli_exit cli_key(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                      struct cli_fault *fault)
{
    if (strcmp(arguments->word, "rotate") == 0) {
        return rotate(daemon, arguments->json, fault);
    }
    if (strcmp(arguments->word, "address") == 0) {
        return show_address(daemon, arguments->json, fault);
    }
    return cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                         "key takes 'rotate' or 'address', not '%s'", arguments->word);
}

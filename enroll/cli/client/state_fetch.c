#include "enroll/cli/client/state.h"
#include "firmware/contract/contract.h"

enum cli_exit cli_state_fetch(struct cli_daemon *daemon, json_t **out, struct cli_fault *fault)
{
    sd_bus_message *reply = NULL;
    const enum cli_exit exit = cli_daemon_call(daemon, ISO_CONTRACT_GET_STATUS, &reply, fault);

    if (exit) {
        return exit;
    }
    const int r = cli_state_read(reply, out);
    sd_bus_message_unref(reply);
    return r < 0 ? cli_daemon_bad_reply(r, ISO_CONTRACT_GET_STATUS, fault) : CLI_EXIT_OK;
}

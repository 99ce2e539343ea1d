#include "enroll/cli/commands/commands.h"

#include "enroll/cli/client/state.h"
#include "enroll/cli/text/report.h"
#include "enroll/cli/text/status_text.h"

enum cli_exit cli_status(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                         struct cli_fault *fault)
{
    json_t *state = NULL;
    const enum cli_exit exit = cli_state_fetch(daemon, &state, fault);

    if (exit) {
        return exit;
    }
    if (arguments->json) {
        return cli_report_json(state);
    }
    cli_status_print(state, stdout);
    json_decref(state);
    return CLI_EXIT_OK;
}

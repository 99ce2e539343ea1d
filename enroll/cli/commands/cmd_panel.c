/* panel install: lets the access panel set its key. */
#include "enroll/cli/commands/commands.h"

#include <string.h>

#include "enroll/cli/text/report.h"
#include "firmware/contract/contract.h"

enum cli_exit cli_panel(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                        struct cli_fault *fault)
{
    if (strcmp(arguments->person, "install") != 0) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "usage", "panel takes install, not '%s'",
                             arguments->person);
    }
    const enum cli_exit exit = cli_daemon_call(daemon, ISO_CONTRACT_INSTALL_PANEL, NULL, fault);
    if (exit) {
        return exit;
    }
    if (arguments->json) {
        return cli_report_json(json_pack("{s:b}", "installing", 1));
    }
    puts("The panel may set its key within the next two minutes.");
    return CLI_EXIT_OK;
}

/* What an installer needs at a new door. door test: switches the relay once, so that one can hear
 * and see that it is wired. panel install: lets the access panel set its key. */
#include "enroll/cli/commands/commands.h"

#include <string.h>

#include "enroll/cli/text/confirm.h"
#include "enroll/cli/text/report.h"
#include "firmware/contract/contract.h"

static const struct cli_confirmation confirmation = {
    .what = "door test unlocks the door for half a second",
    .question = "This unlocks the door for half a second, and is written into the audit log.\n",
    .not_done = "the relay was not switched",
};

enum cli_exit cli_door_test(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                            struct cli_fault *fault)
{
    if (strcmp(arguments->person, "test") != 0) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "usage", "door takes test, not '%s'",
                             arguments->person);
    }
    enum cli_exit exit = arguments->yes ? CLI_EXIT_OK : cli_confirm(&confirmation, fault);
    if (!exit) {
        exit = cli_daemon_call(daemon, ISO_CONTRACT_TEST_DOOR, NULL, fault);
    }
    if (exit) {
        return exit;
    }
    if (arguments->json) {
        return cli_report_json(json_pack("{s:b}", "tested", 1));
    }
    puts("The relay was switched for half a second.");
    return CLI_EXIT_OK;
}

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

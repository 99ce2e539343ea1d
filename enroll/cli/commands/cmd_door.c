/* door test: switches the relay once, so that the installer can hear and see that it is wired. */
#include "enroll/cli/commands/commands.h"

#include <string.h>
#include <unistd.h>

#include "enroll/cli/text/report.h"
#include "firmware/contract/contract.h"

/* Asks for confirmation at the terminal. Returns CLI_EXIT_NO if the answer is not yes, and
 * CLI_EXIT_USAGE if there is no terminal. */
static enum cli_exit confirm(struct cli_fault *fault)
{
    char answer[16] = "";

    if (!isatty(STDIN_FILENO)) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                             "door test unlocks the door for half a second: confirm with --yes, "
                             "since there is no terminal to ask at");
    }
    fputs("This unlocks the door for half a second, and is written into the audit log.\n"
          "Do it now? [y/N] ",
          stderr);
    if (fgets(answer, sizeof answer, stdin) && (answer[0] == 'y' || answer[0] == 'Y')) {
        return CLI_EXIT_OK;
    }
    return cli_fault_set(fault, CLI_EXIT_NO, "not-confirmed", "the relay was not switched");
}

enum cli_exit cli_door_test(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                            struct cli_fault *fault)
{
    if (strcmp(arguments->person, "test") != 0) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "usage", "door takes test, not '%s'",
                             arguments->person);
    }
    enum cli_exit exit = arguments->yes ? CLI_EXIT_OK : confirm(fault);
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

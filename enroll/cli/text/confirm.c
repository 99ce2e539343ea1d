#include "enroll/cli/text/confirm.h"

#include <stdio.h>
#include <unistd.h>

enum cli_exit cli_confirm(const struct cli_confirmation *confirmation, struct cli_fault *fault)
{
    char answer[16] = "";

    if (!isatty(STDIN_FILENO)) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                             "%s: confirm with --yes, since there is no terminal to ask at",
                             confirmation->what);
    }
    fprintf(stderr, "%sDo it now? [y/N] ", confirmation->question);
    if (fgets(answer, sizeof answer, stdin) && (answer[0] == 'y' || answer[0] == 'Y')) {
        return CLI_EXIT_OK;
    }
    return cli_fault_set(fault, CLI_EXIT_NO, "not-confirmed", "%s", confirmation->not_done);
}

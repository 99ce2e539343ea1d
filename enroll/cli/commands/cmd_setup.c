#include <stdio.h>
#include <unistd.h>

#include "enroll/cli/commands/commands.h"
#include "enroll/cli/setup/setup.h"

enum cli_exit cli_setup(const struct cli_arguments *arguments, struct cli_fault *fault)
{
    /* With --json standard output carries the document, so the command asks no questions. */
    const struct cli_dialogue dialogue = {
        .in = STDIN_FILENO,
        .out = arguments->json ? stderr : stdout,
        .terminal = !arguments->json && isatty(STDIN_FILENO) && isatty(STDOUT_FILENO),
    };
    const struct cli_setup_wish wish = {
        .sensor = arguments->sensor,
        .board = arguments->board,
        .picture = arguments->picture ? arguments->picture : "isotherm-setup.png",
        .yes = arguments->yes,
        .dry_run = arguments->dry_run,
        .json = arguments->json,
        .bus = arguments->bus,
    };

    return cli_setup_run(&cli_setup_installed, &wish, &dialogue, fault);
}

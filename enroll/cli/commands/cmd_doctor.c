#include <stdio.h>
#include <unistd.h>

#include "enroll/cli/commands/commands.h"
#include "enroll/cli/commission/commission.h"
#include "enroll/cli/doctor/examine.h"
#include "enroll/cli/text/report.h"

static enum cli_exit commission(const struct cli_arguments *arguments, struct cli_fault *fault)
{
    const struct cli_dialogue dialogue = {
        .in = STDIN_FILENO,
        .out = arguments->json ? stderr : stdout,
        .terminal = isatty(STDIN_FILENO) && isatty(arguments->json ? STDERR_FILENO : STDOUT_FILENO),
    };
    const struct cli_commission_wish wish = {
        .bus = arguments->bus,
        .answers = arguments->answers,
        .json = arguments->json,
    };

    return cli_commission(&wish, &dialogue, fault);
}

enum cli_exit cli_doctor(const struct cli_arguments *arguments, struct cli_fault *fault)
{
    struct cli_diagnosis diagnosis = {0};

    if (arguments->commission) {
        return commission(arguments, fault);
    }
    /* Every fault is part of the result. */
    cli_doctor_examine(&arguments->bus, &diagnosis);
    const enum cli_exit exit = cli_diagnosis_exit(&diagnosis);
    if (!arguments->json) {
        cli_diagnosis_print(&diagnosis, stdout);
        return exit;
    }
    const enum cli_exit written = cli_report_json(cli_diagnosis_json(&diagnosis));
    return written ? written : exit;
}

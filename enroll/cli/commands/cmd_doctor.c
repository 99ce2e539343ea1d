#include "enroll/cli/commands/commands.h"
#include "enroll/cli/doctor/examine.h"
#include "enroll/cli/text/report.h"

enum cli_exit cli_doctor(const struct cli_arguments *arguments, struct cli_fault *fault)
{
    struct cli_diagnosis diagnosis = {0};

    (void)fault; /* every fault is part of the result */
    cli_doctor_examine(&arguments->bus, &diagnosis);
    const enum cli_exit exit = cli_diagnosis_exit(&diagnosis);
    if (!arguments->json) {
        cli_diagnosis_print(&diagnosis, stdout);
        return exit;
    }
    const enum cli_exit written = cli_report_json(cli_diagnosis_json(&diagnosis));
    return written ? written : exit;
}

#include "enroll/cli/text/report.h"

#include <stdio.h>

enum cli_exit cli_report_json(json_t *document)
{
    const int r = document ? json_dumpf(document, stdout, JSON_INDENT(2)) : -1;

    json_decref(document);
    if (r < 0 && !ferror(stdout)) {
        fputs("isotherm: out of memory for the result\n", stderr);
        return CLI_EXIT_FAULT;
    }
    (void)putchar('\n'); /* main() checks whether the output was written */
    return CLI_EXIT_OK;
}

json_t *cli_report_text(const char *text)
{
    return *text ? json_string(text) : json_null();
}

void cli_report_fault(const struct cli_fault *fault, enum cli_exit exit, bool json)
{
    if (!json) {
        fprintf(stderr, "isotherm: %s\n", fault->text);
        return;
    }
    json_t *document = json_pack("{s:{s:s, s:s, s:i}}", "error", "code", fault->code, "message",
                                 fault->text, "exit_code", (int)exit);
    if (cli_report_json(document) != CLI_EXIT_OK) {
        fprintf(stderr, "isotherm: %s\n", fault->text);
    }
}

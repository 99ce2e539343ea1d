/* The findings of `isotherm doctor`: what was checked, what was found, and how to correct it. */
#ifndef CLI_DOCTOR_DIAGNOSIS_H
#define CLI_DOCTOR_DIAGNOSIS_H

#include <jansson.h>
#include <stdio.h>

#include "core/base/fault_code.h"
#include "enroll/cli/client/fault.h"

enum cli_check {
    CLI_CHECK_GOOD,
    CLI_CHECK_ODD,    /* a warning: it works, but not as it should */
    CLI_CHECK_DENIED, /* this user has no right to it */
    CLI_CHECK_BAD,    /* it does not work */
};

enum { CLI_FINDINGS_MAX = 24 };

struct cli_diagnosis {
    size_t n_findings;
    struct cli_finding {
        const char *subject; /* a literal */
        enum cli_check check;
        enum iso_fault_code code; /* ISO_FAULT_NONE: no fault, or a fault without a code */
        char found[256];          /* one line */
    } findings[CLI_FINDINGS_MAX];
};

/* Adds a finding. `subject` is not copied. `found` is copied; if it is "", the meaning of the code
 * is used instead. The remedy follows from the code (enroll/cli/doctor/remedy.h). Findings beyond
 * CLI_FINDINGS_MAX are dropped; they would be an error of the program. */
void cli_diagnosis_add(struct cli_diagnosis *diagnosis, const char *subject, enum cli_check check,
                       enum iso_fault_code code, const char *found);

/* Adds the findings that follow from the daemon's status (see enroll/cli/client/state.h). */
void cli_diagnosis_judge(struct cli_diagnosis *diagnosis, const json_t *state);

/* CLI_EXIT_FAULT if anything is bad, else CLI_EXIT_NO if anything is denied, else CLI_EXIT_OK. */
enum cli_exit cli_diagnosis_exit(const struct cli_diagnosis *diagnosis);

/* Prints the findings, each with its remedy on the next line. */
void cli_diagnosis_print(const struct cli_diagnosis *diagnosis, FILE *out);

/* {"healthy": bool, "checks": [{"subject", "state", "code", "found", "remedy"}]}, where code and
 * remedy are null if there is none. The caller releases it. NULL if there is no memory. */
json_t *cli_diagnosis_json(const struct cli_diagnosis *diagnosis);

#endif

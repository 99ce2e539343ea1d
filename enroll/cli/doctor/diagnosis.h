/* The findings of `isotherm doctor`: what was checked, what was found, and how to correct it. */
#ifndef CLI_DOCTOR_DIAGNOSIS_H
#define CLI_DOCTOR_DIAGNOSIS_H

#include <jansson.h>
#include <stdio.h>

#include "core/base/fault_code.h"
#include "enroll/cli/client/fault.h"

enum cli_check {
    CLI_CHECK_GOOD,
    CLI_CHECK_ODD,    /* a warning: it works */
    CLI_CHECK_DENIED, /* this user has no right to it */
    CLI_CHECK_BAD,
};

enum { CLI_FINDINGS_MAX = 20 };

struct cli_diagnosis {
    size_t n_findings;
    struct cli_finding {
        const char *subject; /* a literal */
        enum cli_check check;
        enum iso_fault_code code; /* which fault it is; ISO_FAULT_NONE: none, or one without code */
        char found[256];
    } findings[CLI_FINDINGS_MAX];
};

/* Adds a finding; `found` is copied, and is the meaning of the code if it is empty; `subject` is
 * kept. Its remedy follows from the code (enroll/cli/doctor/remedy.h). Findings beyond the maximum
 * are dropped; they would be an error of the program. */
void cli_diagnosis_add(struct cli_diagnosis *diagnosis, const char *subject, enum cli_check check,
                       enum iso_fault_code code, const char *found);

/* Adds the findings that follow from the daemon's status (see enroll/cli/client/state.h). */
void cli_diagnosis_judge(struct cli_diagnosis *diagnosis, const json_t *state);

/* CLI_EXIT_FAULT if anything is bad, else CLI_EXIT_NO if anything is denied, else CLI_EXIT_OK. */
enum cli_exit cli_diagnosis_exit(const struct cli_diagnosis *diagnosis);

void cli_diagnosis_print(const struct cli_diagnosis *diagnosis, FILE *out);

/* {"healthy": bool, "checks": [{"subject", "state", "code", "found", "remedy"}]}, where code and
 * remedy are null if there is none. NULL for want of memory. */
json_t *cli_diagnosis_json(const struct cli_diagnosis *diagnosis);

#endif

/* What the checks of a door have shown: one result for each item of the checklist. */
#ifndef CLI_COMMISSION_RESULTS_H
#define CLI_COMMISSION_RESULTS_H

#include <jansson.h>
#include <stdint.h>
#include <stdio.h>

#include "enroll/cli/client/daemon.h"
#include "enroll/cli/commission/answers.h"
#include "firmware/contract/contract.h"

struct cli_result_of_check {
    const char *answer; /* a word ISO_CONTRACT_ANSWER_..., a constant; NULL: not checked yet */
    char remark[ISO_CONTRACT_REMARK_BYTES + 1]; /* one line of text, or "" */
};

struct cli_check_results {
    struct cli_result_of_check items[CLI_CHECKLIST_ITEMS];
};

/* Stores an answer with its remark, which is cut to fit. A remark that is not one line of UTF-8
 * gets
 * '?' for each byte that is not ASCII, so that the daemon accepts it. */
void cli_results_set(struct cli_result_of_check *result, const char *answer, const char *remark);

/* Prints one result: the answer, the item, and the remark. */
void cli_results_print(const struct cli_checklist_item *item,
                       const struct cli_result_of_check *result, FILE *out);

/* Puts all results on record at the daemon. *outcome (a word ISO_CONTRACT_COMMISSION_...; the
 * caller frees it) and *sequence, the number of the record. Faults of cli_daemon_send(). */
enum cli_exit cli_results_record(struct cli_daemon *daemon, const char *by,
                                 const struct cli_check_results *results, char **outcome,
                                 uint64_t *sequence, struct cli_fault *fault)
    __attribute__((warn_unused_result));

/* {"outcome", "by", "record", "items": [{"item", "checked_by", "answer", "remark"}]}, where
 * checked_by is "machine" or "person". The caller releases it. NULL if there is no memory. */
json_t *cli_results_json(const struct cli_check_results *results, const char *by,
                         const char *outcome, uint64_t sequence);

#endif

#include "enroll/cli/commission/commission.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/cli/commission/machine_checks.h"
#include "enroll/cli/machine/interrupt.h"
#include "enroll/cli/text/report.h"
#include "firmware/contract/contract.h"

/* Stores the answer of a person. The relay is switched if the person agrees. */
static void take_answer(struct cli_daemon *daemon, const struct cli_checklist_item *item,
                        const struct cli_answer *answer, struct cli_result_of_check *result)
{
    static const char *const words[] = {
        [CLI_SAID_YES] = ISO_CONTRACT_ANSWER_YES,
        [CLI_SAID_NO] = ISO_CONTRACT_ANSWER_NO,
        [CLI_SAID_SKIP] = ISO_CONTRACT_ANSWER_SKIPPED,
    };

    if (item->way == CLI_WAY_RELAY && answer->said == CLI_SAID_YES) {
        cli_machine_check_relay(daemon, result);
    } else {
        cli_results_set(result, words[answer->said], answer->reason);
    }
}

/* Goes through the items that ask, at the terminal unless there is a file of answers. */
static enum cli_exit ask_all(const struct cli_commission_wish *wish, struct cli_daemon *daemon,
                             const struct cli_dialogue *dialogue, struct cli_answers *answers,
                             struct cli_check_results *results)
{
    enum cli_exit exit = wish->answers ? CLI_EXIT_OK : cli_answers_ask_name(dialogue, answers->by);

    for (size_t i = 0; !exit && i < CLI_CHECKLIST_ITEMS; i++) {
        const struct cli_checklist_item *item = &cli_checklist[i];
        if (!cli_checklist_asks(item)) {
            continue;
        }
        if (!wish->answers) {
            exit = cli_answers_ask(dialogue, item, &answers->items[i]);
        }
        if (!exit) {
            take_answer(daemon, item, &answers->items[i], &results->items[i]);
        }
        if (!exit && (wish->answers || item->way == CLI_WAY_RELAY)) {
            cli_results_print(item, &results->items[i], dialogue->out);
        }
    }
    return exit;
}

static enum cli_exit exit_of(const char *outcome)
{
    if (strcmp(outcome, ISO_CONTRACT_COMMISSION_PASSED) == 0) {
        return CLI_EXIT_OK;
    }
    return strcmp(outcome, ISO_CONTRACT_COMMISSION_INCOMPLETE) == 0 ? CLI_EXIT_NO : CLI_EXIT_FAULT;
}

static enum cli_exit conclude(const struct cli_commission_wish *wish, struct cli_daemon *daemon,
                              const char *by, const struct cli_check_results *results,
                              struct cli_fault *fault)
{
    char *outcome = NULL;
    uint64_t sequence = 0;
    enum cli_exit exit = cli_results_record(daemon, by, results, &outcome, &sequence, fault);

    if (exit) {
        return exit;
    }
    exit = exit_of(outcome);
    if (wish->json) {
        const enum cli_exit written = cli_report_json(
            cli_results_json(results, by, outcome, sequence));
        exit = written ? written : exit;
    } else {
        printf("Outcome: %s; record %" PRIu64 " of the audit log.\n", outcome, sequence);
    }
    free(outcome);
    return exit;
}

static enum cli_exit walk(const struct cli_commission_wish *wish, struct cli_daemon *daemon,
                          const struct cli_dialogue *dialogue, struct cli_answers *answers,
                          struct cli_fault *fault)
{
    struct cli_check_results results = {0};
    enum cli_exit exit = cli_machine_checks(&wish->bus, daemon, dialogue->out, &results, fault);

    if (!exit) {
        exit = ask_all(wish, daemon, dialogue, answers, &results);
    }
    if (exit == CLI_EXIT_INTERRUPTED) {
        return cli_fault_set(fault, exit, "interrupted", "interrupted; nothing has been recorded");
    }
    return exit ? exit : conclude(wish, daemon, answers->by, &results, fault);
}

enum cli_exit cli_commission(const struct cli_commission_wish *wish,
                             const struct cli_dialogue *dialogue, struct cli_fault *fault)
{
    struct cli_answers answers = {.by = ""};
    struct cli_daemon *daemon = NULL;
    enum cli_exit exit = CLI_EXIT_OK;

    if (wish->answers) {
        exit = cli_answers_read(wish->answers, &answers, fault);
    } else if (!dialogue->terminal) {
        exit = cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                             "doctor --commission asks what only a person can see: give --answers "
                             "FILE, since there is no terminal to ask at");
    }
    if (!exit) {
        cli_interrupt_catch();
        exit = cli_daemon_open(&wish->bus, &daemon, fault);
    }
    if (!exit) {
        exit = walk(wish, daemon, dialogue, &answers, fault);
    }
    cli_daemon_close(daemon);
    return exit;
}

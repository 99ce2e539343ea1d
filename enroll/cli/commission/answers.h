/* What a person says about the items of the checklist: from a file, or asked for at the terminal.
 */
#ifndef CLI_COMMISSION_ANSWERS_H
#define CLI_COMMISSION_ANSWERS_H

#include "enroll/cli/client/fault.h"
#include "enroll/cli/commission/checklist.h"
#include "enroll/cli/setup/dialogue.h"
#include "firmware/contract/person_name.h"

struct cli_answer {
    enum cli_said said;
    char reason[CLI_ANSWER_SIZE]; /* one line; "": none was given */
};

/* All answers of a person. Only the items that ask have one. */
struct cli_answers {
    char by[ISO_PERSON_NAME_SIZE]; /* the name of who checks */
    struct cli_answer items[CLI_CHECKLIST_ITEMS];
};

/* Reads a file of answers, with a line for each item that asks:
 *
 *   by = Ada Example
 *   relay = yes
 *   exit-button = no it is not wired
 *   tamper = skip the housing has no switch
 *
 * A reason may follow "no", and has to follow "skip"; the relay is switched or skipped.
 * CLI_EXIT_USAGE "bad-answers" with a fault that names the file and its first fault: it cannot be
 * read, a line that is none of these, or an item without an answer. */
enum cli_exit cli_answers_read(const char *path, struct cli_answers *out, struct cli_fault *fault)
    __attribute__((warn_unused_result));

/* Asks for the name of who checks. CLI_EXIT_INTERRUPTED. */
enum cli_exit cli_answers_ask_name(const struct cli_dialogue *dialogue,
                                   char by[ISO_PERSON_NAME_SIZE])
    __attribute__((warn_unused_result));

/* Asks for one item, and for the reason if the answer is not yes. CLI_EXIT_INTERRUPTED. */
enum cli_exit cli_answers_ask(const struct cli_dialogue *dialogue,
                              const struct cli_checklist_item *item, struct cli_answer *out)
    __attribute__((warn_unused_result));

#endif

#include "enroll/cli/arguments/log_event.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "drivers/terminal/words.h"
#include "firmware/contract/contract.h"

enum { WORD_SIZE = 64 };

static const char *const events[] = {ISO_CONTRACT_EVENTS};

const char *cli_log_event(size_t index, const void *context)
{
    (void)context;
    return index < sizeof events / sizeof *events ? events[index] : NULL;
}

static bool is_event(const char *word)
{
    for (size_t i = 0; cli_log_event(i, NULL); i++) {
        if (strcmp(word, cli_log_event(i, NULL)) == 0) {
            return true;
        }
    }
    return false;
}

static enum cli_exit check_word(const char *word, const char *list, struct cli_fault *fault)
{
    if (is_event(word)) {
        return CLI_EXIT_OK;
    }
    if (!*word) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "usage", "--event: an event is missing in '%s'",
                             list);
    }
    const char *meant = iso_words_nearest(word, cli_log_event, NULL);
    return meant
               ? cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                               "--event: unknown event '%s': did you mean '%s'?", word, meant)
               : cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                               "--event: unknown event '%s' (isotherm(1) lists the events)", word);
}

enum cli_exit cli_log_events_check(const char *list, struct cli_fault *fault)
{
    enum cli_exit exit = CLI_EXIT_OK;

    for (const char *at = list; at && !exit; at = strchr(at, ','), at = at ? at + 1 : NULL) {
        char word[WORD_SIZE];
        (void)snprintf(word, sizeof word, "%.*s", (int)strcspn(at, ","), at);
        exit = check_word(word, list, fault);
    }
    return exit;
}

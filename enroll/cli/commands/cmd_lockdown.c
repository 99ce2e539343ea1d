/* lockdown and lockout: switch the lockdown on or off, and end a lock-out. */
#include "enroll/cli/commands/commands.h"

#include <string.h>

#include "enroll/cli/text/report.h"
#include "firmware/contract/contract.h"

static enum cli_exit bad_word(const char *command, const char *word, const char *words,
                              struct cli_fault *fault)
{
    return cli_fault_set(fault, CLI_EXIT_USAGE, "usage", "%s takes %s, not '%s'", command, words,
                         word);
}

enum cli_exit cli_lockdown(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                           struct cli_fault *fault)
{
    const bool on = strcmp(arguments->person, "on") == 0;
    sd_bus_message *call = NULL;

    if (!on && strcmp(arguments->person, "off") != 0) {
        return bad_word("lockdown", arguments->person, "on or off", fault);
    }
    enum cli_exit exit = cli_daemon_message(daemon, ISO_CONTRACT_SET_LOCKDOWN, &call, fault);
    if (exit) {
        return exit;
    }
    const int r = sd_bus_message_append(call, "b", (int)on);
    if (r < 0) {
        sd_bus_message_unref(call);
        return cli_fault_set(fault, CLI_EXIT_FAULT, "internal", "out of memory");
    }
    exit = cli_daemon_send(daemon, call, NULL, fault);
    if (exit) {
        return exit;
    }
    if (arguments->json) {
        return cli_report_json(json_pack("{s:b}", "lockdown", (int)on));
    }
    puts(on ? "The door admits nobody from now on." : "The door is in service.");
    return CLI_EXIT_OK;
}

enum cli_exit cli_lockout(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                          struct cli_fault *fault)
{
    if (strcmp(arguments->person, "clear") != 0) {
        return bad_word("lockout", arguments->person, "clear", fault);
    }
    const enum cli_exit exit = cli_daemon_call(daemon, ISO_CONTRACT_CLEAR_LOCKOUT, NULL, fault);
    if (exit) {
        return exit;
    }
    if (arguments->json) {
        return cli_report_json(json_pack("{s:b}", "cleared", 1));
    }
    puts("The lock-out is cleared, and its counts are reset.");
    return CLI_EXIT_OK;
}

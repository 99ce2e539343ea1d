/* key: the keys of the appliance. */
#include <string.h>

#include "core/contract.h"
#include "drivers/terminal/progress.h"
#include "enroll/commands.h"
#include "enroll/report.h"

/* Calls a method that returns one text. The text is valid until *reply is released. */
static enum cli_exit ask(struct cli_door *door, const char *method, sd_bus_message **reply,
                         const char **text, struct cli_fault *fault)
{
    enum cli_exit exit = cli_door_call(door, method, reply, fault);
    if (exit) {
        return exit;
    }
    const int r = sd_bus_message_read(*reply, "s", text);
    return r < 0 ? cli_door_bad_reply(r, method, fault) : CLI_EXIT_OK;
}

static enum cli_exit rotate(struct cli_door *door, bool json, struct cli_fault *fault)
{
    sd_bus_message *reply = NULL;
    const char *remark = "";
    struct iso_progress *progress = iso_progress_start(stderr, "isotherm",
                                                       "sealing gallery and log anew", 0, NULL);
    enum cli_exit exit = ask(door, ISO_CONTRACT_ROTATE_KEYS, &reply, &remark, fault);
    iso_progress_end(progress);
    if (!exit && json) {
        exit = cli_report_json(json_pack("{s:b, s:s}", "rotated", 1, "remark", remark));
    } else if (!exit) {
        printf("Gallery and log are sealed with new keys%s%s.\n", *remark ? "; " : "", remark);
    }
    sd_bus_message_unref(reply);
    return exit;
}

static enum cli_exit show_address(struct cli_door *door, bool json, struct cli_fault *fault)
{
    sd_bus_message *reply = NULL;
    const char *address = "";
    enum cli_exit exit = ask(door, ISO_CONTRACT_GET_ADDRESS, &reply, &address, fault);
    if (!exit && json) {
        exit = cli_report_json(json_pack("{s:s}", "address", address));
    } else if (!exit) {
        puts(address);
    }
    sd_bus_message_unref(reply);
    return exit;
}

enum cli_exit cli_key(struct cli_door *door, const struct cli_arguments *arguments,
                      struct cli_fault *fault)
{
    if (strcmp(arguments->word, "rotate") == 0) {
        return rotate(door, arguments->json, fault);
    }
    if (strcmp(arguments->word, "address") == 0) {
        return show_address(door, arguments->json, fault);
    }
    return cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                         "key takes 'rotate' or 'address', not '%s'", arguments->word);
}

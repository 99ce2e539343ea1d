/* validity and rename: change the data of an enrolled person. */
#include "enroll/cli/commands/commands.h"

#include <inttypes.h>

#include "enroll/cli/arguments/limits.h"
#include "enroll/cli/text/report.h"
#include "firmware/contract/contract.h"

static enum cli_exit no_utf8(sd_bus_message *call, struct cli_fault *fault)
{
    sd_bus_message_unref(call);
    return cli_fault_set(fault, CLI_EXIT_USAGE, "invalid-name", "the name is not UTF-8");
}

static enum cli_exit report_validity(sd_bus_message *reply, bool json, struct cli_fault *fault)
{
    const char *person;
    char limits[CLI_LIMITS_SIZE];
    int64_t from_s, until_s;
    const int r = sd_bus_message_read(reply, "sxx", &person, &from_s, &until_s);

    if (r < 0) {
        return cli_daemon_bad_reply(r, ISO_CONTRACT_SET_VALIDITY, fault);
    }
    if (json) {
        return cli_report_json(json_pack("{s:s, s:I, s:I}", "person", person, "valid_from",
                                         (json_int_t)from_s, "valid_until", (json_int_t)until_s));
    }
    cli_limits_format(from_s, until_s, limits);
    printf("The door opens to %s %s.\n", person, limits);
    return CLI_EXIT_OK;
}

enum cli_exit cli_validity(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                           struct cli_fault *fault)
{
    sd_bus_message *call = NULL, *reply = NULL;
    enum cli_exit exit = cli_daemon_message(daemon, ISO_CONTRACT_SET_VALIDITY, &call, fault);

    if (exit) {
        return exit;
    }
    int r = sd_bus_message_append(call, "s", arguments->person);
    if (r >= 0) {
        r = sd_bus_message_open_container(call, 'a', "{sv}");
    }
    if (r >= 0) {
        r = cli_limits_append(call, arguments);
    }
    if (r >= 0) {
        r = sd_bus_message_close_container(call);
    }
    if (r < 0) {
        return no_utf8(call, fault);
    }
    exit = cli_daemon_send(daemon, call, &reply, fault);
    if (!exit) {
        exit = report_validity(reply, arguments->json, fault);
    }
    sd_bus_message_unref(reply);
    return exit;
}

static enum cli_exit report_rename(sd_bus_message *reply, const struct cli_arguments *arguments,
                                   struct cli_fault *fault)
{
    const char *remark;
    const int r = sd_bus_message_read(reply, "s", &remark);

    if (r < 0) {
        return cli_daemon_bad_reply(r, ISO_CONTRACT_RENAME_PERSON, fault);
    }
    if (*remark) {
        fprintf(stderr, "isotherm: %s\n", remark);
    }
    if (arguments->json) {
        return cli_report_json(json_pack("{s:s, s:s, s:s}", "renamed", arguments->person, "person",
                                         arguments->name, "remark", remark));
    }
    printf("%s is called %s now.\n", arguments->person, arguments->name);
    return CLI_EXIT_OK;
}

enum cli_exit cli_rename(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                         struct cli_fault *fault)
{
    sd_bus_message *call = NULL, *reply = NULL;
    enum cli_exit exit = cli_daemon_message(daemon, ISO_CONTRACT_RENAME_PERSON, &call, fault);

    if (exit) {
        return exit;
    }
    if (sd_bus_message_append(call, "ss", arguments->person, arguments->name) < 0) {
        return no_utf8(call, fault);
    }
    exit = cli_daemon_send(daemon, call, &reply, fault);
    if (!exit) {
        exit = report_rename(reply, arguments, fault);
    }
    sd_bus_message_unref(reply);
    return exit;
}

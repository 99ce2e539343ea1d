#include "enroll/cli/arguments/limits.h"

#include <stdio.h>

#include "firmware/contract/contract.h"

int cli_limits_append(sd_bus_message *call, const struct cli_arguments *arguments)
{
    int r = 0;

    if (arguments->names_from) {
        r = sd_bus_message_append(call, "{sv}", ISO_CONTRACT_VALID_FROM, "x",
                                  arguments->valid_from_s);
    }
    if (r >= 0 && arguments->names_until) {
        r = sd_bus_message_append(call, "{sv}", ISO_CONTRACT_VALID_UNTIL, "x",
                                  arguments->valid_until_s);
    }
    if (r >= 0 && arguments->expired) {
        r = sd_bus_message_append(call, "{sv}", ISO_CONTRACT_EXPIRED, "b", 1);
    }
    return r;
}

void cli_limits_format(int64_t from_s, int64_t until_s, char text[CLI_LIMITS_SIZE])
{
    char from[CLI_WHEN_SIZE], until[CLI_WHEN_SIZE];

    cli_when_format(from_s, from);
    cli_when_format(until_s, until);
    if (!from_s && !until_s) {
        (void)snprintf(text, CLI_LIMITS_SIZE, "at all times");
    } else {
        (void)snprintf(text, CLI_LIMITS_SIZE, "%s%s%s%s%s", from_s ? "from " : "",
                       from_s ? from : "", from_s && until_s ? " " : "", until_s ? "until " : "",
                       until_s ? until : "");
    }
}

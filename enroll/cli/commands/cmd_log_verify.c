/* log verify: checks whether every record is there and unchanged. */
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/terminal/terminal.h"
#include "enroll/cli/client/long_call.h"
#include "enroll/cli/commands/commands.h"
#include "enroll/cli/text/report.h"
#include "firmware/contract/contract.h"

struct report {
    int sound;
    uint64_t first, last, flaw_at;
    const char *head, *flaw; /* both point into the reply */
};

/* Reads "17:9f3a...": the sequence and the head from an earlier report. */
static enum cli_exit parse_known(const char *text, uint64_t *sequence, const char **head,
                                 struct cli_fault *fault)
{
    char *end = NULL;
    if (!text) {
        *sequence = 0;
        *head = "";
        return CLI_EXIT_OK;
    }
    errno = 0;
    *sequence = strtoull(text, &end, 10);
    if (errno || end == text || *end != ':' || strspn(end + 1, "0123456789abcdef") != 64 ||
        strlen(end + 1) != 64) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                             "--head: a number, ':' and 64 hexadecimal digits");
    }
    *head = end + 1;
    return CLI_EXIT_OK;
}

static enum cli_exit tell(const struct report *report, bool json)
{
    const enum cli_exit exit = report->sound ? CLI_EXIT_OK : CLI_EXIT_NO;
    if (json) {
        const enum cli_exit written = cli_report_json(
            json_pack("{s:b, s:I, s:I, s:s, s:I, s:s}", "sound", report->sound, "first",
                      (json_int_t)report->first, "last", (json_int_t)report->last, "head",
                      report->head, "flaw_at", (json_int_t)report->flaw_at, "flaw", report->flaw));
        return written ? written : exit;
    }
    const struct iso_terminal terminal = iso_terminal_of(stdout);
    fputs(iso_terminal_paint(&terminal, report->sound ? ISO_PAINT_GOOD : ISO_PAINT_BAD), stdout);
    if (report->sound && report->first == report->last) {
        printf("record %" PRIu64 " is sound%s; head %" PRIu64 ":%s\n", report->first,
               iso_terminal_paint(&terminal, ISO_PAINT_PLAIN), report->last, report->head);
    } else if (report->sound) {
        printf("records %" PRIu64 " to %" PRIu64 " are sound%s; head %" PRIu64 ":%s\n",
               report->first, report->last, iso_terminal_paint(&terminal, ISO_PAINT_PLAIN),
               report->last, report->head);
    } else {
        printf("not sound%s: %s\n", iso_terminal_paint(&terminal, ISO_PAINT_PLAIN), report->flaw);
    }
    return exit;
}

enum cli_exit cli_log_verify(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                             struct cli_fault *fault)
{
    sd_bus_message *call = NULL, *reply = NULL;
    struct report report = {0};
    const char *head = "";
    uint64_t sequence = 0;
    enum cli_exit exit = parse_known(arguments->head, &sequence, &head, fault);
    if (!exit) {
        exit = cli_daemon_message(daemon, ISO_CONTRACT_VERIFY_LOG, &call, fault);
    }
    if (exit) {
        return exit;
    }
    int r = sd_bus_message_append(call, "ts", sequence, head);
    if (r < 0) {
        sd_bus_message_unref(call);
        return cli_daemon_bad_reply(r, ISO_CONTRACT_VERIFY_LOG, fault);
    }
    exit = cli_long_call(daemon, call, "verifying the log", &reply, fault);
    if (exit) {
        return exit;
    }
    r = sd_bus_message_read(reply, "bttsts", &report.sound, &report.first, &report.last,
                            &report.head, &report.flaw_at, &report.flaw);
    exit = r < 0 ? cli_daemon_bad_reply(r, ISO_CONTRACT_VERIFY_LOG, fault)
                 : tell(&report, arguments->json);
    sd_bus_message_unref(reply);
    return exit;
}

#include "enroll/cli/commands/commands.h"

#include <errno.h>
#include <string.h>

#include "enroll/cli/text/log_read.h"
#include "enroll/cli/text/log_record.h"
#include "enroll/cli/text/report.h"

/* The most records if there is no --count. With --day these are all records of the day, up to the
 * largest --count. */
enum { DEFAULT_COUNT = 20, DAY_COUNT = 100000 };

/* The interval at which --follow looks for records that no signal announces. */
static const double follow_period_s = 1.0;

static void print_records(const json_t *records, const struct cli_arguments *arguments)
{
    json_t *record;
    size_t i;

    json_array_foreach(records, i, record)
    {
        if (arguments->json) {
            (void)json_dumpf(record, stdout, JSON_COMPACT);
            (void)putchar('\n');
        } else if (arguments->csv) {
            cli_log_print_csv(record, arguments->full, stdout);
        } else {
            cli_log_print_text(record, arguments->full, stdout);
        }
    }
}

static bool on_any_signal(sd_bus_message *signal, void *context)
{
    (void)signal, (void)context;
    return true; /* a signal came, so the log may have a new record */
}

/* Prints the existing records and then the new ones, until it is interrupted. That is its normal
 * end. */
static enum cli_exit follow(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                            uint64_t from, json_t *records, struct cli_fault *fault)
{
    enum cli_exit exit = cli_daemon_catch_interrupt(daemon, fault);

    if (!exit) {
        exit = cli_daemon_subscribe(daemon, NULL, on_any_signal, NULL, fault);
    }
    while (!exit) {
        print_records(records, arguments);
        if (fflush(stdout) == EOF) {
            return CLI_EXIT_FAULT; /* main() prints the reason */
        }
        exit = cli_daemon_wait(daemon, follow_period_s, fault);
        if (exit == CLI_EXIT_OK || exit == CLI_EXIT_TIMED_OUT) {
            json_array_clear(records);
            exit = cli_log_read_new(daemon, arguments, &from, records, fault);
        }
    }
    return exit == CLI_EXIT_INTERRUPTED ? CLI_EXIT_OK : exit;
}

enum cli_exit cli_log(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                      struct cli_fault *fault)
{
    if (arguments->word) {
        return strcmp(arguments->word, "verify") == 0
                   ? cli_log_verify(daemon, arguments, fault)
                   : cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                                   "log takes 'verify' or nothing, not '%s'", arguments->word);
    }
    const unsigned usual = arguments->day_ends_s ? DAY_COUNT : DEFAULT_COUNT;
    uint64_t from = arguments->from;
    json_t *records = json_array();
    enum cli_exit exit;

    if (!records) {
        return cli_fault_set(fault, CLI_EXIT_FAULT, "internal", "out of memory");
    }
    exit = cli_log_read(daemon, arguments, arguments->count ? arguments->count : usual, &from,
                        records, fault);
    if (!exit && arguments->csv) {
        cli_log_print_csv_head(arguments->full, stdout);
    }
    if (!exit && arguments->follow) {
        exit = follow(daemon, arguments, from, records, fault);
    } else if (!exit && arguments->json) {
        return cli_report_json(json_pack("{s:o}", "records", records));
    } else if (!exit) {
        print_records(records, arguments);
    }
    json_decref(records);
    return exit;
}

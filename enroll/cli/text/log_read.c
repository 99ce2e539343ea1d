#include "enroll/cli/text/log_read.h"

#include <errno.h>
#include <inttypes.h>
#include <string.h>

#include "drivers/terminal/progress.h"
#include "enroll/cli/client/state.h"
#include "enroll/cli/text/log_record.h"
#include "firmware/contract/contract.h"

/* A client may make 20 calls a second. A long log of a busy door needs more, so calls that are
 * refused are repeated for a while. */
enum { TRIES = 60 };
static const double refused_wait_s = 0.25;

/* A clock may have been set back. The search therefore goes on until records are older than the day
 * by this time. */
static const int64_t clock_set_back_s = 7 * 86400;

/* Makes a single call. */
static enum cli_exit ask_for_records(struct cli_daemon *daemon, uint64_t from, unsigned max,
                                     sd_bus_message **reply, struct cli_fault *fault)
{
    sd_bus_message *call = NULL;
    const enum cli_exit exit = cli_daemon_message(daemon, ISO_CONTRACT_READ_LOG, &call, fault);

    if (exit) {
        return exit;
    }
    const int r = sd_bus_message_append(call, "tu", from, max);
    if (r < 0) {
        sd_bus_message_unref(call);
        return cli_daemon_bad_reply(r, ISO_CONTRACT_READ_LOG, fault);
    }
    return cli_daemon_send(daemon, call, reply, fault);
}

/* Makes the call, and repeats it while the daemon refuses it because of too many calls: at most
 * TRIES times, or until the user interrupts. */
static enum cli_exit ask_patiently(struct cli_daemon *daemon, uint64_t from, unsigned max,
                                   sd_bus_message **reply, struct cli_fault *fault)
{
    enum cli_exit exit = ask_for_records(daemon, from, max, reply, fault);

    for (int i = 1; exit && i < TRIES && strcmp(fault->code, "too-many-calls") == 0; i++) {
        const enum cli_exit pause = cli_daemon_wait(daemon, refused_wait_s, fault);
        if (pause != CLI_EXIT_OK && pause != CLI_EXIT_TIMED_OUT) {
            return pause;
        }
        *fault = (struct cli_fault){0};
        exit = ask_for_records(daemon, from, max, reply, fault);
    }
    return exit;
}

/* Reads at most `max` records from number `from` on and appends them to `records`. */
static enum cli_exit read_batch(struct cli_daemon *daemon, uint64_t from, unsigned max,
                                json_t *records, struct cli_fault *fault)
{
    sd_bus_message *reply = NULL;
    const char *line;
    const enum cli_exit exit = ask_patiently(daemon, from, max, &reply, fault);

    if (exit) {
        return exit;
    }
    int r = sd_bus_message_enter_container(reply, 'a', "s");
    while (r >= 0 && (r = sd_bus_message_read_basic(reply, 's', &line)) > 0) {
        json_t *record = json_loads(line, JSON_REJECT_DUPLICATES, NULL);
        r = json_array_append_new(records, record) < 0 ? -EBADMSG : 1;
    }
    sd_bus_message_unref(reply);
    return r < 0 ? cli_daemon_bad_reply(r, ISO_CONTRACT_READ_LOG, fault) : CLI_EXIT_OK;
}

/* Reads at most `max` records from number *from on, and appends the matching ones. Then *from is
 * the number after the last one, and *n_read is the number of records read. Records that the log no
 * longer has are skipped. */
static enum cli_exit read_matching(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                                   uint64_t *from, unsigned max, json_t *records, size_t *n_read,
                                   struct cli_fault *fault)
{
    json_t *batch = json_array(), *record;
    size_t i;
    const enum cli_exit exit = batch ? read_batch(daemon, *from, max, batch, fault)
                                     : cli_fault_set(fault, CLI_EXIT_FAULT, "internal",
                                                     "out of memory");

    *n_read = json_array_size(batch);
    json_array_foreach(batch, i, record)
    {
        *from = cli_log_sequence(record) + 1;
        if (cli_log_matches(record, arguments)) {
            (void)json_array_append(records, record);
        }
    }
    json_decref(batch);
    return exit;
}

/* Reads matching records from *from to `until`, at most `count`. */
static enum cli_exit read_forwards(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                                   size_t count, uint64_t *from, uint64_t until, json_t *records,
                                   struct iso_progress *progress, struct cli_fault *fault)
{
    const uint64_t begin = *from;
    size_t n_read = 1;

    while (*from <= until && n_read > 0 && json_array_size(records) < count) {
        const uint64_t left = until - *from + 1, wanted = count - json_array_size(records);
        uint64_t max = left < CLI_LOG_BATCH ? left : CLI_LOG_BATCH;
        if (!cli_log_chooses(arguments) && wanted < max) {
            max = wanted;
        }
        const enum cli_exit exit = read_matching(daemon, arguments, from, (unsigned)max, records,
                                                 &n_read, fault);
        if (exit) {
            return exit;
        }
        iso_progress_set(progress, *from - begin, until - begin + 1);
    }
    while (json_array_size(records) > count) {
        *from = cli_log_sequence(json_array_get(records, json_array_size(records) - 1));
        (void)json_array_remove(records, json_array_size(records) - 1);
    }
    return CLI_EXIT_OK;
}

/* Whether this record, and therefore all before it, are too old for the requested day. */
static bool is_before_the_day(const json_t *record, const struct cli_arguments *arguments)
{
    return record && arguments->day_ends_s &&
           cli_log_time_s(record) < arguments->day_begins_s - clock_set_back_s;
}

/* Reads all records from `first` to `last` that still exist. */
static enum cli_exit read_all(struct cli_daemon *daemon, uint64_t first, uint64_t last,
                              json_t *records, struct cli_fault *fault)
{
    size_t before = 0;
    enum cli_exit exit = CLI_EXIT_OK;

    do {
        before = json_array_size(records);
        exit = read_batch(daemon, first, (unsigned)(last - first + 1), records, fault);
        first = cli_log_sequence(json_array_get(records, json_array_size(records) - 1)) + 1;
    } while (!exit && json_array_size(records) > before && first <= last);
    return exit;
}

/* Inserts the matching records of a window, up to number `last`, before the records read so far. */
static int prepend_matching(const json_t *window, uint64_t last,
                            const struct cli_arguments *arguments, json_t *records)
{
    json_t *all = json_array(), *record;
    size_t i;
    int r = all ? 0 : -1;

    json_array_foreach(window, i, record)
    {
        if (!r && cli_log_sequence(record) <= last && cli_log_matches(record, arguments)) {
            r = json_array_append(all, record);
        }
    }
    if (!r) {
        r = json_array_extend(all, records);
    }
    if (!r) {
        r = json_array_clear(records);
    }
    if (!r) {
        r = json_array_extend(records, all);
    }
    json_decref(all);
    return r;
}

/* Inserts the matching records from `first` to `last` before the records read so far. *more is true
 * if there are older records that may match. */
static enum cli_exit read_window(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                                 uint64_t first, uint64_t last, json_t *records, bool *more,
                                 struct cli_fault *fault)
{
    json_t *window = json_array();
    enum cli_exit exit = window ? read_all(daemon, first, last, window, fault)
                                : cli_fault_set(fault, CLI_EXIT_FAULT, "internal", "out of memory");
    const json_t *oldest = json_array_get(window, 0);

    *more = first > 1 && oldest && cli_log_sequence(oldest) == first &&
            !is_before_the_day(oldest, arguments);
    if (!exit && prepend_matching(window, last, arguments, records)) {
        exit = cli_fault_set(fault, CLI_EXIT_FAULT, "internal", "out of memory");
    }
    json_decref(window);
    return exit;
}

/* Reads the last `count` matching records up to `until`, from the end to the beginning. */
static enum cli_exit read_backwards(struct cli_daemon *daemon,
                                    const struct cli_arguments *arguments, size_t count,
                                    uint64_t until, json_t *records, struct iso_progress *progress,
                                    struct cli_fault *fault)
{
    const uint64_t size = cli_log_chooses(arguments) || count > CLI_LOG_BATCH ? CLI_LOG_BATCH
                                                                              : count;
    bool more = until > 0;

    for (uint64_t last = until; more && json_array_size(records) < count; last -= size) {
        const uint64_t first = last > size ? last - size + 1 : 1;
        const enum cli_exit exit = read_window(daemon, arguments, first, last, records, &more,
                                               fault);
        if (exit) {
            return exit;
        }
        iso_progress_set(progress, until - first + 1, until);
    }
    while (json_array_size(records) > count) {
        (void)json_array_remove(records, 0);
    }
    return CLI_EXIT_OK;
}

enum cli_exit cli_log_read(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                           size_t count, uint64_t *from, json_t *records, struct cli_fault *fault)
{
    json_t *state = NULL;
    enum cli_exit exit = cli_state_fetch(daemon, &state, fault);

    if (exit) {
        return exit;
    }
    const uint64_t until = (uint64_t)cli_state_number(state, "log-sequence", 0);
    json_decref(state);
    if (*from > until) {
        return cli_fault_set(fault, CLI_EXIT_NOT_FOUND, "no-such-record",
                             "there is no record %" PRIu64 ": the log ends with %" PRIu64, *from,
                             until);
    }
    struct iso_progress *progress = iso_progress_start(stderr, "isotherm", "reading the log", until,
                                                       NULL);
    if (*from > 0) {
        exit = read_forwards(daemon, arguments, count, from, until, records, progress, fault);
    } else {
        exit = read_backwards(daemon, arguments, count, until, records, progress, fault);
        *from = until + 1;
    }
    iso_progress_end(progress);
    return exit;
}

enum cli_exit cli_log_read_new(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                               uint64_t *from, json_t *records, struct cli_fault *fault)
{
    size_t n_read = 0;

    return read_matching(daemon, arguments, from, CLI_LOG_BATCH, records, &n_read, fault);
}

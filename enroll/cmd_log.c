#include "enroll/commands.h"

#include <errno.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "core/contract.h"
#include "enroll/report.h"
#include "enroll/state.h"

/* BATCH: what the daemon hands out at once (core/contract.h). A client may call 20 times a second,
 * which a long log at a busy door takes more of: what is refused is asked for again, for a while.
 */
enum { BATCH = 1000, DEFAULT_COUNT = 20, TRIES = 60 };
static const double refused_wait_s = 0.25;

/* How often --follow looks for records that no signal announces. */
static const double follow_period_s = 1.0;

/* The record's own number; 0 if it has none. */
static uint64_t sequence_of(const json_t *record)
{
    return (uint64_t)json_integer_value(json_object_get(record, "sequence"));
}

/* Asks once. */
static enum cli_exit ask(struct cli_door *door, uint64_t from, unsigned max, sd_bus_message **reply,
                         struct cli_fault *fault)
{
    sd_bus_message *call = NULL;
    const enum cli_exit exit = cli_door_message(door, ISO_CONTRACT_READ_LOG, &call, fault);

    if (exit) {
        return exit;
    }
    const int r = sd_bus_message_append(call, "tu", from, max);
    if (r < 0) {
        sd_bus_message_unref(call);
        return cli_door_bad_reply(r, ISO_CONTRACT_READ_LOG, fault);
    }
    return cli_door_send(door, call, reply, fault);
}

/* Asks until the daemon answers, or the person interrupts. */
static enum cli_exit ask_patiently(struct cli_door *door, uint64_t from, unsigned max,
                                   sd_bus_message **reply, struct cli_fault *fault)
{
    enum cli_exit exit = ask(door, from, max, reply, fault);

    for (int i = 1; exit && i < TRIES && strcmp(fault->code, "too-many-calls") == 0; i++) {
        const enum cli_exit pause = cli_door_wait(door, refused_wait_s, fault);
        if (pause != CLI_EXIT_OK && pause != CLI_EXIT_TIMED_OUT) {
            return pause;
        }
        *fault = (struct cli_fault){0};
        exit = ask(door, from, max, reply, fault);
    }
    return exit;
}

/* Reads at most `max` records from number `from` on and appends them to `records`. */
static enum cli_exit read_batch(struct cli_door *door, uint64_t from, unsigned max, json_t *records,
                                struct cli_fault *fault)
{
    sd_bus_message *reply = NULL;
    const char *line;
    const enum cli_exit exit = ask_patiently(door, from, max, &reply, fault);

    if (exit) {
        return exit;
    }
    int r = sd_bus_message_enter_container(reply, 'a', "s");
    while (r >= 0 && (r = sd_bus_message_read_basic(reply, 's', &line)) > 0) {
        json_t *record = json_loads(line, JSON_REJECT_DUPLICATES, NULL);
        r = json_array_append_new(records, record) < 0 ? -EBADMSG : 1;
    }
    sd_bus_message_unref(reply);
    return r < 0 ? cli_door_bad_reply(r, ISO_CONTRACT_READ_LOG, fault) : CLI_EXIT_OK;
}

/* Appends at most `max` records from number *from on that came up to number `until`; *from is then
 * the number that comes next. Those that the log has dropped meanwhile are passed over. */
static enum cli_exit read_records(struct cli_door *door, uint64_t *from, uint64_t until, size_t max,
                                  json_t *records, struct cli_fault *fault)
{
    const size_t start = json_array_size(records);

    for (;;) {
        const size_t before = json_array_size(records);
        const size_t left = max - (before - start);
        if (*from > until || left == 0) {
            return CLI_EXIT_OK;
        }
        const uint64_t room = until - *from < left ? until - *from + 1 : left;
        const enum cli_exit exit = read_batch(door, *from, room < BATCH ? (unsigned)room : BATCH,
                                              records, fault);
        const size_t after = json_array_size(records);
        if (exit || after == before) {
            return exit;
        }
        *from = sequence_of(json_array_get(records, after - 1)) + 1;
    }
}

/* Which records are asked for: the last `count` of those that there are now (*from 0), or `count`
 * from number *from on. What comes while they are read is not waited for: at a busy door that would
 * have no end. */
static enum cli_exit find_range(struct cli_door *door, unsigned count, uint64_t *from,
                                uint64_t *until, struct cli_fault *fault)
{
    json_t *state = NULL;
    const enum cli_exit exit = cli_state_fetch(door, &state, fault);

    if (exit) {
        return exit;
    }
    *until = (uint64_t)cli_state_number(state, "log-sequence", 0);
    if (*from == 0) {
        *from = *until > count ? *until - count + 1 : 1;
    }
    json_decref(state);
    return CLI_EXIT_OK;
}

static void print_value(const char *name, const json_t *value)
{
    char *text = json_is_string(value) ? NULL : json_dumps(value, JSON_ENCODE_ANY | JSON_COMPACT);

    printf(" %s=%s", name, json_is_string(value) ? json_string_value(value) : text ? text : "?");
    free(text);
}

/* "17 2026-11-21T08:30:15Z visit verdict=allow person=anna ...": the record's members in order. */
static void print_text(json_t *record)
{
    static const char *const leading[] = {"sequence", "time", "event"};
    json_t *value;
    const char *name;

    printf("%" JSON_INTEGER_FORMAT, (json_int_t)sequence_of(record));
    for (size_t i = 1; i < sizeof leading / sizeof *leading; i++) {
        const char *text = json_string_value(json_object_get(record, leading[i]));
        printf(" %s", text ? text : "-");
    }
    json_object_foreach(record, name, value)
    {
        bool printed = false;
        for (size_t i = 0; i < sizeof leading / sizeof *leading; i++) {
            printed |= strcmp(name, leading[i]) == 0;
        }
        if (!printed) {
            print_value(name, value);
        }
    }
    putchar('\n');
}

static void print_records(const json_t *records, bool json)
{
    json_t *record;
    size_t i;

    json_array_foreach(records, i, record)
    {
        if (json) {
            json_dumpf(record, stdout, JSON_COMPACT);
            putchar('\n');
        } else {
            print_text(record);
        }
    }
}

static bool on_any_signal(sd_bus_message *signal, void *context)
{
    (void)signal, (void)context;
    return true; /* something happened: look at the log */
}

/* Prints what there is and then what comes, until interrupted; that is how it is meant to end. */
static enum cli_exit follow(struct cli_door *door, const struct cli_arguments *arguments,
                            uint64_t from, json_t *records, struct cli_fault *fault)
{
    enum cli_exit exit = cli_door_catch_interrupt(door, fault);

    exit = exit ? exit : cli_door_subscribe(door, NULL, on_any_signal, NULL, fault);
    while (!exit) {
        print_records(records, arguments->json);
        if (fflush(stdout) == EOF) {
            return cli_fault_set(fault, CLI_EXIT_FAULT, "output", "cannot write the records");
        }
        exit = cli_door_wait(door, follow_period_s, fault);
        if (exit == CLI_EXIT_OK || exit == CLI_EXIT_TIMED_OUT) {
            json_array_clear(records);
            exit = read_records(door, &from, UINT64_MAX, BATCH, records, fault);
        }
    }
    return exit == CLI_EXIT_INTERRUPTED ? CLI_EXIT_OK : exit;
}

enum cli_exit cli_log(struct cli_door *door, const struct cli_arguments *arguments,
                      struct cli_fault *fault)
{
    if (arguments->word) {
        return strcmp(arguments->word, "verify") == 0
                   ? cli_log_verify(door, arguments, fault)
                   : cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                                   "log takes 'verify' or nothing, not '%s'", arguments->word);
    }
    const unsigned count = arguments->count ? arguments->count : DEFAULT_COUNT;
    uint64_t from = arguments->from, until = 0;
    json_t *records = json_array();
    enum cli_exit exit;

    if (!records) {
        return cli_fault_set(fault, CLI_EXIT_FAULT, "internal", "out of memory");
    }
    exit = find_range(door, count, &from, &until, fault);
    exit = exit ? exit : read_records(door, &from, until, count, records, fault);
    if (!exit && arguments->follow) {
        exit = follow(door, arguments, from, records, fault);
    } else if (!exit && arguments->json) {
        return cli_report_json(json_pack("{s:o}", "records", records));
    } else if (!exit) {
        print_records(records, false);
    }
    json_decref(records);
    return exit;
}

#include "enroll/web/daemon/last_seen.h"

#include <errno.h>
#include <jansson.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "enroll/cli/client/state.h"
#include "enroll/web/daemon/json_text.h"
#include "enroll/web/daemon/seen_table.h"
#include "firmware/contract/contract.h"
#include "firmware/contract/json_member.h"

static const uint64_t pause_us = 100000; /* between two calls */

struct web_last_seen {
    struct web_daemon *daemon;
    struct web_daemon_listener listener;
    sd_event_source *pause;
    uint64_t next, last; /* the next record to read, and the last of the log as it was reported */
    uint64_t asked;      /* `last` when the records were asked for */
    bool is_asking, is_pausing, is_read;
    struct web_seen_table table;
};

static bool let_in(const char *verdict, const char *door)
{
    return verdict && door && strcmp(verdict, "allow") == 0 &&
           (strcmp(door, ISO_CONTRACT_DOOR_UNLOCKED) == 0 ||
            strcmp(door, ISO_CONTRACT_DOOR_OPEN) == 0);
}

/* ---- the log ---- */

/* A record "rename" with a reason says that the one before it was not carried out. */
static void take_rename(struct web_last_seen *seen, const json_t *record, int64_t time_s)
{
    const char *before = cli_state_text(record, "before");
    const char *after = cli_state_text(record, "after");
    if (before && after && !cli_state_text(record, "reason")) {
        web_seen_table_rename(&seen->table, before, after, time_s);
    } else if (before && after) {
        web_seen_table_rename(&seen->table, after, before, time_s);
    }
}

static void take_record(struct web_last_seen *seen, const char *event, const json_t *record)
{
    const char *person = cli_state_text(record, "person");
    const char *time = cli_state_text(record, "time");
    const int64_t time_s = time ? web_time_read(time) : 0;
    if (!person || time_s <= 0) {
        return;
    }
    if (strcmp(event, "rename") == 0) {
        take_rename(seen, record, time_s);
    } else if (strcmp(event, "delete") == 0) {
        if (!cli_state_text(record, "reason")) {
            web_seen_table_remove(&seen->table, person, time_s);
        }
    } else if (let_in(cli_state_text(record, "verdict"), cli_state_text(record, "door"))) {
        web_seen_table_note(&seen->table, person, time_s);
    }
}

/* Reads a line of the log. Most records are about something else, and are not parsed. */
static void take_line(struct web_last_seen *seen, const char *line)
{
    char event[16];
    if (!iso_json_member(line, "event", event, sizeof event) ||
        (strcmp(event, "visit") != 0 && strcmp(event, "rename") != 0 &&
         strcmp(event, "delete") != 0)) {
        return;
    }
    json_t *record = json_loads(line, 0, NULL);
    take_record(seen, event, record);
    json_decref(record);
}

/* The number of a record; 0 if it has none. "sequence" is its first member. */
static uint64_t number_of(const char *line)
{
    static const char begin[] = "{\"sequence\":";
    const char *digits = strncmp(line, begin, sizeof begin - 1) == 0 ? line + sizeof begin - 1 : "";
    return strtoull(digits, NULL, 10);
}

static void on_records(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    struct web_last_seen *seen = context;
    const char *line;
    uint64_t newest = 0;
    seen->is_asking = false;
    if (error || sd_bus_message_enter_container(reply, 'a', "s") < 0) {
        return; /* the next status begins again */
    }
    while (sd_bus_message_read_basic(reply, 's', &line) > 0) {
        newest = number_of(line) > newest ? number_of(line) : newest;
        take_line(seen, line);
    }
    /* An answer without records says that there were none up to the last one. */
    seen->next = newest >= seen->next ? newest + 1 : seen->asked + 1;
    seen->is_read = seen->is_read || seen->next > seen->last;
    if (seen->next <= seen->last && sd_event_source_set_time_relative(seen->pause, pause_us) >= 0) {
        seen->is_pausing = sd_event_source_set_enabled(seen->pause, SD_EVENT_ONESHOT) >= 0;
    }
}

static void read_on(struct web_last_seen *seen)
{
    if (seen->is_asking || seen->is_pausing || seen->next > seen->last) {
        return;
    }
    sd_bus_message *call = web_daemon_message(seen->daemon, ISO_CONTRACT_READ_LOG);
    if (call && sd_bus_message_append(call, "tu", seen->next, (uint32_t)WEB_LAST_SEEN_BLOCK) < 0) {
        call = sd_bus_message_unref(call);
    }
    seen->is_asking = true;
    seen->asked = seen->last;
    web_daemon_send(seen->daemon, call, 0, on_records, seen);
}

static int on_pause_over(sd_event_source *source, uint64_t usec, void *context)
{
    struct web_last_seen *seen = context;
    (void)source;
    (void)usec;
    seen->is_pausing = false;
    read_on(seen);
    return 0;
}

/* ---- the daemon ---- */

static void on_status(void *context, const json_t *status)
{
    struct web_last_seen *seen = context;
    if (!status) {
        return;
    }
    seen->last = (uint64_t)cli_state_number(status, "log-sequence", 0);
    if (seen->last + 1 < seen->next && !seen->is_asking) { /* it is another log */
        web_seen_table_clear(&seen->table);
        seen->next = 1;
        seen->is_read = false;
    }
    if (seen->last > 0 && seen->next > seen->last) {
        seen->is_read = true;
    }
    read_on(seen);
}

/* Visits that come while the log is read are in the log. Somebody who was deleted or renamed in the
 * meantime could be taken for somebody else. */
static void on_signal(void *context, const char *member, sd_bus_message *signal)
{
    struct web_last_seen *seen = context;
    const char *verdict, *person, *door;
    if (seen->is_read && strcmp(member, ISO_CONTRACT_VISIT) == 0 &&
        sd_bus_message_read(signal, "ssdduxsss", &verdict, &person, NULL, NULL, NULL, NULL, NULL,
                            &door, NULL) >= 0 &&
        let_in(verdict, door)) {
        web_seen_table_note(&seen->table, person, time(NULL));
    }
}

int web_last_seen_new(sd_event *event, struct web_daemon *daemon, struct web_last_seen **out)
{
    struct web_last_seen *seen = calloc(1, sizeof *seen);
    if (!seen) {
        return -ENOMEM;
    }
    int r = sd_event_add_time_relative(event, &seen->pause, CLOCK_MONOTONIC, 0, 0, on_pause_over,
                                       seen);
    if (r >= 0) {
        r = sd_event_source_set_enabled(seen->pause, SD_EVENT_OFF);
    }
    if (r < 0) {
        sd_event_source_disable_unref(seen->pause);
        free(seen);
        return r;
    }
    seen->daemon = daemon;
    seen->next = 1;
    web_seen_table_init(&seen->table);
    seen->listener = (struct web_daemon_listener){
        .on_status = on_status, .on_signal = on_signal, .context = seen};
    web_daemon_listen(daemon, &seen->listener);
    *out = seen;
    return 0;
}

void web_last_seen_free(struct web_last_seen *seen)
{
    if (seen) {
        web_daemon_unlisten(seen->daemon, &seen->listener);
        sd_event_source_disable_unref(seen->pause);
        web_seen_table_done(&seen->table);
        free(seen);
    }
}

bool web_last_seen_is_read(const struct web_last_seen *seen)
{
    return seen->is_read;
}

int64_t web_last_seen_of(const struct web_last_seen *seen, const char *name)
{
    return web_seen_table_find(&seen->table, name);
}

void web_last_seen_rename(struct web_last_seen *seen, const char *before, const char *after)
{
    web_seen_table_rename(&seen->table, before, after, time(NULL));
}

/* The door as the appliance sees it: put to work by the configuration, its changes on record and
 * told. */
#include <errno.h>
#include <stdio.h>
#include <syslog.h>

#include "firmware/appliance_state.h"

static bool is_alarm(const struct iso_door_news *news)
{
    return news->state == ISO_DOOR_FORCED || news->state == ISO_DOOR_HELD_OPEN ||
           news->state == ISO_DOOR_FAULT || news->tamper;
}

static int64_t now_ns(const struct iso_appliance *appliance)
{
    return iso_times_now_ns(&appliance->parts.times);
}

static void post(struct iso_appliance *appliance, const char *reason, const char *note)
{
    struct iso_audit_record record = iso_audit_record_of("door");
    record.reason = reason;
    record.note = note;
    (void)!iso_audit_writer_post(appliance->log, &record, NULL);
}

/* On record what was folded; the mutex is held. */
static void record_folded(struct iso_appliance *appliance, bool ending)
{
    struct iso_door_burst burst;
    while (iso_door_events_next(&appliance->recorded, ending, now_ns(appliance), &burst)) {
        post(appliance, "chatter", burst.text);
    }
}

/* On record what the door does; it does so whether there is room for the record or not. Called by
 * the door's thread, too: a record that cannot be queued is counted by the writer, which tells. */
static void record_change(void *context, const struct iso_door_news *news)
{
    struct iso_appliance *appliance = context;
    (void)pthread_mutex_lock(&appliance->recorded_mutex);
    record_folded(appliance, false);
    if (iso_door_events_take(&appliance->recorded, news, now_ns(appliance))) {
        post(appliance, iso_door_event_name(news->cause), iso_door_state_name(news->state));
    }
    (void)pthread_mutex_unlock(&appliance->recorded_mutex);
}

static void tell_change(struct iso_appliance *appliance, const struct iso_door_news *news)
{
    const struct iso_appliance_events *events = &appliance->parts.events;
    const char *state = iso_door_state_name(news->state);
    const char *cause = iso_door_event_name(news->cause);
    iso__appliance_say(appliance, is_alarm(news) ? LOG_WARNING : LOG_INFO, "door %s (%s)%s%s",
                       state, cause, *news->fault ? ": " : "", news->fault);
    events->door_changed(events->context, state, cause);
}

/* Tells of changes that were folded: the door's state now is what clients need. */
static void tell_folded(struct iso_appliance *appliance, bool ending)
{
    const struct iso_appliance_events *events = &appliance->parts.events;
    struct iso_door_burst burst;
    while (iso_door_events_next(&appliance->told, ending, now_ns(appliance), &burst)) {
        iso__appliance_say(appliance, LOG_WARNING, "door: %s", burst.text);
        events->door_changed(events->context, iso_door_state_name(burst.state),
                             iso_door_event_name(burst.cause));
    }
}

static void flush_folded(struct iso_appliance *appliance, bool ending)
{
    (void)pthread_mutex_lock(&appliance->recorded_mutex);
    record_folded(appliance, ending);
    (void)pthread_mutex_unlock(&appliance->recorded_mutex);
    tell_folded(appliance, ending);
}

void iso__appliance_flush_door(struct iso_appliance *appliance)
{
    flush_folded(appliance, true);
}

int64_t iso__appliance_door_events_due_ns(struct iso_appliance *appliance)
{
    (void)pthread_mutex_lock(&appliance->recorded_mutex);
    const int64_t record_ns = iso_door_events_due_ns(&appliance->recorded);
    (void)pthread_mutex_unlock(&appliance->recorded_mutex);
    const int64_t tell_ns = iso_door_events_due_ns(&appliance->told);
    return record_ns < tell_ns ? record_ns : tell_ns;
}

void iso__appliance_tell_door(struct iso_appliance *appliance)
{
    struct iso_door_news news;
    struct iso_fault fault;
    size_t missed = 0;
    int error = 0;
    flush_folded(appliance, false);
    while (iso_door_guard_next(appliance->door, &news, &missed)) {
        if (missed > 0) {
            iso__appliance_say(appliance, LOG_WARNING, "%zu changes of the door were not told",
                               missed);
        }
        if (iso_door_events_take(&appliance->told, &news, now_ns(appliance))) {
            tell_change(appliance, &news);
        }
    }
    if (iso_audit_writer_take_result(appliance->log, &error, &fault)) {
        const int said = appliance->log_error; /* each fault once, until the log is written again */
        iso__appliance_note_storage(appliance, error, &fault);
        (void)iso__appliance_say_fault(appliance, error == said ? 0 : error, &fault);
        appliance->log_error = error;
    }
}

int iso__appliance_new_door(struct iso_appliance *appliance)
{
    const struct iso_appliance_parts *parts = &appliance->parts;
    const struct iso_config_door *config = &parts->config->door;
    const struct iso_door_guard_options options = {
        .door =
            {
                .fail = config->fail,
                .unlock_ns = config->unlock_ms * ISO_NS_PER_MS,
                .held_ns = config->held_ms * ISO_NS_PER_MS,
                .refused_ns = config->refused_ms * ISO_NS_PER_MS,
                .pulse_ns = config->relay_pulse_ms * ISO_NS_PER_MS,
            },
        .timing =
            {
                .poll_ns = config->poll_ms * ISO_NS_PER_MS,
                .retry_ns = config->retry_ms * ISO_NS_PER_MS,
                .retry_max_ns = config->retry_max_ms * ISO_NS_PER_MS,
            },
        .clock = parts->times.boottime.now_ns ? parts->times.boottime : parts->times.monotonic,
        .io = parts->door_io,
        .threaded = parts->threads,
        .record = record_change,
        .context = appliance,
    };
    return iso_door_guard_new(&options, &appliance->door);
}

void iso__appliance_refuse_at_door(struct iso_appliance *appliance)
{
    iso_door_guard_refuse(appliance->door);
    iso__appliance_tell_door(appliance);
}

int iso__appliance_grant_at_door(struct iso_appliance *appliance, int64_t since_ns,
                                 enum iso_door_answer *answer)
{
    const int64_t stale_ns = appliance->parts.config->sensor.stale_ms * ISO_NS_PER_MS;
    const int64_t until_ns = since_ns + appliance->suspension.asleep_ns + stale_ns;
    const int error = iso_door_guard_grant(appliance->door, until_ns, answer);
    iso__appliance_tell_door(appliance);
    return error;
}

/* Starts the door as the configuration says, and records and reports its changes, and those of an
 * access panel. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <syslog.h>

#include "drivers/process/thread.h"
#include "drivers/terminal/words.h"
#include "firmware/appliance/appliance_calls.h"
#include "firmware/config/door_options.h"

static bool is_alarm(const struct iso_door_news *news)
{
    return news->state == ISO_DOOR_FORCED || news->state == ISO_DOOR_HELD_OPEN ||
           news->state == ISO_DOOR_FAULT || news->tamper;
}

/* Posts a record of an event that happened age_ns ago. */
static void post(struct iso_appliance *appliance, const char *reason, const char *note,
                 int64_t age_ns)
{
    struct iso_audit_record record = iso_audit_record_of("door");
    record.reason = reason;
    record.note = note;
    record.wall_ns = iso_times_wall_ns(&appliance->borrowed.times) - age_ns;
    record.monotonic_ns = iso__appliance_now_ns(appliance) - age_ns;
    (void)!iso_audit_writer_post(appliance->log, &record, NULL);
}

/* Records changes that were only counted; the mutex is held. */
static void record_folded(struct iso_appliance *appliance, bool ending)
{
    struct iso_door_burst burst;
    while (iso_door_events_next(&appliance->door_news.recorded, ending,
                                iso__appliance_now_ns(appliance), &burst)) {
        post(appliance, "chatter", burst.text, 0);
    }
}

/* Records a change of the door. It does not wait for room in the queue of the log, because the
 * thread of the door calls it, too: the writer counts records that found no room, and reports
 * them. The record has the time of the change, which may be long ago if the log was not open yet.
 */
static void record_change(void *context, const struct iso_door_news *news)
{
    struct iso_appliance *appliance = context;
    const int64_t age_ns = iso_times_boot_ns(&appliance->borrowed.times) - news->t_ns;
    (void)pthread_mutex_lock(&appliance->door_news.mutex);
    record_folded(appliance, false);
    if (iso_door_events_take(&appliance->door_news.recorded, news,
                             iso__appliance_now_ns(appliance) - age_ns)) {
        post(appliance, iso_door_event_name(news->cause), iso_door_state_name(news->state), age_ns);
    }
    (void)pthread_mutex_unlock(&appliance->door_news.mutex);
}

static void tell_change(struct iso_appliance *appliance, const struct iso_door_news *news)
{
    const struct iso_appliance_events *events = &appliance->borrowed.events;
    const char *state = iso_door_state_name(news->state);
    const char *cause = iso_door_event_name(news->cause);
    char tag[ISO_FAULT_TAG_SIZE];
    iso__appliance_say(appliance, is_alarm(news) ? LOG_WARNING : LOG_INFO, "door %s (%s)%s%s%s",
                       state, cause, news->fault.text[0] ? ": " : "", news->fault.text,
                       iso_fault_tag(news->fault.code, tag));
    events->door_changed(events->context, state, cause);
}

/* Reports changes that were only counted. Clients need the present state of the door. */
static void tell_folded(struct iso_appliance *appliance, bool ending)
{
    const struct iso_appliance_events *events = &appliance->borrowed.events;
    struct iso_door_burst burst;
    while (iso_door_events_next(&appliance->door_news.reported, ending,
                                iso__appliance_now_ns(appliance), &burst)) {
        iso__appliance_say(appliance, LOG_WARNING, "door: %s", burst.text);
        events->door_changed(events->context, iso_door_state_name(burst.state),
                             iso_door_event_name(burst.cause));
    }
}

static void flush_folded(struct iso_appliance *appliance, bool ending)
{
    (void)pthread_mutex_lock(&appliance->door_news.mutex);
    record_folded(appliance, ending);
    (void)pthread_mutex_unlock(&appliance->door_news.mutex);
    tell_folded(appliance, ending);
}

void iso__appliance_flush_door(struct iso_appliance *appliance)
{
    flush_folded(appliance, true);
}

int64_t iso__appliance_door_events_due_ns(struct iso_appliance *appliance)
{
    (void)pthread_mutex_lock(&appliance->door_news.mutex);
    const int64_t record_ns = iso_door_events_due_ns(&appliance->door_news.recorded);
    (void)pthread_mutex_unlock(&appliance->door_news.mutex);
    const int64_t tell_ns = iso_door_events_due_ns(&appliance->door_news.reported);
    return record_ns < tell_ns ? record_ns : tell_ns;
}

static void tell_panel_of_door(const struct iso_appliance *appliance,
                               const struct iso_door_news *news)
{
    const bool open = news->state == ISO_DOOR_OPENED || news->state == ISO_DOOR_HELD_OPEN ||
                      news->state == ISO_DOOR_FORCED;
    if (appliance->borrowed.panel) {
        iso_panel_set_door(appliance->borrowed.panel, open, news->tamper);
    }
}

void iso__appliance_tell_door(struct iso_appliance *appliance)
{
    struct iso_door_news news;
    size_t missed = 0;
    flush_folded(appliance, false);
    while (iso_door_guard_next(appliance->door, &news, &missed)) {
        if (missed > 0) {
            iso__appliance_say(appliance, LOG_WARNING, "%zu changes of the door were not reported",
                               missed);
        }
        tell_panel_of_door(appliance, &news);
        if (iso_door_events_take(&appliance->door_news.reported, &news,
                                 iso__appliance_now_ns(appliance))) {
            tell_change(appliance, &news);
        }
    }
    iso__appliance_tell_log(appliance);
}

int iso__appliance_new_door(struct iso_appliance *appliance)
{
    const struct iso_appliance_borrowed *borrowed = &appliance->borrowed;
    const struct iso_door_guard_options options = iso_door_options_of(
        &borrowed->config->door, &borrowed->times, borrowed->door_io, borrowed->threads);
    iso_thread_mutex_init(&appliance->door_news.mutex);
    appliance->door = borrowed->door;
    return borrowed->door ? 0 : iso_door_guard_new(&options, &appliance->door);
}

void iso__appliance_free_door(struct iso_appliance *appliance)
{
    if (appliance->borrowed.door) {
        iso_door_guard_detach(appliance->door);
    } else {
        iso_door_guard_free(appliance->door);
    }
    (void)pthread_mutex_destroy(&appliance->door_news.mutex);
}

/* Records how many changes before the log was open could not be kept. */
static void record_missing(struct iso_appliance *appliance, size_t n)
{
    char note[64];
    struct iso_audit_record record = iso_audit_record_of("records-lost");
    (void)snprintf(note, sizeof note, "%zu %s", n, iso_plural(n, "record", "records"));
    record.note = note;
    if (n > 0) {
        (void)iso__appliance_note(appliance, &record);
    }
}

int iso__appliance_start_door(struct iso_appliance *appliance, struct iso_fault *fault)
{
    const int error = appliance->borrowed.door ? 0 : iso_door_guard_start(appliance->door);
    if (error) {
        return iso_fault_set(fault, error, "the door has no thread: %s", strerror(-error));
    }
    if (iso_door_guard_look(appliance->door).ordinary) {
        const struct iso_fault ordinary = {
            .text = "the thread of the door has no real-time priority: on a busy machine the door "
                    "may be late; see REAL TIME in isothermd(8)",
            .code = ISO_FAULT_NOT_REALTIME,
        };
        iso__appliance_warn(appliance, &ordinary);
    }
    return 0;
}

void iso__appliance_record_door(struct iso_appliance *appliance)
{
    const size_t missing = iso_door_guard_attach(appliance->door, record_change, appliance);
    record_missing(appliance, missing);
}

void iso__appliance_refuse_at_door(struct iso_appliance *appliance)
{
    iso_door_guard_refuse(appliance->door);
    iso__appliance_tell_door(appliance);
}

int iso__appliance_grant_at_door(struct iso_appliance *appliance, int64_t since_ns,
                                 enum iso_door_answer *answer)
{
    const int64_t stale_ns = appliance->borrowed.config->sensor.stale_ms * ISO_NS_PER_MS;
    const int64_t until_ns = since_ns + appliance->suspension.asleep_ns + stale_ns;
    const int error = iso_door_guard_grant(appliance->door, until_ns, answer);
    iso__appliance_tell_door(appliance);
    return error;
}

/* ---- the access panel ---- */

static void record_panel(struct iso_appliance *appliance, const struct iso_panel_news *news)
{
    struct iso_audit_record record = iso_audit_record_of("panel");
    record.reason = news->event;
    record.note = news->note[0] ? news->note : NULL;
    (void)iso__appliance_note(appliance, &record);
    iso__appliance_say(appliance, news->alarm ? LOG_WARNING : LOG_INFO, "panel %s%s%s", news->event,
                       news->note[0] ? ": " : "", news->note);
}

void iso__appliance_start_panel(struct iso_appliance *appliance)
{
    struct iso_panel *panel = appliance->borrowed.panel;
    if (panel && iso_panel_fault(panel)->text[0]) {
        iso__appliance_warn(appliance, iso_panel_fault(panel));
    }
}

/* How often a lamp of the panel is looked at, which may blink: its times are in units of 100 ms. */
static const int64_t lamp_ns = 100 * ISO_NS_PER_MS;

/* Shows the lamp and the buzzer of the panel at the door: red is the light of a refusal, green that
 * of a grant, amber both. */
static void show_panel(struct iso_appliance *appliance, int64_t now_ns)
{
    struct iso_panel_look look;
    struct iso_appliance_panel *panel = &appliance->panel;
    if (now_ns < panel->due_ns) {
        return;
    }
    iso_panel_look(appliance->borrowed.panel, &look);
    const bool amber = look.shown.lamp == ISO_OSDP_AMBER;
    const struct iso_door_lamps lamps = {
        .granted = amber || look.shown.lamp == ISO_OSDP_GREEN,
        .refused = amber || look.shown.lamp == ISO_OSDP_RED,
        .buzzer = look.shown.buzzer,
    };
    panel->due_ns = now_ns + lamp_ns;
    if (memcmp(&lamps, &panel->lamps, sizeof lamps) != 0) {
        panel->lamps = lamps;
        iso_door_guard_show(appliance->door, &lamps);
    }
}

void iso__appliance_tell_panel(struct iso_appliance *appliance, int64_t now_ns)
{
    if (appliance->borrowed.panel) {
        show_panel(appliance, now_ns);
    }
    struct iso_panel *panel = appliance->borrowed.panel;
    struct iso_panel_news news;
    if (!panel) {
        return;
    }
    iso_panel_set_reader(panel, strcmp(iso__appliance_sensor_state(appliance), "started") == 0);
    while (iso_panel_next(panel, now_ns, &news)) {
        record_panel(appliance, &news);
    }
}

int64_t iso__appliance_panel_due_ns(const struct iso_appliance *appliance)
{
    const struct iso_panel *panel = appliance->borrowed.panel;
    if (!panel) {
        return ISO_NEVER_NS;
    }
    const int64_t news_ns = iso_panel_due_ns(panel);
    return news_ns < appliance->panel.due_ns ? news_ns : appliance->panel.due_ns;
}

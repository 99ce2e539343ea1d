#include "enroll/web/daemon/feed.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "enroll/cli/client/state.h"
#include "enroll/web/daemon/history.h"
#include "enroll/web/daemon/json_text.h"
#include "enroll/web/daemon/outline.h"
#include "enroll/web/daemon/stream_set.h"
#include "enroll/web/http/now.h"
#include "firmware/contract/contract.h"

static const int64_t repeat_ns = 10000000000;

struct web_feed {
    struct web_daemon *daemon;
    struct web_daemon_listener listener;
    struct web_outline *outline;
    json_t *status;  /* NULL: the daemon does not answer */
    json_t *compare; /* what counts as a change of it */
    int64_t sent_ns; /* when the last event "status" was sent */
    struct web_stream_set events;
    struct web_history history;
};

/* ---- events ---- */

/* The chunk of an event. `data` is released. NULL: there is no memory. */
static struct web_chunk *chunk_of(const char *name, json_t *data)
{
    struct web_chunk *chunk = NULL;
    char *text = data ? json_dumps(data, JSON_COMPACT) : NULL;
    json_decref(data);
    if (text) {
        const size_t size = strlen("event: ") + strlen(name) + strlen("\ndata: ") + strlen(text) +
                            strlen("\n\n");
        chunk = web_chunk_new(size + 1); /* snprintf writes a NUL, too */
        if (chunk) {
            (void)snprintf((char *)chunk->bytes, size + 1, "event: %s\ndata: %s\n\n", name, text);
            chunk->size = size;
        }
        free(text);
    }
    return chunk;
}

void web_feed_send(struct web_feed *feed, const char *name, json_t *data, enum web_role least)
{
    struct web_chunk *chunk = feed->events.n > 0 ? chunk_of(name, data) : NULL;
    if (chunk) {
        web_stream_set_send(&feed->events, least, chunk);
        web_chunk_unref(chunk);
    } else if (feed->events.n == 0) {
        json_decref(data);
    }
}

void web_feed_send_one(struct web_stream *stream, const char *name, json_t *data)
{
    struct web_chunk *chunk = chunk_of(name, data);
    if (chunk) {
        web_stream_send(stream, chunk);
        web_chunk_unref(chunk);
    }
}

int web_feed_viewers(const struct web_feed *feed, uint64_t session)
{
    return web_stream_set_of(&feed->events, session);
}

static void on_viewer_gone(void *context, struct web_stream *stream)
{
    struct web_feed *feed = context;
    web_stream_set_remove(&feed->events, stream);
}

struct web_stream *web_feed_open_events(struct web_feed *feed, struct web_exchange *exchange)
{
    struct web_stream *stream = web_stream_set_open(&feed->events, exchange, "text/event-stream",
                                                    WEB_STREAM_EVENTS, on_viewer_gone, feed);
    if (stream) {
        web_feed_send_one(stream, "status", web_feed_state(feed));
    }
    return stream;
}

void web_feed_open_outline(struct web_feed *feed, struct web_exchange *exchange)
{
    web_outline_open(feed->outline, exchange);
}

/* ---- the state ---- */

const json_t *web_feed_status(const struct web_feed *feed)
{
    return feed->status;
}

json_t *web_feed_state(const struct web_feed *feed)
{
    char now[WEB_TIME_TEXT_SIZE];
    json_t *status = feed->status ? json_incref(feed->status) : json_object();
    return json_pack("{s:s, s:b, s:o}", "time", web_time_text(time(NULL), now), "daemon",
                     feed->status != NULL, "status", status);
}

void web_feed_write_history(const struct web_feed *feed, FILE *out)
{
    web_history_write(&feed->history, out);
}

/* The state without the values that change with the time or with each frame. Of a lock-out counts
 * only whether there is one. */
static json_t *what_counts(const json_t *status)
{
    static const char *const restless[] = {"uptime-ms", "frames", "attack-frames", "last-outcome"};
    json_t *copy = json_copy((json_t *)status);
    for (size_t i = 0; i < sizeof restless / sizeof *restless; i++) {
        (void)json_object_del(copy, restless[i]);
    }
    const bool locked_out = cli_state_number(status, "lockout-ms", 0) > 0;
    (void)json_object_set_new(copy, "lockout-ms", json_boolean(locked_out));
    return copy;
}

static void on_status(void *context, const json_t *status)
{
    struct web_feed *feed = context;
    json_t *compare = status ? what_counts(status) : NULL;
    const bool changed = !json_equal(compare, feed->compare) && (compare || feed->compare);
    const int64_t t_ns = web_now_ns();

    web_history_take(&feed->history, status, t_ns, time(NULL));
    json_decref(feed->status);
    feed->status = json_incref((json_t *)status);
    json_decref(feed->compare);
    feed->compare = compare;
    if (changed || t_ns - feed->sent_ns >= repeat_ns) {
        feed->sent_ns = t_ns;
        web_feed_send(feed, "status", web_feed_state(feed), WEB_ROLE_OBSERVER);
    }
}

/* ---- signals ---- */

static json_t *read_visit(sd_bus_message *signal)
{
    const char *verdict, *person, *reason, *door, *door_fault;
    char now[WEB_TIME_TEXT_SIZE];
    double score, threshold;
    uint32_t frames;
    int64_t latency_us;
    if (sd_bus_message_read(signal, "ssdduxsss", &verdict, &person, &score, &threshold, &frames,
                            &latency_us, &reason, &door, &door_fault) < 0) {
        return NULL;
    }
    return json_pack("{s:s, s:s, s:s, s:o, s:o, s:I, s:I, s:s, s:s, s:s}", "time",
                     web_time_text(time(NULL), now), "verdict", verdict, "person", person, "score",
                     isfinite(score) ? json_real(score) : json_null(), "threshold",
                     isfinite(threshold) ? json_real(threshold) : json_null(), "frames",
                     (json_int_t)frames, "latency_us", (json_int_t)latency_us, "reason", reason,
                     "door", door, "door_fault", door_fault);
}

static json_t *read_hint(sd_bus_message *signal)
{
    const char *word;
    return sd_bus_message_read(signal, "s", &word) < 0 ? NULL : json_pack("{s:s}", "word", word);
}

static json_t *read_door(sd_bus_message *signal)
{
    const char *state, *cause;
    return sd_bus_message_read(signal, "ss", &state, &cause) < 0
               ? NULL
               : json_pack("{s:s, s:s}", "state", state, "cause", cause);
}

static void on_signal(void *context, const char *member, sd_bus_message *signal)
{
    static const struct {
        const char *member, *event;
        json_t *(*read)(sd_bus_message *signal);
    } kinds[] = {
        {ISO_CONTRACT_VISIT, "visit", read_visit},
        {ISO_CONTRACT_HINT, "hint", read_hint},
        {ISO_CONTRACT_DOOR_CHANGED, "door", read_door},
    };
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        if (strcmp(member, kinds[i].member) == 0) {
            web_feed_send(context, kinds[i].event, kinds[i].read(signal), WEB_ROLE_OBSERVER);
        }
    }
}

/* ---- the whole ---- */

int web_feed_new(sd_event *event, struct web_daemon *daemon, struct web_feed **out)
{
    struct web_feed *feed = calloc(1, sizeof *feed);
    if (!feed) {
        return -ENOMEM;
    }
    const int error = web_outline_new(event, daemon, &feed->outline);
    if (error) {
        free(feed);
        return error;
    }
    feed->daemon = daemon;
    feed->listener = (struct web_daemon_listener){
        .on_status = on_status, .on_signal = on_signal, .context = feed};
    web_daemon_listen(daemon, &feed->listener);
    *out = feed;
    return 0;
}

void web_feed_free(struct web_feed *feed)
{
    if (feed) {
        web_daemon_unlisten(feed->daemon, &feed->listener);
        web_outline_free(feed->outline);
        json_decref(feed->status);
        json_decref(feed->compare);
        free(feed);
    }
}

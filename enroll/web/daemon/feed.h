/* What the daemon reports, for the pages: its state, events as server-sent events, the outline, and
 * the history of the last day.
 *
 * An event is a chunk "event: NAME\ndata: JSON\n\n". Each stream begins with "status", which
 * follows at each change, too, and every ten seconds. Values that change with the time or with each
 * frame do not count as a change. One thread. */
#ifndef WEB_DAEMON_FEED_H
#define WEB_DAEMON_FEED_H

#include <jansson.h>
#include <stdio.h>
#include <systemd/sd-event.h>

#include "enroll/web/account/role.h"
#include "enroll/web/daemon/daemon.h"
#include "enroll/web/http/exchange.h"

struct web_feed;

/* -ENOMEM. `daemon` has to live longer. */
int web_feed_new(sd_event *event, struct web_daemon *daemon, struct web_feed **out)
    __attribute__((warn_unused_result));

/* All its streams have to be closed before. NULL is accepted. */
void web_feed_free(struct web_feed *feed);

/* The keys of GetStatus as the daemon answered last; NULL if it does not answer. Valid until the
 * event loop goes on. */
const json_t *web_feed_status(const struct web_feed *feed);

/* The object Status of openapi.json. The caller releases it. NULL: there is no memory. */
json_t *web_feed_state(const struct web_feed *feed);

/* Writes the samples of the last day as a JSON array. */
void web_feed_write_history(const struct web_feed *feed, FILE *out);

/* Answers with a stream of events. Returns it, or NULL if there was no memory; then the exchange
 * has been answered, too. */
struct web_stream *web_feed_open_events(struct web_feed *feed, struct web_exchange *exchange);

/* Answers with the stream of the outline. */
void web_feed_open_outline(struct web_feed *feed, struct web_exchange *exchange);

/* Sends an event to all streams whose role is at least this one. `data` is taken over; without
 * memory, and for a NULL, nothing is sent. */
void web_feed_send(struct web_feed *feed, const char *name, json_t *data, enum web_role least);

/* Sends an event to one stream of web_feed_open_events. `data` is taken over. */
void web_feed_send_one(struct web_stream *stream, const char *name, json_t *data);

/* How many streams of events a session has. */
int web_feed_viewers(const struct web_feed *feed, uint64_t session);

#endif

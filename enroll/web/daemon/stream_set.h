/* The open streams of one kind, and whose they are. One thread. */
#ifndef WEB_DAEMON_STREAM_SET_H
#define WEB_DAEMON_STREAM_SET_H

#include "enroll/web/account/role.h"
#include "enroll/web/http/exchange.h"
#include "enroll/web/http/server.h"

/* An all-zero set is empty. Each stream has a connection, so there are never more of them. */
struct web_stream_set {
    int n;
    struct web_stream_of {
        struct web_stream *stream;
        enum web_role role;
        uint64_t session;
    } items[WEB_CONNECTIONS_MOST];
};

/* Answers an exchange with a stream, which is in the set until it is closed. `on_closed` gets
 * `context`, and has to call web_stream_set_remove. Returns the stream, or NULL if there is no
 * memory or no room; then the exchange has been answered. */
struct web_stream *web_stream_set_open(struct web_stream_set *set, struct web_exchange *exchange,
                                       const char *content_type, enum web_stream_kind kind,
                                       void (*on_closed)(void *context, struct web_stream *stream),
                                       void *context);

/* A stream that is not in the set is accepted. */
void web_stream_set_remove(struct web_stream_set *set, const struct web_stream *stream);

/* Sends a chunk to all streams whose role is at least this one. */
void web_stream_set_send(struct web_stream_set *set, enum web_role least, struct web_chunk *chunk);

/* Ends all streams and takes them out of the set. web_stream_end calls on_closed later. */
void web_stream_set_end(struct web_stream_set *set);

/* How many streams a session has. */
int web_stream_set_of(const struct web_stream_set *set, uint64_t session);

#endif

/* A response without an end: the server sends chunks to the client as they come. A client that
 * reads too slowly holds back nobody: each stream has a short queue of its own.
 *
 *   open -> closed   the client goes away, web_stream_end is called, or the queue of events is full
 *
 * One thread. */
#ifndef WEB_HTTP_STREAM_H
#define WEB_HTTP_STREAM_H

#include <stdint.h>

#include "enroll/web/http/chunk.h"

/* What happens to a chunk that does not fit. */
enum web_stream_kind {
    WEB_STREAM_EVENTS, /* up to WEB_STREAM_EVENTS_MOST wait; beyond that the stream is closed, so
                          that the client notices that it has missed something */
    WEB_STREAM_FRAMES, /* up to WEB_STREAM_FRAMES_MOST wait; beyond that the oldest one that has
                          not begun to be sent is dropped */
};
enum { WEB_STREAM_EVENTS_MOST = 64, WEB_STREAM_FRAMES_MOST = 2 };

struct web_stream;

/* Sends a chunk, of which the stream takes a reference of its own. */
void web_stream_send(struct web_stream *stream, struct web_chunk *chunk);

/* The number of chunks that were dropped so far. */
uint64_t web_stream_dropped(const struct web_stream *stream);

/* Closes the stream after what waits has been sent. `on_closed` is called later. */
void web_stream_end(struct web_stream *stream);

#endif

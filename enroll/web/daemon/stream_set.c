#include "enroll/web/daemon/stream_set.h"

struct web_stream *web_stream_set_open(struct web_stream_set *set, struct web_exchange *exchange,
                                       const char *content_type, enum web_stream_kind kind,
                                       void (*on_closed)(void *context, struct web_stream *stream),
                                       void *context)
{
    const enum web_role role = web_exchange_role(exchange);
    const uint64_t session = web_exchange_session(exchange);
    if (set->n == WEB_CONNECTIONS_MOST) {
        web_exchange_problem(exchange, 503, "busy", "there are too many streams");
        return NULL;
    }
    struct web_stream *stream = web_exchange_stream(exchange, content_type, kind, on_closed,
                                                    context);
    if (stream) {
        set->items[set->n++] = (struct web_stream_of){stream, role, session};
    }
    return stream;
}

void web_stream_set_remove(struct web_stream_set *set, const struct web_stream *stream)
{
    for (int i = 0; i < set->n; i++) {
        if (set->items[i].stream == stream) {
            set->items[i] = set->items[--set->n];
            return;
        }
    }
}

/* From the last to the first, because a stream may leave the set meanwhile. */
void web_stream_set_send(struct web_stream_set *set, enum web_role least, struct web_chunk *chunk)
{
    for (int i = set->n; i-- > 0;) {
        if (set->items[i].role >= least) {
            web_stream_send(set->items[i].stream, chunk);
        }
    }
}

void web_stream_set_end(struct web_stream_set *set)
{
    for (int i = 0; i < set->n; i++) {
        web_stream_end(set->items[i].stream);
    }
    set->n = 0; /* nothing is sent to them any more, even before they are closed */
}

int web_stream_set_of(const struct web_stream_set *set, uint64_t session)
{
    int n = 0;
    for (int i = 0; i < set->n; i++) {
        n += set->items[i].session == session;
    }
    return n;
}

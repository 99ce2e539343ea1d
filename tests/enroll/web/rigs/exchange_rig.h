/* Exchanges, streams and chunks that record what a handler does with them: a test double of
 * enroll/web/http, so that tests of handlers need no HTTP. */
#ifndef TEST_WEB_RIG_EXCHANGE_H
#define TEST_WEB_RIG_EXCHANGE_H

#include <stdbool.h>
#include <systemd/sd-event.h>

#include "enroll/web/http/exchange.h"

struct web_stream {
    enum web_stream_kind kind;
    bool slow;  /* nothing is read; else each chunk is read at once */
    bool ended; /* web_stream_end was called, or the queue of events was full */
    int n_received, n_waiting;
    uint64_t dropped;
    struct web_chunk *waiting[WEB_STREAM_EVENTS_MOST];
    struct web_chunk *last; /* the chunk that was received last */
    char text[1 << 16];     /* of events: all that was received, as far as it fits */
    size_t text_size;
    void (*on_closed)(void *context, struct web_stream *stream);
    void *context;
};

struct web_exchange {
    const char *part, *query[8]; /* names and values in turn, up to a NULL */
    json_t *body;
    const char *account;
    enum web_role role;
    uint64_t session;

    bool answered;
    unsigned status;
    char code[64], detail[512]; /* of a problem */
    json_t *json;               /* of any other answer with a body */
    struct web_stream *stream;
};

/* An exchange of an account "ada" with this role and session. `body` is JSON with ' in place of ",
 * or NULL. */
struct web_exchange rig_exchange(enum web_role role, uint64_t session, const char *body);

/* Frees the answer and the body. The stream has to be closed before. */
void rig_exchange_done(struct web_exchange *exchange);

/* The client of a stream goes away: calls on_closed and frees the stream. */
void rig_close(struct web_exchange *exchange);

/* Runs the event loop until *flag is set. Fails the test after 20 seconds. */
void rig_until(sd_event *event, const bool *flag);

/* Runs the event loop until `holds` returns true. `what` is for the message. */
void rig_wait(sd_event *event, bool (*holds)(void *context), void *context, const char *what);

/* Runs the event loop for a time. */
void rig_run(sd_event *event, unsigned ms);

/* Waits for the answer, and fails unless it has this status and, for a problem, this code. */
void rig_expect(sd_event *event, struct web_exchange *exchange, unsigned status, const char *code);

/* Waits until a stream of events has received this text. */
void rig_expect_text(sd_event *event, struct web_stream *stream, const char *text);

#endif

/* A web server with streams: /frames and /events for observers, /open for everybody, and /later,
 * whose exchange the test answers. */
#ifndef TESTS_ENROLL_WEB_RIGS_STREAM_RIG_H
#define TESTS_ENROLL_WEB_RIGS_STREAM_RIG_H

#include "tests/enroll/web/rigs/web_rig.h"

enum { STREAM_RIG_MOST = 16 };

extern struct web_rig stream_rig;
/* In the order in which they were opened; NULL once it has been closed. */
extern struct web_stream *stream_rig_streams[STREAM_RIG_MOST];
extern int stream_rig_opened, stream_rig_closed;
extern struct web_exchange *stream_rig_deferred; /* of /later */

/* cmocka set-up and tear-down. */
int stream_rig_setup(void **state);
int stream_rig_teardown(void **state);

/* Opens a connection and asks. */
void stream_rig_ask(struct https *client, const char *path, const char *headers, bool small_buffer);

/* The same, and reads the head of the answer. */
void stream_rig_begin(struct https *client, const char *path, const char *headers,
                      bool small_buffer);

/* Waits for the next request of /later. */
void stream_rig_wait_for_deferred(void);

/* Answers an exchange with a stream. */
void stream_rig_open(struct web_exchange *exchange, enum web_stream_kind kind);

/* Sends a chunk of which each byte is `value`. */
void stream_rig_send(struct web_stream *stream, uint8_t value, size_t size);

/* Waits until this many streams have been closed. */
void stream_rig_wait_until_closed(int n);

#endif

/* The clients that watch a stream, each with a socket of its own. Sending never waits: a record for
 * which a client has no room is dropped for this client, and its next record says how many it has
 * missed. */
#ifndef ISO_FIRMWARE_STREAM_STREAM_LIST_H
#define ISO_FIRMWARE_STREAM_STREAM_LIST_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#include "core/base/fault.h"
#include "firmware/contract/stream_record.h"

enum {
    ISO_STREAMS_MAX = 16,
    ISO_STREAMS_PER_USER = 4, /* so that no user takes the streams of all others */
};

struct iso_stream {
    int fd; /* the daemon's end */
    enum iso_stream_kind kind;
    uid_t user;
    uint16_t missed; /* records since the last one that was sent */
};

/* All zero: nobody watches. */
struct iso_stream_list {
    int n;
    struct iso_stream streams[ISO_STREAMS_MAX];
};

/* Makes a stream for a user. Returns the client's end, non-blocking, which the caller closes when
 * it has been sent; or a negative errno, with a fault: -EBUSY too many streams, of this user or in
 * all; or an error of socketpair(2). Streams that their clients have closed do not count. */
int iso_stream_list_add(struct iso_stream_list *list, enum iso_stream_kind kind, uid_t user,
                        struct iso_fault *fault) __attribute__((warn_unused_result));

/* Whether somebody watches this kind of stream. */
bool iso_stream_list_has(const struct iso_stream_list *list, enum iso_stream_kind kind);

/* Sends a record to all who watch this kind. Changes its count of missed records. A stream that its
 * client has closed is removed. */
void iso_stream_list_send(struct iso_stream_list *list, enum iso_stream_kind kind, uint8_t *bytes,
                          size_t size);

/* Ends all streams of this kind: the clients read the end of file. */
void iso_stream_list_end(struct iso_stream_list *list, enum iso_stream_kind kind);

#endif

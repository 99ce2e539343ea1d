/* The relief of the person who is being enrolled: the stream of the daemon, compressed, for the
 * session that began the enrolment. It shows the shape of a face, so nothing of it stays in memory:
 * all buffers are wiped, after each frame and at the end. */
#ifndef WEB_DAEMON_RELIEF_H
#define WEB_DAEMON_RELIEF_H

#include <stddef.h>
#include <stdint.h>
#include <systemd/sd-event.h>

#include "enroll/web/http/chunk.h"

struct web_relief;

/* Takes over the stream `fd` of the daemon, also after an error, and passes each record on.
 * on_chunk borrows the chunk. -ENOMEM, or an errno of sd-event. */
int web_relief_new(sd_event *event, int fd,
                   void (*on_chunk)(void *context, struct web_chunk *chunk), void *context,
                   struct web_relief **out) __attribute__((warn_unused_result));

/* Wipes and frees it. NULL is accepted. */
void web_relief_free(struct web_relief *relief);

/* The chunk of one record of the daemon, as openapi.json describes it: the length (uint32, little
 * endian), the first 20 bytes of the record, and zlib data. NULL: the record is not valid, or there
 * is no memory. */
struct web_chunk *web_relief_chunk(struct web_relief *relief, const uint8_t *bytes, size_t size);

#endif

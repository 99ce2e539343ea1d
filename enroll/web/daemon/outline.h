/* The outline of the person before the sensor: one stream of the daemon while somebody watches,
 * each record of which goes to everybody who watches. */
#ifndef WEB_DAEMON_OUTLINE_H
#define WEB_DAEMON_OUTLINE_H

#include <systemd/sd-event.h>

#include "enroll/web/daemon/daemon.h"
#include "enroll/web/daemon/stream_set.h"

struct web_outline;

/* -ENOMEM. `daemon` has to live longer. */
int web_outline_new(sd_event *event, struct web_daemon *daemon, struct web_outline **out)
    __attribute__((warn_unused_result));

/* All its streams have to be closed before. NULL is accepted. */
void web_outline_free(struct web_outline *outline);

/* Answers with a stream of records: the length (uint32, little endian), then the bytes of the
 * daemon, as firmware/contract/stream_record.h describes them. */
void web_outline_open(struct web_outline *outline, struct web_exchange *exchange);

/* The chunk of a record: its length and the record. NULL: there is no memory. */
struct web_chunk *web_record_chunk(const uint8_t *bytes, size_t size);

#endif

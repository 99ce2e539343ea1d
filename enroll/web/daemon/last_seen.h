/* When each person was let in last. The audit log is read once from its beginning, in the
 * background, and then followed; visits count at once. The daemon answers a client 20 times a
 * second at most, so the log takes at most half of that. One thread. */
#ifndef WEB_DAEMON_LAST_SEEN_H
#define WEB_DAEMON_LAST_SEEN_H

#include <stdbool.h>
#include <stdint.h>
#include <systemd/sd-event.h>

#include "enroll/web/daemon/daemon.h"

enum { WEB_LAST_SEEN_BLOCK = 1000 }; /* records of a call */

struct web_last_seen;

/* -ENOMEM, or an errno of sd-event. `daemon` has to live longer. */
int web_last_seen_new(sd_event *event, struct web_daemon *daemon, struct web_last_seen **out)
    __attribute__((warn_unused_result));

/* NULL is accepted. */
void web_last_seen_free(struct web_last_seen *seen);

/* Whether the log has been read to its end. */
bool web_last_seen_is_read(const struct web_last_seen *seen);

/* When the person of this name was let in last, in seconds since 1970; 0: never, or not known. */
int64_t web_last_seen_of(const struct web_last_seen *seen, const char *name);

/* The person has got another name just now. The log says so, too, a moment later. */
void web_last_seen_rename(struct web_last_seen *seen, const char *before, const char *after);

#endif

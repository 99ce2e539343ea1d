/* What the web server knows of updates of the image: the slots and the work of RAUC, as
 * `isotherm update` shows them, the bundle that comes (upload.h), and what became of the last one.
 * RAUC is asked when somebody looks; on a machine without the folder of an image it is never asked.
 * The web server asks RAUC for its state, its slots and the next one, and for nothing else
 * (board/image/etc/de.pengutronix.rauc.conf). One thread. */
#ifndef WEB_UPDATE_UPDATE_H
#define WEB_UPDATE_UPDATE_H

#include <jansson.h>
#include <systemd/sd-event.h>

#include "enroll/web/update/upload.h"

struct web_update;

struct web_update_setup {
    sd_event *event;
    const char *bus;        /* "system", "session" or an address */
    const char *folder;     /* DIR of upload.h */
    const char *os_release; /* os-release(5) of the machine */
};

/* All that `setup` points to has to live longer. -ENOMEM, or an errno of sd-event. */
int web_update_new(const struct web_update_setup *setup, struct web_update **out)
    __attribute__((warn_unused_result));

/* Answers all who wait, and ends the connection to the bus; called before the server is freed,
 * because exchanges wait. */
void web_update_close(struct web_update *update);

/* The same, and frees it. NULL is accepted. */
void web_update_free(struct web_update *update);

/* The bundle that comes. It belongs to `update`. */
struct web_upload *web_update_upload(struct web_update *update);

/* Finds the state out, and calls on_seen once, not before it has returned unless there is no
 * memory: with the schema Update of openapi.json, which on_seen takes over, or NULL (no memory). */
void web_update_look(struct web_update *update, void (*on_seen)(void *context, json_t *state),
                     void *context);

#endif

/* The screen's connection to the daemon: it keeps a screen_state up to date. It never gives up: a
 * bus or a daemon that is gone is tried again every second. */
#ifndef ENROLL_SCREEN_CLIENT_CLIENT_H
#define ENROLL_SCREEN_CLIENT_CLIENT_H

#include <systemd/sd-event.h>

#include "enroll/screen/scene/screen_state.h"

struct screen_client;

/* Makes a client on an event loop, and tries to connect at once. `address` is "system", "session"
 * or a D-Bus address. With show_names the state has the names of people who are let in. -ENOMEM or
 * an errno of sd-event. */
int screen_client_new(sd_event *event, const char *address, bool show_names,
                      struct screen_client **out) __attribute__((warn_unused_result));

/* Closes the connection and frees it. NULL is accepted. */
void screen_client_free(struct screen_client *client);

/* What is known now; valid until the client is freed. */
const struct screen_state *screen_client_state(const struct screen_client *client);

#endif

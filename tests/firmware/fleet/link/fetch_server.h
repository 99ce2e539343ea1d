/* A small HTTP or HTTPS server of a test in the event loop of the test. One request at a time can
 * be held back. */
#ifndef TESTS_FLEET_LINK_FETCH_SERVER_H
#define TESTS_FLEET_LINK_FETCH_SERVER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <systemd/sd-event.h>

struct MHD_Daemon;
struct MHD_Connection;

struct fetch_answer {
    unsigned status;
    void *bytes; /* malloc */
    size_t size;
};

struct fetch_server {
    sd_event *event;
    sd_event_source *io, *timer;
    struct MHD_Daemon *mhd;
    uint16_t port;
    char url[64];
    void *context;
    /* Makes the answer when the whole request is there. */
    void (*answer)(void *context, const char *path, const void *body, size_t size,
                   struct fetch_answer *out);
    bool holds; /* the next answer waits for fetch_server_release() */
    struct MHD_Connection *held;
    unsigned requests;
};

/* `key` and `chain` are PEM texts; NULL: plain HTTP. The other members of *server are zero, or
 * answer and context. */
void fetch_server_start(struct fetch_server *server, sd_event *event, const char *key,
                        const char *chain);
void fetch_server_release(struct fetch_server *server);
void fetch_server_stop(struct fetch_server *server);

#endif

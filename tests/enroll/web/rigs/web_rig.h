/* A web server on the loop-back interface, with pages and a certificate in a temporary folder. */
#ifndef TESTS_ENROLL_WEB_RIGS_WEB_RIG_H
#define TESTS_ENROLL_WEB_RIGS_WEB_RIG_H

#include "enroll/web/http/server.h"
#include "tests/enroll/web/rigs/https.h"

struct web_rig {
    sd_event *event;
    struct web_certificate certificate;
    struct web_sessions sessions;
    struct web_server *server;
    int port;
};

/* The clock of the deadlines of servers that are started from now on; NULL: the monotonic one. */
extern int64_t (*web_rig_clock)(void);

/* The plain routes of servers that are started from now on; NULL: none. */
extern const struct web_plain_route *web_rig_plain;

/* The same for the intakes. */
extern const struct web_intake *web_rig_intakes;

/* Starts the server with these routes. `folder` is that of scratch_setup; the pages are in its
 * subfolder "pages". */
void web_rig_start(struct web_rig *rig, const char *folder, const struct web_route *routes,
                   void *context);

/* Frees the server (which may have been freed already: NULL) and the rest. */
void web_rig_stop(struct web_rig *rig);

/* Begins a session and returns the header lines of a request of the own pages with its cookie, in
 * a static buffer. */
const char *web_rig_login(struct web_rig *rig, const char *name, enum web_role role, uint64_t *id);

/* A socket that listens on 127.0.0.1, and its port. */
int web_rig_listen(int *port);

/* Opens a connection, which must succeed. */
void web_rig_connect(struct web_rig *rig, struct https *client);

/* Asks, and compares the status and the code of the problem (NULL: it is none). */
void web_rig_expect(struct https *client, const char *method, const char *path, const char *headers,
                    const char *body, int status, const char *code);

/* Checks that an answer has the headers that every answer has. */
void web_rig_check_headers(const struct https_answer *answer);

/* The resident memory of this process, kB. */
long web_rig_resident_kb(void);

#define WEB_RIG_ORIGIN "Origin: https://door.test\r\n"
#define WEB_RIG_JSON   "Content-Type: application/json\r\n"

#endif

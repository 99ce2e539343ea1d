/* The handlers on a private bus with the stand-in of the daemon, all on one event loop. */
#ifndef TEST_WEB_RIG_API_H
#define TEST_WEB_RIG_API_H

#include "enroll/web/api/api.h"
#include "enroll/web/daemon/enrolment.h"
#include "enroll/web/daemon/feed.h"
#include "enroll/web/daemon/last_seen.h"
#include "tests/enroll/web/rigs/exchange_rig.h"
#include "tests/enroll/web/rigs/service_rig.h"
#include "tests/support/programs/private_bus.h"

enum { RIG_LEFT_MS = 700 }; /* how long an enrolment goes on that nobody watches */

struct rig {
    struct private_bus bus;
    sd_event *event;
    struct rig_service service;
    struct web_sessions sessions;
    struct web_certificate certificate;
    struct web_api api;
};

/* The id of the session of an administrator that every test has. */
enum { RIG_SESSION = 1 };

/* Makes the parts on a bus, and waits until the daemon answers. */
void rig_begin(struct rig *rig, const char *address);
void rig_end(struct rig *rig);

/* cmocka set-up and tear-down of one test: *state becomes a struct rig with the stand-in; NULL if
 * there is no bus on this machine. */
int rig_setup(void **state);
int rig_teardown(void **state);

/* Begins a session of an administrator; returns its id. */
uint64_t rig_session(struct rig *rig);

/* Waits until the daemon is there, or not. */
void rig_wait_daemon(struct rig *rig, bool there);

#endif

/* Asks the daemon whether the face before the camera is that of a user. It waits for nothing
 * without a limit: neither for the bus, nor for the daemon, nor for the camera. */
#ifndef LOGIN_VERIFY_H
#define LOGIN_VERIFY_H

#include <sys/types.h>

#include "core/base/fault.h"

/* All-zero lets nobody in. */
enum login_verdict {
    LOGIN_UNAVAILABLE = 0, /* there is no verdict: nobody came, or something does not work */
    LOGIN_REFUSED,         /* the face is that of somebody else, or a picture, screen or mask */
    LOGIN_MATCH,           /* the face is that of the user */
};

/* The limits in milliseconds: until the bus says who the daemon is; for each answer of the daemon;
 * how long to wait while another client has the camera. */
enum { LOGIN_CONNECT_MS = 3000, LOGIN_ANSWER_MS = 5000, LOGIN_TURN_MS = 5000 };

struct login_request {
    const char *bus;    /* a D-Bus address */
    const char *person; /* for a caller that is root: who it must be. NULL: the person of `user` */
    uid_t user;         /* without `person`: the user of this process */
    int timeout_s;      /* how long to look */
    void (*began)(void *context);                  /* REQUIRED: the camera looks from now on */
    void (*hint)(void *context, const char *word); /* REQUIRED: a word of isotherm/capture.h */
    void *context;
};

/* Looks once. Only a verdict of the client that owned the daemon's name when the call began counts;
 * when that client leaves the bus there is none. *fault says why the verdict is not LOGIN_MATCH. */
enum login_verdict login_verify(const struct login_request *request, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif

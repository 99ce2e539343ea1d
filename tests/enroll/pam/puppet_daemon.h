/* A stand-in for the daemon in a process of its own, which behaves as a test says. */
#ifndef TEST_PUPPET_DAEMON_H
#define TEST_PUPPET_DAEMON_H

#include <sys/types.h>

enum puppet_act {
    PUPPET_MATCHES,      /* "verify-match" */
    PUPPET_REFUSES,      /* an error: the camera has a fault */
    PUPPET_SAYS_NOTHING, /* never answers a call */
    PUPPET_STAYS_BUSY,   /* AlreadyInUse to every call */
    PUPPET_BUSY_TWICE,   /* AlreadyInUse to two calls, then "verify-match" */
    PUPPET_LEAVES,       /* accepts the call, then leaves the bus */
    PUPPET_IS_FORGED, /* another client sends "verify-match"; the daemon then "verify-no-match" */
    PUPPET_IS_FORGED_ALONE, /* the same without a word of the daemon */
    PUPPET_IS_EARLY, /* sends "verify-match" before it accepts the call, then "verify-no-match" */
    PUPPET_GIVES_HINTS,      /* two hints, one of them twice, and "verify-timed-out" */
    PUPPET_SPEAKS_OTHERWISE, /* other words that must not be taken for a match, then "-attack" */
    PUPPET_IS_OTHER_USER,    /* VerifySelf answers that it verifies root, then "verify-match" */
};

/* Starts it on this bus, and waits until it has the name. Returns its process. */
pid_t puppet_daemon_start(const char *address, enum puppet_act act);

/* Ends it. */
void puppet_daemon_stop(pid_t pid);

#endif

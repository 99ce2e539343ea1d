/* A stand-in for systemd's manager on a private bus: it has the name, object and interface of
 * org.freedesktop.systemd1 as far as `isotherm setup` asks it, and does what a script says. It runs
 * in a process of its own. */
#ifndef TEST_FAKE_MANAGER_H
#define TEST_FAKE_MANAGER_H

#include <stdbool.h>
#include <sys/types.h>

struct fake_manager_script {
    bool enabled, active;    /* the unit, before */
    const char *result;      /* how a RestartUnit ends; NULL: "done"; "": never */
    const char *fail_method; /* this one is refused */
    const char *started;     /* a file whose text is noted with RestartUnit; NULL: none */
};

struct fake_manager {
    pid_t pid;
    int trace_fd;
};

/* Returns when it is on the bus. */
void fake_manager_start(struct fake_manager *manager, const char *address,
                        const struct fake_manager_script *script);

/* Waits until the manager is asked to start the unit. */
void fake_manager_wait_for_start(struct fake_manager *manager);

/* Ends it and returns the calls it got, "Subscribe;LoadUnit;...;RestartUnit<TEXT OF started>".
 * Valid until the next call. */
const char *fake_manager_stop(struct fake_manager *manager);

#endif

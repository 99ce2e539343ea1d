/* A stand-in for systemd's manager on a private bus. It has the name, object and interface of
 * org.freedesktop.systemd1, as far as `isotherm setup` uses them, and follows a script. It runs in
 * a process of its own. */
#ifndef TEST_FAKE_MANAGER_H
#define TEST_FAKE_MANAGER_H

#include <stdbool.h>
#include <sys/types.h>

struct fake_manager_script {
    bool enabled, active;    /* state of the unit before the first call */
    const char *result;      /* result of the first job; NULL: "done"; "": no result */
    const char *fail_method; /* the method that fails */
    const char *started;     /* the text of this file is noted with each job; NULL: no file */
};

struct fake_manager {
    pid_t pid;
    int trace_fd;
};

/* Returns when the manager is on the bus. */
void fake_manager_start(struct fake_manager *manager, const char *address,
                        const struct fake_manager_script *script);

/* Waits until a client calls RestartUnit. */
void fake_manager_wait_for_start(struct fake_manager *manager);

/* Ends the manager and returns the calls that it received,
 * "Subscribe;LoadUnit;...;RestartUnit;<TEXT OF started>;". The text is valid until the next
 * fake_manager_start. */
const char *fake_manager_stop(struct fake_manager *manager);

#endif

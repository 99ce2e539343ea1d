/* A message bus of the test's own: a dbus-daemon with a configuration that lets everybody do
 * everything, in a directory that is removed again. */
#ifndef TEST_PRIVATE_BUS_H
#define TEST_PRIVATE_BUS_H

#include <stdbool.h>
#include <sys/types.h>

struct private_bus {
    pid_t pid;
    char directory[64];
    char address[256];
};

/* What main() returns to ctest if the test cannot be run here. */
enum { TEST_SKIPPED = 77 };

/* False, with a line that says so, if there is no dbus-daemon on this machine: the test is to be
 * skipped. Anything else that goes wrong fails the test. */
bool private_bus_start(struct private_bus *bus);

/* Ends the daemon and leaves its directory; begins another daemon there, at the same address. */
void private_bus_kill(struct private_bus *bus);
bool private_bus_revive(struct private_bus *bus);

/* Has the next daemon there read another file of configuration, too. */
void private_bus_include(const struct private_bus *bus, const char *file);

void private_bus_stop(struct private_bus *bus);

#endif

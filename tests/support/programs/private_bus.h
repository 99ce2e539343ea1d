/* A private message bus for one test: a dbus-daemon whose configuration permits every call, in a
 * directory that is removed at the end. */
#ifndef TEST_PRIVATE_BUS_H
#define TEST_PRIVATE_BUS_H

#include <stdbool.h>
#include <sys/types.h>

struct private_bus {
    pid_t pid;
    char directory[64];
    char address[256];
};

/* main() returns this to ctest if the test cannot run on this machine. */
enum { TEST_SKIPPED = 77 };

/* Starts the bus. If there is no dbus-daemon on this machine, prints a line and returns false: the
 * caller then skips the test. Any other failure fails the test. */
bool private_bus_start(struct private_bus *bus);

/* The first ends the daemon and keeps its directory. The second starts another daemon there, at the
 * same address, and returns false as private_bus_start does. */
void private_bus_kill(struct private_bus *bus);
bool private_bus_revive(struct private_bus *bus);

/* Makes the next daemon in this directory read another configuration file, too. */
void private_bus_include(const struct private_bus *bus, const char *file);

/* Ends the daemon and removes the directory. */
void private_bus_stop(struct private_bus *bus);

#endif

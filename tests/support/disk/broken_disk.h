/* A disk that cannot be written: calls that write files, of the test program or of SQLite, fail as
 * on such a disk. The linker replaces the calls of all statically linked code by these
 * (isotherm_broken_disk() in CMake), and SQLite is configured to call them. */
#ifndef TESTS_SUPPORT_DISK_BROKEN_DISK_H
#define TESTS_SUPPORT_DISK_BROKEN_DISK_H

#include <stdbool.h>

struct broken_disk {
    int error;   /* of calls that write or open for writing: ENOSPC, EROFS; 0: the disk works */
    bool locked; /* another process has locked every file */
};

extern struct broken_disk broken_disk;

/* Makes SQLite use this disk. Call it once, before a database is opened. */
void broken_disk_install(void);

#endif

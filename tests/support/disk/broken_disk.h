/* A disk that cannot be written: files that a test program writes, by itself or through SQLite,
 * fail as they do on such a disk. The linker puts it before the calls of everything that is linked
 * statically (isotherm_broken_disk() in CMake), SQLite is asked to call it. */
#ifndef TESTS_SUPPORT_DISK_BROKEN_DISK_H
#define TESTS_SUPPORT_DISK_BROKEN_DISK_H

#include <stdbool.h>

struct broken_disk {
    int error;   /* what writing, and opening to write, fails with: ENOSPC, EROFS; 0: it works */
    bool locked; /* somebody else has every file locked */
};

extern struct broken_disk broken_disk;

/* Has SQLite notice; once, before a database is opened. */
void broken_disk_install(void);

#endif

/* A disk on which the Nth call that writes fails. In a test program that is linked with this file,
 * all calls that change files pass through here, those of its own code and of its libraries (SQLite
 * among them): write, pwrite, fsync, fdatasync, ftruncate, rename, renameat2, unlink, open with
 * O_CREAT, and the writes of streams that fdopen() makes. Those of fopen() do not pass through
 * here. Calls that read fail for FAILING_DISK_DEAD only. Pipes, sockets and memory files are not on
 * the disk.
 *
 * Synchronisation does nothing here: the files of these tests need not survive a power cut. */
#ifndef TESTS_SUPPORT_DISK_FAILING_DISK_H
#define TESTS_SUPPORT_DISK_FAILING_DISK_H

#include <stdbool.h>

enum failing_disk_kind {
    FAILING_DISK_ONCE,         /* one call fails with EIO, and does nothing */
    FAILING_DISK_FULL,         /* the same with ENOSPC */
    FAILING_DISK_SHORT,        /* one call: a write writes half, any other fails with EIO */
    FAILING_DISK_LIES,         /* one call does its work, but reports EIO */
    FAILING_DISK_BROKEN,       /* from one call on, all calls that write fail with EIO */
    FAILING_DISK_DEAD,         /* the same, and all calls that read or open fail, too */
    FAILING_DISK_KILLS,        /* the process is killed before one call */
    FAILING_DISK_KILLS_BEHIND, /* the process is killed after one call has done its work */
    FAILING_DISK_KINDS
};

extern const char *const failing_disk_names[FAILING_DISK_KINDS];

/* From now on calls are counted, and call n (from 1) is the first that fails. */
void failing_disk_arm(enum failing_disk_kind kind, long nth);

/* The number of write and pwrite calls, to files of any kind, that passed through here since the
 * disk was armed; and the number that the kernel counted, which is larger if some calls did not
 * pass through here. -1: the kernel does not say. */
long failing_disk_writes(void);
long failing_disk_kernel_writes(void);

/* Whether a journal of SQLite was deleted since the disk was armed, and its directory was not
 * synchronised afterwards: a power cut may restore the journal and with it the earlier state. */
bool failing_disk_journal_may_return(void);

/* Makes the disk work again. Returns the number of calls since it was armed. */
long failing_disk_heal(void);

#endif

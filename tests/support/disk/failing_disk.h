/* A disk of which the Nth call that writes fails. Every test program that is linked with this file
 * has its calls of the C library that change files, of its own code and of the libraries that it is
 * linked with (SQLite among them), pass through here: write, pwrite, fsync, fdatasync, ftruncate,
 * rename, renameat2, unlink, and open with O_CREAT; a stream that is made for writing, too. Calls
 * that read fail for FAILING_DISK_DEAD only. Pipes, sockets and memory files are not on the disk.
 *
 * Synchronisation always takes no time here: nothing of these tests has to outlast the machine. */
#ifndef TESTS_SUPPORT_DISK_FAILING_DISK_H
#define TESTS_SUPPORT_DISK_FAILING_DISK_H

#include <stdbool.h>

enum failing_disk_kind {
    FAILING_DISK_ONCE,         /* one call fails with EIO, and does nothing */
    FAILING_DISK_FULL,         /* the same with ENOSPC */
    FAILING_DISK_SHORT,        /* one write writes half; one other call fails with EIO */
    FAILING_DISK_LIES,         /* one call does its work, and reports EIO nevertheless */
    FAILING_DISK_BROKEN,       /* from one call on all that write fail with EIO */
    FAILING_DISK_DEAD,         /* the same, and those that read and open too */
    FAILING_DISK_KILLS,        /* the process is killed before one call, */
    FAILING_DISK_KILLS_BEHIND, /* or when that one has done its work */
    FAILING_DISK_KINDS
};

extern const char *const failing_disk_names[FAILING_DISK_KINDS];

/* From now on calls are counted, and the nth (from 1) is the first that fails. */
void failing_disk_arm(enum failing_disk_kind kind, long nth);

/* How many write and pwrite calls, to whatever, were made here since it was armed; and how many the
 * kernel counted, which are more if some did not come through here. -1: it does not say. */
long failing_disk_writes(void);
long failing_disk_kernel_writes(void);

/* Whether a journal of SQLite's was deleted since it was armed, and its directory not synchronised
 * after that: a power cut may bring it back, and with it the state from before the change. */
bool failing_disk_journal_may_return(void);

/* The disk works again. Returns how many calls there were since it was armed. */
long failing_disk_heal(void);

#endif

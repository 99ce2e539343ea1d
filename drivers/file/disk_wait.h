/* Whether the daemon's main thread waits for the disk: so that whoever watches over it can tell a
 * disk that is slow from a program that hangs.
 *
 * Whatever may wait for the disk says so by begin and end, in whichever thread it runs; only the
 * waits of the thread that has called iso_disk_wait_watch count. */
#ifndef ISO_DRIVERS_FILE_DISK_WAIT_H
#define ISO_DRIVERS_FILE_DISK_WAIT_H

#include <stdbool.h>

/* From now on the waits of the calling thread are those that iso_disk_wait_lasts tells of. One
 * thread of a process. */
void iso_disk_wait_watch(void);

/* Around a call that may wait for the disk, or for a thread that does; they may be nested. */
void iso_disk_wait_begin(void);
void iso_disk_wait_end(void);

/* Whether the watched thread is between begin and end; from any thread. */
bool iso_disk_wait_lasts(void);

/* fsync(2) and fdatasync(2) between begin and end. 0, or -1 with errno. */
int iso_disk_wait_fsync(int fd);
int iso_disk_wait_fdatasync(int fd);

#endif

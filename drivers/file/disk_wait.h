/* Reports whether the daemon's main thread waits for the disk. By this the watchdog distinguishes a
 * slow disk from a program that hangs.
 *
 * Code that may wait for the disk calls begin before and end after it, in any thread; only the
 * waits of the thread that has called iso_disk_wait_watch count. */
#ifndef ISO_DRIVERS_FILE_DISK_WAIT_H
#define ISO_DRIVERS_FILE_DISK_WAIT_H

#include <stdbool.h>

/* From now on iso_disk_wait_lasts reports the waits of the calling thread. One thread of a process
 * may call this. */
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

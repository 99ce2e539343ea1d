/* The thread that plays a file. For openni2_session.c.
 *
 * The runtime's player goes through the list of its streams without a lock: all the time at the end
 * of a file, and every 10 ms while the streams are stopped. Destroying a stream at that moment
 * crashes the process. The runtime offers no way to stop this thread first, because it ends only
 * with the device, and the device must outlive its streams. So the session destroys a stream just
 * after the kernel has reported that the thread fell asleep.
 *
 * This makes the crash rare and does not rule it out: if the session itself is kept from the
 * processor for 10 ms just then, the player may be awake again.
 */
#ifndef ISO_DRIVERS_SENSOR_OPENNI2_OPENNI2_PLAYER_H
#define ISO_DRIVERS_SENSOR_OPENNI2_OPENNI2_PLAYER_H

#include <sys/types.h>

enum { ISO__OPENNI2_THREADS = 256 };

/* Some threads of this process, by the kernel's numbers. All-zero: none. */
struct iso__openni2_threads {
    pid_t ids[ISO__OPENNI2_THREADS];
    int n;
};

/* Lists the threads of this process. The list is empty where /proc cannot be read, and ends early
 * after ISO__OPENNI2_THREADS. */
void iso__openni2_threads_list(struct iso__openni2_threads *threads);

/* Lists the threads that have come since `before` was listed. */
void iso__openni2_threads_new(const struct iso__openni2_threads *before,
                              struct iso__openni2_threads *threads);

/* Waits until all of the threads sleep at the same time, and each has just fallen asleep or has
 * slept for at least 30 ms; threads that have ended do not count. Gives up after some 0.5 s,
 * because a thread that came by chance with those of the player may be busy for ever. Waits for 3
 * ms if there is none. */
void iso__openni2_threads_await_sleep(const struct iso__openni2_threads *threads);

#endif

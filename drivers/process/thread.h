/* Starts threads. Our threads take no signals, because the main thread handles them, and have a
 * stack of a fixed size. Without a fixed size a thread gets the stack limit with which the program
 * starts: 8 MiB on one machine, of which little is used, and too little on another. */
#ifndef ISO_DRIVERS_PROCESS_THREAD_H
#define ISO_DRIVERS_PROCESS_THREAD_H

#include <pthread.h>
#include <stdbool.h>

/* For any work of the project: the deepest calls, from a frame to its best hits, take less than 136
 * KiB, and several times as much with sanitizers. */
enum { ISO_THREAD_STACK_BYTES = 1 << 20 };

/* Starts a thread that runs run(context). 0, or the negative errno of pthread_create: -EAGAIN or
 * -ENOMEM there is no memory for it, or there are too many threads. */
int iso_thread_start(pthread_t *thread, void *(*run)(void *context), void *context)
    __attribute__((warn_unused_result));

/* Does the same with the scheduling policy SCHED_FIFO and this priority (1 or more). If the process
 * may not use it (RLIMIT_RTPRIO), the thread gets the ordinary policy. *realtime says which policy
 * the thread has; realtime may be NULL. If the calling thread has this policy and priority itself,
 * the new thread inherits them. This also works where sched_setscheduler is forbidden. */
int iso_thread_start_realtime(pthread_t *thread, void *(*run)(void *context), void *context,
                              int priority, bool *realtime) __attribute__((warn_unused_result));

/* Gives the calling thread a name, at most 15 bytes, by which ps(1) and top(1) show it. */
void iso_thread_set_name(const char *name);

/* A mutex with priority inheritance: its holder has the priority of the thread that waits for it,
 * so that threads of medium priority cannot delay a thread of high priority. */
void iso_thread_mutex_init(pthread_mutex_t *mutex);

#endif

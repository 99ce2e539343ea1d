/* Threads that take no signals: those are the business of the thread that has always been there. */
#ifndef ISO_DRIVERS_THREAD_H
#define ISO_DRIVERS_THREAD_H

#include <pthread.h>
#include <stdbool.h>

/* Starts a thread that runs run(context). With `priority` above 0 the thread has that priority of
 * SCHED_FIFO where the process may have it (RLIMIT_RTPRIO), and the ordinary scheduling elsewhere;
 * *realtime (may be NULL) says which. -EAGAIN or -ENOMEM: no thread can be had. */
int iso_thread_start(void *(*run)(void *context), void *context, int priority, pthread_t *thread,
                     bool *realtime) __attribute__((warn_unused_result));

/* A mutex whose holder has the priority of whoever waits for it: a thread of low priority does not
 * keep one of high priority waiting because others keep the processors busy. */
void iso_thread_mutex_init(pthread_mutex_t *mutex);

#endif

#include "drivers/thread.h"

#include <errno.h>
#include <sched.h>
#include <signal.h>
#include <stddef.h>

static int start(void *(*run)(void *context), void *context, int priority, pthread_t *thread)
{
    const struct sched_param parameters = {.sched_priority = priority};
    pthread_attr_t attributes;
    int error = pthread_attr_init(&attributes);
    if (error) {
        return -error;
    }
    if (priority > 0) {
        (void)pthread_attr_setinheritsched(&attributes, PTHREAD_EXPLICIT_SCHED);
        (void)pthread_attr_setschedpolicy(&attributes, SCHED_FIFO);
        (void)pthread_attr_setschedparam(&attributes, &parameters);
    }
    error = pthread_create(thread, &attributes, run, context);
    (void)pthread_attr_destroy(&attributes);
    return -error;
}

int iso_thread_start(void *(*run)(void *context), void *context, int priority, pthread_t *thread,
                     bool *realtime)
{
    sigset_t all, before;
    (void)sigfillset(&all);
    (void)pthread_sigmask(SIG_SETMASK, &all, &before);
    int error = priority > 0 ? start(run, context, priority, thread) : -EPERM;
    const bool has_priority = error == 0;
    if (error == -EPERM) {
        error = start(run, context, 0, thread);
    }
    (void)pthread_sigmask(SIG_SETMASK, &before, NULL);
    if (!error && realtime) {
        *realtime = has_priority;
    }
    return error;
}

void iso_thread_mutex_init(pthread_mutex_t *mutex)
{
    pthread_mutexattr_t attributes;
    (void)pthread_mutexattr_init(&attributes);
    (void)pthread_mutexattr_setprotocol(&attributes, PTHREAD_PRIO_INHERIT);
    (void)pthread_mutex_init(mutex, &attributes);
    (void)pthread_mutexattr_destroy(&attributes);
}

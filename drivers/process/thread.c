#include "drivers/process/thread.h"

#include <errno.h>
#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>

/* priority 0: the priority of the caller */
static int start(pthread_t *thread, void *(*run)(void *context), void *context, int priority)
{
    const struct sched_param parameters = {.sched_priority = priority};
    pthread_attr_t attributes;
    sigset_t all, before;
    int error = pthread_attr_init(&attributes);
    if (error) {
        return -error;
    }
    if (priority > 0) {
        (void)pthread_attr_setinheritsched(&attributes, PTHREAD_EXPLICIT_SCHED);
        (void)pthread_attr_setschedpolicy(&attributes, SCHED_FIFO);
        (void)pthread_attr_setschedparam(&attributes, &parameters);
    }
    error = pthread_attr_setstacksize(&attributes, ISO_THREAD_STACK_BYTES);
    if (!error) {
        (void)sigfillset(&all);
        (void)pthread_sigmask(SIG_SETMASK, &all, &before); /* the new thread inherits the mask */
        error = pthread_create(thread, &attributes, run, context);
        (void)pthread_sigmask(SIG_SETMASK, &before, NULL);
    }
    (void)pthread_attr_destroy(&attributes);
    return -error;
}

int iso_thread_start(pthread_t *thread, void *(*run)(void *context), void *context)
{
    return start(thread, run, context, 0);
}

static bool has_priority_itself(int priority)
{
    struct sched_param own;
    return sched_getscheduler(0) == SCHED_FIFO && sched_getparam(0, &own) == 0 &&
           own.sched_priority == priority;
}

int iso_thread_start_realtime(pthread_t *thread, void *(*run)(void *context), void *context,
                              int priority, bool *realtime)
{
    const bool inherits = has_priority_itself(priority);
    int error = start(thread, run, context, inherits ? 0 : priority);
    const bool has_priority = error == 0;
    if (error == -EPERM) {
        error = start(thread, run, context, 0);
    }
    if (!error && realtime) {
        *realtime = has_priority;
    }
    return error;
}

void iso_thread_set_name(const char *name)
{
    (void)prctl(PR_SET_NAME, name);
}

void iso_thread_mutex_init(pthread_mutex_t *mutex)
{
    pthread_mutexattr_t attributes;
    (void)pthread_mutexattr_init(&attributes);
    (void)pthread_mutexattr_setprotocol(&attributes, PTHREAD_PRIO_INHERIT);
    (void)pthread_mutex_init(mutex, &attributes);
    (void)pthread_mutexattr_destroy(&attributes);
}

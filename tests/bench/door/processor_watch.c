#include "tests/bench/door/processor_watch.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <time.h>

enum { PERIOD_NS = 1000000, NOTED_NS = 200000, LATE_NS = 1000000, NOTES = 4096, PROCESSORS = 64 };

/* A waking that was late: when it was due, and when it came. */
struct note {
    int64_t due_ns, came_ns;
};

struct processor {
    struct bench_watch *watch;
    int number;
    pthread_t thread;
    pthread_mutex_t mutex; /* protects the fields below; held only for a short time */
    struct note notes[NOTES];
    size_t n;
    struct bench_watch_total total;
};

struct bench_watch {
    atomic_bool ending;
    int n;
    struct processor processors[PROCESSORS];
};

static int64_t now_ns(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * INT64_C(1000000000) + now.tv_nsec;
}

static void wait_until(int64_t t_ns)
{
    const struct timespec until = {t_ns / 1000000000, t_ns % 1000000000};
    (void)clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL);
}

static void note(struct processor *processor, int64_t due_ns, int64_t came_ns)
{
    const int64_t late_ns = came_ns - due_ns;
    struct bench_watch_total *total = &processor->total;
    (void)pthread_mutex_lock(&processor->mutex);
    total->wakings++;
    total->late += late_ns > LATE_NS;
    total->latest_ns = late_ns > total->latest_ns ? late_ns : total->latest_ns;
    if (late_ns > NOTED_NS) {
        processor->notes[processor->n++ % NOTES] = (struct note){due_ns, came_ns};
    }
    (void)pthread_mutex_unlock(&processor->mutex);
}

static void *run(void *context)
{
    struct processor *processor = context;
    int64_t due_ns = now_ns() + PERIOD_NS;
    while (!atomic_load(&processor->watch->ending)) {
        wait_until(due_ns);
        const int64_t came_ns = now_ns();
        note(processor, due_ns, came_ns);
        due_ns = came_ns + PERIOD_NS;
    }
    return NULL;
}

static int start(struct processor *processor)
{
    const struct sched_param highest = {.sched_priority = sched_get_priority_max(SCHED_FIFO)};
    pthread_attr_t attributes;
    pthread_mutexattr_t inherit;
    cpu_set_t own;
    CPU_ZERO(&own);
    CPU_SET((unsigned)processor->number, &own);
    (void)pthread_mutexattr_init(&inherit);
    (void)pthread_mutexattr_setprotocol(&inherit, PTHREAD_PRIO_INHERIT);
    (void)pthread_mutex_init(&processor->mutex, &inherit);
    (void)pthread_mutexattr_destroy(&inherit);
    (void)pthread_attr_init(&attributes);
    (void)pthread_attr_setinheritsched(&attributes, PTHREAD_EXPLICIT_SCHED);
    (void)pthread_attr_setschedpolicy(&attributes, SCHED_FIFO);
    (void)pthread_attr_setschedparam(&attributes, &highest);
    (void)pthread_attr_setaffinity_np(&attributes, sizeof own, &own);
    const int error = pthread_create(&processor->thread, &attributes, run, processor);
    (void)pthread_attr_destroy(&attributes);
    return error;
}

struct bench_watch *bench_watch_start(void)
{
    struct bench_watch *watch = calloc(1, sizeof *watch);
    cpu_set_t allowed;
    if (!watch || sched_getaffinity(0, sizeof allowed, &allowed)) {
        free(watch);
        return NULL;
    }
    for (int i = 0; i < PROCESSORS; i++) {
        struct processor *processor = &watch->processors[watch->n];
        if (!CPU_ISSET((unsigned)i, &allowed)) {
            continue;
        }
        processor->watch = watch;
        processor->number = i;
        if (start(processor)) {
            bench_watch_stop(watch);
            return NULL;
        }
        watch->n++;
    }
    return watch;
}

void bench_watch_stop(struct bench_watch *watch)
{
    if (!watch) {
        return;
    }
    atomic_store(&watch->ending, true);
    for (int i = 0; i < watch->n; i++) {
        (void)pthread_join(watch->processors[i].thread, NULL);
        (void)pthread_mutex_destroy(&watch->processors[i].mutex);
    }
    free(watch);
}

static int64_t overlap_ns(const struct note *note, int64_t from_ns, int64_t to_ns)
{
    const int64_t begin_ns = note->due_ns > from_ns ? note->due_ns : from_ns;
    const int64_t end_ns = note->came_ns < to_ns ? note->came_ns : to_ns;
    return end_ns - begin_ns;
}

int64_t bench_watch_late_ns(struct bench_watch *watch, int64_t from_ns, int64_t to_ns)
{
    int64_t latest_ns = 0;
    for (int i = 0; i < watch->n; i++) {
        struct processor *processor = &watch->processors[i];
        (void)pthread_mutex_lock(&processor->mutex);
        for (size_t k = 0; k < processor->n && k < NOTES; k++) {
            const int64_t late_ns = overlap_ns(&processor->notes[k], from_ns, to_ns);
            latest_ns = late_ns > latest_ns ? late_ns : latest_ns;
        }
        (void)pthread_mutex_unlock(&processor->mutex);
    }
    return latest_ns;
}

struct bench_watch_total bench_watch_total(struct bench_watch *watch)
{
    struct bench_watch_total all = {.wakings = 0};
    for (int i = 0; i < watch->n; i++) {
        struct processor *processor = &watch->processors[i];
        (void)pthread_mutex_lock(&processor->mutex);
        const struct bench_watch_total one = processor->total;
        (void)pthread_mutex_unlock(&processor->mutex);
        all.wakings += one.wakings;
        all.late += one.late;
        all.latest_ns = one.latest_ns > all.latest_ns ? one.latest_ns : all.latest_ns;
    }
    return all;
}

#include "sim/lab/match/parallel.h"

#include <errno.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>

#include "drivers/process/thread.h"
#include "sim/base/progress.h"

enum { THREADS_MAX = 64 };

struct work {
    sim_job *job;
    void *context;
    size_t n_jobs;
    atomic_size_t next;
    atomic_int error;
    bool shown; /* whether its progress is shown */
};

struct worker {
    struct work *work;
    pthread_t thread;
    int number;
};

static void *work_on(void *argument)
{
    const struct worker *worker = argument;
    struct work *work = worker->work;
    while (atomic_load(&work->error) == 0) {
        const size_t job = atomic_fetch_add(&work->next, 1);
        if (job >= work->n_jobs) {
            break;
        }
        const int error = work->job(work->context, worker->number, job);
        if (error) {
            atomic_store(&work->error, error);
        }
        if (work->shown) {
            sim_progress_step(1);
        }
    }
    return NULL;
}

int sim_parallel(int threads, const char *what, size_t n_jobs, sim_job *job, void *context)
{
    if (threads < 1 || threads > THREADS_MAX) {
        return -EINVAL;
    }
    struct work work = {.job = job, .context = context, .n_jobs = n_jobs};
    struct worker workers[THREADS_MAX];
    int started = 0;
    work.shown = sim_progress_begin(what, n_jobs);
    for (; started < threads; started++) {
        workers[started] = (struct worker){.work = &work, .number = started};
        if (iso_thread_start(&workers[started].thread, work_on, &workers[started])) {
            break;
        }
    }
    for (int i = 0; i < started; i++) {
        (void)pthread_join(workers[i].thread, NULL);
    }
    sim_progress_end(work.shown);
    return started > 0 ? atomic_load(&work.error) : -EAGAIN;
}

/* Runs numbered jobs on several threads. */
#ifndef SIM_LAB_MATCH_PARALLEL_H
#define SIM_LAB_MATCH_PARALLEL_H

#include <stddef.h>

/* Does one job; `worker` is the calling thread's number, from 0. 0 or a negative errno. */
typedef int sim_job(void *context, int worker, size_t job);

/* Runs jobs 0 .. n_jobs - 1, each once, on `threads` threads (1..64) and waits for all. `what`
 * is the description for sim/base/progress.h. After a job has failed no further job is started.
 * Returns the error of one of the failed jobs, -EINVAL for an invalid number of threads, or
 * -EAGAIN if no thread could be started. */
int sim_parallel(int threads, const char *what, size_t n_jobs, sim_job *job, void *context)
    __attribute__((warn_unused_result));

#endif

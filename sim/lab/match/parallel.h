/* Work on numbered jobs by several threads. */
#ifndef SIM_LAB_MATCH_PARALLEL_H
#define SIM_LAB_MATCH_PARALLEL_H

#include <stddef.h>

/* Does one job; `worker` is the calling thread's number, from 0. 0 or a negative errno. */
typedef int sim_job(void *context, int worker, size_t job);

/* Runs jobs 0 .. n_jobs - 1, each once, on `threads` threads (1..64) and waits for all; `what` is
 * what sim/base/progress.h says of it. After a job has failed no further ones are begun. Returns
 * the failure of one of those that failed, -EINVAL for the number of threads, -EAGAIN if no thread
 * could be started. */
int sim_parallel(int threads, const char *what, size_t n_jobs, sim_job *job, void *context)
    __attribute__((warn_unused_result));

#endif

/* Several things done at once, by whoever has threads: core starts none. The caller hands in how a
 * batch of tasks is run; without that they are run one after the other.
 *
 * Two kinds of batch: one that is run waits for every worker that took part in it, wherever its
 * processor is; one that is raced only for its results, and what a worker has not finished in time
 * is done once more by the caller. */
#ifndef ISO_CORE_BASE_TASKS_H
#define ISO_CORE_BASE_TASKS_H

/* One of a batch of independent tasks. Of all tasks with one `worker` number, only one runs at a
 * time. */
typedef void iso_task(void *batch, int task, int worker);

enum { ISO_TASKS_RACE_MAX = 64 };

struct iso_tasks {
    int n_workers; /* worker numbers are 0..n_workers - 1, that of the caller 0 */
    void *context;
    /* Runs task 0..n_tasks - 1 of a batch, each once, and returns when all are done. */
    void (*run)(void *context, iso_task *task, void *batch, int n_tasks);
    /* Runs task 0..n_tasks - 1 (at most ISO_TASKS_RACE_MAX), each at least once and perhaps by two
     * workers at the same time, and returns when each has been done by one; another may still be at
     * it. So a task works in what is its worker's own and makes its result known by one atomic
     * store, and what it reads stays as it is until `settle`. */
    void (*race)(void *context, iso_task *task, void *batch, int n_tasks);
    /* Returns when no worker is at a task any more. Every batch begins with it. */
    void (*settle)(void *context);
    /* Says that batches are about to come, some 100 us from now, the last of them a race: who
     * sleeps may get up. NULL: nobody sleeps. */
    void (*expect)(void *context);
};

static inline void iso__tasks_alone(iso_task *task, void *batch, int n_tasks)
{
    for (int i = 0; i < n_tasks; i++) {
        task(batch, i, 0);
    }
}

/* The operations; without `tasks` (NULL) the caller is the only worker. */
static inline void iso_tasks_run(const struct iso_tasks *tasks, iso_task *task, void *batch,
                                 int n_tasks)
{
    if (tasks) {
        tasks->run(tasks->context, task, batch, n_tasks);
    } else {
        iso__tasks_alone(task, batch, n_tasks);
    }
}

static inline void iso_tasks_race(const struct iso_tasks *tasks, iso_task *task, void *batch,
                                  int n_tasks)
{
    if (tasks) {
        tasks->race(tasks->context, task, batch, n_tasks);
    } else {
        iso__tasks_alone(task, batch, n_tasks);
    }
}

static inline void iso_tasks_settle(const struct iso_tasks *tasks)
{
    if (tasks) {
        tasks->settle(tasks->context);
    }
}

static inline void iso_tasks_expect(const struct iso_tasks *tasks)
{
    if (tasks && tasks->expect) {
        tasks->expect(tasks->context);
    }
}

#endif

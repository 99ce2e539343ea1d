/* Several things done at once, by whoever has threads: core starts none. The caller hands in how a
 * batch of tasks is run; without that they are run one after the other. */
#ifndef ISO_CORE_TASKS_H
#define ISO_CORE_TASKS_H

/* One of a batch of independent tasks. Of all tasks with one `worker` number, only one runs at a
 * time. */
typedef void iso_task(void *batch, int task, int worker);

struct iso_tasks {
    int n_workers; /* worker numbers are 0..n_workers - 1 */
    /* Runs task 0..n_tasks - 1 of a batch, each once, and returns when all are done. */
    void (*run)(void *context, iso_task *task, void *batch, int n_tasks);
    void *context;
};

/* Runs a batch by `tasks`, or one after the other as worker 0 if that is NULL. */
static inline void iso_tasks_run(const struct iso_tasks *tasks, iso_task *task, void *batch,
                                 int n_tasks)
{
    if (tasks) {
        tasks->run(tasks->context, task, batch, n_tasks);
        return;
    }
    for (int i = 0; i < n_tasks; i++) {
        task(batch, i, 0);
    }
}

#endif

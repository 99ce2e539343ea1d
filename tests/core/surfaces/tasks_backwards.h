/* Tasks done by nobody but the caller, as three workers might: the last first, and in a race each a
 * second time, in vain. */
#ifndef TESTS_CORE_SURFACES_TASKS_BACKWARDS_H
#define TESTS_CORE_SURFACES_TASKS_BACKWARDS_H

#include "core/base/tasks.h"

enum { TASKS_BACKWARDS_WORKERS = 3 };

static inline void tasks_backwards_run(void *n_run, iso_task *task, void *batch, int n_tasks)
{
    for (int i = n_tasks - 1; i >= 0; i--) {
        task(batch, i, i % TASKS_BACKWARDS_WORKERS);
        ++*(int *)n_run;
    }
}

static inline void tasks_backwards_race(void *n_run, iso_task *task, void *batch, int n_tasks)
{
    tasks_backwards_run(n_run, task, batch, n_tasks);
    for (int i = 0; i < n_tasks; i++) {
        task(batch, i, (i + 1) % TASKS_BACKWARDS_WORKERS);
    }
}

static inline void tasks_backwards_settle(void *n_run)
{
    (void)n_run;
}

/* Counts tasks in *n_run, those done in vain left out. */
static inline struct iso_tasks tasks_backwards(int *n_run)
{
    return (struct iso_tasks){TASKS_BACKWARDS_WORKERS, n_run,
                              tasks_backwards_run,     tasks_backwards_race,
                              tasks_backwards_settle,  NULL};
}

#endif

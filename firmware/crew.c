#include "firmware/crew.h"

#include <errno.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>

struct helper {
    struct iso_crew *crew;
    int worker;
    pthread_t thread;
};

struct iso_crew {
    struct iso_tasks tasks;
    int n_started; /* helpers */
    struct helper helper[ISO_CREW_MAX - 1];

    pthread_mutex_t lock; /* of what follows, but for next */
    pthread_cond_t begun, done;
    bool open;       /* there is a batch to join */
    bool ending;     /* of the crew */
    unsigned number; /* of the batch */
    int working;     /* helpers at it */
    iso_task *task;
    void *batch;
    int n_tasks;
    atomic_int next; /* task that nobody has taken */
};

static void take_tasks(struct iso_crew *crew, int worker)
{
    for (;;) {
        int i = atomic_fetch_add(&crew->next, 1);
        if (i >= crew->n_tasks) {
            return;
        }
        crew->task(crew->batch, i, worker);
    }
}

static void *help(void *context)
{
    struct helper *helper = context;
    struct iso_crew *crew = helper->crew;
    unsigned joined = 0; /* batches so far */
    (void)pthread_mutex_lock(&crew->lock);
    for (;;) {
        while (!crew->ending && !(crew->open && crew->number != joined)) {
            (void)pthread_cond_wait(&crew->begun, &crew->lock);
        }
        if (crew->ending) {
            break;
        }
        joined = crew->number;
        crew->working++;
        (void)pthread_mutex_unlock(&crew->lock);
        take_tasks(crew, helper->worker);
        (void)pthread_mutex_lock(&crew->lock);
        crew->working--;
        if (crew->working == 0) {
            (void)pthread_cond_signal(&crew->done);
        }
    }
    (void)pthread_mutex_unlock(&crew->lock);
    return NULL;
}

static void run(void *context, iso_task *task, void *batch, int n_tasks)
{
    struct iso_crew *crew = context;
    (void)pthread_mutex_lock(&crew->lock);
    crew->task = task;
    crew->batch = batch;
    crew->n_tasks = n_tasks;
    atomic_store(&crew->next, 0);
    crew->number++;
    crew->open = true;
    (void)pthread_cond_broadcast(&crew->begun);
    (void)pthread_mutex_unlock(&crew->lock);
    take_tasks(crew, 0);
    (void)pthread_mutex_lock(&crew->lock);
    crew->open = false; /* who has not come by now need not */
    while (crew->working > 0) {
        (void)pthread_cond_wait(&crew->done, &crew->lock);
    }
    (void)pthread_mutex_unlock(&crew->lock);
}

int iso_crew_new(int n_workers, struct iso_crew **out)
{
    if (n_workers < 1 || n_workers > ISO_CREW_MAX) {
        return -EINVAL;
    }
    struct iso_crew *crew = calloc(1, sizeof *crew);
    if (!crew) {
        return -ENOMEM;
    }
    crew->tasks = (struct iso_tasks){n_workers, run, crew};
    (void)pthread_mutex_init(&crew->lock, NULL);
    (void)pthread_cond_init(&crew->begun, NULL);
    (void)pthread_cond_init(&crew->done, NULL);
    for (int i = 0; i + 1 < n_workers; i++) {
        struct helper *helper = &crew->helper[i];
        helper->crew = crew;
        helper->worker = i + 1;
        if (pthread_create(&helper->thread, NULL, help, helper)) {
            iso_crew_free(crew);
            return -EAGAIN;
        }
        crew->n_started++;
    }
    *out = crew;
    return 0;
}

void iso_crew_free(struct iso_crew *crew)
{
    if (!crew) {
        return;
    }
    (void)pthread_mutex_lock(&crew->lock);
    crew->ending = true;
    (void)pthread_cond_broadcast(&crew->begun);
    (void)pthread_mutex_unlock(&crew->lock);
    for (int i = 0; i < crew->n_started; i++) {
        (void)pthread_join(crew->helper[i].thread, NULL);
    }
    (void)pthread_cond_destroy(&crew->begun);
    (void)pthread_cond_destroy(&crew->done);
    (void)pthread_mutex_destroy(&crew->lock);
    free(crew);
}

const struct iso_tasks *iso_crew_tasks(const struct iso_crew *crew)
{
    return &crew->tasks;
}

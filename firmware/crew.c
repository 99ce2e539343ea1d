#include "firmware/crew.h"

#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <time.h>

/* How long a thread looks again and again before it sleeps: to be woken takes some 50 us, and so
 * long a batch follows another or somebody finishes a task. On a machine that is busy it is what
 * may be lost. */
static const int64_t patience_ns = 60000;

struct helper {
    struct iso_crew *crew;
    int worker;
    pthread_t thread;
};

struct iso_crew {
    struct iso_tasks tasks;
    int n_started; /* helpers */
    struct helper helper[ISO_CREW_MAX - 1];

    pthread_mutex_t lock; /* to change what follows, but for next */
    pthread_cond_t begun, done;
    bool open;          /* there is a batch to join */
    bool ending;        /* of the crew */
    atomic_uint number; /* of the batch */
    atomic_int working; /* helpers at it */
    iso_task *task;
    void *batch;
    int n_tasks;
    atomic_int next; /* task that nobody has taken */
};

static int64_t now_ns(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

/* Lets the other thread of the core have what there is. */
static void relax(void)
{
#if defined __x86_64__ || defined __i386__
    __builtin_ia32_pause();
#elif defined __aarch64__
    __asm__ volatile("yield");
#endif
}

/* Until there is another batch, or patience is over. */
static void look_for_a_batch(struct iso_crew *crew, unsigned joined)
{
    const int64_t until_ns = now_ns() + patience_ns;
    while (crew->number == joined && now_ns() < until_ns) {
        relax();
    }
}

/* Until no helper is at work, or patience is over. */
static void look_for_the_end(struct iso_crew *crew)
{
    const int64_t until_ns = now_ns() + patience_ns;
    while (crew->working > 0 && now_ns() < until_ns) {
        relax();
    }
}

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
        (void)pthread_mutex_unlock(&crew->lock);
        look_for_a_batch(crew, joined);
        (void)pthread_mutex_lock(&crew->lock);
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
    (void)pthread_mutex_unlock(&crew->lock);
    look_for_the_end(crew);
    (void)pthread_mutex_lock(&crew->lock);
    while (crew->working > 0) {
        (void)pthread_cond_wait(&crew->done, &crew->lock);
    }
    (void)pthread_mutex_unlock(&crew->lock);
}

/* Signals are for who started the crew. */
static int start(struct helper *helper)
{
    sigset_t all, before;
    (void)sigfillset(&all);
    (void)pthread_sigmask(SIG_SETMASK, &all, &before);
    const int error = pthread_create(&helper->thread, NULL, help, helper);
    (void)pthread_sigmask(SIG_SETMASK, &before, NULL);
    return error;
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
        if (start(helper)) {
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

#include "firmware/recognise/crew.h"

#include <errno.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <time.h>

#include "drivers/process/thread.h"

/* How long a helper looks out for a batch before it sleeps: to be woken takes some 50 us. After a
 * batch another may follow at once; one that is expected comes when the caller has done what is
 * before it. */
static const int64_t patience_after_ns = 60000, patience_expecting_ns = 500000;

enum { NOWHERE = -1 };

struct helper {
    struct iso_crew *crew;
    int worker;
    pthread_t thread;
};

struct iso_crew {
    struct iso_tasks tasks;
    int n_started; /* helpers */
    struct helper helper[ISO_CREW_MAX - 1];

    cpu_set_t processors; /* that the crew may use; none: it is not known */
    int kept_off;         /* of these, the one that the helpers were told to leave to the caller */

    pthread_mutex_t lock; /* to change what follows, but for the last group */
    pthread_cond_t begun, done;
    bool open;   /* there is a batch to join */
    bool ending; /* of the crew */
    iso_task *task;
    void *batch;
    int n_tasks;
    atomic_uint number;    /* of the batch */
    atomic_bool expecting; /* a batch is about to come */
    atomic_int working;    /* helpers at it */

    atomic_int processor; /* of the caller */
    atomic_int next;      /* task that nobody has taken */
    atomic_bool ended[ISO_TASKS_RACE_MAX];
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

/* A helper on the caller's own processor keeps it from its work. */
static bool is_in_the_way(struct iso_crew *crew)
{
    return sched_getcpu() == atomic_load(&crew->processor);
}

/* Until there is a batch that the helper has not joined, or patience is over. */
static void look_for_a_batch(struct iso_crew *crew, unsigned joined)
{
    const int64_t begin_ns = now_ns();
    int64_t ns = 0;
    while (crew->number == joined && !is_in_the_way(crew) &&
           ns < (crew->expecting ? patience_expecting_ns : patience_after_ns)) {
        relax();
        ns = now_ns() - begin_ns;
    }
}

/* Takes what nobody has taken. Returns the longest time that one took. */
static int64_t take_tasks(struct iso_crew *crew, int worker)
{
    int64_t longest_ns = 0, begin_ns = now_ns();
    for (;;) {
        int i = atomic_fetch_add(&crew->next, 1);
        if (i >= crew->n_tasks) {
            return longest_ns;
        }
        crew->task(crew->batch, i, worker);
        if (i < ISO_TASKS_RACE_MAX) {
            atomic_store(&crew->ended[i], true);
        }
        const int64_t end_ns = now_ns();
        longest_ns = end_ns - begin_ns > longest_ns ? end_ns - begin_ns : longest_ns;
        begin_ns = end_ns;
    }
}

static void *help(void *context)
{
    struct helper *helper = context;
    struct iso_crew *crew = helper->crew;
    iso_thread_set_name("isothermd-crew");
    unsigned joined = 0; /* batches so far */
    (void)pthread_mutex_lock(&crew->lock);
    while (!crew->ending) {
        if (crew->open && crew->number != joined && !is_in_the_way(crew)) {
            joined = crew->number;
            crew->working++;
            (void)pthread_mutex_unlock(&crew->lock);
            (void)take_tasks(crew, helper->worker);
            (void)pthread_mutex_lock(&crew->lock);
            crew->working--;
            if (crew->working == 0) {
                (void)pthread_cond_signal(&crew->done);
            }
        } else {
            (void)pthread_cond_wait(&crew->begun, &crew->lock);
            joined = crew->open ? joined : crew->number;
        }
        (void)pthread_mutex_unlock(&crew->lock);
        look_for_a_batch(crew, joined);
        (void)pthread_mutex_lock(&crew->lock);
    }
    (void)pthread_mutex_unlock(&crew->lock);
    return NULL;
}

/* Leaves the caller its processor. The kernel often wakes a helper on the one where it slept, which
 * may be where the caller is by now, though another is idle. Where that may not be said to the
 * kernel, helpers see themselves that they are in the way, and sleep on. */
static void keep_off(struct iso_crew *crew, int processor)
{
    cpu_set_t others = crew->processors;
    if (processor == crew->kept_off || processor < 0 || processor >= CPU_SETSIZE) {
        return;
    }
    CPU_CLR((size_t)processor, &others);
    for (int i = 0; i < crew->n_started && CPU_COUNT(&others) > 0; i++) {
        (void)pthread_setaffinity_np(crew->helper[i].thread, sizeof others, &others);
    }
    crew->kept_off = processor;
}

static void expect(void *context)
{
    struct iso_crew *crew = context;
    const int processor = sched_getcpu();
    keep_off(crew, processor);
    (void)pthread_mutex_lock(&crew->lock);
    crew->processor = processor;
    crew->expecting = true;
    (void)pthread_cond_broadcast(&crew->begun);
    (void)pthread_mutex_unlock(&crew->lock);
}

static void settle(void *context)
{
    struct iso_crew *crew = context;
    const int64_t until_ns = now_ns() + patience_after_ns;
    while (crew->working > 0 && now_ns() < until_ns) {
        relax();
    }
    if (crew->working > 0) {
        (void)pthread_mutex_lock(&crew->lock);
        while (crew->working > 0) {
            (void)pthread_cond_wait(&crew->done, &crew->lock);
        }
        (void)pthread_mutex_unlock(&crew->lock);
    }
}

/* Helpers may join from now on. */
static void open_batch(struct iso_crew *crew, iso_task *task, void *batch, int n_tasks)
{
    (void)pthread_mutex_lock(&crew->lock);
    crew->processor = sched_getcpu();
    crew->task = task;
    crew->batch = batch;
    crew->n_tasks = n_tasks;
    atomic_store(&crew->next, 0);
    crew->number++;
    crew->open = true;
    (void)pthread_cond_broadcast(&crew->begun);
    (void)pthread_mutex_unlock(&crew->lock);
}

/* Who has not come by now need not. */
static void close_batch(struct iso_crew *crew)
{
    (void)pthread_mutex_lock(&crew->lock);
    crew->open = false;
    (void)pthread_mutex_unlock(&crew->lock);
}

static void run(void *context, iso_task *task, void *batch, int n_tasks)
{
    struct iso_crew *crew = context;
    settle(crew);
    open_batch(crew, task, batch, n_tasks);
    (void)take_tasks(crew, 0);
    close_batch(crew);
    settle(crew);
}

/* Whoever needs longer for a task than the caller needed for its longest has lost its processor. */
static void race(void *context, iso_task *task, void *batch, int n_tasks)
{
    struct iso_crew *crew = context;
    settle(crew);
    for (int i = 0; i < n_tasks; i++) {
        atomic_store(&crew->ended[i], false);
    }
    open_batch(crew, task, batch, n_tasks);
    const int64_t longest_ns = take_tasks(crew, 0);
    crew->expecting = false;
    close_batch(crew);
    const int64_t until_ns = now_ns() + longest_ns;
    for (int i = 0; i < n_tasks; i++) {
        while (!crew->ended[i] && now_ns() < until_ns) {
            relax();
        }
        if (!crew->ended[i]) {
            task(batch, i, 0);
        }
    }
}

static int start(struct helper *helper)
{
    return iso_thread_start(&helper->thread, help, helper);
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
    crew->tasks = (struct iso_tasks){n_workers, crew, run, race, settle, expect};
    atomic_init(&crew->processor, NOWHERE);
    crew->kept_off = NOWHERE;
    if (sched_getaffinity(0, sizeof crew->processors, &crew->processors) != 0) {
        CPU_ZERO(&crew->processors);
    }
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

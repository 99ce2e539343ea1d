#include "enroll/hub/api/worker.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/queue.h>
#include <unistd.h>

#include "drivers/process/thread.h"

struct waiting {
    STAILQ_ENTRY(waiting) link;
    struct hub_task task;
};

struct lane {
    struct hub_worker *worker;
    struct hub_store store;
    pthread_t thread;
    bool is_started;
    /* of the event loop */
    STAILQ_HEAD(, waiting) waiting;
    int n;
    struct waiting *current;
    /* under the lock */
    struct waiting *given;
    bool is_done;
};

struct hub_worker {
    pthread_mutex_t lock;
    pthread_cond_t wanted;
    bool is_ending; /* under the lock */
    int fd;
    sd_event_source *io;
    struct lane lanes[HUB_LANES];
};

static void *run(void *context)
{
    struct lane *lane = context;
    struct hub_worker *worker = lane->worker;
    const uint64_t one = 1;

    iso_thread_set_name("database");
    (void)pthread_mutex_lock(&worker->lock);
    while (!worker->is_ending) {
        const struct waiting *given = lane->given;
        if (!given) {
            (void)pthread_cond_wait(&worker->wanted, &worker->lock);
            continue;
        }
        (void)pthread_mutex_unlock(&worker->lock);
        given->task.work(given->task.context, &lane->store);
        (void)pthread_mutex_lock(&worker->lock);
        lane->given = NULL;
        lane->is_done = true;
        (void)!write(worker->fd, &one, sizeof one); /* the counter cannot be full */
    }
    (void)pthread_mutex_unlock(&worker->lock);
    return NULL;
}

/* ---- the event loop ---- */

/* Gives the thread of an idle lane the next task. */
static void go_on(struct lane *lane)
{
    struct hub_worker *worker = lane->worker;

    while (!lane->current && !STAILQ_EMPTY(&lane->waiting)) {
        struct waiting *next = STAILQ_FIRST(&lane->waiting);
        STAILQ_REMOVE_HEAD(&lane->waiting, link);
        lane->n--;
        if (next->task.may && !next->task.may(next->task.context)) {
            free(next);
            continue;
        }
        lane->current = next;
        (void)pthread_mutex_lock(&worker->lock);
        lane->given = next;
        (void)pthread_cond_broadcast(&worker->wanted);
        (void)pthread_mutex_unlock(&worker->lock);
    }
}

static void end_task(struct waiting *task, bool is_done)
{
    task->task.done(task->task.context, is_done);
    free(task);
}

static int on_done(sd_event_source *source, int fd, uint32_t events, void *context)
{
    struct hub_worker *worker = context;
    uint64_t count;

    (void)source;
    (void)events;
    (void)!read(fd, &count, sizeof count);
    for (int i = 0; i < HUB_LANES; i++) {
        struct lane *lane = &worker->lanes[i];
        (void)pthread_mutex_lock(&worker->lock);
        const bool is_done = lane->is_done;
        lane->is_done = false;
        (void)pthread_mutex_unlock(&worker->lock);
        if (is_done) {
            struct waiting *task = lane->current;
            lane->current = NULL;
            end_task(task, true);
            go_on(lane);
        }
    }
    return 0;
}

static int start(struct hub_worker *worker, const struct hub_store_options *options,
                 struct iso_fault *fault)
{
    int r = 0;

    for (int i = 0; r == 0 && i < HUB_LANES; i++) {
        struct lane *lane = &worker->lanes[i];
        r = hub_store_open(options, &lane->store, fault);
        if (r == 0) {
            r = iso_thread_start(&lane->thread, run, lane);
            lane->is_started = r == 0;
            r = r < 0 ? iso_fault_set(fault, r, "a thread: %s", strerror(-r)) : 0;
        }
    }
    return r;
}

int hub_worker_new(sd_event *event, const struct hub_store_options *options,
                   struct hub_worker **out, struct iso_fault *fault)
{
    struct hub_worker *worker = calloc(1, sizeof *worker);

    if (!worker) {
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    (void)pthread_mutex_init(&worker->lock, NULL);
    (void)pthread_cond_init(&worker->wanted, NULL);
    for (int i = 0; i < HUB_LANES; i++) {
        worker->lanes[i].worker = worker;
        STAILQ_INIT(&worker->lanes[i].waiting);
    }
    worker->fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    int r = worker->fd < 0
                ? -errno
                : sd_event_add_io(event, &worker->io, worker->fd, EPOLLIN, on_done, worker);
    r = r < 0 ? iso_fault_set(fault, r, "the event loop: %s", strerror(-r))
              : start(worker, options, fault);
    if (r < 0) {
        hub_worker_free(worker);
        return r;
    }
    *out = worker;
    return 0;
}

static void end_lane(struct lane *lane)
{
    if (lane->is_started) {
        (void)pthread_join(lane->thread, NULL);
    }
    if (lane->current) {
        end_task(lane->current, lane->is_done);
    }
    while (!STAILQ_EMPTY(&lane->waiting)) {
        struct waiting *task = STAILQ_FIRST(&lane->waiting);
        STAILQ_REMOVE_HEAD(&lane->waiting, link);
        end_task(task, false);
    }
    hub_store_close(&lane->store);
}

void hub_worker_free(struct hub_worker *worker)
{
    if (!worker) {
        return;
    }
    (void)pthread_mutex_lock(&worker->lock);
    worker->is_ending = true;
    (void)pthread_cond_broadcast(&worker->wanted);
    (void)pthread_mutex_unlock(&worker->lock);
    for (int i = 0; i < HUB_LANES; i++) {
        end_lane(&worker->lanes[i]);
    }
    sd_event_source_disable_unref(worker->io);
    if (worker->fd >= 0) {
        (void)close(worker->fd);
    }
    (void)pthread_cond_destroy(&worker->wanted);
    (void)pthread_mutex_destroy(&worker->lock);
    free(worker);
}

int hub_worker_do(struct hub_worker *worker, enum hub_lane which, const struct hub_task *task)
{
    struct lane *lane = &worker->lanes[which];
    struct waiting *waiting = lane->n < HUB_WORKER_WAITING_MOST ? malloc(sizeof *waiting) : NULL;

    if (!waiting) {
        return lane->n < HUB_WORKER_WAITING_MOST ? -ENOMEM : -EBUSY;
    }
    waiting->task = *task;
    STAILQ_INSERT_TAIL(&lane->waiting, waiting, link);
    lane->n++;
    go_on(lane);
    return 0;
}

int hub_worker_waiting(const struct hub_worker *worker, enum hub_lane lane)
{
    return worker->lanes[lane].n;
}

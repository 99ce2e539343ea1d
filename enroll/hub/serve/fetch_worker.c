#include "enroll/hub/serve/fetch_worker.h"

#include <errno.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <unistd.h>

#include "drivers/process/thread.h"
#include "enroll/web/http/now.h"

struct job {
    struct job *next;
    void (*done)(void *context, const struct hub_fetch_result *result);
    void *context;
    struct hub_fetch_result result;
    size_t size;
    unsigned char bytes[];
};

struct list {
    struct job *first, **end;
};

struct worker {
    struct hub_fetch *fetch;
    struct hub_store store;
    pthread_t thread;
    bool is_started;
};

struct hub_fetch {
    pthread_mutex_t lock;
    pthread_cond_t wanted;
    struct list waiting, answered; /* under the lock */
    bool is_ending;                /* under the lock */
    int n;                         /* of the main thread: jobs that are not done */
    int fd;
    sd_event_source *io;
    struct worker workers[HUB_FETCH_THREADS];
};

static void append(struct list *list, struct job *job)
{
    job->next = NULL;
    *(list->first ? list->end : &list->first) = job;
    list->end = &job->next;
}

static struct job *take(struct list *list)
{
    struct job *job = list->first;

    if (job) {
        list->first = job->next;
    }
    return job;
}

/* ---- the threads ---- */

struct output {
    int fd;
    uint64_t size;
};

static int write_all(void *context, const void *bytes, size_t size)
{
    struct output *out = context;

    for (size_t done = 0; done < size;) {
        const ssize_t n = write(out->fd, (const char *)bytes + done, size - done);
        if (n < 0 && errno != EINTR) {
            return -errno;
        }
        done += n > 0 ? (size_t)n : 0;
    }
    out->size += size;
    return 0;
}

static void answer(struct hub_store *store, struct job *job)
{
    struct hub_fetch_result *result = &job->result;
    const int64_t begun_ns = web_now_ns();

    if (hub_fetch_is_update(job->bytes, job->size)) {
        result->error = hub_answer_update(store, job->bytes, job->size, &result->fd,
                                          &result->offset, &result->size, &result->fault);
        result->seconds = 1e-9 * (double)(web_now_ns() - begun_ns);
        return;
    }
    struct output out = {.fd = memfd_create("isotherm-fetch", MFD_CLOEXEC)};
    result->error = out.fd < 0 ? iso_fault_set(&result->fault, -errno, "a file in memory: %s",
                                               strerror(errno))
                               : hub_answer_fetch(store, job->bytes, job->size, write_all, &out,
                                                  &result->what, &result->fault);
    if (result->error && out.fd >= 0) {
        (void)close(out.fd);
        out.fd = -1;
    }
    result->fd = out.fd;
    result->size = out.size;
    result->seconds = 1e-9 * (double)(web_now_ns() - begun_ns);
}

static void *run(void *context)
{
    struct worker *worker = context;
    struct hub_fetch *fetch = worker->fetch;
    const uint64_t one = 1;

    iso_thread_set_name("fetch");
    (void)pthread_mutex_lock(&fetch->lock);
    while (!fetch->is_ending) {
        struct job *job = take(&fetch->waiting);
        if (!job) {
            (void)pthread_cond_wait(&fetch->wanted, &fetch->lock);
            continue;
        }
        (void)pthread_mutex_unlock(&fetch->lock);
        answer(&worker->store, job);
        (void)pthread_mutex_lock(&fetch->lock);
        append(&fetch->answered, job);
        (void)!write(fetch->fd, &one, sizeof one); /* the counter cannot be full */
    }
    (void)pthread_mutex_unlock(&fetch->lock);
    return NULL;
}

/* ---- the event loop ---- */

static void finish(struct hub_fetch *fetch, struct job *job)
{
    fetch->n--;
    job->done(job->context, &job->result);
    free(job);
}

static int on_answered(sd_event_source *source, int fd, uint32_t events, void *context)
{
    struct hub_fetch *fetch = context;
    uint64_t count;
    struct job *job;

    (void)source;
    (void)events;
    (void)!read(fd, &count, sizeof count);
    do {
        (void)pthread_mutex_lock(&fetch->lock);
        job = take(&fetch->answered);
        (void)pthread_mutex_unlock(&fetch->lock);
        if (job) {
            finish(fetch, job);
        }
    } while (job);
    return 0;
}

static int start(struct hub_fetch *fetch, const struct hub_store_options *options,
                 struct iso_fault *fault)
{
    int r = 0;

    for (int i = 0; r == 0 && i < HUB_FETCH_THREADS; i++) {
        struct worker *worker = &fetch->workers[i];
        worker->fetch = fetch;
        r = hub_store_open(options, &worker->store, fault);
        if (r == 0) {
            r = iso_thread_start(&worker->thread, run, worker);
            worker->is_started = r == 0;
            r = r < 0 ? iso_fault_set(fault, r, "a thread: %s", strerror(-r)) : 0;
        }
    }
    return r;
}

int hub_fetch_new(sd_event *event, const struct hub_store_options *options, struct hub_fetch **out,
                  struct iso_fault *fault)
{
    struct hub_fetch *fetch = calloc(1, sizeof *fetch);

    if (!fetch) {
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    (void)pthread_mutex_init(&fetch->lock, NULL);
    (void)pthread_cond_init(&fetch->wanted, NULL);
    fetch->fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    int r = fetch->fd < 0
                ? -errno
                : sd_event_add_io(event, &fetch->io, fetch->fd, EPOLLIN, on_answered, fetch);
    r = r < 0 ? iso_fault_set(fault, r, "the event loop: %s", strerror(-r))
              : start(fetch, options, fault);
    if (r < 0) {
        hub_fetch_free(fetch);
        return r;
    }
    *out = fetch;
    return 0;
}

void hub_fetch_free(struct hub_fetch *fetch)
{
    struct job *job;

    if (!fetch) {
        return;
    }
    (void)pthread_mutex_lock(&fetch->lock);
    fetch->is_ending = true;
    (void)pthread_cond_broadcast(&fetch->wanted);
    (void)pthread_mutex_unlock(&fetch->lock);
    for (int i = 0; i < HUB_FETCH_THREADS; i++) {
        if (fetch->workers[i].is_started) {
            (void)pthread_join(fetch->workers[i].thread, NULL);
        }
        hub_store_close(&fetch->workers[i].store);
    }
    while ((job = take(&fetch->answered))) {
        finish(fetch, job);
    }
    while ((job = take(&fetch->waiting))) {
        job->result = (struct hub_fetch_result){.error = -ECANCELED, .fd = -1};
        finish(fetch, job);
    }
    sd_event_source_disable_unref(fetch->io);
    if (fetch->fd >= 0) {
        (void)close(fetch->fd);
    }
    (void)pthread_cond_destroy(&fetch->wanted);
    (void)pthread_mutex_destroy(&fetch->lock);
    free(fetch);
}

int hub_fetch_ask(struct hub_fetch *fetch, const void *bytes, size_t size,
                  void (*done)(void *context, const struct hub_fetch_result *result), void *context)
{
    if (fetch->n >= HUB_FETCH_WAITING_MOST) {
        return -EBUSY;
    }
    struct job *job = calloc(1, sizeof *job + size);
    if (!job) {
        return -ENOMEM;
    }
    job->done = done;
    job->context = context;
    job->result.fd = -1;
    job->size = size;
    memcpy(job->bytes, bytes, size);
    fetch->n++;
    (void)pthread_mutex_lock(&fetch->lock);
    append(&fetch->waiting, job);
    (void)pthread_cond_signal(&fetch->wanted);
    (void)pthread_mutex_unlock(&fetch->lock);
    return 0;
}

#include "firmware/site/site_index.h"

#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/wipe.h"
#include "drivers/process/thread.h"
#include "firmware/site/site_generation.h"
#include "firmware/site/site_rows.h"

/* One computation of the thread. */
struct job {
    struct iso_site_index *site;
    uint64_t version; /* of the people that it reads */
    struct iso_site_work work;
};

struct iso_site_index {
    const struct iso_metric *metric;
    bool adapt;
    struct iso_index *index; /* the thread does not use it, nor the next one */
    struct iso_site_generation current;
    struct job job; /* only the thread uses it */
    pthread_t thread;
    bool running;
    pthread_mutex_t mutex; /* protects all members below; held for microseconds */
    pthread_cond_t changed;
    struct iso_site_rows rows;         /* the thread only reads them; see iso_site_index_person() */
    struct iso_site_teaching teaching; /* which of them teach */
    uint64_t version;                  /* counts the changes of the rows and of `teaching` */
    uint64_t computed;                 /* the version that the thread has finished */
    int error;                         /* of that version */
    bool holds_removed;                /* `current` has learned from templates that teach no more */
    bool is_ready;                     /* `ready` waits to become the current generation */
    struct iso_site_generation ready;
    bool is_estimated; /* `estimate` is that of the present people */
    struct iso_site_estimate estimate;
    bool ending;
};

/* ---- the thread ---- */

/* Copies the next person for a job. -ECANCELED also if the thread has to end. */
static int read_person(void *context, bool teaching, size_t *at, struct iso_site_person *out)
{
    const struct job *job = context;
    struct iso_site_index *site = job->site;
    int more = 0;
    (void)pthread_mutex_lock(&site->mutex);
    if (site->ending || site->version != job->version) {
        more = -ECANCELED;
    }
    while (more == 0 && *at < site->rows.n) {
        out->number = site->rows.person[*at];
        out->n = iso_site_rows_copy(&site->rows, teaching ? &site->teaching : NULL, *at,
                                    out->captures, ISO_INDEX_TEMPLATES_MAX, at);
        more = out->n > 0;
    }
    (void)pthread_mutex_unlock(&site->mutex);
    return more;
}

/* Hands over the generation of a job that has ended with `error`. After an error it is all zero:
 * the shipped metric, which replaces one that has learned from somebody who was removed. Returns
 * false if the people have changed meanwhile; then the caller keeps the generation. The mutex is
 * held. */
static bool publish(struct iso_site_index *site, const struct iso_site_generation *made, int error)
{
    if (site->version != site->job.version || error == -ECANCELED) {
        return false;
    }
    site->computed = site->job.version;
    site->error = error;
    if (!error || site->holds_removed) {
        site->ready = *made;
        site->is_ready = true;
    }
    (void)pthread_cond_broadcast(&site->changed);
    return true;
}

/* Estimates the error rates with the metric that the job has made. Without memory there is no
 * estimate. */
static void run_estimate(struct iso_site_index *site, struct iso_site_shared *metric)
{
    struct iso_site_estimate estimate;
    const int error = iso_site_estimate_make(&site->job.work, metric, &estimate);
    (void)pthread_mutex_lock(&site->mutex);
    if (!error && site->version == site->job.version) {
        site->estimate = estimate;
        site->is_estimated = true;
    }
    (void)pthread_mutex_unlock(&site->mutex);
}

/* Computes the generation of the present people, and then the estimate. The mutex is held on entry
 * and on return. */
static void run_job(struct iso_site_index *site)
{
    struct iso_site_generation made = {.shared = NULL};
    site->job.version = site->version;
    (void)pthread_mutex_unlock(&site->mutex);
    const int error = iso_site_generation_make(&site->job.work, &made);
    struct iso_site_shared *metric = iso_site_shared_keep(made.shared);
    (void)pthread_mutex_lock(&site->mutex);
    const bool published = publish(site, &made, error);
    (void)pthread_mutex_unlock(&site->mutex);
    if (!published) {
        iso_site_generation_free(&made);
    } else if (!error) {
        run_estimate(site, metric);
    }
    iso_site_shared_free(metric);
    (void)pthread_mutex_lock(&site->mutex);
}

static void *run_thread(void *context)
{
    struct iso_site_index *site = context;
    iso_thread_set_name("isothermd-site");
    (void)pthread_mutex_lock(&site->mutex);
    while (!site->ending) {
        if (site->computed != site->version) {
            run_job(site);
        } else {
            (void)pthread_cond_wait(&site->changed, &site->mutex);
        }
    }
    (void)pthread_mutex_unlock(&site->mutex);
    return NULL;
}

/* ---- new and free ---- */

int iso_site_index_new(const struct iso_metric *metric, bool adapt, struct iso_site_index **out)
{
    struct iso_site_index *site = calloc(1, sizeof *site);
    if (!site || iso_index_new(metric, &site->index)) {
        free(site);
        return -ENOMEM;
    }
    site->metric = metric;
    site->adapt = adapt;
    site->rows.width = (size_t)metric->n_dimensions;
    site->job.site = site;
    site->job.work.metric = metric;
    site->job.work.reader = (struct iso_site_reader){read_person, &site->job};
    iso_metric_steps_fill(metric, &site->job.work.steps);
    iso_thread_mutex_init(&site->mutex);
    (void)pthread_cond_init(&site->changed, NULL);
    *out = site;
    return 0;
}

int iso_site_index_start(struct iso_site_index *site)
{
    if (!site->adapt || site->running) {
        return 0;
    }
    const int error = iso_thread_start(&site->thread, run_thread, site);
    site->running = error == 0;
    return error;
}

void iso_site_index_free(struct iso_site_index *site)
{
    if (!site) {
        return;
    }
    if (site->running) {
        (void)pthread_mutex_lock(&site->mutex);
        site->ending = true;
        (void)pthread_cond_broadcast(&site->changed);
        (void)pthread_mutex_unlock(&site->mutex);
        (void)pthread_join(site->thread, NULL);
    }
    iso_index_free(site->index);
    iso_site_generation_free(&site->current);
    iso_site_generation_free(&site->ready);
    iso_site_rows_free(&site->rows);
    (void)pthread_cond_destroy(&site->changed);
    (void)pthread_mutex_destroy(&site->mutex);
    iso_wipe_free(site);
}

/* ---- changes ---- */

int iso_site_index_reserve(struct iso_site_index *site, size_t n)
{
    int error = iso_index_reserve(site->index, iso_index_size(site->index) + n);
    if (!error && site->adapt) {
        (void)pthread_mutex_lock(&site->mutex);
        error = iso_site_rows_reserve(&site->rows, n);
        (void)pthread_mutex_unlock(&site->mutex);
    }
    return error;
}

/* Begins a change of the rows. Returns the generation that was ready, which does not have this
 * change; end_change() frees it after it has unlocked the mutex, because that takes long. */
static struct iso_site_generation begin_change(struct iso_site_index *site)
{
    (void)pthread_mutex_lock(&site->mutex);
    const struct iso_site_generation outdated = site->ready;
    site->version++;
    site->is_ready = false;
    site->is_estimated = false;
    site->ready = (struct iso_site_generation){.shared = NULL};
    return outdated;
}

static void end_change(struct iso_site_index *site, struct iso_site_generation *outdated)
{
    (void)pthread_cond_broadcast(&site->changed);
    (void)pthread_mutex_unlock(&site->mutex);
    iso_site_generation_free(outdated);
}

int iso_site_index_add(struct iso_site_index *site, int64_t person, uint64_t number,
                       const char *sensor, const struct iso_metric_vector *vector)
{
    const int error = iso_index_add(site->index, person, vector);
    if (!error && site->adapt) {
        struct iso_site_generation outdated = begin_change(site);
        iso_site_rows_insert(&site->rows, person, number, sensor, vector);
        end_change(site, &outdated);
    }
    return error;
}

void iso_site_index_remove(struct iso_site_index *site, int64_t person)
{
    /* A person without a vector is not in the index. */
    if (iso_index_remove(site->index, person) == 0 && site->adapt) {
        iso_site_shared_forget(site->current.shared, person);
        struct iso_site_generation outdated = begin_change(site);
        site->holds_removed = true;
        iso_site_rows_remove(&site->rows, person);
        end_change(site, &outdated);
    }
}

void iso_site_index_set_record(struct iso_site_index *site, const struct iso_site_record *record)
{
    struct iso_site_generation outdated = begin_change(site);
    site->teaching.record = *record;
    site->holds_removed = true;
    end_change(site, &outdated);
}

/* Only this thread changes the rows and `teaching`, so it reads them without the mutex. */
void iso_site_index_set_sensor(struct iso_site_index *site, const char *sensor)
{
    struct iso_site_teaching now = site->teaching;
    (void)snprintf(now.sensor, sizeof now.sensor, "%s", sensor);
    if (strcmp(now.sensor, site->teaching.sensor) == 0) {
        return;
    }
    const bool same = iso_site_rows_are_same(&site->rows, &site->teaching, &now);
    (void)pthread_mutex_lock(&site->mutex);
    site->teaching = now;
    (void)pthread_mutex_unlock(&site->mutex);
    if (!same) {
        struct iso_site_generation outdated = begin_change(site);
        end_change(site, &outdated);
        iso_site_generation_free(&site->current);
    }
}

bool iso_site_index_is_other(const struct iso_site_index *site, int64_t person)
{
    return iso_site_rows_is_other(&site->rows, &site->teaching, person);
}

size_t iso_site_index_count(struct iso_site_index *site, uint64_t first, bool teaching)
{
    size_t n = 0;
    (void)pthread_mutex_lock(&site->mutex);
    for (size_t i = 0; i < site->rows.n; i++) {
        const uint64_t number = site->rows.number[i];
        n += number >= first && iso_site_record_teaches(&site->teaching.record, number) == teaching;
    }
    (void)pthread_mutex_unlock(&site->mutex);
    return n;
}

/* ---- the generation in use ---- */

/* If a new generation is ready, makes it the current one and returns true. *before receives the
 * generation that was the current one until now, which the caller frees; without a new one it is
 * all zero. The caller holds the mutex. */
static bool take_ready(struct iso_site_index *site, struct iso_site_generation *before)
{
    *before = (struct iso_site_generation){.shared = NULL};
    if (!site->is_ready) {
        return false;
    }
    *before = site->current;
    site->current = site->ready;
    site->ready = (struct iso_site_generation){.shared = NULL};
    site->is_ready = false;
    site->holds_removed = false;
    return true;
}

bool iso_site_index_follow(struct iso_site_index *site)
{
    if (!site->running || pthread_mutex_trylock(&site->mutex)) {
        return false;
    }
    struct iso_site_generation before;
    const bool followed = take_ready(site, &before);
    (void)pthread_mutex_unlock(&site->mutex);
    iso_site_generation_free(&before);
    return followed;
}

const struct iso_index *iso_site_index_current(const struct iso_site_index *site)
{
    return site->index;
}

const struct iso_site_metric *iso_site_index_metric(const struct iso_site_index *site)
{
    return site->current.shared ? &site->current.shared->adapted : NULL;
}

/* Only this thread changes the rows, so it reads them without the mutex. */
int iso_site_index_person(const struct iso_site_index *site, int64_t person,
                          struct iso_metric_vector *out)
{
    const struct iso_site_rows *rows = &site->rows;
    const struct iso_site_shared *shared = site->current.shared;
    struct iso_metric_vector capture, one;
    if (!shared) {
        return iso_index_find(site->index, person, out);
    }
    size_t at = iso_site_rows_find(rows, person);
    if (at == rows->n || rows->person[at] != person) {
        return -ENOENT;
    }
    *out = (struct iso_metric_vector){.n = 0};
    for (; at < rows->n && rows->person[at] == person; at++) {
        iso_site_rows_get(rows, at, &capture);
        iso_site_turn(&shared->adapted, &capture, &one);
        iso_metric_vector_add(shared->adapted.metric, &one, out);
    }
    explicit_bzero(&capture, sizeof capture);
    explicit_bzero(&one, sizeof one);
    return 0;
}

int iso_site_index_settle(struct iso_site_index *site)
{
    if (!site->running) {
        return 0;
    }
    (void)pthread_mutex_lock(&site->mutex);
    while (site->computed != site->version) {
        (void)pthread_cond_wait(&site->changed, &site->mutex);
    }
    struct iso_site_generation before;
    (void)take_ready(site, &before);
    const int error = site->error;
    (void)pthread_mutex_unlock(&site->mutex);
    iso_site_generation_free(&before);
    return error;
}

struct iso_site_state iso_site_index_state(struct iso_site_index *site)
{
    struct iso_site_state state = {
        .adapts = site->adapt,
        .adapted = site->current.shared != NULL,
        .summary = site->current.summary,
    };
    (void)pthread_mutex_lock(&site->mutex);
    state.due = site->adapt && (site->computed != site->version || site->is_ready);
    state.error = site->error;
    (void)pthread_mutex_unlock(&site->mutex);
    return state;
}

bool iso_site_index_estimate(struct iso_site_index *site, struct iso_site_estimate *out)
{
    (void)pthread_mutex_lock(&site->mutex);
    const bool known = site->is_estimated && !site->is_ready;
    if (known) {
        *out = site->estimate;
    }
    (void)pthread_mutex_unlock(&site->mutex);
    return known;
}

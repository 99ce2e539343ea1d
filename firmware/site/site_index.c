#include "firmware/site/site_index.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/wipe.h"
#include "core/match/metric_vector.h"
#include "drivers/process/thread.h"
#include "firmware/site/site_rows.h"

/* A metric and the index by it. */
struct generation {
    struct iso_site_metric adapted; /* all zero: the shipped metric */
    struct iso_index *index;
    struct iso_site_summary summary;
};

/* One computation of the thread. */
struct job {
    struct iso_site_index *site;
    uint64_t version;
    size_t at; /* the row of the next person */
    size_t n_people;
    int64_t person;
    struct iso_metric_steps shipped; /* of the shipped metric */
    struct iso_metric_vector captures[ISO_INDEX_TEMPLATES_MAX];
};

struct iso_site_index {
    const struct iso_metric *metric;
    bool adapt;
    struct generation current; /* the thread does not use it */
    struct job job;            /* only the thread uses it */
    pthread_t thread;
    bool running;
    pthread_mutex_t mutex; /* protects all members below; held for microseconds */
    pthread_cond_t changed;
    struct iso_site_rows rows;
    uint64_t version;  /* counts the changes of the rows */
    uint64_t computed; /* the version that the thread has finished */
    int error;         /* of that version */
    bool is_ready;     /* `ready` waits to become the current generation */
    struct generation ready;
    bool ending;
};

static void free_generation(struct generation *generation)
{
    iso_index_free(generation->index);
    iso_site_metric_free(&generation->adapted);
    *generation = (struct generation){.index = NULL};
}

/* ---- the thread ---- */

/* Copies the vectors of the next person; 0 if there is nobody left. -ECANCELED if the people have
 * changed since the job began, or if the thread has to end. */
static int next_person(struct job *job)
{
    struct iso_site_index *site = job->site;
    int n = 0;
    (void)pthread_mutex_lock(&site->mutex);
    if (site->ending || site->version != job->version) {
        n = -ECANCELED;
    } else if (job->at < site->rows.n) {
        job->person = site->rows.person[job->at];
        n = iso_site_rows_copy(&site->rows, job->at, job->captures, ISO_INDEX_TEMPLATES_MAX,
                               &job->at);
    }
    (void)pthread_mutex_unlock(&site->mutex);
    return n;
}

static int collect_statistics(struct job *job, struct iso_site *statistics)
{
    int n = 0, error = 0;
    job->at = 0;
    job->n_people = 0;
    while (!error && (n = next_person(job)) > 0) {
        if (job->n_people++ < ISO_SITE_PEOPLE_MAX) {
            error = iso_site_add(statistics, job->person, job->captures, n);
        }
    }
    error = error ? error : n;
    if (!error) {
        error = iso_site_find_directions(statistics);
    }
    job->at = 0;
    for (int p = 0; !error && p < ISO_SITE_PEOPLE_MAX && (n = next_person(job)) > 0; p++) {
        error = iso_site_review(statistics, job->captures, n);
    }
    return error || n > 0 ? error : n;
}

static const struct iso_metric *metric_of(const struct job *job,
                                          const struct generation *generation)
{
    return generation->adapted.metric ? generation->adapted.metric : job->site->metric;
}

/* Computes the person's vector by the metric of the generation. */
static int put_person(struct job *job, int n, const struct generation *generation)
{
    struct iso_metric_vector all = {.n = 0}, one;
    const struct iso_metric *metric = metric_of(job, generation);
    for (int i = 0; i < n; i++) {
        if (generation->adapted.metric) {
            iso_site_turn(&generation->adapted, &job->captures[i], &one);
        } else {
            one = job->captures[i];
            iso_metric_vector_judge(metric, &job->shipped, &one);
        }
        iso_metric_vector_add(metric, &one, &all);
    }
    const int error = iso_index_put(generation->index, job->person, &all);
    explicit_bzero(&all, sizeof all);
    explicit_bzero(&one, sizeof one);
    return error;
}

static int fill_index(struct job *job, struct generation *generation)
{
    int n = 0, error = iso_index_new(metric_of(job, generation), &generation->index);
    if (!error) {
        error = iso_index_reserve(generation->index, job->n_people);
    }
    job->at = 0;
    while (!error && (n = next_person(job)) > 0) {
        error = put_person(job, n, generation);
    }
    return error ? error : n;
}

/* Computes the statistics and the metric. The statistics of many people are large, so they are
 * freed before the index is made. */
static int compute_metric(struct job *job, struct generation *out)
{
    struct iso_site *statistics = NULL;
    int error = iso_site_new(job->site->metric, &statistics);
    if (!error) {
        error = collect_statistics(job, statistics);
    }
    if (!error) {
        out->summary = iso_site_summary(statistics);
    }
    if (!error && out->summary.people >= ISO_SITE_PEOPLE_MIN) {
        error = iso_site_adapt(statistics, job->site->metric, &out->adapted);
    }
    iso_site_free(statistics);
    return error;
}

static int compute_generation(struct job *job, struct generation *out)
{
    int error = compute_metric(job, out);
    if (!error) {
        error = fill_index(job, out);
    }
    explicit_bzero(job->captures, sizeof job->captures);
    if (error) {
        free_generation(out);
    }
    return error;
}

/* Computes the generation of the present people. The mutex is held on entry and on return. */
static void run_job(struct iso_site_index *site)
{
    struct generation made = {.index = NULL};
    struct job *job = &site->job;
    job->version = site->version;
    (void)pthread_mutex_unlock(&site->mutex);
    const int error = compute_generation(job, &made);
    (void)pthread_mutex_lock(&site->mutex);
    if (site->version != job->version || error == -ECANCELED) {
        (void)pthread_mutex_unlock(&site->mutex);
        free_generation(&made);
        (void)pthread_mutex_lock(&site->mutex);
        return;
    }
    site->computed = job->version;
    site->error = error;
    if (!error) {
        site->ready = made;
        site->is_ready = true;
    }
    (void)pthread_cond_broadcast(&site->changed);
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
    if (!site || iso_index_new(metric, &site->current.index)) {
        free(site);
        return -ENOMEM;
    }
    site->metric = metric;
    site->adapt = adapt;
    site->rows.width = (size_t)metric->n_dimensions;
    site->job.site = site;
    iso_metric_steps_fill(metric, &site->job.shipped);
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
    free_generation(&site->current);
    free_generation(&site->ready);
    iso_site_rows_free(&site->rows);
    (void)pthread_cond_destroy(&site->changed);
    (void)pthread_mutex_destroy(&site->mutex);
    iso_wipe_free(site);
}

/* ---- changes ---- */

int iso_site_index_reserve(struct iso_site_index *site, size_t n)
{
    int error = iso_index_reserve(site->current.index, iso_index_size(site->current.index) + 1);
    if (!error && site->adapt) {
        (void)pthread_mutex_lock(&site->mutex);
        error = iso_site_rows_reserve(&site->rows, n);
        (void)pthread_mutex_unlock(&site->mutex);
    }
    return error;
}

/* Begins a change of the rows. Returns the generation that was ready, which does not have this
 * change; end_change() frees it after it has unlocked the mutex, because that takes long. */
static struct generation begin_change(struct iso_site_index *site)
{
    (void)pthread_mutex_lock(&site->mutex);
    const struct generation outdated = site->ready;
    site->version++;
    site->is_ready = false;
    site->ready = (struct generation){.index = NULL};
    return outdated;
}

static void end_change(struct iso_site_index *site, struct generation *outdated)
{
    (void)pthread_cond_broadcast(&site->changed);
    (void)pthread_mutex_unlock(&site->mutex);
    free_generation(outdated);
}

int iso_site_index_add(struct iso_site_index *site, int64_t person,
                       const struct iso_metric_vector *vector)
{
    struct iso_metric_vector turned = *vector;
    if (site->current.adapted.metric) {
        iso_site_turn(&site->current.adapted, vector, &turned);
    }
    const int error = iso_index_add(site->current.index, person, &turned);
    explicit_bzero(&turned, sizeof turned);
    if (!error && site->adapt) {
        struct generation outdated = begin_change(site);
        iso_site_rows_insert(&site->rows, person, vector);
        end_change(site, &outdated);
    }
    return error;
}

void iso_site_index_remove(struct iso_site_index *site, int64_t person)
{
    /* A person without a vector is not in the index. */
    if (iso_index_remove(site->current.index, person) == 0 && site->adapt) {
        iso_site_metric_forget(&site->current.adapted, person);
        struct generation outdated = begin_change(site);
        iso_site_rows_remove(&site->rows, person);
        end_change(site, &outdated);
    }
}

/* ---- the generation in use ---- */

/* Takes over the generation that waits. The mutex is held. */
static struct generation take_ready(struct iso_site_index *site)
{
    struct generation before = {.index = NULL};
    if (site->is_ready) {
        before = site->current;
        site->current = site->ready;
        site->ready = (struct generation){.index = NULL};
        site->is_ready = false;
    }
    return before;
}

bool iso_site_index_follow(struct iso_site_index *site)
{
    if (!site->running || pthread_mutex_trylock(&site->mutex)) {
        return false;
    }
    struct generation before = take_ready(site);
    (void)pthread_mutex_unlock(&site->mutex);
    const bool followed = before.index != NULL;
    free_generation(&before);
    return followed;
}

const struct iso_index *iso_site_index_current(const struct iso_site_index *site)
{
    return site->current.index;
}

const struct iso_site_metric *iso_site_index_metric(const struct iso_site_index *site)
{
    return site->current.adapted.metric ? &site->current.adapted : NULL;
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
    struct generation before = take_ready(site);
    const int error = site->error;
    (void)pthread_mutex_unlock(&site->mutex);
    free_generation(&before);
    return error;
}

struct iso_site_state iso_site_index_state(struct iso_site_index *site)
{
    struct iso_site_state state = {
        .adapts = site->adapt,
        .adapted = site->current.adapted.metric != NULL,
        .summary = site->current.summary,
    };
    (void)pthread_mutex_lock(&site->mutex);
    state.due = site->adapt && (site->computed != site->version || site->is_ready);
    state.error = site->error;
    (void)pthread_mutex_unlock(&site->mutex);
    return state;
}

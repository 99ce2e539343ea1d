#include "firmware/site/site_generation.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/wipe.h"
#include "drivers/process/thread.h"
#include "firmware/site/site_index.h"

/* ---- the metric ---- */

struct iso_site_shared *iso_site_shared_keep(struct iso_site_shared *shared)
{
    if (shared) {
        (void)atomic_fetch_add(&shared->owners, 1);
    }
    return shared;
}

void iso_site_shared_free(struct iso_site_shared *shared)
{
    if (shared && atomic_fetch_sub(&shared->owners, 1) == 1) {
        iso_site_metric_free(&shared->adapted);
        (void)pthread_mutex_destroy(&shared->mutex);
        iso_wipe_free(shared);
    }
}

void iso_site_shared_forget(struct iso_site_shared *shared, int64_t person)
{
    if (shared) {
        (void)pthread_mutex_lock(&shared->mutex);
        iso_site_metric_forget(&shared->adapted, person);
        (void)pthread_mutex_unlock(&shared->mutex);
    }
}

void iso_site_generation_free(struct iso_site_generation *generation)
{
    iso_index_free(generation->index);
    iso_site_shared_free(generation->shared);
    *generation = (struct iso_site_generation){.index = NULL};
}

static int adapt(const struct iso_site_work *work, const struct iso_site *statistics,
                 struct iso_site_shared **out)
{
    struct iso_site_shared *shared = calloc(1, sizeof *shared);
    if (!shared) {
        return -ENOMEM;
    }
    atomic_init(&shared->owners, 1);
    iso_thread_mutex_init(&shared->mutex);
    const int error = iso_site_adapt(statistics, work->metric, &shared->adapted);
    if (error) {
        iso_site_shared_free(shared);
        return error;
    }
    *out = shared;
    return 0;
}

static int read_next(struct iso_site_work *work, bool teaching, size_t *at)
{
    return work->reader.next(work->reader.context, teaching, at, &work->person);
}

/* Shows the people to the statistics, at most ISO_SITE_PEOPLE_MAX of them: in the first pass, or in
 * the second one. */
static int pass_people(struct iso_site_work *work, struct iso_site *statistics, bool second)
{
    const struct iso_site_person *person = &work->person;
    size_t at = 0;
    for (int p = 0; p < ISO_SITE_PEOPLE_MAX; p++) {
        const int more = read_next(work, true, &at);
        if (more <= 0) {
            return more;
        }
        const int error = second ? iso_site_review(statistics, person->captures, person->n)
                                 : iso_site_add(statistics, person->number, person->captures,
                                                person->n);
        if (error) {
            return error;
        }
    }
    return 0;
}

static int collect_statistics(struct iso_site_work *work, struct iso_site *statistics)
{
    int error = pass_people(work, statistics, false);
    if (!error) {
        error = iso_site_find_directions(statistics);
    }
    return error ? error : pass_people(work, statistics, true);
}

/* Computes the statistics and the metric. The statistics of many people are large, so they are
 * freed before the index is made. */
static int compute_metric(struct iso_site_work *work, struct iso_site_generation *out)
{
    struct iso_site *statistics = NULL;
    int error = iso_site_new(work->metric, &statistics);
    if (!error) {
        error = collect_statistics(work, statistics);
    }
    if (!error) {
        out->summary = iso_site_summary(statistics);
    }
    if (!error && out->summary.people >= ISO_SITE_PEOPLE_MIN) {
        error = adapt(work, statistics, &out->shared);
    }
    iso_site_free(statistics);
    return error;
}

/* ---- the index ---- */

void iso_site_capture(const struct iso_site_work *work, const struct iso_site_shared *shared,
                      const struct iso_metric_vector *capture, struct iso_metric_vector *out)
{
    if (shared) {
        iso_site_turn(&shared->adapted, capture, out);
    } else {
        *out = *capture;
        iso_metric_vector_judge(work->metric, &work->steps, out);
    }
}

/* Computes the vector of the person who was read, by the metric of the generation. */
static int put_person(const struct iso_site_work *work,
                      const struct iso_site_generation *generation)
{
    struct iso_metric_vector all = {.n = 0}, one;
    const struct iso_metric *metric = generation->shared ? generation->shared->adapted.metric
                                                         : work->metric;
    for (int i = 0; i < work->person.n; i++) {
        iso_site_capture(work, generation->shared, &work->person.captures[i], &one);
        iso_metric_vector_add(metric, &one, &all);
    }
    const int error = iso_index_put(generation->index, work->person.number, &all);
    explicit_bzero(&all, sizeof all);
    explicit_bzero(&one, sizeof one);
    return error;
}

/* Counts the people, so that the index gets room for them and not for more. */
static int count_people(struct iso_site_work *work, size_t *n)
{
    size_t at = 0;
    int more;
    for (*n = 0; (more = read_next(work, false, &at)) > 0; ++*n) {
    }
    return more;
}

static int fill_index(struct iso_site_work *work, struct iso_site_generation *generation)
{
    size_t n = 0, at = 0;
    int error = count_people(work, &n);
    if (!error) {
        error = iso_index_new(generation->shared ? generation->shared->adapted.metric
                                                 : work->metric,
                              &generation->index);
    }
    if (!error) {
        error = iso_index_reserve(generation->index, n);
    }
    int more = 1;
    while (!error && (more = read_next(work, false, &at)) > 0) {
        error = put_person(work, generation);
    }
    return error ? error : more;
}

int iso_site_generation_make(struct iso_site_work *work, struct iso_site_generation *out)
{
    int error = compute_metric(work, out);
    if (!error) {
        error = fill_index(work, out);
    }
    explicit_bzero(&work->person, sizeof work->person);
    if (error) {
        iso_site_generation_free(out);
    }
    return error;
}

int iso_site_generation_ship(struct iso_site_work *work, struct iso_site_generation *out)
{
    *out = (struct iso_site_generation){.index = NULL};
    const int error = fill_index(work, out);
    explicit_bzero(&work->person, sizeof work->person);
    if (error) {
        iso_site_generation_free(out);
    }
    return error;
}

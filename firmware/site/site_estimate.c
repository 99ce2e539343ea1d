#include "firmware/site/site_estimate.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/wipe.h"

/* A person of the sample, in the coordinates of the metric. */
struct member {
    int64_t number;
    int n; /* probes */
    struct iso_metric_vector all, probe[ISO_SITE_PROBES_MAX];
    size_t trials, errors[ISO_SITE_LEVELS]; /* non-mated comparisons of this person */
};

/* The comparisons of one sample. */
struct comparing {
    struct iso_site_work *work;
    struct iso_site_shared *shared;
    struct iso_site_estimate *estimate;
    struct member *members; /* [ISO_SITE_SAMPLE_MAX] */
};

static const struct iso_metric *metric_of(const struct comparing *comparing)
{
    return comparing->shared ? comparing->shared->adapted.metric : comparing->work->metric;
}

static double score_of(const struct comparing *comparing, int64_t number,
                       const struct iso_metric_vector *person,
                       const struct iso_metric_vector *probe)
{
    struct iso_site_shared *shared = comparing->shared;
    if (!shared) {
        return iso_metric_score(comparing->work->metric, person, probe);
    }
    (void)pthread_mutex_lock(&shared->mutex);
    const double score = iso_site_score(&shared->adapted, number, person, probe);
    (void)pthread_mutex_unlock(&shared->mutex);
    return score;
}

/* ---- a person's own templates ---- */

/* Computes the score of capture `probe` and the person's other captures. */
static double score_own(const struct comparing *comparing, const struct iso_site_person *person,
                        int probe)
{
    struct iso_metric_vector others = {.n = 0}, one;
    for (int i = 0; i < person->n; i++) {
        if (i != probe) {
            iso_site_capture(comparing->work, comparing->shared, &person->captures[i], &one);
            iso_metric_vector_add(metric_of(comparing), &one, &others);
        }
    }
    iso_site_capture(comparing->work, comparing->shared, &person->captures[probe], &one);
    const double score = score_of(comparing, person->number, &others, &one);
    explicit_bzero(&others, sizeof others);
    explicit_bzero(&one, sizeof one);
    return score;
}

static void compare_own(const struct comparing *comparing, const struct iso_site_person *person)
{
    struct iso_site_estimate *estimate = comparing->estimate;
    size_t errors[ISO_SITE_LEVELS] = {0};
    if (person->n < 2) {
        return;
    }
    for (int i = 0; i < person->n; i++) {
        const double score = score_own(comparing, person, i);
        for (int l = 0; l < ISO_SITE_LEVELS; l++) {
            errors[l] += score < estimate->level[l].score;
        }
    }
    for (int l = 0; l < ISO_SITE_LEVELS; l++) {
        iso_people_rate_add(&estimate->level[l].same, errors[l], (size_t)person->n);
    }
    estimate->repeated++;
}

/* Keeps the vectors that the comparisons with others need. */
static void keep_member(const struct comparing *comparing, const struct iso_site_person *person,
                        struct member *member)
{
    struct iso_metric_vector one;
    member->number = person->number;
    for (int i = 0; i < person->n; i++) {
        iso_site_capture(comparing->work, comparing->shared, &person->captures[i], &one);
        iso_metric_vector_add(metric_of(comparing), &one, &member->all);
        if (member->n < ISO_SITE_PROBES_MAX) {
            member->probe[member->n++] = one;
        }
    }
    explicit_bzero(&one, sizeof one);
}

static int read_sample(const struct comparing *comparing)
{
    const struct iso_site_reader *reader = &comparing->work->reader;
    struct iso_site_estimate *estimate = comparing->estimate;
    size_t at = 0;
    while (estimate->people < ISO_SITE_SAMPLE_MAX) {
        const int more = reader->next(reader->context, false, &at, &comparing->work->person);
        if (more <= 0) {
            return more;
        }
        compare_own(comparing, &comparing->work->person);
        keep_member(comparing, &comparing->work->person, &comparing->members[estimate->people++]);
    }
    return 0;
}

/* ---- pairs of people ---- */

/* Inserts a pair if its score is among the highest. The pairs come in rising order of numbers. */
static void keep_pair(struct iso_site_estimate *estimate, const struct iso_site_pair *pair)
{
    int at = estimate->n_pairs;
    while (at > 0 && estimate->pair[at - 1].score < pair->score) {
        at--;
    }
    if (at == ISO_SITE_PAIRS_MAX) {
        return;
    }
    const int moved = (estimate->n_pairs < ISO_SITE_PAIRS_MAX ? estimate->n_pairs
                                                              : ISO_SITE_PAIRS_MAX - 1) -
                      at;
    memmove(&estimate->pair[at + 1], &estimate->pair[at], (size_t)moved * sizeof *estimate->pair);
    estimate->pair[at] = *pair;
    estimate->n_pairs = at + moved + 1;
}

/* Compares the probes of one person with another one. Each comparison counts for both. Returns the
 * highest score. */
static double compare_one_way(const struct comparing *comparing, struct member *probed,
                              struct member *person)
{
    double highest = -INFINITY;
    for (int i = 0; i < probed->n; i++) {
        const double score = score_of(comparing, person->number, &person->all, &probed->probe[i]);
        for (int l = 0; l < ISO_SITE_LEVELS; l++) {
            const bool reached = score >= comparing->estimate->level[l].score;
            probed->errors[l] += reached;
            person->errors[l] += reached;
        }
        probed->trials++;
        person->trials++;
        highest = fmax(highest, score);
    }
    return highest;
}

/* Compares everybody with everybody else. Before each person it asks the reader whether the people
 * have changed. */
static int compare_others(const struct comparing *comparing)
{
    const struct iso_site_reader *reader = &comparing->work->reader;
    struct iso_site_estimate *estimate = comparing->estimate;
    struct member *members = comparing->members;
    for (int p = 0; p < estimate->people; p++) {
        size_t first = 0;
        if (reader->next(reader->context, false, &first, &comparing->work->person) < 0) {
            return -ECANCELED;
        }
        for (int o = p + 1; o < estimate->people; o++) {
            const double there = compare_one_way(comparing, &members[p], &members[o]);
            const double back = compare_one_way(comparing, &members[o], &members[p]);
            const struct iso_site_pair pair = {members[p].number, members[o].number,
                                               fmax(there, back)};
            keep_pair(estimate, &pair);
        }
    }
    return 0;
}

static void count_others(const struct comparing *comparing)
{
    struct iso_site_estimate *estimate = comparing->estimate;
    for (int p = 0; p < estimate->people; p++) {
        const struct member *member = &comparing->members[p];
        for (int l = 0; member->trials > 0 && l < ISO_SITE_LEVELS; l++) {
            iso_people_rate_add(&estimate->level[l].others, member->errors[l], member->trials);
        }
    }
}

int iso_site_estimate_make(struct iso_site_work *work, struct iso_site_shared *shared,
                           struct iso_site_estimate *out)
{
    const struct comparing comparing = {work, shared, out,
                                        calloc(ISO_SITE_SAMPLE_MAX, sizeof *comparing.members)};
    *out = (struct iso_site_estimate){.people = 0};
    for (int l = 0; l < ISO_SITE_LEVELS; l++) {
        out->level[l].score = (double)(ISO_SITE_LEVEL_LEAST + l);
    }
    int error = comparing.members ? 0 : -ENOMEM;
    if (!error) {
        error = read_sample(&comparing);
    }
    if (!error) {
        error = compare_others(&comparing);
    }
    if (!error) {
        count_others(&comparing);
    }
    explicit_bzero(&work->person, sizeof work->person);
    iso_wipe_free(comparing.members);
    return error;
}

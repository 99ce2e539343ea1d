#include "core/match/search.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static int by_score(const void *a, const void *b)
{
    const struct iso_search_hit *x = a, *y = b;
    const int order = (x->score < y->score) - (x->score > y->score);
    return order ? order : (x->person > y->person) - (x->person < y->person);
}

void iso_search_sort(struct iso_search_hit *hits, size_t n)
{
    qsort(hits, n, sizeof *hits, by_score);
}

/* Inserts a hit into a list that is sorted by falling score and has only one hit of a person. */
static void insert_hit(struct iso_search_hit *hits, int *n, int capacity, struct iso_search_hit hit)
{
    int i = 0;
    while (i < *n && hits[i].person != hit.person) {
        i++;
    }
    if (i < *n) {
        if (hits[i].score >= hit.score) {
            return;
        }
    } else if (*n < capacity) {
        (*n)++;
    } else if (capacity > 0 && hits[capacity - 1].score < hit.score) {
        i = capacity - 1;
    } else {
        return;
    }
    for (; i > 0 && hits[i - 1].score < hit.score; i--) {
        hits[i] = hits[i - 1];
    }
    hits[i] = hit;
}

int iso_search(struct iso_icp_workspace *work, const struct iso_search_entry *entries,
               int n_entries, const struct iso_template *probe, const struct iso_cohort *cohort,
               const struct iso_match_options *options, struct iso_search_hit *hits, int capacity,
               int *n_hits)
{
    struct iso_cohort_norm norm;
    int error = iso_cohort_normalise(work, cohort, probe, options, &norm);
    if (error) {
        return error;
    }
    int n = 0;
    for (int i = 0; i < n_entries; i++) {
        double distance;
        error = iso_match_distance(work, probe, entries[i].tmpl, options, &distance);
        if (error == -ENODATA) {
            continue; /* too few points in common with this one: it cannot be a hit */
        }
        if (error) {
            return error;
        }
        insert_hit(hits, &n, capacity,
                   (struct iso_search_hit){.person = entries[i].person,
                                           .distance_mm = distance,
                                           .score = iso_cohort_score(norm, distance)});
    }
    *n_hits = n;
    return 0;
}

/* Makes the vector of all templates of the person to whom the first entry belongs. *n_entries is
 * the number of entries of that person. A template with too few points adds nothing. */
static int gather(const struct iso_search_entry *first, int n_left, const struct iso_metric *metric,
                  struct iso_metric_vector *person, int *n_entries)
{
    person->n = 0;
    for (*n_entries = 0; *n_entries < n_left; ++*n_entries) {
        struct iso_metric_vector one;
        if (first[*n_entries].person != first->person) {
            return 0;
        }
        int error = iso_metric_project(metric, first[*n_entries].tmpl, &one);
        if (error && error != -ENODATA) {
            return error;
        }
        if (!error) {
            iso_metric_vector_add(metric, &one, person);
        }
    }
    return 0;
}

/* A person that the metric has found, and that person's entries. */
struct candidate {
    double score;
    int first, n;
};

/* Inserts a candidate into a list of the best ISO_RERANK_CANDIDATES, sorted by falling score. */
static void insert_candidate(struct candidate *list, int *n, struct candidate one)
{
    if (*n == ISO_RERANK_CANDIDATES && !(list[*n - 1].score < one.score)) {
        return;
    }
    int i = *n < ISO_RERANK_CANDIDATES ? (*n)++ : *n - 1;
    for (; i > 0 && list[i - 1].score < one.score; i--) {
        list[i] = list[i - 1];
    }
    list[i] = one;
}

static double look_again(struct iso_rerank_workspace *work, const struct iso_search_entry *entries,
                         const struct candidate *one, int place, const struct iso_template *probe,
                         const struct iso_metric *metric)
{
    enum { TEMPLATES_MAX = 16 };
    const struct iso_upper_face *person[TEMPLATES_MAX];
    int n = 0;
    for (; n < one->n && n < TEMPLATES_MAX; n++) {
        person[n] = &entries[one->first + n].tmpl->upper;
    }
    return iso_rerank(work, metric, &probe->upper, person, n, place, one->score);
}

int iso_search_by_metric(struct iso_rerank_workspace *work, const struct iso_search_entry *entries,
                         int n_entries, const struct iso_template *probe,
                         const struct iso_metric *metric, struct iso_search_hit *hits, int capacity,
                         int *n_hits)
{
    struct candidate list[ISO_RERANK_CANDIDATES];
    struct iso_metric_vector seen, person = {.n = 0};
    int error = iso_metric_project(metric, probe, &seen);
    int n = 0, n_found = 0;
    for (int i = 0, taken = 0; !error && i < n_entries; i += taken) {
        error = gather(&entries[i], n_entries - i, metric, &person, &taken);
        if (!error && person.n > 0) {
            const double score = iso_metric_score(metric, &person, &seen);
            insert_candidate(list, &n, (struct candidate){score, i, taken});
        }
    }
    for (int i = 0; !error && i < n; i++) {
        insert_hit(hits, &n_found, capacity,
                   (struct iso_search_hit){
                       .person = entries[list[i].first].person,
                       .distance_mm = NAN,
                       .score = look_again(work, entries, &list[i], i, probe, metric)});
    }
    explicit_bzero(&seen, sizeof seen);
    explicit_bzero(&person, sizeof person);
    if (!error) {
        *n_hits = n_found;
    }
    return error;
}

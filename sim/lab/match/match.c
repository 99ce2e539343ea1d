#include "sim/lab/match/match.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/wipe.h"
#include "core/match/search.h"
#include "sim/lab/match/latency.h"
#include "sim/lab/match/parallel.h"

struct matching {
    struct sim_acquisition *acquisition;
    const struct sim_gallery *gallery;
    const struct sim_scoring *scoring;
    struct iso_metric_vector *enrolled; /* [n_people], with a metric */
    struct iso_metric_vector *indexed;  /* [n_people]: by the shipped metric, with a site */
    double *rank; /* [threads][n_people]: scores by which candidates are chosen */
    struct sim_matches *matches;
    struct iso_rerank_workspace *rerank;    /* of each thread */
    struct iso_icp_workspace *registration; /* of each thread */
};

/* Sets the distance to the nearest template of every person. */
static int measure_distances(const struct matching *work, int worker,
                             const struct iso_template *probe, double *distance_mm)
{
    const struct sim_gallery *gallery = work->gallery;
    for (size_t i = 0; i < gallery->n_templates; i++) {
        double d;
        const int error = iso_match_distance(&work->registration[worker], probe,
                                             gallery->templates[i], &work->scoring->match, &d);
        if (error == -ENODATA) {
            continue; /* too few common points: the distance stays infinite */
        }
        if (error) {
            return error;
        }
        double *nearest = &distance_mm[gallery->person[i]];
        *nearest = fmin(*nearest, d);
    }
    return 0;
}

/* Computes the vectors of the people by a metric, each from all of that person's templates. NULL:
 * none. */
static int enrol_vectors(const struct sim_gallery *gallery, const struct iso_metric *metric,
                         struct iso_metric_vector *enrolled)
{
    for (size_t i = 0; metric && i < gallery->n_templates; i++) {
        struct iso_metric_vector one;
        const int error = iso_metric_project(metric, gallery->templates[i], &one);
        if (error && error != -ENODATA) {
            return error;
        }
        if (!error) {
            iso_metric_vector_add(metric, &one, &enrolled[gallery->person[i]]);
        }
    }
    return 0;
}

/* A probe that cannot be scored counts as not acquired. */
static int give_up(struct sim_sample *sample, int error)
{
    if (error == -ENODATA) {
        sample->acquired = false;
        sample->reason = ISO_CAPTURE_TOO_FEW_POINTS;
        return 0;
    }
    return error;
}

/* Writes the best people by score, best first, and returns their number. */
static int shortlist_people(const double *score, size_t n_people,
                            struct iso_search_hit best[ISO_RERANK_CANDIDATES])
{
    int n = 0;
    for (size_t p = 0; p < n_people; p++) {
        if (!(score[p] > -INFINITY) ||
            (n == ISO_RERANK_CANDIDATES && !(best[n - 1].score < score[p]))) {
            continue;
        }
        int i = n < ISO_RERANK_CANDIDATES ? n++ : n - 1;
        for (; i > 0 && best[i - 1].score < score[p]; i--) {
            best[i] = best[i - 1];
        }
        best[i] = (struct iso_search_hit){.person = (int64_t)p, .score = score[p]};
    }
    return n;
}

/* The fused score of one person. */
static double look_again(const struct matching *work, int worker, const struct iso_template *probe,
                         size_t person, int place, double metric_score)
{
    enum { TEMPLATES_MAX = 64 };
    const struct sim_gallery *gallery = work->gallery;
    const struct iso_upper_face *of_person[TEMPLATES_MAX];
    int n = 0;
    for (size_t i = 0; i < gallery->n_templates && n < TEMPLATES_MAX; i++) {
        if (gallery->person[i] == person) {
            of_person[n++] = &gallery->templates[i]->upper;
        }
    }
    return iso_rerank(&work->rerank[worker], work->scoring->metric, &probe->upper, of_person, n,
                      place, metric_score);
}

/* Reranks the people whose `rank` is highest. Like the daemon, it first sorts them by their scores,
 * because the reranking registers two templates only for the best of them. */
static void rerank_scores(const struct matching *work, int worker, const struct iso_template *probe,
                          const double *rank, double *score)
{
    struct iso_search_hit best[ISO_RERANK_CANDIDATES];
    const int n = shortlist_people(rank, work->gallery->n_people, best);
    double least = INFINITY;
    for (int i = 0; i < n; i++) {
        best[i].score = score[best[i].person];
    }
    iso_search_sort(best, (size_t)n);
    for (int i = 0; i < n; i++) {
        best[i].score = look_again(work, worker, probe, (size_t)best[i].person, i, best[i].score);
        least = fmin(least, best[i].score);
    }
    for (size_t p = 0; p < work->gallery->n_people; p++) {
        score[p] = fmin(score[p], least);
    }
    for (int i = 0; i < n; i++) {
        score[best[i].person] = best[i].score;
    }
}

/* Scores the people by the shipped metric, for the choice of candidates. */
static int rank_people(const struct matching *work, const struct iso_template *tmpl, double *rank)
{
    const struct iso_metric *shipped = work->scoring->shipped;
    struct iso_metric_vector probe;
    const int error = iso_metric_project(shipped, tmpl, &probe);
    for (size_t p = 0; !error && p < work->gallery->n_people; p++) {
        rank[p] = iso_metric_score(shipped, &work->indexed[p], &probe);
    }
    return error;
}

static int search_by_metric(const struct matching *work, int worker, struct sim_sample *sample,
                            double *distance_mm, double *score)
{
    const struct iso_metric *metric = work->scoring->metric;
    const struct iso_site_metric *site = work->scoring->site;
    double *rank = site ? &work->rank[(size_t)worker * work->gallery->n_people] : score;
    struct iso_metric_vector probe;
    int error = iso_metric_project(metric, &sample->tmpl, &probe);
    for (size_t p = 0; !error && p < work->gallery->n_people; p++) {
        score[p] = site ? iso_site_score(site, (int64_t)p, &work->enrolled[p], &probe)
                        : iso_metric_score(metric, &work->enrolled[p], &probe);
        distance_mm[p] = NAN;
    }
    if (!error && site) {
        error = rank_people(work, &sample->tmpl, rank);
    }
    if (!error && work->scoring->rerank) {
        rerank_scores(work, worker, &sample->tmpl, rank, score);
    }
    return error ? give_up(sample, error) : 0;
}

static int search_sample(const struct matching *work, int worker, struct sim_sample *sample,
                         double *distance_mm, double *score)
{
    const struct iso_cohort *cohort = work->scoring->cohort;
    struct iso_cohort_norm norm = {0};
    if (cohort) {
        int error = iso_cohort_normalise(&work->registration[worker], cohort, &sample->tmpl,
                                         &work->scoring->match, &norm);
        if (error) {
            return give_up(sample, error);
        }
    }
    const int error = measure_distances(work, worker, &sample->tmpl, distance_mm);
    for (size_t p = 0; !error && p < work->gallery->n_people; p++) {
        score[p] = cohort ? iso_cohort_score(norm, distance_mm[p]) : -distance_mm[p];
    }
    return error;
}

static int match_probe(void *context, int worker, size_t probe)
{
    const struct matching *work = context;
    struct sim_matches *m = work->matches;
    double *distance_mm = m->distance_mm + probe * m->n_people;
    double *score = m->score + probe * m->n_people;
    struct sim_sample *sample = &work->acquisition->samples[m->sample[probe]];
    const bool *wanted = work->scoring->wanted;
    if (!sample->acquired || (wanted && !wanted[m->sample[probe]])) {
        return 0;
    }
    const int64_t wall_ns = sim_wall_ns(NULL), cpu_ns = sim_thread_cpu_ns(NULL);
    const int error = work->scoring->metric
                          ? search_by_metric(work, worker, sample, distance_mm, score)
                          : search_sample(work, worker, sample, distance_mm, score);
    m->cpu_ns[probe] = sim_thread_cpu_ns(NULL) - cpu_ns;
    m->wall_ns[probe] = sim_wall_ns(NULL) - wall_ns;
    return error;
}

int sim_matches_new(const struct sim_corpus *corpus, const struct sim_acquisition *acquisition,
                    size_t n_people, struct sim_matches **out)
{
    const size_t n_samples = acquisition->n_samples;
    struct sim_matches *m = calloc(1, sizeof *m);
    if (!m) {
        return -ENOMEM;
    }
    m->n_people = n_people;
    m->sample = calloc(n_samples, sizeof *m->sample);
    m->distance_mm = calloc(n_samples * n_people + 1, sizeof *m->distance_mm);
    m->score = calloc(n_samples * n_people + 1, sizeof *m->score);
    m->wall_ns = calloc(n_samples, sizeof *m->wall_ns);
    m->cpu_ns = calloc(n_samples, sizeof *m->cpu_ns);
    if (!m->sample || !m->distance_mm || !m->score || !m->wall_ns || !m->cpu_ns) {
        sim_matches_free(m);
        return -ENOMEM;
    }
    for (size_t i = 0; i < n_samples; i++) {
        if (corpus->rows[acquisition->samples[i].row].role != SIM_ROLE_GALLERY) {
            m->sample[m->n_probes++] = i;
        }
    }
    for (size_t i = 0; i < m->n_probes * n_people; i++) {
        m->distance_mm[i] = INFINITY;
        m->score[i] = -INFINITY;
    }
    *out = m;
    return 0;
}

static int reserve_memory(struct matching *work, int threads)
{
    const size_t n = work->gallery->n_people;
    work->enrolled = calloc(n + 1, sizeof *work->enrolled);
    work->indexed = calloc(n + 1, sizeof *work->indexed);
    work->rank = calloc((size_t)threads * n + 1, sizeof *work->rank);
    work->rerank = calloc((size_t)threads, sizeof *work->rerank);
    work->registration = calloc((size_t)threads, sizeof *work->registration);
    return work->enrolled && work->indexed && work->rank && work->rerank && work->registration
               ? 0
               : -ENOMEM;
}

static void free_memory(const struct matching *work)
{
    iso_wipe_free(work->enrolled);
    iso_wipe_free(work->indexed);
    free(work->rank);
    free(work->rerank);
    free(work->registration);
}

int sim_match(const struct sim_corpus *corpus, struct sim_acquisition *acquisition,
              const struct sim_gallery *gallery, const struct sim_scoring *scoring, int threads,
              struct sim_matches **out)
{
    struct sim_matches *m = NULL;
    int error = sim_matches_new(corpus, acquisition, gallery->n_people, &m);
    if (error) {
        return error;
    }
    struct matching work = {
        .acquisition = acquisition, .gallery = gallery, .scoring = scoring, .matches = m};
    error = reserve_memory(&work, threads);
    if (!error) {
        error = enrol_vectors(gallery, scoring->metric, work.enrolled);
    }
    if (!error && scoring->site) {
        error = enrol_vectors(gallery, scoring->shipped, work.indexed);
    }
    if (!error) {
        error = sim_parallel(threads, "searching", m->n_probes, match_probe, &work);
    }
    free_memory(&work);
    if (error) {
        sim_matches_free(m);
        return error;
    }
    *out = m;
    return 0;
}

bool sim_matches_find_nan(const struct sim_matches *matches, size_t *probe, size_t *person)
{
    for (size_t i = 0; i < matches->n_probes * matches->n_people; i++) {
        if (isnan(matches->score[i]) ||
            (matches->stranger_score && isnan(matches->stranger_score[i]))) {
            *probe = i / matches->n_people;
            *person = i % matches->n_people;
            return true;
        }
    }
    return false;
}

void sim_matches_free(struct sim_matches *m)
{
    if (m) {
        free(m->sample);
        free(m->distance_mm);
        free(m->score);
        free(m->stranger_score);
        free(m->wall_ns);
        free(m->cpu_ns);
        free(m);
    }
}

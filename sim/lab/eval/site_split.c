#include "sim/lab/eval/site_split.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/match/site.h"
#include "sim/base/random.h"
#include "sim/lab/eval/site_rates.h"

struct splitting {
    const struct sim_corpus *corpus;
    struct sim_acquisition *acquisition;
    const struct sim_gallery *gallery;
    const struct sim_scoring *scoring;
    int threads;
    size_t *person;                     /* [n_samples]: place in the gallery, or SIM_NOBODY */
    struct iso_metric_vector *vector;   /* [n_samples]: by the shipped metric; n of 0: none */
    struct iso_metric_vector *captures; /* [n_samples]: those of one person */
    bool *learned;                      /* [n_people] */
    struct sim_scores scores;           /* pooled */
    size_t capacity;                    /* of both arrays of scores */
    struct sim_site_split *out;
};

/* ---- learning ---- */

static int project_samples(const struct splitting *s)
{
    for (size_t i = 0; i < s->acquisition->n_samples; i++) {
        const struct sim_sample *sample = &s->acquisition->samples[i];
        const char *subject = s->corpus->rows[sample->row].subject;
        s->person[i] = sim_gallery_find(s->gallery, subject);
        if (s->person[i] == SIM_NOBODY || !sample->acquired) {
            continue;
        }
        const int error = iso_metric_project(s->scoring->metric, &sample->tmpl, &s->vector[i]);
        if (error && error != -ENODATA) {
            return error;
        }
    }
    return 0;
}

static int pass_people(const struct splitting *s, bool second, struct iso_site *site)
{
    int error = 0;
    for (size_t p = 0; p < s->gallery->n_people && !error; p++) {
        int n = 0;
        for (size_t i = 0; s->learned[p] && i < s->acquisition->n_samples; i++) {
            if (s->person[i] == p && s->vector[i].n > 0) {
                s->captures[n++] = s->vector[i];
            }
        }
        if (n > 0) {
            error = second ? iso_site_review(site, s->captures, n)
                           : iso_site_add(site, (int64_t)p, s->captures, n);
        }
    }
    return error;
}

static int teach_site(const struct splitting *s, struct iso_site *site)
{
    int error = pass_people(s, false, site);
    if (!error) {
        error = iso_site_find_directions(site);
    }
    return error ? error : pass_people(s, true, site);
}

static int learn_metric(const struct splitting *s, struct iso_site_metric *out)
{
    struct iso_site *site = NULL;
    int error = iso_site_new(s->scoring->metric, &site);
    if (!error) {
        error = teach_site(s, site);
    }
    if (!error) {
        error = iso_site_adapt(site, s->scoring->metric, out);
    }
    if (!error) {
        const struct iso_site_summary summary = iso_site_summary(site);
        s->out->offset += summary.offset;
        s->out->expected += summary.expected;
        s->out->growth += summary.growth;
        s->out->share += summary.share;
    }
    iso_site_free(site);
    return error;
}

/* ---- judging ---- */

static int reserve_scores(struct splitting *s, size_t more)
{
    const size_t used = s->scores.n_mated > s->scores.n_non_mated ? s->scores.n_mated
                                                                  : s->scores.n_non_mated;
    if (used + more <= s->capacity) {
        return 0;
    }
    const size_t room = 2 * (used + more);
    struct sim_score *mated = realloc(s->scores.mated, room * sizeof *mated);
    s->scores.mated = mated ? mated : s->scores.mated;
    struct sim_score *non_mated = realloc(s->scores.non_mated, room * sizeof *non_mated);
    s->scores.non_mated = non_mated ? non_mated : s->scores.non_mated;
    if (!mated || !non_mated) {
        return -ENOMEM;
    }
    s->capacity = room;
    return 0;
}

/* Adds the comparisons of one search to the pool. */
static void pool_search(struct splitting *s, const struct sim_gallery *judged, const double *score,
                        size_t person)
{
    const size_t mate = sim_gallery_find(judged, s->gallery->names[person]);
    double best = -INFINITY;
    for (size_t p = 0; p < judged->n_people; p++) {
        const struct sim_score one = {score[p], (uint32_t)person};
        if (judged->n_templates_of[p] == 0) {
            continue;
        }
        if (p == mate) {
            s->scores.mated[s->scores.n_mated++] = one;
        } else {
            s->scores.non_mated[s->scores.n_non_mated++] = one;
            best = fmax(best, one.score);
        }
    }
    s->out->rank_1.trials++;
    s->out->rank_1.events += score[mate] > best;
}

static int pool_matches(struct splitting *s, const struct sim_gallery *judged,
                        const struct sim_matches *m)
{
    for (size_t i = 0; i < m->n_probes; i++) {
        const size_t sample = m->sample[i], person = s->person[sample];
        if (person == SIM_NOBODY || s->learned[person] || s->gallery->n_templates_of[person] == 0 ||
            !s->acquisition->samples[sample].acquired) {
            continue;
        }
        const int error = reserve_scores(s, judged->n_people);
        if (error) {
            return error;
        }
        pool_search(s, judged, &m->score[i * m->n_people], person);
    }
    return 0;
}

/* Learns from the people that are marked, and judges the others. */
static int judge_others(struct splitting *s, bool *others)
{
    struct iso_site_metric adapted = {.n = 0};
    struct sim_gallery *judged = NULL;
    struct sim_matches *matches = NULL;
    struct sim_scoring scoring = *s->scoring;
    for (size_t p = 0; p < s->gallery->n_people; p++) {
        others[p] = !s->learned[p];
    }
    int error = learn_metric(s, &adapted);
    if (!error) {
        scoring.metric = adapted.metric;
        error = sim_gallery_part(s->gallery, others, &judged);
    }
    if (!error) {
        error = sim_match(s->corpus, s->acquisition, judged, &scoring, s->threads, &matches);
    }
    if (!error) {
        error = pool_matches(s, judged, matches);
    }
    s->out->splits++;
    sim_matches_free(matches);
    sim_gallery_free(judged);
    iso_site_metric_free(&adapted);
    return error;
}

static int judge_both_ways(struct splitting *s, bool *others)
{
    int error = judge_others(s, others);
    for (size_t p = 0; p < s->gallery->n_people; p++) {
        s->learned[p] = !s->learned[p];
    }
    return error ? error : judge_others(s, others);
}

/* ---- the splits ---- */

/* n over k, or a number above the limit. */
static size_t count_choices(size_t n, size_t k)
{
    size_t c = 1;
    for (size_t i = 1; i <= k && c <= SIM_SITE_SPLITS; i++) {
        c = c * (n - k + i) / i;
    }
    return c;
}

/* Marks the next k of n places after `place` [k], which rises; false after the last one. */
static bool next_choice(size_t *place, size_t n, size_t k)
{
    size_t i = k;
    while (i > 0 && place[i - 1] == n - k + i - 1) {
        i--;
    }
    if (i == 0) {
        return false;
    }
    place[i - 1]++;
    for (; i < k; i++) {
        place[i] = place[i - 1] + 1;
    }
    return true;
}

static void draw_choice(struct sim_random *random, size_t *place, size_t n, size_t k)
{
    size_t taken = 0;
    for (size_t p = 0; p < n && taken < k; p++) {
        if (sim_random_below(random, (uint32_t)(n - p)) < k - taken) {
            place[taken++] = p;
        }
    }
}

static int run_splits(struct splitting *s, size_t *place, bool *others)
{
    const size_t n = s->gallery->n_people, k = n / 2;
    const bool all = count_choices(n, k) <= SIM_SITE_SPLITS;
    struct sim_random random = sim_random_seeded(1, sim_random_hash("site split"), 0);
    int error = 0;
    for (size_t i = 0; i < k; i++) {
        place[i] = i;
    }
    for (int split = 0; split < SIM_SITE_SPLITS && !error; split++) {
        if (!all) {
            draw_choice(&random, place, n, k);
        }
        memset(s->learned, 0, n * sizeof *s->learned);
        for (size_t i = 0; i < k; i++) {
            s->learned[place[i]] = true;
        }
        error = judge_both_ways(s, others);
        if (all && !next_choice(place, n, k)) {
            break;
        }
    }
    return error;
}

/* ---- the result ---- */

static void count_refused(const struct splitting *s)
{
    for (size_t i = 0; i < s->acquisition->n_samples; i++) {
        const struct sim_sample *sample = &s->acquisition->samples[i];
        if (s->corpus->rows[sample->row].role != SIM_ROLE_GALLERY && s->person[i] != SIM_NOBODY) {
            s->out->refused.trials++;
            s->out->refused.events += !sample->acquired;
        }
    }
}

static int summarise_splits(struct splitting *s)
{
    const double splits = (double)s->out->splits;
    s->out->offset /= splits;
    s->out->expected /= splits;
    s->out->growth /= splits;
    s->out->share /= splits;
    count_refused(s);
    const size_t searches = s->out->refused.trials - s->out->refused.events;
    const int error = sim_site_rates(&s->scores, (uint32_t)s->gallery->n_people, s->out);
    return error ? error
                 : sim_calibration_of(&s->scores, (uint32_t)s->gallery->n_people,
                                      (double)(searches * (s->gallery->n_people - 1)),
                                      &s->out->calibration);
}

int sim_site_split(const struct sim_corpus *corpus, struct sim_acquisition *acquisition,
                   const struct sim_gallery *gallery, const struct sim_scoring *scoring,
                   int threads, struct sim_site_split *out)
{
    enum { PEOPLE_MIN = 4 };
    const size_t people = gallery->n_people, samples = acquisition->n_samples;
    struct splitting s = {.corpus = corpus,
                          .acquisition = acquisition,
                          .gallery = gallery,
                          .scoring = scoring,
                          .threads = threads,
                          .out = out};
    *out = (struct sim_site_split){.people = people, .learned = people / 2};
    if (people < PEOPLE_MIN) {
        return -EINVAL;
    }
    size_t *place = calloc(people, sizeof *place);
    bool *others = calloc(people, sizeof *others);
    s.learned = calloc(people, sizeof *s.learned);
    s.person = calloc(samples, sizeof *s.person);
    s.vector = calloc(samples, sizeof *s.vector);
    s.captures = calloc(samples, sizeof *s.captures);
    const bool room = place && others && s.learned && s.person && s.vector && s.captures;
    int error = room ? project_samples(&s) : -ENOMEM;
    if (!error) {
        error = run_splits(&s, place, others);
    }
    if (!error) {
        error = summarise_splits(&s);
    }
    free(place);
    free(others);
    free(s.learned);
    free(s.person);
    free(s.vector);
    free(s.captures);
    free(s.scores.mated);
    free(s.scores.non_mated);
    return error;
}

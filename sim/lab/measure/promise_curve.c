#include "sim/lab/measure/promise_curve.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "sim/base/random.h"
#include "sim/base/spread.h"

enum { RESAMPLES = 1000 };

/* Counts of non-mated comparisons, and room for resampling. */
struct counting {
    uint32_t n_people;
    uint32_t *n;      /* [n_people]: of each person */
    uint32_t *reach;  /* [SIM_PROMISE_POINTS][n_people]: of these, those that reach the score */
    uint32_t *copies; /* [n_people]: how often a person was drawn */
    double *rate;     /* [SIM_PROMISE_POINTS][RESAMPLES] */
};

/* The number of points whose score is at most `score`. */
static int points_reached(double score)
{
    int n = 0;
    while (n < SIM_PROMISE_POINTS && (double)n / SIM_PROMISE_STEPS <= score) {
        n++;
    }
    return n;
}

static void count(const struct sim_scores *scores, struct counting *c)
{
    for (size_t i = 0; i < scores->n_non_mated; i++) {
        const struct sim_score *one = &scores->non_mated[i];
        const int n = points_reached(one->score);
        c->n[one->person]++;
        for (int k = 0; k < n; k++) {
            c->reach[(size_t)k * c->n_people + one->person]++;
        }
    }
}

/* The rate at one point if each person counts copies[person] times. NaN without comparisons. */
static double rate_at(const struct counting *c, int point)
{
    const uint32_t *reach = &c->reach[(size_t)point * c->n_people];
    double events = 0.0, trials = 0.0;
    for (uint32_t p = 0; p < c->n_people; p++) {
        events += (double)c->copies[p] * reach[p];
        trials += (double)c->copies[p] * c->n[p];
    }
    return trials > 0.0 ? events / trials : NAN;
}

static void draw_people(struct sim_random *random, struct counting *c)
{
    for (uint32_t p = 0; p < c->n_people; p++) {
        c->copies[p] = 0;
    }
    for (uint32_t p = 0; p < c->n_people; p++) {
        c->copies[sim_random_below(random, c->n_people)]++;
    }
}

/* Returns the number of resamples with comparisons. */
static size_t resample(struct counting *c)
{
    struct sim_random random = sim_random_seeded(1, sim_random_hash("promise curve"), 0);
    size_t n = 0;
    for (int r = 0; r < RESAMPLES; r++) {
        draw_people(&random, c);
        for (int k = 0; k < SIM_PROMISE_POINTS; k++) {
            c->rate[(size_t)k * RESAMPLES + n] = rate_at(c, k);
        }
        n += isnan(c->rate[n]) ? 0 : 1;
    }
    return n;
}

static struct sim_interval interval_of(double *rates, size_t n, double rate, double distinct)
{
    if (n == 0 || isnan(rate)) {
        return (struct sim_interval){0.0, 1.0};
    }
    const struct sim_interval counts = sim_rate_interval(
        (struct sim_rate){(size_t)lround(rate * distinct), (size_t)lround(distinct)});
    sim_sort(rates, n);
    return (struct sim_interval){fmin(rates[n * 25 / 1000], counts.low),
                                 fmax(rates[n * 975 / 1000], counts.high)};
}

static void measure(const struct sim_scores *scores, double distinct, struct counting *c,
                    struct sim_promise_point out[SIM_PROMISE_POINTS])
{
    count(scores, c);
    for (uint32_t p = 0; p < c->n_people; p++) {
        c->copies[p] = 1;
    }
    for (int k = 0; k < SIM_PROMISE_POINTS; k++) {
        const double score = (double)k / SIM_PROMISE_STEPS;
        out[k] = (struct sim_promise_point){
            .score = score, .promised = pow(10.0, -score), .fmr = rate_at(c, k)};
    }
    const size_t n = resample(c);
    for (int k = 0; k < SIM_PROMISE_POINTS; k++) {
        out[k].interval = interval_of(&c->rate[(size_t)k * RESAMPLES], n, out[k].fmr, distinct);
    }
}

int sim_promise_curve_of(const struct sim_scores *scores, uint32_t n_people, double distinct,
                         struct sim_promise_point out[SIM_PROMISE_POINTS])
{
    struct counting c = {.n_people = n_people};
    c.n = calloc(n_people + 1, sizeof *c.n);
    c.copies = calloc(n_people + 1, sizeof *c.copies);
    c.reach = calloc((size_t)SIM_PROMISE_POINTS * n_people + 1, sizeof *c.reach);
    c.rate = calloc((size_t)SIM_PROMISE_POINTS * RESAMPLES, sizeof *c.rate);
    const int error = c.n && c.copies && c.reach && c.rate ? 0 : -ENOMEM;
    if (!error) {
        measure(scores, distinct, &c, out);
    }
    free(c.n);
    free(c.copies);
    free(c.reach);
    free(c.rate);
    return error;
}

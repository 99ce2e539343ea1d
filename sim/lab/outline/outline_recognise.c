/* The recogniser. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "sim/lab/outline/outline_study.h"

enum { FEATURES = sizeof(struct sim_outline_features) / sizeof(float) };

static const float *values(const struct sim_outline_sample *sample)
{
    return &sample->features.window[0][0];
}

static size_t count_people(const struct sim_outline_sample *samples, size_t n)
{
    size_t most = 0;
    for (size_t i = 0; i < n; i++) {
        most = samples[i].subject + 1 > most ? samples[i].subject + 1 : most;
    }
    return most;
}

/* The mean squared difference of a feature between frames of the same person, plus a little, so
 * that a feature that never differs does not decide alone. */
static void spreads_within(const struct sim_outline_sample *samples, size_t n, double *spread)
{
    for (size_t k = 0; k < FEATURES; k++) {
        double sum = 0.0;
        double pairs = 0.0;
        for (size_t i = 1; i < n; i++) {
            if (samples[i].subject == samples[i - 1].subject) {
                const double d = (double)(values(&samples[i])[k] - values(&samples[i - 1])[k]);
                sum += d * d;
                pairs += 1.0;
            }
        }
        spread[k] = sum / fmax(1.0, pairs) +
                    (k < SIM_OUTLINE_ROWS * SIM_OUTLINE_COLUMNS ? 0.02 : 1e-6);
    }
}

static size_t nearest(const struct sim_outline_sample *gallery, size_t n, const double *spread,
                      const struct sim_outline_sample *probe)
{
    size_t best = 0;
    double least = INFINITY;
    for (size_t i = 0; i < n; i++) {
        double distance = 0.0;
        for (size_t k = 0; k < FEATURES && distance < least; k++) {
            const double d = (double)(values(&gallery[i])[k] - values(probe)[k]);
            distance += d * d / spread[k];
        }
        if (distance < least) {
            least = distance;
            best = i;
        }
    }
    return gallery[best].subject;
}

/* The mean over people and its interval. `right` and `tried` are per person. */
static void rate_over_people(const double *right, const double *tried, size_t people,
                             struct sim_outline_result *out)
{
    double n = 0.0;
    double sum = 0.0;
    double squares = 0.0;
    for (size_t i = 0; i < people; i++) {
        if (tried[i] > 0.0) {
            const double rate = right[i] / tried[i];
            n += 1.0;
            sum += rate;
            squares += rate * rate;
        }
    }
    out->rate = sum / n;
    const double variance = fmax(0.0, (squares - sum * sum / n) / fmax(1.0, n - 1.0));
    const double half = 2.05 * sqrt(variance / n); /* t of some 30 people */
    out->interval = (struct iso_interval){fmax(0.0, out->rate - half), out->rate + half};
}

int sim_outline_recognise(const struct sim_outline_sample *gallery, size_t n_gallery,
                          const struct sim_outline_sample *probes, size_t n_probes,
                          struct sim_outline_result *out)
{
    const size_t people = count_people(gallery, n_gallery);
    *out = (struct sim_outline_result){.people = people, .learned = n_gallery, .probes = n_probes};
    if (people < 2 || n_probes == 0) {
        return -EINVAL;
    }
    double *spread = calloc(FEATURES + 2 * people, sizeof *spread);
    if (!spread) {
        return -ENOMEM;
    }
    double *right = spread + FEATURES;
    double *tried = right + people;
    spreads_within(gallery, n_gallery, spread);
    for (size_t i = 0; i < n_probes; i++) {
        const size_t subject = probes[i].subject;
        if (subject < people) {
            const bool is_right = nearest(gallery, n_gallery, spread, &probes[i]) == subject;
            out->right += is_right;
            right[subject] += is_right;
            tried[subject] += 1.0;
        }
    }
    rate_over_people(right, tried, people, out);
    free(spread);
    return 0;
}

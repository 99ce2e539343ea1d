#include "core/shape/describe/vocabulary.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS_MAX = 40 };

/* Soft assignment: exp(-d^2 / (2 sigma^2)), where sigma^2 is `softness` times the spread. */
static const double softness = 1.0;

/* Numbers in 0..1 (MMIX's linear congruential generator). */
static double next_random(uint64_t *state)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) / 9007199254740992.0;
}

static float square_distance(const float *a, const float *b, int32_t n)
{
    float sum = 0.0f;
    for (int32_t i = 0; i < n; i++) {
        sum += (a[i] - b[i]) * (a[i] - b[i]);
    }
    return sum;
}

/* Chooses first words that are far from each other: each row is drawn with a probability
 * proportional to the square of its distance from those drawn before (k-means++). */
static void start_words(const float *row, int32_t n, uint64_t seed, float *nearest,
                        struct iso_vocabulary *v)
{
    const size_t size = (size_t)v->n_values;
    uint64_t state = seed * 2862933555777941757u + 3037000493u;
    int32_t drawn = (int32_t)(next_random(&state) * n);
    for (int32_t i = 0; i < n; i++) {
        nearest[i] = INFINITY;
    }
    for (int32_t w = 0; w < v->n_words; w++) {
        const float *word = memcpy(&v->word[(size_t)w * size], &row[(size_t)drawn * size],
                                   size * sizeof *row);
        double sum = 0.0;
        for (int32_t i = 0; i < n; i++) {
            nearest[i] = fminf(nearest[i],
                               square_distance(&row[(size_t)i * size], word, v->n_values));
            sum += (double)nearest[i];
        }
        double left = next_random(&state) * sum;
        for (drawn = 0; drawn < n - 1 && left > (double)nearest[drawn]; drawn++) {
            left -= (double)nearest[drawn];
        }
    }
}

static int32_t nearest_word(const struct iso_vocabulary *v, const float *row, float *distance)
{
    int32_t best = 0;
    *distance = INFINITY;
    for (int32_t w = 0; w < v->n_words; w++) {
        const float d = square_distance(row, &v->word[(size_t)w * (size_t)v->n_values],
                                        v->n_values);
        if (d < *distance) {
            *distance = d;
            best = w;
        }
    }
    return best;
}

/* Moves each word to the mean of the rows that are nearest to it. Returns how many rows changed
 * their word. */
static int32_t improve_words(const float *row, int32_t n, int32_t *word_of, double *sum,
                             int32_t *count, struct iso_vocabulary *v)
{
    const size_t size = (size_t)v->n_values;
    int32_t changed = 0;
    memset(sum, 0, (size_t)v->n_words * size * sizeof *sum);
    memset(count, 0, (size_t)v->n_words * sizeof *count);
    v->spread = 0.0;
    for (int32_t i = 0; i < n; i++) {
        float distance;
        const int32_t w = nearest_word(v, &row[(size_t)i * size], &distance);
        changed += w != word_of[i];
        word_of[i] = w;
        v->spread += (double)distance / n;
        count[w]++;
        for (size_t k = 0; k < size; k++) {
            sum[(size_t)w * size + k] += (double)row[(size_t)i * size + k];
        }
    }
    for (int32_t w = 0; w < v->n_words; w++) {
        for (size_t k = 0; count[w] > 0 && k < size; k++) {
            v->word[(size_t)w * size + k] = (float)(sum[(size_t)w * size + k] / count[w]);
        }
    }
    return changed;
}

int iso_vocabulary_init(const float *row, int32_t n, int32_t n_values, int32_t n_words,
                        uint64_t seed, struct iso_vocabulary *out)
{
    if (n < 1 || n_values < 1 || n_words < 1 || n_words > ISO_WORDS_MAX) {
        return -EINVAL;
    }
    struct iso_vocabulary v = {.n_words = n_words, .n_values = n_values};
    const size_t cells = (size_t)n_words * (size_t)n_values;
    v.word = calloc(cells, sizeof *v.word);
    float *nearest = calloc((size_t)n, sizeof *nearest);
    int32_t *word_of = calloc((size_t)n, sizeof *word_of),
            *count = calloc((size_t)n_words, sizeof *count);
    double *sum = calloc(cells, sizeof *sum);
    const int error = v.word && nearest && word_of && count && sum ? 0 : -ENOMEM;
    if (!error) {
        start_words(row, n, seed, nearest, &v);
        memset(word_of, 0xff, (size_t)n * sizeof *word_of);
        for (int round = 0; round < ROUNDS_MAX; round++) {
            if (improve_words(row, n, word_of, sum, count, &v) == 0) {
                break;
            }
        }
        *out = v;
    } else {
        iso_vocabulary_done(&v);
    }
    free(nearest);
    free(word_of);
    free(count);
    free(sum);
    return error;
}

void iso_vocabulary_done(struct iso_vocabulary *vocabulary)
{
    free(vocabulary->word);
    *vocabulary = (struct iso_vocabulary){0};
}

void iso_vocabulary_count(const struct iso_vocabulary *v, const float *row, const float *weight,
                          int32_t n, float *bag)
{
    const float scale = (float)(-0.5 / fmax(softness * v->spread, 1e-30));
    for (int32_t i = 0; i < n; i++) {
        const float *r = &row[(size_t)i * (size_t)v->n_values];
        float nearest, sum = 0.0f, share[ISO_WORDS_MAX];
        nearest_word(v, r, &nearest);
        for (int32_t w = 0; w < v->n_words; w++) {
            const float *word = &v->word[(size_t)w * (size_t)v->n_values];
            share[w] = expf(scale * (square_distance(r, word, v->n_values) - nearest));
            sum += share[w];
        }
        for (int32_t w = 0; w < v->n_words; w++) {
            bag[w] += weight[i] * share[w] / sum;
        }
    }
}

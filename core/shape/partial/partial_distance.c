#include "core/shape/partial/partial_distance.h"

#include <cblas.h>
#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "core/shape/partial/local_heat.h"

enum {
    COARSE = ISO_LOCAL_COARSE,
    POINTS = ISO_LOCAL_POINTS,
    /* Seven times are compared, from 2^-8 to 2^-3.2 of the whole area in steps of 2^0.8. */
    TIMES = 7,
    EVERY = 4,
    ITEM_START = 1, /* among the times of a shape that is taken as whole */
    /* The query's area is 2^-0.2, 2^0, 2^0.2 ... 2^0.8 times smaller than the whole. The first one
     * is for queries whose area is too large, since they are rough. */
    AREAS = 6,
    /* d^2 = sum w (f - x)^2 / sum w = constant + other . query; these vectors have two halves each:
     * -2 x and x^2, w f / sum w and w / sum w. */
    HALVES = 2 * TIMES,
};

/* Times of which nothing is known count this much, so that points on the boundary count as well. */
static const double weight_least = 1e-3;

/* The bound of what a point adds to the mean: a difference of this size counts as half of it. It
 * has no unit, because differences are those of a logarithm of heat times area, which is the same
 * at every scale. Chosen on generated shapes (sim/results/shapes.md). */
static const double difference_most = 0.2;

struct iso_partial_query {
    float query[AREAS][HALVES][COARSE];
    float constant[AREAS][COARSE];
    float weight[AREAS][COARSE]; /* of the points, sum 1 */
    /* Working memory. A row has the points of the query, so that many minima are found at once. */
    float other[POINTS][HALVES];
    float square[POINTS][COARSE];
    float least[COARSE];
};

static double area_of(int a)
{
    return exp2(ISO_LOCAL_STEP * (a - ITEM_START));
}

static void prepare_point(struct iso_partial_query *q, int a, int p, const float *feature)
{
    const float *heat = &feature[2 * COARSE + ISO_LOCAL_TIMES * p];
    const double boundary = (double)feature[COARSE + p];
    double w[TIMES], sum = 0.0, constant = 0.0;
    for (int k = 0; k < TIMES; k++) {
        const double t = exp2(ISO_LOCAL_FIRST + (a + EVERY * k) * ISO_LOCAL_STEP);
        w[k] = weight_least - expm1(-boundary / (4.0 * t));
        sum += w[k];
    }
    for (int k = 0; k < TIMES; k++) {
        const double f = (double)heat[a + EVERY * k] + log(area_of(a));
        q->query[a][k][p] = (float)(w[k] / sum * f);
        q->query[a][TIMES + k][p] = (float)(w[k] / sum);
        constant += w[k] / sum * f * f;
    }
    q->constant[a][p] = (float)constant;
    q->weight[a][p] = (float)(sum / TIMES) * feature[p];
}

int iso_partial_query_new(const float *feature, struct iso_partial_query **out)
{
    struct iso_partial_query *q = calloc(1, sizeof *q);
    if (!q) {
        return -ENOMEM;
    }
    for (int a = 0; a < AREAS; a++) {
        float sum = 0.0f;
        for (int p = 0; p < COARSE; p++) {
            if (feature[p] > 0.0f) {
                prepare_point(q, a, p, feature);
                sum += q->weight[a][p];
            }
        }
        for (int p = 0; p < COARSE && sum > 0.0f; p++) {
            q->weight[a][p] /= sum;
        }
    }
    *out = q;
    return 0;
}

void iso_partial_query_free(struct iso_partial_query *query)
{
    free(query);
}

static void fill_other(struct iso_partial_query *q, const float *other)
{
    for (int p = 0; p < POINTS; p++) {
        const float *heat = &other[2 * COARSE + ISO_LOCAL_TIMES * p + ITEM_START];
        for (int k = 0; k < TIMES; k++) {
            const float x = heat[EVERY * k];
            q->other[p][k] = -2.0f * x;
            q->other[p][TIMES + k] = x * x;
        }
    }
}

/* The mean of the bounded differences of the query's points, as if its whole area were number `a`.
 */
static double mean_distance(struct iso_partial_query *q, int a)
{
    double mean = 0.0;
    cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, POINTS, COARSE, HALVES, 1.0f,
                q->other[0], HALVES, q->query[a][0], COARSE, 0.0f, q->square[0], COARSE);
    for (int p = 0; p < COARSE; p++) {
        q->least[p] = FLT_MAX;
    }
    for (int i = 0; i < POINTS; i++) {
        for (int p = 0; p < COARSE; p++) {
            q->least[p] = q->square[i][p] < q->least[p] ? q->square[i][p] : q->least[p];
        }
    }
    for (int p = 0; p < COARSE; p++) {
        const double square = (double)(q->least[p] + q->constant[a][p]);
        const double difference = sqrt(fmax(square, 0.0));
        mean += (double)q->weight[a][p] * difference / (1.0 + difference / difference_most);
    }
    return mean;
}

double iso_partial_distance(struct iso_partial_query *query, const float *other, double *area_ratio)
{
    double best = INFINITY, ratio = 1.0;
    fill_other(query, other);
    for (int a = 0; a < AREAS; a++) {
        const double mean = mean_distance(query, a);
        if (mean < best) {
            best = mean;
            ratio = area_of(a);
        }
    }
    if (area_ratio) {
        *area_ratio = ratio;
    }
    return best;
}

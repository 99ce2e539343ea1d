#include "sim/train/metric/rerank_learn.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim/train/metric/metric_learn.h"

/* Learns from the n comparisons that have both values. `sum` holds the metric's scores on entry,
 * and is changed. */
static int learn(double *sum, double *fit, size_t n, struct iso_rerank_weights *out)
{
    double *sorted = calloc(n + 1, sizeof *sorted);
    if (!sorted) {
        return -ENOMEM;
    }
    memcpy(sorted, fit, n * sizeof *fit);
    float fit_gain = 0.0f, fit_bias = 0.0f, gain = 0.0f, bias = 0.0f;
    int error = sim_metric_calibrate(sorted, n, &fit_gain, &fit_bias);
    free(sorted);
    for (size_t i = 0; i < n; i++) {
        sum[i] += (double)fit_gain * fit[i] + (double)fit_bias;
    }
    if (!error) {
        error = sim_metric_calibrate(sum, n, &gain, &bias);
    }
    if (!error) {
        *out = (struct iso_rerank_weights){
            .metric = gain,
            .upper = gain * fit_gain,
            .bias = gain * fit_bias + bias,
        };
    }
    return error;
}

int sim_rerank_learn(const struct sim_rerank_pairs *strangers, struct iso_rerank_weights *out)
{
    double *sum = calloc(strangers->n + 1, sizeof *sum);
    double *fit = calloc(strangers->n + 1, sizeof *fit);
    size_t n = 0;
    for (size_t i = 0; sum && fit && i < strangers->n; i++) {
        if (!isnan(strangers->fit[i])) {
            sum[n] = strangers->score[i];
            fit[n++] = strangers->fit[i];
        }
    }
    const int error = sum && fit ? learn(sum, fit, n, out) : -ENOMEM;
    free(sum);
    free(fit);
    return error;
}

#include "core/match/rerank.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "core/match/upper_surface.h"

int iso_rerank_misfit(const struct iso_upper_face *probe,
                      const struct iso_upper_face *const *person, int n, double *rms_mm)
{
    struct iso_upper_surface surface;
    double least_mm = INFINITY;
    for (int i = 0; i < n; i++) {
        struct iso_upper_fit fit;
        iso_upper_surface_of(person[i], &surface);
        if (iso_upper_fit(probe, &surface, &fit) == 0) {
            least_mm = fmin(least_mm, fit.rms_mm);
        }
    }
    explicit_bzero(&surface, sizeof surface);
    if (isinf(least_mm)) {
        return -ENODATA;
    }
    *rms_mm = fmax(least_mm, ISO_RERANK_RMS_MIN_MM);
    return 0;
}

double iso_rerank_fuse(const struct iso_rerank_weights *weights, double metric_score, double rms_mm)
{
    return (double)weights->metric * metric_score - (double)weights->upper * log(rms_mm) +
           (double)weights->bias;
}

double iso_rerank(const struct iso_metric *metric, const struct iso_upper_face *probe,
                  const struct iso_upper_face *const *person, int n, double metric_score)
{
    double rms_mm;
    if (!(metric->rerank.upper > 0.0f) || iso_rerank_misfit(probe, person, n, &rms_mm)) {
        return metric_score;
    }
    return iso_rerank_fuse(&metric->rerank, metric_score, rms_mm);
}

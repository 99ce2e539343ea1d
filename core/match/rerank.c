#include "core/match/rerank.h"

#include <errno.h>
#include <math.h>
#include <string.h>

int iso_rerank_misfit(struct iso_rerank_workspace *work, const struct iso_upper_face *probe,
                      const struct iso_upper_face *const *person, int n, double *rms_mm)
{
    double least_mm = INFINITY;
    for (int i = 0; i < n; i++) {
        struct iso_upper_fit fit;
        iso_upper_surface_of(person[i], &work->surface);
        if (iso_upper_fit(&work->fit, probe, &work->surface, &fit) == 0) {
            least_mm = fmin(least_mm, fit.rms_mm);
        }
    }
    explicit_bzero(work, sizeof *work);
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

double iso_rerank(struct iso_rerank_workspace *work, const struct iso_metric *metric,
                  const struct iso_upper_face *probe, const struct iso_upper_face *const *person,
                  int n, double metric_score)
{
    double rms_mm;
    if (!(metric->rerank.upper > 0.0f) || iso_rerank_misfit(work, probe, person, n, &rms_mm)) {
        return metric_score;
    }
    return iso_rerank_fuse(&metric->rerank, metric_score, rms_mm);
}

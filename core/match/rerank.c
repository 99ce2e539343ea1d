#include "core/match/rerank.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "isotherm/index.h"

enum {
    ORDERED = ISO_INDEX_TEMPLATES_MAX,
    STRIDE = 3,    /* nodes, in both directions */
    NODES_MIN = 30 /* that both faces have */
};

/* Returns how much the heights of two faces differ before any registration: the standard deviation
 * of the difference, mm, at nodes that both have; infinity if these are too few. */
static double rough_misfit(const struct iso_upper_face *one, const struct iso_upper_face *other)
{
    double sum = 0.0, square = 0.0;
    int n = 0;
    for (int v = 0; v < ISO_UPPER_ROWS; v += STRIDE) {
        for (int u = 0; u < ISO_UPPER_COLUMNS; u += STRIDE) {
            if (one->kind[v][u] == ISO_UPPER_MEASURED && other->kind[v][u] == ISO_UPPER_MEASURED) {
                const double off_mm = (double)one->z_mm[v][u] - (double)other->z_mm[v][u];
                sum += off_mm;
                square += off_mm * off_mm;
                n++;
            }
        }
    }
    return n < NODES_MIN ? INFINITY : sqrt(fmax(square / n - sum * sum / n / n, 0.0));
}

/* Sorts the templates of a person: the template that differs least from the probe comes first. At
 * most ORDERED templates are written to `ordered`; the function returns their number. To register
 * all templates would take too long. A person who was enrolled in several poses has one template in
 * nearly the same pose as the probe, and that template comes first. If there are at most `chosen`
 * templates, all will be registered, and the order does not matter. */
static int put_in_order(const struct iso_upper_face *probe,
                        const struct iso_upper_face *const *person, int n, int chosen,
                        const struct iso_upper_face **ordered)
{
    double misfit[ORDERED];
    int n_ordered = 0;
    for (int i = 0; i < n; i++) {
        const double one = n > chosen ? rough_misfit(probe, person[i]) : 0.0;
        if (n_ordered == ORDERED && !(one < misfit[ORDERED - 1])) {
            continue;
        }
        int k = n_ordered < ORDERED ? n_ordered++ : ORDERED - 1;
        for (; k > 0 && one < misfit[k - 1]; k--) {
            misfit[k] = misfit[k - 1];
            ordered[k] = ordered[k - 1];
        }
        misfit[k] = one;
        ordered[k] = person[i];
    }
    return n_ordered;
}

/* If a template has too few points in common with the probe, it cannot be registered. The next one
 * in the order takes its place. */
int iso_rerank_misfit(struct iso_rerank_workspace *work, const struct iso_upper_face *probe,
                      const struct iso_upper_face *const *person, int n, int place, double *rms_mm)
{
    const struct iso_upper_face *ordered[ORDERED];
    const int chosen = place < ISO_RERANK_FIRST ? 2 : 1;
    const int n_ordered = put_in_order(probe, person, n, chosen, ordered);
    double least_mm = INFINITY;
    int registered = 0;
    for (int i = 0; i < n_ordered && registered < chosen; i++) {
        struct iso_upper_fit fit;
        iso_upper_surface_of(ordered[i], &work->surface);
        if (iso_upper_fit(&work->fit, probe, &work->surface, &fit) == 0) {
            least_mm = fmin(least_mm, fit.rms_mm);
            registered++;
        }
    }
    explicit_bzero(work, sizeof *work);
    if (registered == 0) {
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
                  int n, int place, double metric_score)
{
    double rms_mm;
    if (!(metric->rerank.upper > 0.0f) ||
        iso_rerank_misfit(work, probe, person, n, place, &rms_mm)) {
        return metric_score;
    }
    return iso_rerank_fuse(&metric->rerank, metric_score, rms_mm);
}

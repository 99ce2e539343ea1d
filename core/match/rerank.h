/* The reranking of the few best candidates that the metric finds in a gallery. Their upper faces
 * are registered to that of the probe, and the remaining distance between the surfaces is combined
 * with the metric's score.
 *
 * The metric has learned how people differ. The comparison of surfaces needs no learning, and makes
 * errors on other faces. A fused score is
 *
 *     weight_m * metric's score - weight_u * ln(rms / 1 mm) + bias,
 *
 * with the weights and the bias that `isotherm-sim train metric` finds on people who are not in the
 * training set. They are such that a score of s or more is as rare among strangers as with the
 * metric alone. */
#ifndef ISO_CORE_MATCH_RERANK_H
#define ISO_CORE_MATCH_RERANK_H

#include "core/match/upper_surface.h"
#include "isotherm/metric.h"

/* ISO_RERANK_CANDIDATES candidates of a search are reranked. For the first ISO_RERANK_FIRST of
 * them, which have the highest scores by the metric, two templates are registered. For each of the
 * others one template is registered, which saves time. If the visitor is enrolled, the right person
 * is almost always among the first candidates. One template instead of two can only lower the fused
 * score of the other candidates, because the template that fits best decides. */
enum { ISO_RERANK_CANDIDATES = 10, ISO_RERANK_FIRST = 3 };

/* Working memory, 102 kB. It is allocated once and used by one thread at a time; it needs no
 * initial values. iso_rerank_misfit and iso_rerank wipe it when they have used it. */
struct iso_rerank_workspace {
    struct iso_upper_surface surface;
    struct iso_upper_workspace fit;
};

/* The least misfit, mm. */
#define ISO_RERANK_RMS_MIN_MM 0.05

/* Measures how well the probe's upper face fits the upper faces of a person's n templates. `place`
 * is the number of candidates with a higher score by the metric. If the place is below
 * ISO_RERANK_FIRST, the function registers two templates, otherwise one. It chooses the templates
 * whose heights differ least from the probe's. If one of these cannot be registered, the next one
 * is tried, up to 16. *rms_mm receives the smallest rms after a registration (upper_surface.h), at
 * least ISO_RERANK_RMS_MIN_MM. Returns -ENODATA if no template can be registered. */
int iso_rerank_misfit(struct iso_rerank_workspace *work, const struct iso_upper_face *probe,
                      const struct iso_upper_face *const *person, int n, int place, double *rms_mm)
    __attribute__((warn_unused_result));

/* Returns the fused score of a person with n templates. `place` is as for iso_rerank_misfit();
 * `metric_score` is the person's score by the metric. The function returns metric_score unchanged
 * in two cases:
 *
 * - No template can be registered. It has no upper face, or the two faces have too few points in
 *   common.
 * - The weight of the misfit, `upper` in struct iso_rerank_weights, is 0.
 *
 * The function takes about 0.1 ms for each template that it registers. */
double iso_rerank(struct iso_rerank_workspace *work, const struct iso_metric *metric,
                  const struct iso_upper_face *probe, const struct iso_upper_face *const *person,
                  int n, int place, double metric_score);

/* Computes the fused score from the metric's score and a measured misfit. */
double iso_rerank_fuse(const struct iso_rerank_weights *weights, double metric_score,
                       double rms_mm);

#endif

/* The reranking of the few best candidates that the metric finds in a gallery. Their upper faces
 * are registered to that of the probe, and the remaining distance between the surfaces is combined
 * with the metric's score.
 *
 * The metric has learned how people differ. The comparison of surfaces needs no learning, and makes
 * errors on other faces. A fused score is
 *
 *     weight_m * metric's score - weight_u * ln(rms / 1 mm) + bias,
 *
 * with the weights and the bias that `isotherm-sim train metric` finds on people who are held out,
 * such that a score of s or more is as rare among strangers as by the metric alone. */
#ifndef ISO_CORE_MATCH_RERANK_H
#define ISO_CORE_MATCH_RERANK_H

#include "core/match/upper_surface.h"
#include "isotherm/metric.h"

/* Candidates that a search hands on for reranking. */
enum { ISO_RERANK_CANDIDATES = 10 };

/* Working memory, 104 kB. It is allocated once and used by one thread at a time; it needs no
 * initial values. Each function wipes what it leaves. */
struct iso_rerank_workspace {
    struct iso_upper_surface surface;
    struct iso_upper_workspace fit;
};

/* How well the probe's upper face fits those of one person's templates: the least rms, mm, after
 * registration (upper_surface.h), at least ISO_RERANK_RMS_MIN_MM. -ENODATA if none can be
 * registered. */
#define ISO_RERANK_RMS_MIN_MM 0.05
int iso_rerank_misfit(struct iso_rerank_workspace *work, const struct iso_upper_face *probe,
                      const struct iso_upper_face *const *person, int n, double *rms_mm)
    __attribute__((warn_unused_result));

/* The fused score of a person with n templates whose score by the metric is known. It is the
 * metric's score if surfaces cannot be compared (no upper face in a template, too few points in
 * common, weights of zero). About 0.1 ms a template. */
double iso_rerank(struct iso_rerank_workspace *work, const struct iso_metric *metric,
                  const struct iso_upper_face *probe, const struct iso_upper_face *const *person,
                  int n, double metric_score);

/* The fused score from a misfit that is known already. */
double iso_rerank_fuse(const struct iso_rerank_weights *weights, double metric_score,
                       double rms_mm);

#endif

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

/* How many candidates of a search are reranked, and how many of these, the best ones by the metric,
 * have two templates registered. The others have one. A search for a person who is enrolled almost
 * always has that person among the best. A person further back can only lose score by the second
 * template that is left out, because a score belongs to the template that fits best. */
enum { ISO_RERANK_CANDIDATES = 10, ISO_RERANK_FIRST = 3 };

/* Working memory, 102 kB. It is allocated once and used by one thread at a time; it needs no
 * initial values. iso_rerank_misfit and iso_rerank wipe it when they have used it. */
struct iso_rerank_workspace {
    struct iso_upper_surface surface;
    struct iso_upper_workspace fit;
};

/* The least misfit, mm. */
#define ISO_RERANK_RMS_MIN_MM 0.05

/* Measures how well the probe's upper face fits those of n templates of one person. `place` is the
 * number of candidates that the metric finds better than this one. Two templates are registered if
 * the place is below ISO_RERANK_FIRST, else one: those whose heights differ least from the probe's,
 * without the ones that cannot be registered; of more than 16, the 16 likeliest are tried. *rms_mm
 * is the least rms after registration (upper_surface.h), at least ISO_RERANK_RMS_MIN_MM. -ENODATA
 * if none can be registered. */
int iso_rerank_misfit(struct iso_rerank_workspace *work, const struct iso_upper_face *probe,
                      const struct iso_upper_face *const *person, int n, int place, double *rms_mm)
    __attribute__((warn_unused_result));

/* Returns the fused score of a person with n templates, in this place among the candidates;
 * `metric_score` is the person's score by the metric. The function returns metric_score unchanged
 * in two cases: the surfaces cannot be compared (a template has no upper face, or the faces have
 * too few points in common), or the weight of the misfit (`upper` in struct iso_rerank_weights) is
 * 0. The function takes about 0.1 ms for each template that is registered, two at most, and less
 * for one that cannot be registered. */
double iso_rerank(struct iso_rerank_workspace *work, const struct iso_metric *metric,
                  const struct iso_upper_face *probe, const struct iso_upper_face *const *person,
                  int n, int place, double metric_score);

/* The fused score from a misfit that is known already. */
double iso_rerank_fuse(const struct iso_rerank_weights *weights, double metric_score,
                       double rms_mm);

#endif

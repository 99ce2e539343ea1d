/* Parts of a shape by the persistence of a function of its vertices (Chazal, Guibas, Oudot and
 * Skraba, "Persistence-based clustering in Riemannian manifolds", Journal of the ACM 60(6), 2013;
 * with the heat kernel signature: Skraba, Ovsjanikov, Chazal and Guibas, "Persistence-based
 * segmentation of deformable shapes", NORDIA 2010).
 *
 * While a level sinks, each peak of the function starts an island, and islands meet at passes. Of
 * two islands that meet, the one of the lower peak ends. The persistence of a peak is its height
 * above the pass where its island ends, or above the least value for the highest peak. Noise makes
 * peaks of low persistence; they do not become segments. */
#ifndef ISO_CORE_SHAPE_DESCRIBE_PERSISTENCE_H
#define ISO_CORE_SHAPE_DESCRIBE_PERSISTENCE_H

#include "isotherm/shape.h"

struct iso_peak {
    int32_t vertex;
    double persistence; /* in the unit of the function */
};

struct iso_segments {
    int32_t n_peaks;       /* all peaks, also those that have no segment */
    struct iso_peak *peak; /* [n_peaks], by falling persistence */
    int32_t n_segments;    /* the first peaks, of at least the wanted persistence */
    int32_t *segment;      /* [n_vertices]: the segment of each vertex, 0..n_segments - 1 */
};

/* Divides a shape into segments, one for each peak whose persistence is at least `least`, and one
 * for the highest peak. f [n_vertices]: the function, finite. If two vertices have the same value,
 * the one with the smaller index counts as the higher one. The caller releases *out with
 * iso_segments_done(). -EINVAL if a value is not finite or `least` is below 0; -ENOMEM. */
int iso_shape_segments(const struct iso_shape *shape, const double *f, double least,
                       struct iso_segments *out) __attribute__((warn_unused_result));

/* Frees the arrays of the segments. */
void iso_segments_done(struct iso_segments *segments);

#endif

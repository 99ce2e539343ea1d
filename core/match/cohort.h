/* Score normalisation against a fixed cohort: people who are in no gallery.
 *
 *     score = 1 - distance / sqrt(m * 2 mm),   m = mean distance of the probe to the cohort.
 *
 * A probe of an unusual face, or from a noisy frame, has larger distances to strangers and to
 * templates of its own person; the root compensates half of that. 1 is a perfect match, strangers
 * lie about 0; higher is more alike. Other normalisations were measured on 200 generated probes
 * each of mild and strong expressions. The z- and t-norm (Auckenthaler, Carey and Lloyd-Thomas
 * 2000), which also divide by the spread, were far worse at low FMR: FNMR at FMR 1e-3 19.5 %
 * against 1.0 % (mild), because the spread of 64 distances is itself uncertain. */
#ifndef ISO_CORE_MATCH_COHORT_H
#define ISO_CORE_MATCH_COHORT_H

#include "core/match/distance.h"
#include "isotherm/fault.h"
#include "isotherm/template.h"

struct iso_cohort;

enum { ISO_COHORT_MIN = 8, ISO_COHORT_MAX = 1024 };

/* File, little endian: char magic[8] = "ISOCOHO1"; uint32 bytes of the file; uint32 crc32 of all
 * that follows it; uint32 count; then each template: uint32 bytes, iso_template_serialise. All of
 * one algorithm. -EBADMSG the file is damaged, -ENOMEM; both with a fault. */
int iso_cohort_parse(const void *bytes, size_t size, struct iso_cohort **out,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

/* Writes the bytes of a cohort file to a buffer that the caller frees with free(). -EINVAL for a
 * number of templates outside ISO_COHORT_MIN..ISO_COHORT_MAX, or templates that cannot be
 * serialised or compared; -ENOMEM. */
int iso_cohort_serialise(const struct iso_template *const *templates, int n, void **bytes,
                         size_t *size) __attribute__((warn_unused_result));

/* Frees it. NULL is accepted. */
void iso_cohort_free(struct iso_cohort *cohort);

/* The number of templates in it. */
int iso_cohort_size(const struct iso_cohort *cohort);

/* The algorithm of its templates (isotherm/template.h). */
uint32_t iso_cohort_algorithm(const struct iso_cohort *cohort);

struct iso_cohort_norm {
    double mean_mm; /* m */
};

/* The mean of the probe's distances to the cohort. Errors as for iso_match_distance. */
int iso_cohort_normalise(struct iso_icp_workspace *work, const struct iso_cohort *cohort,
                         const struct iso_template *probe, const struct iso_match_options *options,
                         struct iso_cohort_norm *out) __attribute__((warn_unused_result));

/* The score of a template at a distance from the probe (see above). `norm` is that of the probe. */
double iso_cohort_score(struct iso_cohort_norm norm, double distance_mm);

#endif

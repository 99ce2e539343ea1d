/* How alike two templates are: distance after registration, and the normalised score. */
#ifndef ISO_CORE_MATCH_SCORE_H
#define ISO_CORE_MATCH_SCORE_H

#include "core/match/template.h"

struct iso_match_options {
    double trim;        /* share of the points that count, 0.5..1; default 0.8 */
    int icp_iterations; /* default 10 */
};

struct iso_match_options iso_match_options_default(void);

/* Trimmed distance, mm: the probe's points are registered rigidly to the gallery's (each landmark's
 * isotherm to the same isotherm) by trimmed ICP, then the mean distance of the best `trim` share of
 * points, weighted. Symmetric up to ICP's tolerance. -EINVAL if algorithm or shape differ,
 * -ENODATA if fewer than 30 % of the points are present in both. */
int iso_match_distance(const struct iso_template *probe, const struct iso_template *gallery,
                       const struct iso_match_options *options, double *distance_mm)
    __attribute__((warn_unused_result));

/* A fixed cohort: templates of people who are in no gallery, against which a probe's distances are
 * normalised (t-norm, Auckenthaler 2000): score = (mean_cohort - distance) / sd_cohort, so that one
 * threshold serves every probe. Higher is more alike. */
struct iso_cohort;

/* File, little endian: magic "ISOCOHO1", u32 file bytes, u32 crc32 of the rest, u32 count, then each: u32 bytes, template.
 * -EBADMSG with *fault if damaged; -ENOMEM. */
int iso_cohort_parse(const void *bytes, size_t size, struct iso_cohort **out, const char **fault)
    __attribute__((warn_unused_result));
int iso_cohort_serialise(const struct iso_template *const *templates, int n, void **bytes,
                         size_t *size) __attribute__((warn_unused_result));
void iso_cohort_free(struct iso_cohort *cohort);
int iso_cohort_size(const struct iso_cohort *cohort);
uint32_t iso_cohort_algorithm(const struct iso_cohort *cohort);

struct iso_cohort_norm {
    double mean_mm, sd_mm;
};

/* The probe's distances to the whole cohort. -EINVAL, -ENODATA as for iso_match_distance. */
int iso_cohort_normalise(const struct iso_cohort *cohort, const struct iso_template *probe,
                         const struct iso_match_options *options, struct iso_cohort_norm *out)
    __attribute__((warn_unused_result));

static inline double iso_score(struct iso_cohort_norm norm, double distance_mm)
{
    return (norm.mean_mm - distance_mm) / norm.sd_mm;
}

#endif

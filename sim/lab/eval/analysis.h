/* From scores to the figures of an evaluation. The subjects of probes are used only from this
 * step on: `none` is not a face and is reported separately; a subject in the gallery makes a
 * mated search; any other subject is a stranger. */
#ifndef SIM_LAB_EVAL_ANALYSIS_H
#define SIM_LAB_EVAL_ANALYSIS_H

#include <stdbool.h>

#include "sim/lab/match/latency.h"
#include "sim/lab/match/match.h"
#include "sim/lab/measure/det.h"
#include "sim/lab/measure/identification.h"

enum {
    SIM_FMR_TARGETS = 4,
    SIM_FPIR_TARGETS = 3,
    SIM_CONDITION_MIN = 5, /* conditions with fewer searches are not reported */
};

extern const double sim_fmr_targets[SIM_FMR_TARGETS];   /* 1e-1 .. 1e-4 */
extern const double sim_fpir_targets[SIM_FPIR_TARGETS]; /* 1e-1 .. 1e-3 */

enum sim_probe_kind { SIM_PROBE_MATED, SIM_PROBE_STRANGER, SIM_PROBE_NONE, SIM_PROBE_KINDS };

struct sim_operating_point {
    struct sim_det_point at;
    struct sim_interval fnmr; /* confidence interval of at.fnmr */
    struct sim_rate gfnmr;    /* with lost comparisons counted as non-matches */
    bool supported;           /* there are enough non-mated comparisons for this FMR */
};

/* One-to-one figures. */
struct sim_verification {
    struct sim_scores scores; /* sorted */
    size_t n_lost;            /* lost mated comparisons: probe not acquired or mate not enrolled */
    size_t n_det; /* 0: no mated or no non-mated comparison; the fields below are then not set */
    struct sim_det_point *det;
    double eer;
    struct sim_interval eer_interval;
    struct sim_operating_point at_fmr[SIM_FMR_TARGETS];
};

/* One-to-many figures. */
struct sim_identification {
    size_t n_searches, n_strangers;
    struct sim_mated_search *searches;
    double *top_score;                                   /* [n_strangers] */
    struct sim_open_set_point at_fpir[SIM_FPIR_TARGETS]; /* if there are searches and strangers */
};

/* Figures of the probes of one pose or one expression. */
struct sim_condition {
    const char *column, *value;                   /* "pose", "yaw_a" */
    struct sim_rate not_acquired, rank_1, rank_4; /* of mated searches */
    double eer; /* of this condition's probes only; NaN if there are too few */
};

struct sim_analysis {
    /* [n_probes] of the matches: */
    enum sim_probe_kind *kind;
    size_t *mate;     /* index of the mate in the gallery, or SIM_NOBODY */
    uint32_t *person; /* number of the probe's subject */
    uint32_t n_subjects;

    struct sim_verification verification;
    struct sim_identification identification;
    size_t n_conditions;
    struct sim_condition *conditions;

    size_t n_kind[SIM_PROBE_KINDS];
    size_t n_gallery_samples, n_people_not_enrolled, n_usable_captures;
    /* Samples by outcome, ISO_CAPTURE_OK for acquired ones: of the gallery, and of probes by
     * kind. */
    size_t gallery_reason[SIM_REASONS], probe_reason[SIM_PROBE_KINDS][SIM_REASONS];
    size_t none_matched; /* non-faces that would match a person at the third FMR's threshold */
    /* Over usable frames: processor time of each stage, and both clocks for the whole
     * extraction; also the time of searching the gallery. */
    struct sim_latency stage[ISO_STAGES], extract_cpu, extract_wall, search_cpu, search_wall;
};

/* Computes all figures. All arguments must outlive the result. -ENOMEM. */
int sim_analyse(const struct sim_corpus *corpus, const struct sim_acquisition *acquisition,
                const struct sim_gallery *gallery, const struct sim_matches *matches,
                struct sim_analysis **out) __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void sim_analysis_free(struct sim_analysis *analysis);

#endif

/* Evaluation of recognition on a corpus: from recordings to figures, by the same code as the
 * appliance's. */
#ifndef SIM_LAB_EVAL_EVAL_H
#define SIM_LAB_EVAL_EVAL_H

#include "sim/lab/eval/analysis.h"
#include "sim/lab/eval/curve.h"
#include "sim/lab/eval/growth.h"
#include "sim/lab/eval/landmark_error.h"
#include "sim/lab/match/training_set.h"

struct sim_eval_options {
    const char *corpus; /* directory */
    const char *model;  /* file */
    const char *metric; /* file, or NULL: the score comes from distances */
    const char *cohort; /* file, or NULL: the score is the negative distance */
    size_t fuse;        /* frames in a sample; 0: all frames of a row */
    /* How many frames of a row are looked at, the first of it; 0: all. */
    size_t gallery_frames, probe_frames;
    size_t gallery_limit; /* people; 0: all. Probes of the rest count as strangers */
    int threads;          /* 1 with ISO_HEAT_SPECTRAL, whose solver is not reentrant */
    struct iso_extract_options extract; /* its clock and sensor are set by the evaluation */
    struct iso_match_options match;
    /* What is compared; none: the appliance's own method alone. */
    size_t n_methods;
    const struct sim_method *methods[SIM_METHODS];
    bool lenient; /* a method that cannot learn here is left out with a remark, not refused */
    struct sim_training_set *training; /* what methods learn from, or NULL */
};

/* One method's part of an evaluation. */
struct sim_eval_method {
    const struct sim_method *method;
    struct sim_matches *matches; /* NULL: left out, for the reason in the fault */
    struct sim_analysis *analysis;
    struct iso_fault fault;
    int64_t wall_ns; /* it took, learning included */
};

/* Everything that an evaluation leaves behind, for the reports. */
struct sim_eval {
    struct sim_eval_options options;
    struct sim_corpus *corpus;
    struct iso_head_model *model;
    struct iso_metric *metric; /* NULL: none was given */
    struct iso_cohort *cohort; /* NULL: none was given */
    struct sim_acquisition *acquisition;
    struct sim_gallery *gallery;
    struct sim_scans *faces; /* NULL: only the appliance's own method was asked for */
    bool trained_apart;      /* the training set and the corpus both say who is in them */
    size_t n_methods;
    struct sim_eval_method methods[SIM_METHODS]; /* in the order of the options */
    struct sim_matches *matches;                 /* of the first method that was not left out */
    struct sim_analysis *analysis;               /* likewise */
    struct sim_growth growth;                    /* at an FPIR of 1e-2 */
    struct sim_curve curves[SIM_FACTORS];        /* at the threshold of the third FMR */
    struct sim_landmark_error landmarks[ISO_LANDMARKS + 1]; /* of usable frames */
    int64_t wall_ns;                                        /* the whole evaluation took */
};

/* The method whose matches and analysis are the evaluation's own: the first not left out. */
static inline const struct sim_method *sim_eval_first(const struct sim_eval *eval)
{
    size_t i = 0;
    while (eval->methods[i].matches != eval->matches) {
        i++;
    }
    return eval->methods[i].method;
}

/* What the scores of the first method are. */
enum sim_score_kind {
    SIM_SCORE_PAIRWISE, /* negative distances that the method computes by itself */
    SIM_SCORE_METRIC,   /* by the learned metric */
    SIM_SCORE_COHORT,   /* negative distances, normalised by a cohort */
    SIM_SCORE_DISTANCE, /* negative distances in millimetres */
};

enum sim_score_kind sim_eval_score_kind(const struct sim_eval *eval);

/* The strings and the training set in the options must outlive the result. -EINVAL for options out
 * of range, a training set that shares people with the corpus, or a method that cannot learn;
 * -EBADMSG for a cohort or metric of another algorithm, a metric that was learned from people of
 * the corpus, a cohort that may hold some of them, or the errors of reading the corpus and the data
 * files and of the extractor; each with a fault. */
int sim_eval_run(const struct sim_eval_options *options, struct sim_eval **out,
                 struct iso_fault *fault) __attribute__((warn_unused_result));
void sim_eval_free(struct sim_eval *eval);

#endif

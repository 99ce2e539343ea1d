/* Evaluation of recognition on a corpus: from recordings to figures, by the same code as the
 * appliance's. */
#ifndef SIM_EVAL_EVAL_H
#define SIM_EVAL_EVAL_H

#include "sim/eval/analysis.h"
#include "sim/eval/landmark_error.h"

struct sim_eval_options {
    const char *corpus;   /* directory */
    const char *model;    /* file */
    const char *cohort;   /* file, or NULL: the score is the negative distance */
    size_t fuse;          /* frames in a sample; 0: all frames of a row */
    size_t gallery_limit; /* people; 0: all. Probes of the rest count as strangers */
    int threads;          /* 1 with ISO_HEAT_SPECTRAL, whose solver is not reentrant */
    struct iso_extract_options extract; /* its clock and sensor are set by the evaluation */
    struct iso_match_options match;
};

/* Everything that an evaluation leaves behind, for the reports. */
struct sim_eval {
    struct sim_eval_options options;
    struct sim_corpus *corpus;
    struct iso_head_model *model;
    struct iso_cohort *cohort; /* NULL: none was given */
    struct sim_acquisition *acquisition;
    struct sim_gallery *gallery;
    struct sim_matches *matches;
    struct sim_analysis *analysis;
    struct sim_landmark_error landmarks[ISO_LANDMARKS + 1]; /* of usable frames */
    int64_t wall_ns;                                        /* the whole evaluation took */
};

/* The strings in the options must outlive the result. -EINVAL for options out of range, -EBADMSG
 * for a cohort of another algorithm, or the errors of reading the corpus and the data files and of
 * the extractor; each with a fault. */
int sim_eval_run(const struct sim_eval_options *options, struct sim_eval **out,
                 struct iso_fault *fault) __attribute__((warn_unused_result));
void sim_eval_free(struct sim_eval *eval);

#endif

/* Evaluates recognition on a corpus, from recordings to figures, with the same code as the
 * appliance. */
#ifndef SIM_LAB_EVAL_EVAL_H
#define SIM_LAB_EVAL_EVAL_H

#include "sim/lab/eval/analysis.h"
#include "sim/lab/eval/curve.h"
#include "sim/lab/eval/growth.h"
#include "sim/lab/eval/landmark_error.h"
#include "sim/lab/eval/site_gallery.h"
#include "sim/lab/eval/site_split.h"
#include "sim/lab/match/training_set.h"
#include "sim/lab/measure/calibration.h"

/* Which rows are enrolled. An enrolment may consist of several rows: one with the role gallery, and
 * others with the role probe, which have the same person, session and expression and another pose.
 * The latter are called the other poses here. */
enum sim_enrolled {
    SIM_ENROLLED_ROLE,    /* rows with the role gallery; the other poses are searched for */
    SIM_ENROLLED_FRONTAL, /* the same, but the other poses are left out */
    SIM_ENROLLED_POSES,   /* rows with the role gallery, and the other poses */
};

struct sim_eval_options {
    const char *corpus; /* directory */
    const char *model;  /* file */
    const char *metric; /* file, or NULL: the score comes from distances */
    const char *cohort; /* file, or NULL: the score is the negative distance */
    size_t fuse;        /* frames in a sample; 0: all frames of a row */
    /* Use only the first frames of each row, up to this number; 0: all. */
    size_t gallery_frames, probe_frames;
    enum sim_enrolled enrolled;
    size_t gallery_limit; /* people to enrol; 0: all. Probes of the others count as strangers */
    int threads;          /* 1 with ISO_HEAT_SPECTRAL, whose solver is not reentrant */
    struct iso_extract_options extract; /* the evaluation sets its clock and sensor */
    struct iso_match_options match;
    /* The methods to compare; none: only the appliance's own method. */
    size_t n_methods;
    const struct sim_method *methods[SIM_METHODS];
    bool lenient; /* skip a pairwise method that cannot work on the corpus, and keep the reason */
    enum sim_site site;                /* with a metric: where the site statistics come from */
    struct sim_training_set *training; /* for methods that learn, or NULL */
};

/* One method's part of an evaluation. */
struct sim_eval_method {
    const struct sim_method *method;
    struct sim_matches *matches; /* NULL: the method was skipped; the fault has the reason */
    struct sim_analysis *analysis;
    struct iso_fault fault;
    int64_t wall_ns; /* duration, including learning; 0 if the method was skipped */
};

/* All results of an evaluation, for the reports. */
struct sim_eval {
    struct sim_eval_options options;
    struct sim_corpus *corpus;
    struct iso_head_model *model;
    struct iso_metric *metric;      /* NULL: none was given */
    struct iso_site_metric adapted; /* to the people of the gallery; all zero: not asked for */
    struct iso_cohort *cohort;      /* NULL: none was given */
    struct sim_acquisition *acquisition;
    struct sim_gallery *gallery;
    struct sim_scans *faces; /* NULL: only the appliance's own methods were requested */
    bool trained_apart;      /* the training set and the corpus are known to share no person */
    size_t n_methods;
    struct sim_eval_method methods[SIM_METHODS]; /* in the order of the options */
    struct sim_matches *matches;                 /* of the first method that was not skipped */
    struct sim_analysis *analysis;               /* of the same method */
    struct sim_calibration calibration;          /* of the same method, if a metric scores */
    struct sim_growth growth;                    /* at an FPIR of 1e-2 */
    struct sim_site_split site;                  /* splits is 0 if they were not requested */
    struct sim_curve curves[SIM_FACTORS];        /* at the threshold of the third FMR */
    struct sim_landmark_error landmarks[ISO_LANDMARKS + 1]; /* of usable frames */
    int64_t wall_ns;                                        /* duration of the whole evaluation */
};

/* The method that supplies the evaluation's matches and analysis: the first that was not skipped.
 */
static inline const struct sim_method *sim_eval_first(const struct sim_eval *eval)
{
    size_t i = 0;
    while (eval->methods[i].matches != eval->matches) {
        i++;
    }
    return eval->methods[i].method;
}

/* The kind of the first method's scores. */
enum sim_score_kind {
    SIM_SCORE_PAIRWISE, /* negative distances that the method computes by itself */
    SIM_SCORE_METRIC,   /* by the learned metric */
    SIM_SCORE_COHORT,   /* negative distances, normalised by a cohort */
    SIM_SCORE_DISTANCE, /* negative distances in millimetres */
};

enum sim_score_kind sim_eval_score_kind(const struct sim_eval *eval);

/* Runs an evaluation. The strings and the training set in the options must outlive the result.
 * -EINVAL: options out of range, a training set that shares people with the corpus, or a method
 * that cannot learn or needs infrared images that the corpus does not have.
 * -EBADMSG: a cohort or metric of another algorithm, a metric learned from people of the corpus,
 * or a cohort that may contain some of them. Otherwise the errors of reading the corpus and the
 * data files and of the extractor. Each comes with a fault. */
int sim_eval_run(const struct sim_eval_options *options, struct sim_eval **out,
                 struct iso_fault *fault) __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void sim_eval_free(struct sim_eval *eval);

#endif

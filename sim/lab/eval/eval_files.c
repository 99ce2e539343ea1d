#include "sim/lab/eval/eval_files.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/model/model_file.h"
#include "sim/world/face/person.h"

/* Shortens each row to its first frames, as in a visit with fewer frames. */
static void shorten_rows(struct sim_corpus *corpus, const struct sim_eval_options *options)
{
    for (size_t i = 0; i < corpus->n_rows; i++) {
        struct sim_corpus_row *row = &corpus->rows[i];
        const size_t most = row->role == SIM_ROLE_GALLERY ? options->gallery_frames
                                                          : options->probe_frames;
        row->count = most > 0 && most < row->count ? most : row->count;
    }
}

/* Whether a row is of the enrolment of another row, in another pose. */
static bool is_posed(const struct sim_corpus_row *row, const struct sim_corpus_row *gallery)
{
    return row->role == SIM_ROLE_PROBE && gallery->role == SIM_ROLE_GALLERY &&
           strcmp(row->subject, gallery->subject) == 0 &&
           strcmp(row->session, gallery->session) == 0 &&
           strcmp(row->expression, gallery->expression) == 0 &&
           strcmp(row->pose, gallery->pose) != 0;
}

/* Marks the rows that is_posed() finds for any row of the gallery. */
static void mark_posed(const struct sim_corpus *corpus, bool *posed)
{
    for (size_t i = 0; i < corpus->n_rows; i++) {
        for (size_t j = 0; j < corpus->n_rows && !posed[i]; j++) {
            posed[i] = is_posed(&corpus->rows[i], &corpus->rows[j]);
        }
    }
}

/* Enrols the rows of the enrolment in other poses, or drops them. -ENOMEM. */
static int choose_enrolled(struct sim_corpus *corpus, enum sim_enrolled enrolled)
{
    size_t kept = 0;
    if (enrolled == SIM_ENROLLED_ROLE) {
        return 0;
    }
    bool *posed = calloc(corpus->n_rows, sizeof *posed);
    if (!posed) {
        return -ENOMEM;
    }
    mark_posed(corpus, posed);
    for (size_t i = 0; i < corpus->n_rows; i++) {
        struct sim_corpus_row row = corpus->rows[i];
        row.role = posed[i] ? SIM_ROLE_GALLERY : row.role;
        if (!posed[i] || enrolled == SIM_ENROLLED_POSES) {
            corpus->rows[kept++] = row;
        }
    }
    corpus->n_rows = kept;
    free(posed);
    return 0;
}

int sim_eval_load(struct sim_eval *eval, struct iso_fault *fault)
{
    int error = iso_head_model_load(eval->options.model, &eval->model, fault);
    if (!error && eval->options.cohort) {
        error = iso_cohort_load(eval->options.cohort, &eval->cohort, fault);
    }
    if (!error && eval->options.metric) {
        error = iso_metric_load(eval->options.metric, &eval->metric, fault);
    }
    if (!error) {
        error = sim_corpus_read(eval->options.corpus, &eval->corpus, fault);
    }
    if (error) {
        return error;
    }
    if (choose_enrolled(eval->corpus, eval->options.enrolled)) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", eval->options.corpus);
    }
    shorten_rows(eval->corpus, &eval->options);
    return 0;
}

int sim_eval_check_metric(const struct sim_eval *eval, struct iso_fault *fault)
{
    const struct iso_metric *metric = eval->metric;
    if (!metric) {
        return 0;
    }
    if (metric->algorithm != eval->acquisition->origin.algorithm) {
        return iso_fault_set(fault, -EBADMSG,
                             "%s: made by algorithm %08x, templates are of %08x (--metric none "
                             "compares by distance)",
                             eval->options.metric, (unsigned)metric->algorithm,
                             (unsigned)eval->acquisition->origin.algorithm);
    }
    /* A test must not use people from the training of the metric. */
    for (size_t row = 0; row < eval->corpus->n_rows; row++) {
        for (int i = 0; i < metric->n_origins; i++) {
            if (sim_corpus_row_is_of(&eval->corpus->rows[row], metric->origin[i])) {
                return iso_fault_set(fault, -EBADMSG, "%s: was learned from the people of %s (%s)",
                                     eval->options.metric, eval->options.corpus, metric->origin[i]);
            }
        }
    }
    return 0;
}

/* A cohort does not state its people, but they are of the population `train`. People of this
 * population must not be tested with a cohort. */
int sim_eval_check_cohort(const struct sim_eval *eval, struct iso_fault *fault)
{
    const char trained[] = SIM_POPULATION_TRAIN "-";
    for (size_t row = 0; eval->cohort && row < eval->corpus->n_rows; row++) {
        const char *origin = eval->corpus->rows[row].note;
        if (strncmp(origin, trained, strlen(trained)) == 0) {
            return iso_fault_set(fault, -EBADMSG, "%s: may hold people of %s (%s)",
                                 eval->options.cohort, eval->options.corpus, origin);
        }
    }
    if (eval->cohort && iso_cohort_algorithm(eval->cohort) != eval->acquisition->origin.algorithm) {
        return iso_fault_set(fault, -EBADMSG, "%s: made by algorithm %08x, templates are of %08x",
                             eval->options.cohort, (unsigned)iso_cohort_algorithm(eval->cohort),
                             (unsigned)eval->acquisition->origin.algorithm);
    }
    return 0;
}

#include "sim/train/metric/metric_templates.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void keep_template(void *context, size_t number, const struct sim_capture *capture)
{
    struct sim_metric_templates *t = context;
    const size_t at = t->first + number;
    t->usable[at] = capture->extraction.outcome == ISO_CAPTURE_OK;
    t->tmpl[at] = capture->extraction.tmpl;
}

static int grow_arrays(struct sim_metric_templates *t, size_t frames)
{
    const size_t n = t->n + frames;
    struct iso_template *tmpl = realloc(t->tmpl, n * sizeof *tmpl);
    t->tmpl = tmpl ? tmpl : t->tmpl;
    size_t *person = realloc(t->person, n * sizeof *person);
    t->person = person ? person : t->person;
    bool *usable = realloc(t->usable, n * sizeof *usable);
    t->usable = usable ? usable : t->usable;
    return tmpl && person && usable ? 0 : -ENOMEM;
}

/* Numbers the subjects of a corpus, whose rows need not be in order. */
static void number_people(struct sim_metric_templates *t, const struct sim_corpus *corpus)
{
    const size_t first_person = t->n_people;
    size_t frame = t->n;
    for (size_t row = 0; row < corpus->n_rows; row++) {
        size_t person = t->n_people;
        size_t known = t->n;
        for (size_t before = 0; before < row; before++) {
            if (strcmp(corpus->rows[before].subject, corpus->rows[row].subject) == 0) {
                person = t->person[known];
                break;
            }
            known += corpus->rows[before].count;
        }
        t->n_people += person == t->n_people && person >= first_person;
        for (size_t i = 0; i < corpus->rows[row].count; i++) {
            t->person[frame++] = person;
        }
    }
}

/* All people of a corpus come from one population and seed. The learning must not use a person
 * twice. */
static int check_origin(const struct sim_corpus *corpus, const char *directory,
                        struct iso_metric *shape, struct iso_fault *fault)
{
    const char *origin = corpus->rows[0].note;
    for (size_t row = 0; row < corpus->n_rows; row++) {
        if (!sim_corpus_row_is_of(&corpus->rows[row], origin)) {
            return iso_fault_set(fault, -EINVAL, "%s: row %zu: no origin, or another, in its note",
                                 directory, row + 1);
        }
    }
    for (int i = 0; i < shape->n_origins; i++) {
        if (sim_corpus_row_is_of(&corpus->rows[0], shape->origin[i])) {
            return iso_fault_set(fault, -EINVAL, "%s: the people of %s are there already",
                                 directory, shape->origin[i]);
        }
    }
    (void)snprintf(shape->origin[shape->n_origins++], ISO_METRIC_ORIGIN_MAX, "%.*s",
                   (int)sim_corpus_origin_length(origin), origin);
    return 0;
}

int sim_metric_templates_read(struct sim_metric_templates *t, const char *directory,
                              const struct sim_capture_options *options, struct iso_metric *shape,
                              struct iso_fault *fault)
{
    struct sim_capture_origin origin;
    struct sim_corpus *corpus = NULL;
    int error = sim_corpus_read(directory, &corpus, fault);
    if (error) {
        return error;
    }
    const size_t frames = sim_corpus_frames(corpus);
    error = check_origin(corpus, directory, shape, fault);
    if (!error && grow_arrays(t, frames)) {
        error = iso_fault_set(fault, -ENOMEM, "%s: out of memory", directory);
    }
    if (!error) {
        number_people(t, corpus);
        t->first = t->n;
        error = sim_capture_all(directory, corpus, options, keep_template, t, &origin, fault);
    }
    if (!error) {
        t->n += frames;
        shape->algorithm = origin.algorithm;
    }
    sim_corpus_free(corpus);
    return error;
}

void sim_metric_templates_leave_usable(struct sim_metric_templates *t)
{
    size_t n = 0;
    for (size_t i = 0; i < t->n; i++) {
        if (t->usable[i]) {
            t->tmpl[n] = t->tmpl[i];
            t->person[n++] = t->person[i];
        }
    }
    t->n = n;
}

void sim_metric_templates_done(struct sim_metric_templates *t)
{
    free(t->tmpl);
    free(t->person);
    free(t->usable);
}

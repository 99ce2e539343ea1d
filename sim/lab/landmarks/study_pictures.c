#include "sim/lab/landmarks/study_pictures.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/base/path.h"
#include "sim/lab/landmarks/fit_picture.h"

/* ---- choosing --------------------------------------------------------------------- */

struct ranked {
    double error_mm;
    size_t number;
};

static int by_falling_error(const void *a, const void *b)
{
    const struct ranked *p = a, *q = b;
    const int order = (p->error_mm < q->error_mm) - (p->error_mm > q->error_mm);
    return order ? order : (p->number > q->number) - (p->number < q->number);
}

/* Whether two frames have the same outcome and the same kind of content. */
static bool alike(const struct sim_corpus *corpus, const struct sim_measured_frame *a,
                  const struct sim_measured_frame *b)
{
    const struct sim_corpus_row *p = &corpus->rows[a->row], *q = &corpus->rows[b->row];
    const bool person = sim_row_kind_of(p) == SIM_ROW_BONA_FIDE;
    return a->reason == b->reason && person == (sim_row_kind_of(q) == SIM_ROW_BONA_FIDE) &&
           (person || strcmp(p->note, q->note) == 0);
}

static size_t choose_firsts(const struct sim_corpus *corpus,
                            const struct sim_measurement *measurement,
                            struct sim_chosen_frame *chosen)
{
    size_t n = 0;
    for (size_t i = 0; i < measurement->n_frames; i++) {
        const struct sim_measured_frame *f = &measurement->frames[i];
        bool fresh = f->reason != SIM_REASON_UNREADABLE;
        for (size_t k = 0; fresh && k < n; k++) {
            fresh = !alike(corpus, f, &measurement->frames[chosen[k].number]);
        }
        if (fresh) {
            chosen[n++] = (struct sim_chosen_frame){i, 0};
        }
    }
    return n;
}

int sim_choose_frames(const struct sim_corpus *corpus, const struct sim_measurement *measurement,
                      size_t n_worst, struct sim_chosen_frame **chosen, size_t *n_chosen)
{
    const size_t n_frames = measurement->n_frames;
    struct ranked *ranked = calloc(n_frames, sizeof *ranked);
    struct sim_chosen_frame *list = calloc(2 * n_frames, sizeof *list);
    size_t n_ranked = 0, n = 0;
    if (!ranked || !list) {
        free(ranked);
        free(list);
        return -ENOMEM;
    }
    for (size_t i = 0; i < n_frames; i++) {
        const struct sim_measured_frame *f = &measurement->frames[i];
        if (f->n_known > 0 && sim_row_kind_of(&corpus->rows[f->row]) == SIM_ROW_BONA_FIDE) {
            ranked[n_ranked++] = (struct ranked){f->centred_mean_mm, i};
        }
    }
    qsort(ranked, n_ranked, sizeof *ranked, by_falling_error);
    for (; n < n_worst && n < n_ranked; n++) {
        list[n] = (struct sim_chosen_frame){ranked[n].number, n + 1};
    }
    free(ranked);
    *n_chosen = n + choose_firsts(corpus, measurement, list + n);
    *chosen = list;
    return 0;
}

/* ---- drawing ---------------------------------------------------------------------- */

struct drawing {
    const struct sim_study *study;
    const char *directory;
    const struct sim_truth *truth; /* of each frame */
    struct iso_extractor *extractor;
    struct iso_extraction *extraction; /* of the frame that is drawn */
};

static int path_of(const struct drawing *d, struct sim_chosen_frame chosen, char path[PATH_MAX],
                   struct iso_fault *fault)
{
    const struct sim_measured_frame *f = &d->study->measurement->frames[chosen.number];
    const struct sim_corpus_row *row = &d->study->corpus->rows[f->row];
    const bool person = sim_row_kind_of(row) == SIM_ROW_BONA_FIDE;
    char name[4 * SIM_CORPUS_NAME_MAX];
    if (chosen.rank > 0) {
        (void)snprintf(name, sizeof name, "worst-%02zu-%s-%zu.png", chosen.rank, row->recording,
                       f->frame);
    } else {
        const char *thing = *row->note ? row->note : "none";
        const char *kind = person ? "person" : thing;
        (void)snprintf(name, sizeof name, "first-%s-%s-%s-%zu.png", sim_reason_name(f->reason),
                       kind, row->recording, f->frame);
    }
    for (char *c = name; *c; c++) {
        if (!isalnum((unsigned char)*c) && !strchr(".-_", *c)) {
            *c = '_';
        }
    }
    return iso_path_join(d->directory, name, path, fault);
}

/* Reads the frame, runs the extractor on it and draws. */
static int draw_frame(const struct drawing *d, struct sim_chosen_frame chosen,
                      struct iso_recording *recording, struct iso_frame *frame,
                      struct iso_fault *fault)
{
    const struct sim_measured_frame *f = &d->study->measurement->frames[chosen.number];
    const struct sim_corpus_row *row = &d->study->corpus->rows[f->row];
    char path[PATH_MAX], title[6 * SIM_CORPUS_NAME_MAX];
    int error = iso_recording_read(recording, f->frame, frame, fault);
    if (!error) {
        error = path_of(d, chosen, path, fault);
    }
    if (error) {
        return error;
    }
    error = iso_extractor_run(d->extractor, frame, d->extraction);
    if (error) {
        return iso_fault_set(fault, error, "%s: frame %zu: %s", row->recording, f->frame,
                             strerror(-error));
    }
    (void)snprintf(title, sizeof title, "%s frame %zu    %s %s %s %s", row->recording, f->frame,
                   row->subject, row->pose, row->expression, row->note);
    const struct sim_fit_subject subject = {
        d->study->model, d->extractor, d->extraction, frame, &d->truth[chosen.number], title};
    error = sim_fit_picture(&subject, path, fault);
    iso_template_wipe(&d->extraction->tmpl);
    return error;
}

static int draw_chosen(const struct drawing *d, struct sim_chosen_frame chosen,
                       struct iso_fault *fault)
{
    const struct sim_measured_frame *f = &d->study->measurement->frames[chosen.number];
    const char *name = d->study->corpus->rows[f->row].recording;
    struct iso_recording *recording = NULL;
    struct iso_frame *frame = NULL;
    int error = sim_recording_open(d->study->options.corpus, name, &recording, fault);
    if (error) {
        return error;
    }
    error = iso_recording_frame_new(recording, &frame);
    if (error) {
        (void)iso_fault_set(fault, error, "%s: out of memory", name);
    } else {
        error = draw_frame(d, chosen, recording, frame, fault);
    }
    iso_frame_free(frame);
    iso_recording_close(recording);
    return error;
}

int sim_study_pictures(const struct sim_study *study, const char *directory, size_t n_worst,
                       struct iso_fault *fault)
{
    struct sim_chosen_frame *chosen = NULL;
    size_t n_chosen = 0;
    struct sim_truth *truth = NULL;
    struct drawing drawing = {.study = study, .directory = directory};
    int error = sim_truth_read(study->options.corpus, study->corpus, &truth, fault);
    if (error) {
        return error;
    }
    drawing.truth = truth;
    error = sim_choose_frames(study->corpus, study->measurement, n_worst, &chosen, &n_chosen);
    drawing.extraction = calloc(1, sizeof *drawing.extraction);
    if (!error && !drawing.extraction) {
        error = -ENOMEM;
    }
    if (!error) {
        error = iso_extractor_new(study->model, &study->options.extract, &drawing.extractor);
    }
    if (error) {
        (void)iso_fault_set(fault, error, "pictures: %s", strerror(-error));
    }
    for (size_t i = 0; !error && i < n_chosen; i++) {
        error = draw_chosen(&drawing, chosen[i], fault);
    }
    iso_extractor_free(drawing.extractor);
    free(drawing.extraction);
    free(chosen);
    free(truth);
    return error;
}

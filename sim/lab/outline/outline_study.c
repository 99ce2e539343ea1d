/* Takes the outlines of a corpus. */
#include "sim/lab/outline/outline_study.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/model/model_file.h"
#include "isotherm/extract.h"
#include "sim/base/progress.h"
#include "sim/corpus/corpus.h"
#include "sim/lab/match/capture.h"

struct samples {
    struct sim_outline_sample *sample;
    size_t n, capacity;
};

struct study {
    struct sim_corpus *corpus;
    struct iso_head_model *model;
    struct iso_extractor *extractor;
    struct iso_head_outline head;
    const char **subjects; /* of the gallery, in the order in which they appear */
    size_t n_subjects;
    struct samples gallery[SIM_OUTLINE_VIEWS], probes[SIM_OUTLINE_VIEWS];
};

static int add(struct samples *to, size_t subject, const struct sim_outline_features *features)
{
    if (to->n == to->capacity) {
        const size_t capacity = 2 * to->capacity + 64;
        struct sim_outline_sample *grown = reallocarray(to->sample, capacity, sizeof *grown);
        if (!grown) {
            return -ENOMEM;
        }
        to->sample = grown;
        to->capacity = capacity;
    }
    to->sample[to->n].subject = subject;
    to->sample[to->n++].features = *features;
    return 0;
}

/* The number of a subject of the gallery; n_subjects if there is none of this name. */
static size_t find_subject(const struct study *study, const char *name)
{
    size_t i = 0;
    while (i < study->n_subjects && strcmp(study->subjects[i], name) != 0) {
        i++;
    }
    return i;
}

static int list_subjects(struct study *study)
{
    const struct sim_corpus *corpus = study->corpus;
    study->subjects = calloc(corpus->n_rows, sizeof *study->subjects);
    for (size_t i = 0; study->subjects && i < corpus->n_rows; i++) {
        const struct sim_corpus_row *row = &corpus->rows[i];
        if (row->role == SIM_ROLE_GALLERY &&
            find_subject(study, row->subject) == study->n_subjects) {
            study->subjects[study->n_subjects++] = row->subject;
        }
    }
    return study->subjects ? 0 : -ENOMEM;
}

static int take_frame(struct study *study, const struct sim_corpus_row *row,
                      const struct iso_frame *frame)
{
    static struct iso_extraction extraction;
    struct sim_outline_features features;
    const size_t subject = find_subject(study, row->subject);
    int error = iso_extractor_run(study->extractor, frame, &extraction);
    const struct iso_rigid pose = extraction.camera_from_face;
    iso_template_wipe(&extraction.tmpl);
    for (int view = 0; !error && extraction.fitted && view < SIM_OUTLINE_VIEWS; view++) {
        if (sim_outline_features_of(&study->head, &pose, frame, (enum sim_outline_view)view,
                                    &features)) {
            struct samples *to = row->role == SIM_ROLE_GALLERY ? &study->gallery[view]
                                                               : &study->probes[view];
            error = add(to, subject, &features);
        }
    }
    return error;
}

static int take_row(struct study *study, const char *directory, const struct sim_corpus_row *row,
                    struct iso_fault *fault)
{
    struct iso_recording *recording = NULL;
    struct iso_frame *frame = NULL;
    int error = sim_recording_open(directory, row->recording, &recording, fault);
    if (!error) {
        error = iso_recording_frame_new(recording, &frame);
    }
    for (size_t i = 0; !error && i < row->count; i++) {
        error = iso_recording_read(recording, row->first + i, frame, fault);
        if (!error) {
            error = take_frame(study, row, frame);
        }
    }
    iso_frame_free(frame);
    iso_recording_close(recording);
    return error;
}

static int open_study(struct study *study, const char *corpus, const char *model,
                      struct iso_fault *fault)
{
    const struct iso_extract_options options = iso_extract_options_default();
    int error = iso_head_model_load(model, &study->model, fault);
    if (!error) {
        error = sim_corpus_read(corpus, &study->corpus, fault);
    }
    if (!error) {
        error = list_subjects(study);
    }
    if (!error) {
        error = iso_extractor_new(study->model, &options, &study->extractor);
    }
    if (!error) {
        iso_head_outline_init(&study->head, study->model);
    }
    return error;
}

static void close_study(struct study *study)
{
    for (int view = 0; view < SIM_OUTLINE_VIEWS; view++) {
        free(study->gallery[view].sample);
        free(study->probes[view].sample);
    }
    free(study->subjects);
    iso_extractor_free(study->extractor);
    iso_head_model_free(study->model);
    sim_corpus_free(study->corpus);
}

static int take_corpus(struct study *study, const char *directory, struct iso_fault *fault)
{
    int error = 0;
    const bool shown = sim_progress_begin("outlines", study->corpus->n_rows);
    for (size_t i = 0; !error && i < study->corpus->n_rows; i++) {
        const struct sim_corpus_row *row = &study->corpus->rows[i];
        if (find_subject(study, row->subject) < study->n_subjects) {
            error = take_row(study, directory, row, fault);
        }
        sim_progress_step(1);
    }
    sim_progress_end(shown);
    return error;
}

int sim_outline_study(const char *corpus, const char *model, struct sim_outline_result *results,
                      struct iso_fault *fault)
{
    struct study study = {.corpus = NULL};
    int error = open_study(&study, corpus, model, fault);
    if (!error) {
        error = take_corpus(&study, corpus, fault);
    }
    for (int view = 0; !error && view < SIM_OUTLINE_VIEWS; view++) {
        const struct samples *gallery = &study.gallery[view];
        const struct samples *probes = &study.probes[view];
        error = sim_outline_recognise(gallery->sample, gallery->n, probes->sample, probes->n,
                                      &results[view]);
        if (error == -EINVAL) {
            (void)iso_fault_set(fault, error, "%s: no probes, or fewer than two people", corpus);
        }
    }
    close_study(&study);
    return error;
}

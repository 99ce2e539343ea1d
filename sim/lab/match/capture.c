#include "sim/lab/match/capture.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/base/path.h"
#include "sim/lab/match/latency.h"
#include "sim/lab/match/parallel.h"

struct capturing {
    const char *directory;
    const struct sim_corpus *corpus;
    const struct sim_capture_options *options;
    sim_capture_visitor *visit;
    void *visit_context;
    size_t *first_number;              /* of each row */
    struct iso_extractor **extractors; /* one for each worker */
    struct iso_fault *faults;          /* one for each worker */
};

const char *sim_reason_name(int reason)
{
    return reason == SIM_REASON_UNREADABLE ? "unreadable"
                                           : iso_capture_name((enum iso_capture)reason);
}

int sim_capture_reason(const struct sim_capture *capture)
{
    return capture->readable ? (int)capture->extraction.outcome : SIM_REASON_UNREADABLE;
}

size_t sim_corpus_frames(const struct sim_corpus *corpus)
{
    size_t n = 0;
    for (size_t row = 0; row < corpus->n_rows; row++) {
        n += corpus->rows[row].count;
    }
    return n;
}

int sim_recording_open(const char *directory, const char *name, struct iso_recording **out,
                       struct iso_fault *fault)
{
    char path[PATH_MAX];
    const int error = iso_path_join(directory, name, path, fault);
    if (error) {
        return error;
    }
    return iso_recording_open(path, out, fault);
}

static int capture_frame(const struct capturing *work, int worker, struct iso_recording *recording,
                         struct iso_frame *frame, struct sim_capture *capture)
{
    struct iso_fault fault = {.text = ""};
    if (iso_recording_read(recording, capture->frame, frame, &fault)) {
        fprintf(stderr, "isotherm-sim: frame left out: %s\n", fault.text);
        return 0;
    }
    capture->readable = true;
    const int64_t wall_ns = sim_wall_ns(NULL), cpu_ns = sim_thread_cpu_ns(NULL);
    const int error = iso_extractor_run(work->extractors[worker], frame, &capture->extraction);
    capture->cpu_ns = sim_thread_cpu_ns(NULL) - cpu_ns;
    capture->wall_ns = sim_wall_ns(NULL) - wall_ns;
    (void)snprintf(capture->extraction.tmpl.sensor, sizeof capture->extraction.tmpl.sensor, "%.*s",
                   ISO_TEMPLATE_SENSOR_MAX - 1, iso_recording_meta(recording)->sensor);
    return error ? iso_fault_set(&work->faults[worker], error, "frame %zu: %s", capture->frame,
                                 strerror(-error))
                 : 0;
}

static int capture_row(void *context, int worker, size_t row)
{
    const struct capturing *work = context;
    const struct sim_corpus_row *r = &work->corpus->rows[row];
    struct iso_recording *recording = NULL;
    struct iso_frame *frame = NULL;
    int error = sim_recording_open(work->directory, r->recording, &recording,
                                   &work->faults[worker]);
    if (error) {
        return error;
    }
    struct sim_capture *capture = calloc(1, sizeof *capture);
    error = capture ? iso_recording_frame_new(recording, &frame) : -ENOMEM;
    for (size_t i = 0; !error && i < r->count; i++) {
        memset(capture, 0, sizeof *capture);
        capture->row = row;
        capture->frame = r->first + i;
        error = capture_frame(work, worker, recording, frame, capture);
        if (!error && work->options->inspect && capture->extraction.outcome == ISO_CAPTURE_OK) {
            error = work->options->inspect(work->options->inspect_context,
                                           work->first_number[row] + i, work->extractors[worker],
                                           frame, capture);
        }
        if (!error) {
            work->visit(work->visit_context, work->first_number[row] + i, capture);
        }
    }
    if (capture) {
        explicit_bzero(capture, sizeof *capture); /* a template */
    }
    free(capture);
    iso_frame_free(frame);
    iso_recording_close(recording);
    return error;
}

static int new_extractors(struct capturing *work, const struct sim_capture_options *options,
                          struct sim_capture_origin *origin, struct iso_fault *fault)
{
    struct iso_extract_options extract = options->extract;
    struct iso_recording *recording = NULL;
    int error = sim_recording_open(work->directory, work->corpus->rows[0].recording, &recording,
                                   fault);
    if (error) {
        return error;
    }
    (void)snprintf(origin->sensor, sizeof origin->sensor, "%.*s", ISO_TEMPLATE_SENSOR_MAX - 1,
                   iso_recording_meta(recording)->sensor);
    memcpy(extract.sensor, origin->sensor, sizeof extract.sensor);
    iso_recording_close(recording);
    extract.now_ns = sim_thread_cpu_ns;
    for (int i = 0; !error && i < options->threads; i++) {
        error = iso_extractor_new(options->model, &extract, &work->extractors[i]);
    }
    if (error) {
        return iso_fault_set(fault, error, "extractor: %s",
                             error == -EINVAL ? "an option is out of range" : strerror(-error));
    }
    origin->algorithm = iso_extractor_algorithm(work->extractors[0]);
    return 0;
}

static void number_rows(const struct capturing *work)
{
    for (size_t row = 1; row < work->corpus->n_rows; row++) {
        work->first_number[row] = work->first_number[row - 1] + work->corpus->rows[row - 1].count;
    }
}

static void first_fault(const struct capturing *work, int threads, struct iso_fault *fault)
{
    for (int i = 0; i < threads; i++) {
        if (work->faults[i].text[0] != '\0') {
            (void)iso_fault_set(fault, 0, "%s", work->faults[i].text);
            return;
        }
    }
}

static int capture_rows(struct capturing *work, int threads, struct iso_fault *fault)
{
    const int error = sim_parallel(threads, "looking for faces in recordings", work->corpus->n_rows,
                                   capture_row, work);
    if (error) {
        (void)iso_fault_set(fault, error, "%s: %s", work->directory, strerror(-error));
        first_fault(work, threads, fault);
    }
    return error;
}

int sim_capture_all(const char *directory, const struct sim_corpus *corpus,
                    const struct sim_capture_options *options, sim_capture_visitor *visit,
                    void *context, struct sim_capture_origin *origin, struct iso_fault *fault)
{
    const size_t threads = (size_t)options->threads;
    struct capturing work = {directory, corpus, options, visit, context, NULL, NULL, NULL};
    struct sim_capture_origin found = {0};
    work.first_number = calloc(corpus->n_rows, sizeof *work.first_number);
    work.extractors = calloc(threads, sizeof *work.extractors);
    work.faults = calloc(threads, sizeof *work.faults);
    int error = 0;
    if (!work.first_number || !work.extractors || !work.faults) {
        error = iso_fault_set(fault, -ENOMEM, "%s: out of memory", directory);
    }
    if (!error) {
        number_rows(&work);
        error = new_extractors(&work, options, &found, fault);
    }
    if (!error) {
        error = capture_rows(&work, options->threads, fault);
    }
    if (!error) {
        *origin = found;
    }
    for (size_t i = 0; work.extractors && i < threads; i++) {
        iso_extractor_free(work.extractors[i]);
    }
    free(work.extractors);
    free(work.faults);
    free(work.first_number);
    return error;
}

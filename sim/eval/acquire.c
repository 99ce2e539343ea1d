#include "sim/eval/acquire.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/recording/recording.h"
#include "sim/eval/latency.h"
#include "sim/eval/parallel.h"

enum { FUSED_MAX = 64 }; /* of iso_template_fuse */

struct acquiring {
    const char *directory;
    const struct sim_corpus *corpus;
    struct sim_acquisition *acquisition;
    size_t *first_capture;             /* of each row */
    struct iso_extractor **extractors; /* one a worker */
    struct iso_fault *faults;          /* one a worker */
};

const char *sim_reason_name(int reason)
{
    return reason == SIM_REASON_UNREADABLE ? "unreadable"
                                           : iso_capture_name((enum iso_capture)reason);
}

static int open_recording(const char *directory, const char *name, struct iso_recording **out,
                          struct iso_fault *fault)
{
    char path[4096];
    int length = snprintf(path, sizeof path, "%s/%s", directory, name);
    if (length < 0 || (size_t)length >= sizeof path) {
        return iso_fault_set(fault, -ENAMETOOLONG, "%s: path too long", name);
    }
    return iso_recording_open(path, out, fault);
}

static int capture_frame(const struct acquiring *work, int worker, struct iso_recording *recording,
                         struct iso_frame *frame, struct sim_capture *capture)
{
    struct iso_fault fault = {""};
    if (iso_recording_read(recording, capture->frame, frame, &fault)) {
        fprintf(stderr, "isotherm-sim: frame left out: %s\n", fault.text);
        return 0;
    }
    capture->readable = true;
    int64_t wall_ns = sim_wall_ns(NULL), cpu_ns = sim_thread_cpu_ns(NULL);
    int error = iso_extractor_run(work->extractors[worker], frame, &capture->extraction);
    capture->cpu_ns = sim_thread_cpu_ns(NULL) - cpu_ns;
    capture->wall_ns = sim_wall_ns(NULL) - wall_ns;
    return error ? iso_fault_set(&work->faults[worker], error, "frame %zu: %s", capture->frame,
                                 strerror(-error))
                 : 0;
}

static int capture_row(void *context, int worker, size_t row)
{
    const struct acquiring *work = context;
    const struct sim_corpus_row *r = &work->corpus->rows[row];
    struct iso_recording *recording = NULL;
    struct iso_frame *frame = NULL;
    int error = open_recording(work->directory, r->recording, &recording, &work->faults[worker]);
    if (error) {
        return error;
    }
    error = iso_recording_frame_new(recording, &frame);
    for (size_t i = 0; !error && i < r->count; i++) {
        struct sim_capture *capture = &work->acquisition->captures[work->first_capture[row] + i];
        *capture = (struct sim_capture){.row = row, .frame = r->first + i};
        error = capture_frame(work, worker, recording, frame, capture);
    }
    iso_frame_free(frame);
    iso_recording_close(recording);
    return error;
}

/* Fuses the usable frames of a sample. */
static int make_sample(const struct sim_capture *captures, struct sim_sample *sample)
{
    const struct iso_template *usable[FUSED_MAX];
    int n = 0;
    for (size_t i = 0; i < sample->n_captures && n < FUSED_MAX; i++) {
        const struct iso_extraction *e = &captures[sample->first_capture + i].extraction;
        if (e->outcome == ISO_CAPTURE_OK) {
            usable[n++] = &e->tmpl;
        }
    }
    if (n == 0) {
        const struct sim_capture *first = &captures[sample->first_capture];
        sample->reason = first->readable ? (int)first->extraction.outcome : SIM_REASON_UNREADABLE;
        return 0;
    }
    sample->acquired = true;
    sample->reason = ISO_CAPTURE_OK;
    if (n == 1) {
        sample->tmpl = *usable[0];
        return 0;
    }
    return iso_template_fuse(usable, n, &sample->tmpl);
}

static size_t group_size(const struct sim_corpus_row *row, size_t fuse)
{
    size_t size = fuse > 0 && fuse < row->count ? fuse : row->count;
    return size < FUSED_MAX ? size : FUSED_MAX;
}

static int make_samples(const struct acquiring *work, size_t fuse, struct iso_fault *fault)
{
    struct sim_acquisition *a = work->acquisition;
    for (size_t row = 0; row < work->corpus->n_rows; row++) {
        size_t count = work->corpus->rows[row].count;
        size_t size = group_size(&work->corpus->rows[row], fuse);
        for (size_t first = 0; first < count; first += size) {
            struct sim_sample *sample = &a->samples[a->n_samples++];
            *sample = (struct sim_sample){
                .row = row,
                .first_capture = work->first_capture[row] + first,
                .n_captures = count - first < size ? count - first : size,
            };
            int error = make_sample(a->captures, sample);
            if (error) {
                return iso_fault_set(fault, error, "%s: frames cannot be fused: %s",
                                     work->corpus->rows[row].recording, strerror(-error));
            }
        }
    }
    return 0;
}

static int new_extractors(struct acquiring *work, const struct sim_acquire_options *options,
                          struct iso_fault *fault)
{
    struct iso_extract_options extract = options->extract;
    struct iso_recording *recording = NULL;
    int error = open_recording(work->directory, work->corpus->rows[0].recording, &recording, fault);
    if (error) {
        return error;
    }
    /* Templates of one run are compared with each other, whatever the recordings' sensors. */
    char *sensor = work->acquisition->sensor;
    (void)snprintf(sensor, ISO_TEMPLATE_SENSOR_MAX, "%.*s", ISO_TEMPLATE_SENSOR_MAX - 1,
                   iso_recording_meta(recording)->sensor);
    memcpy(extract.sensor, sensor, sizeof extract.sensor);
    iso_recording_close(recording);
    extract.now_ns = sim_thread_cpu_ns;
    for (int i = 0; !error && i < options->threads; i++) {
        error = iso_extractor_new(options->model, &extract, &work->extractors[i]);
    }
    if (error) {
        return iso_fault_set(fault, error, "extractor: %s",
                             error == -EINVAL ? "an option is out of range" : strerror(-error));
    }
    work->acquisition->algorithm = iso_extractor_algorithm(work->extractors[0]);
    return 0;
}

static int new_acquisition(struct acquiring *work, size_t fuse)
{
    struct sim_acquisition *a = calloc(1, sizeof *a);
    work->acquisition = a;
    work->first_capture = calloc(work->corpus->n_rows, sizeof *work->first_capture);
    if (!a || !work->first_capture) {
        return -ENOMEM;
    }
    size_t n_samples = 0;
    for (size_t row = 0; row < work->corpus->n_rows; row++) {
        size_t count = work->corpus->rows[row].count;
        size_t size = group_size(&work->corpus->rows[row], fuse);
        work->first_capture[row] = a->n_captures;
        a->n_captures += count;
        n_samples += (count + size - 1) / size;
    }
    a->captures = calloc(a->n_captures, sizeof *a->captures);
    a->samples = calloc(n_samples, sizeof *a->samples);
    return a->captures && a->samples ? 0 : -ENOMEM;
}

static void first_fault(const struct acquiring *work, int threads, struct iso_fault *fault)
{
    for (int i = 0; i < threads; i++) {
        if (work->faults[i].text[0] != '\0') {
            (void)iso_fault_set(fault, 0, "%s", work->faults[i].text);
            return;
        }
    }
}

int sim_acquire(const char *directory, const struct sim_corpus *corpus,
                const struct sim_acquire_options *options, struct sim_acquisition **out,
                struct iso_fault *fault)
{
    size_t threads = (size_t)options->threads;
    struct acquiring work = {.directory = directory, .corpus = corpus};
    work.extractors = calloc(threads, sizeof *work.extractors);
    work.faults = calloc(threads, sizeof *work.faults);
    int error = work.extractors && work.faults ? new_acquisition(&work, options->fuse) : -ENOMEM;
    if (error) {
        (void)iso_fault_set(fault, error, "%s: out of memory", directory);
        goto out;
    }
    error = new_extractors(&work, options, fault);
    if (error) {
        goto out;
    }
    error = sim_parallel(options->threads, corpus->n_rows, capture_row, &work);
    if (error) {
        (void)iso_fault_set(fault, error, "%s: %s", directory, strerror(-error));
        first_fault(&work, options->threads, fault);
        goto out;
    }
    error = make_samples(&work, options->fuse, fault);
out:
    for (size_t i = 0; work.extractors && i < threads; i++) {
        iso_extractor_free(work.extractors[i]);
    }
    free(work.extractors);
    free(work.faults);
    free(work.first_capture);
    if (error) {
        sim_acquisition_free(work.acquisition);
        return error;
    }
    *out = work.acquisition;
    return 0;
}

static void wipe_and_free(void *memory, size_t bytes)
{
    if (memory) {
        explicit_bzero(memory, bytes); /* templates */
        free(memory);
    }
}

void sim_acquisition_free(struct sim_acquisition *a)
{
    if (a) {
        wipe_and_free(a->captures, a->n_captures * sizeof *a->captures);
        wipe_and_free(a->samples, a->n_samples * sizeof *a->samples);
        free(a);
    }
}

/* Measures the way from a frame in memory to its landmarks, in milliseconds of processor time, with
 * one thread. The face is looked for in whole frames and in frames of half the resolution, or it is
 * followed from frame to frame. Where the frame shows nobody, the whole call is measured.
 *
 * The three ways take turns on every frame, so that other work of the machine affects all alike. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/frame/shrink.h"
#include "drivers/model/model_file.h"
#include "isotherm/extract.h"
#include "sim/lab/match/latency.h"
#include "tests/bench/frames.h"
#include "tests/bench/machine.h"

enum { HALF_MAX = 1920 * 1200 }; /* pixels */

enum way { LOOKED_FOR, HALF_SIZE, FOLLOWED, WAYS };

/* What is reported: the three ways, and the whole work on frames in which nobody is. */
enum { NOBODY = WAYS, REPORTED };

static const char *const names[REPORTED] = {"looked for", "looked for, half size", "followed",
                                            "nobody there"};

struct bench {
    struct iso_extractor *extractor[WAYS];
    struct iso_frame half;
    int width_px, height_px; /* of the last frame */
    size_t n[REPORTED], n_ok[REPORTED];
    int64_t *times_ns[REPORTED];
};

/* The time of the stages up to the landmarks. The patch is not one of them: it is for the template.
 */
static int64_t landmarks_ns(const struct iso_extraction *x)
{
    return x->stage_ns[ISO_STAGE_REGION] + x->stage_ns[ISO_STAGE_CLEAN] +
           x->stage_ns[ISO_STAGE_FIT];
}

static int time_frame(struct bench *b, enum way way, const struct iso_frame *frame)
{
    struct iso_extraction x;
    const int64_t begin_ns = sim_thread_cpu_ns(NULL);
    int error = iso_extractor_locate(b->extractor[way], frame, &x);
    const int64_t end_ns = sim_thread_cpu_ns(NULL);
    if (error || (way == FOLLOWED && !x.tracked)) {
        return error;
    }
    if (way == LOOKED_FOR && x.outcome == ISO_CAPTURE_NOBODY) {
        b->times_ns[NOBODY][b->n[NOBODY]++] = end_ns - begin_ns;
    }
    b->times_ns[way][b->n[way]++] = landmarks_ns(&x);
    b->n_ok[way] += x.outcome == ISO_CAPTURE_OK;
    return 0;
}

/* Times the three ways on one frame. */
static int time_ways(void *context, const struct iso_frame *frame, struct iso_fault *fault)
{
    struct bench *b = context;
    const struct iso_window all = {0, 0, frame->width_px, frame->height_px};
    int error = iso_frame_shrink(frame, all, 2, HALF_MAX, &b->half);
    if (!error) {
        error = time_frame(b, LOOKED_FOR, frame);
    }
    if (!error) {
        error = time_frame(b, HALF_SIZE, &b->half);
    }
    if (!error) {
        error = time_frame(b, FOLLOWED, frame);
    }
    b->width_px = frame->width_px;
    b->height_px = frame->height_px;
    return error ? iso_fault_set(fault, error, "extractor: %s", strerror(-error)) : 0;
}

static int prepare(struct bench *b, const struct iso_head_model *model, size_t n_frames)
{
    struct iso_extract_options options = iso_extract_options_default();
    options.now_ns = sim_thread_cpu_ns;
    int error = 0;
    for (int way = 0; way < WAYS && !error; way++) {
        options.track = way == FOLLOWED;
        error = iso_extractor_new(model, &options, &b->extractor[way]);
    }
    for (int i = 0; i < REPORTED && !error; i++) {
        b->times_ns[i] = calloc(n_frames, sizeof *b->times_ns[i]);
        error = b->times_ns[i] ? 0 : -ENOMEM;
    }
    b->half.depth_mm = calloc(HALF_MAX, sizeof *b->half.depth_mm);
    return b->half.depth_mm ? error : -ENOMEM;
}

static void report(struct bench *b)
{
    bench_print_machine();
    printf("one thread, processor time; the last frame was %d x %d\n", b->width_px, b->height_px);
    printf("%-22s %8s %8s %9s %9s\n", "landmarks", "frames", "usable", "median", "p95, ms");
    for (int i = 0; i < REPORTED; i++) {
        if (b->n[i] > 0) {
            const struct sim_latency latency = sim_latency_of(b->times_ns[i], b->n[i]);
            printf("%-22s %8zu %8zu %9.2f %9.2f\n", names[i], b->n[i], b->n_ok[i],
                   latency.median_ms, latency.p95_ms);
        }
    }
}

int main(int argc, char **argv)
{
    if (argc != 3) {
        fprintf(stderr, "usage: bench_landmarks CORPUS HEAD_MODEL\n");
        return 2;
    }
    struct bench bench = {0};
    struct iso_fault fault = {.text = ""};
    struct iso_head_model *model = NULL;
    struct sim_corpus *corpus = NULL;
    int error = iso_head_model_load(argv[2], &model, &fault);
    if (!error) {
        error = sim_corpus_read(argv[1], &corpus, &fault);
    }
    if (!error) {
        error = prepare(&bench, model, bench_frames_in(corpus));
    }
    for (size_t r = 0; !error && r < corpus->n_rows; r++) {
        iso_extractor_forget(bench.extractor[FOLLOWED]);
        error = bench_frames_of_row(argv[1], &corpus->rows[r], time_ways, &bench, &fault);
    }
    if (error) {
        fprintf(stderr, "bench_landmarks: %s\n", fault.text[0] ? fault.text : strerror(-error));
    } else {
        report(&bench);
    }
    for (int way = 0; way < WAYS; way++) {
        iso_extractor_free(bench.extractor[way]);
    }
    for (int i = 0; i < REPORTED; i++) {
        free(bench.times_ns[i]);
    }
    free(bench.half.depth_mm);
    sim_corpus_free(corpus);
    iso_head_model_free(model);
    return error ? 1 : 0;
}

/* Computes one stored frame once, from the frame in memory to the ten best of 1,000 made-up people,
 * with one thread. It is for a script that counts instructions from outside
 * (tests/aarch64/instructions.sh): each line of the output names the code between two calls of
 * one_frame_mark().
 *
 *   one_frame CORPUS MODEL METRIC RECORDING      the first frame of a recording of the corpus */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/model/model_file.h"
#include "isotherm/extract.h"
#include "isotherm/index.h"
#include "sim/lab/match/capture.h"
#include "tests/bench/crowd.h"

enum { PEOPLE = 1000, SHORTLIST = 10 };

struct bench {
    struct iso_head_model *model;
    struct iso_metric *metric;
    struct iso_extractor *extractor;
    struct iso_index *index;
    struct iso_recording *recording;
    struct iso_frame *frame;
    int64_t marks;
};

/* An empty function that the script finds by its name in the program. */
void one_frame_mark(void);

__attribute__((noinline)) void one_frame_mark(void)
{
    __asm__ volatile("");
}

/* The extractor's clock, which the extractor reads before its first stage and after each stage. */
static int64_t count_marks(void *context)
{
    struct bench *bench = context;
    one_frame_mark();
    return ++bench->marks;
}

static int prepare(struct bench *bench, char **argv, struct iso_fault *fault)
{
    struct iso_extract_options options = iso_extract_options_default();
    options.now_ns = count_marks;
    options.now_context = bench;
    int error = iso_head_model_load(argv[2], &bench->model, fault);
    if (!error) {
        error = iso_metric_load(argv[3], &bench->metric, fault);
    }
    if (!error) {
        error = sim_recording_open(argv[1], argv[4], &bench->recording, fault);
    }
    if (!error) {
        error = iso_recording_frame_new(bench->recording, &bench->frame);
    }
    if (!error) {
        error = iso_recording_read(bench->recording, 0, bench->frame, fault);
    }
    if (!error) {
        error = iso_extractor_new(bench->model, &options, &bench->extractor);
    }
    if (!error) {
        error = iso_index_new(bench->metric, &bench->index);
    }
    if (!error) {
        error = iso_index_reserve(bench->index, PEOPLE);
    }
    for (size_t i = 0; !error && i < PEOPLE; i++) {
        const struct iso_metric_vector vector = bench_vector(bench->metric, i, 0);
        error = iso_index_put(bench->index, (int64_t)i, &vector);
    }
    return error;
}

static int run(struct bench *bench)
{
    struct iso_extraction extraction;
    struct iso_metric_vector probe;
    struct iso_search_hit hits[SHORTLIST];
    int n = 0;
    int error = iso_extractor_run(bench->extractor, bench->frame, &extraction);
    if (!error && (extraction.outcome != ISO_CAPTURE_OK || bench->marks != ISO_STAGES + 1)) {
        error = -ENODATA; /* the extractor did not run every stage once */
    }
    one_frame_mark();
    if (!error) {
        error = iso_metric_project(bench->metric, &extraction.tmpl, &probe);
    }
    one_frame_mark();
    if (!error) {
        error = iso_index_search(bench->index, &probe, hits, SHORTLIST, &n);
    }
    one_frame_mark();
    if (!error && n != SHORTLIST) {
        error = -ENODATA;
    }
    return error;
}

static void release(struct bench *bench)
{
    iso_index_free(bench->index);
    iso_extractor_free(bench->extractor);
    iso_frame_free(bench->frame);
    iso_recording_close(bench->recording);
    iso_metric_free(bench->metric);
    iso_head_model_free(bench->model);
}

int main(int argc, char **argv)
{
    struct bench bench = {0};
    struct iso_fault fault = {.text = ""};
    if (argc != 5) {
        (void)fprintf(stderr, "usage: one_frame CORPUS MODEL METRIC RECORDING\n");
        return 2;
    }
    int error = prepare(&bench, argv, &fault);
    if (!error) {
        error = run(&bench);
    }
    if (error) {
        (void)fprintf(stderr, "one_frame: %s\n", fault.text[0] ? fault.text : strerror(-error));
    }
    for (int s = 0; !error && s < ISO_STAGES; s++) {
        puts(iso_stage_name((enum iso_stage)s));
    }
    if (!error) {
        puts("return\nprojection\nsearch");
    }
    release(&bench);
    return error ? EXIT_FAILURE : EXIT_SUCCESS;
}

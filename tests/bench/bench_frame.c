/* From a frame in memory to a verdict, one thread, 1,000 people enrolled: milliseconds per stage.
 *
 * Every frame is worked on twice, timed by wall clock and by the thread's processor time: the first
 * is what a person waits, the second does not depend on what else the machine is doing. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/extract.h"
#include "core/match/index.h"
#include "drivers/recording/recording.h"
#include "firmware/decision.h"
#include "firmware/times.h"
#include "sim/data_file.h"
#include "sim/eval/extract_options.h"
#include "sim/eval/latency.h"
#include "sim/recording/corpus.h"
#include "tests/bench/crowd.h"
#include "tests/bench/machine.h"

enum { ENROLLED = 1000, SHORTLIST = 10 };

/* What is timed: the extractor's stages, search and decision, and all of it. */
enum { SEARCH = ISO_STAGES, TOTAL, TIMED };

typedef int64_t clock_function(void *context);

static clock_function *const clocks[] = {sim_wall_ns, sim_thread_cpu_ns};
enum { CLOCKS = sizeof clocks / sizeof *clocks };

struct bench {
    const char *directory, *model_path, *metric_path;
    struct iso_extract_options extract;
    struct iso_match_options match;
    struct iso_head_model *model;
    struct iso_metric *metric;
    struct sim_corpus *corpus;
    struct iso_extractor *extractor;
    clock_function *clock; /* in use */
    struct iso_index *index;
    size_t n_enrolled;
    struct iso_decision decision;
    int64_t t_ns; /* of the frame, for the decision */
    int64_t *times_ns[CLOCKS][TIMED];
    size_t n_timed, n_frames;
};

static int64_t bench_now_ns(void *context)
{
    const struct bench *bench = context;
    return bench->clock(NULL);
}

/* Does something with each frame of the rows of a kind: gallery, or not. */
typedef int frame_function(struct bench *bench, const struct iso_frame *frame,
                           struct iso_fault *fault);

static int read_row(struct bench *bench, const struct sim_corpus_row *row, frame_function *each,
                    struct iso_fault *fault)
{
    char path[4096];
    (void)snprintf(path, sizeof path, "%s/%s", bench->directory, row->recording);
    struct iso_recording *recording = NULL;
    struct iso_frame *frame = NULL;
    int error = iso_recording_open(path, &recording, fault);
    if (error) {
        return error;
    }
    error = iso_recording_frame_new(recording, &frame);
    for (size_t i = 0; !error && i < row->count; i++) {
        error = iso_recording_read(recording, row->first + i, frame, fault);
        if (!error) {
            error = each(bench, frame, fault);
        }
    }
    iso_frame_free(frame);
    iso_recording_close(recording);
    return error;
}

static int read_rows(struct bench *bench, bool gallery, frame_function *each,
                     struct iso_fault *fault)
{
    int error = 0;
    for (size_t i = 0; !error && i < bench->corpus->n_rows; i++) {
        const struct sim_corpus_row *row = &bench->corpus->rows[i];
        if ((row->role == SIM_ROLE_GALLERY) == gallery) {
            error = read_row(bench, row, each, fault);
        }
    }
    return error;
}

static int extract(struct bench *bench, const struct iso_frame *frame,
                   struct iso_extraction *extraction, struct iso_fault *fault)
{
    int error = iso_extractor_run(bench->extractor, frame, extraction);
    return error ? iso_fault_set(fault, error, "extractor: %s", strerror(-error)) : 0;
}

static int enrol_frame(struct bench *bench, const struct iso_frame *frame, struct iso_fault *fault)
{
    struct iso_extraction extraction;
    if (bench->n_enrolled == ENROLLED) {
        return 0;
    }
    int error = extract(bench, frame, &extraction, fault);
    if (!error && extraction.outcome == ISO_CAPTURE_OK) {
        struct iso_metric_vector vector;
        error = iso_metric_project(bench->metric, &extraction.tmpl, &vector);
        error = error ? error : iso_index_put(bench->index, (int64_t)++bench->n_enrolled, &vector);
    }
    return error == -ENODATA ? 0 : error;
}

/* As many made-up people as are missing. */
static int fill_up(struct bench *bench)
{
    int error = 0;
    while (!error && bench->n_enrolled < ENROLLED) {
        const struct iso_metric_vector vector = bench_vector(bench->metric, bench->n_enrolled, 0);
        error = iso_index_put(bench->index, (int64_t)++bench->n_enrolled, &vector);
    }
    return error;
}

/* The best people, and what the decision makes of them. */
static int recognise(struct bench *bench, const struct iso_extraction *extraction)
{
    struct iso_search_hit hits[SHORTLIST];
    struct iso_metric_vector probe;
    struct iso_verdict verdict;
    int n = 0;
    int error = iso_metric_project(bench->metric, &extraction->tmpl, &probe);
    error = error ? error : iso_index_search(bench->index, &probe, hits, SHORTLIST, &n);
    if (!error) {
        const struct iso_decision_frame face = {bench->t_ns,   hits[0].person, hits[0].score,
                                                hits[1].score, true,           1};
        (void)iso_decision_time(&bench->decision, bench->t_ns, &verdict);
        (void)iso_decision_track(&bench->decision, 1, &verdict);
        (void)iso_decision_face(&bench->decision, &face, &verdict);
    }
    return error;
}

static int time_frame(struct bench *bench, const struct iso_frame *frame, struct iso_fault *fault)
{
    bench->n_frames++;
    bench->t_ns += 33 * ISO_NS_PER_MS;
    for (int c = 0; c < CLOCKS; c++) {
        struct iso_extraction extraction;
        bench->clock = clocks[c];
        int64_t begin_ns = bench->clock(NULL);
        int error = extract(bench, frame, &extraction, fault);
        if (error || extraction.outcome != ISO_CAPTURE_OK) {
            return error;
        }
        int64_t extracted_ns = bench->clock(NULL);
        error = recognise(bench, &extraction);
        if (error) {
            return error == -ENODATA ? 0
                                     : iso_fault_set(fault, error, "search: %s", strerror(-error));
        }
        int64_t end_ns = bench->clock(NULL);
        for (int s = 0; s < ISO_STAGES; s++) {
            bench->times_ns[c][s][bench->n_timed] = extraction.stage_ns[s];
        }
        bench->times_ns[c][SEARCH][bench->n_timed] = end_ns - extracted_ns;
        bench->times_ns[c][TOTAL][bench->n_timed] = end_ns - begin_ns;
    }
    bench->n_timed++;
    return 0;
}

/* Loads what is needed and makes room for as many times as there are frames. */
static int prepare(struct bench *bench, struct iso_fault *fault)
{
    int error = sim_head_model_load(bench->model_path, &bench->model, fault);
    if (!error) {
        error = sim_metric_load(bench->metric_path, &bench->metric, fault);
    }
    if (!error) {
        error = sim_corpus_read(bench->directory, &bench->corpus, fault);
    }
    if (error) {
        return error;
    }
    size_t n_frames = 0;
    for (size_t i = 0; i < bench->corpus->n_rows; i++) {
        n_frames += bench->corpus->rows[i].count;
    }
    error = iso_index_new(bench->metric, &bench->index);
    error = error ? error : iso_index_reserve(bench->index, ENROLLED);
    iso_decision_init(&bench->decision, &(struct iso_decision_options){3.0, 0.5, 2, 10, 3,
                                                                       ISO_NS_PER_S, ISO_NS_PER_S});
    for (int i = 0; i < CLOCKS * TIMED; i++) {
        int64_t **times_ns = &bench->times_ns[i / TIMED][i % TIMED];
        *times_ns = calloc(n_frames, sizeof **times_ns);
        error = *times_ns ? error : -ENOMEM;
    }
    bench->extract.now_ns = bench_now_ns;
    bench->extract.now_context = bench;
    if (!error) {
        error = iso_extractor_new(bench->model, &bench->extract, &bench->extractor);
    }
    return error ? iso_fault_set(fault, error, "extractor: %s", strerror(-error)) : 0;
}

/* Enrols from the gallery, then from the other frames, and makes up who is missing; then times
 * these. */
static int run(struct bench *bench, struct iso_fault *fault)
{
    int error = read_rows(bench, true, enrol_frame, fault);
    if (!error) {
        error = read_rows(bench, false, enrol_frame, fault);
    }
    if (!error) {
        error = fill_up(bench);
    }
    return error ? error : read_rows(bench, false, time_frame, fault);
}

static void release(struct bench *bench)
{
    for (int i = 0; i < CLOCKS * TIMED; i++) {
        free(bench->times_ns[i / TIMED][i % TIMED]);
    }
    iso_index_free(bench->index);
    iso_extractor_free(bench->extractor);
    sim_corpus_free(bench->corpus);
    iso_metric_free(bench->metric);
    iso_head_model_free(bench->model);
}

static void print_table(struct bench *bench)
{
    bench_print_machine();
    printf("%zu of %zu frames usable; %zu people enrolled, metric of %d numbers; one thread\n\n",
           bench->n_timed, bench->n_frames, bench->n_enrolled, bench->metric->n_dimensions);
    printf("ms                  wall              processor\n"
           "stage         median      p95      median      p95\n");
    for (int s = 0; s < TIMED; s++) {
        struct sim_latency wall = sim_latency_of(bench->times_ns[0][s], bench->n_timed);
        struct sim_latency cpu = sim_latency_of(bench->times_ns[1][s], bench->n_timed);
        const char *name = s == SEARCH  ? "recognise"
                           : s == TOTAL ? "total"
                                        : iso_stage_name((enum iso_stage)s);
        printf("%-10s %9.2f %8.2f   %9.2f %8.2f\n", name, wall.median_ms, wall.p95_ms,
               cpu.median_ms, cpu.p95_ms);
    }
}

#define FIELD(name) offsetof(struct bench, name)

static const struct sim_option own_options[] = {
    {"corpus", "DIR", "recordings and manifest.csv", sim_option_text, FIELD(directory)},
    {"model", "FILE", "head model", sim_option_text, FIELD(model_path)},
    {"metric", "FILE", "learned metric", sim_option_text, FIELD(metric_path)},
};

int main(int argc, char **argv)
{
    struct bench bench = {
        .model_path = SIM_DATA_FILE_MODEL,
        .metric_path = SIM_DATA_FILE_METRIC,
        .extract = iso_extract_options_default(),
        .match = iso_match_options_default(),
        .clock = sim_wall_ns,
    };
    const struct sim_option_set sets[] = {
        {own_options, sizeof own_options / sizeof *own_options, &bench},
        sim_extract_option_set(&bench.extract),
        sim_match_option_set(&bench.match),
    };
    size_t n_sets = sizeof sets / sizeof *sets;
    struct iso_fault fault = {"--corpus is needed"};
    enum sim_options_outcome outcome = sim_options_parse(argc, argv, sets, n_sets, &fault);
    if (outcome == SIM_OPTIONS_HELP) {
        puts("Usage: bench_frame --corpus DIR [OPTION...]\n");
        sim_options_help(sets, n_sets, stdout);
        return EXIT_SUCCESS;
    }
    bool read = outcome == SIM_OPTIONS_READ && bench.directory;
    int error = read ? prepare(&bench, &fault) : -EINVAL;
    if (!error) {
        error = run(&bench, &fault);
    }
    if (!error) {
        print_table(&bench);
    } else {
        fprintf(stderr, "bench_frame: %s\n", fault.text);
    }
    release(&bench);
    return error ? EXIT_FAILURE : EXIT_SUCCESS;
}

/* Measures each stage from a frame in memory to a verdict, in milliseconds, with one thread and
 * 1,000 enrolled people.
 *
 * The gallery is a sealed file, as the daemon's is. It has the people of the corpus, and made-up
 * people who have the upper faces of the people of the corpus. The reranking of every frame is
 * timed twice: first without templates in memory, so that all candidates are read from the file,
 * which the total includes; then once more with all templates in memory.
 *
 * Every frame is computed twice, timed by the wall clock and by the thread's processor time. The
 * first is the time that a person waits; the second does not depend on other work of the machine.
 */
#include <errno.h>
#include <libgen.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "drivers/base/shipped.h"
#include "drivers/base/times.h"
#include "drivers/model/model_file.h"
#include "firmware/recognise/method/reranker.h"
#include "firmware/visit/decision.h"
#include "isotherm/extract.h"
#include "isotherm/index.h"
#include "sim/corpus/corpus.h"
#include "sim/lab/match/extract_options.h"
#include "sim/lab/match/latency.h"
#include "tests/bench/crowd.h"
#include "tests/bench/enrolled.h"
#include "tests/bench/frames.h"
#include "tests/bench/machine.h"

enum { ENROLLED = 1000, FACES_MAX = 512, PLACE_MAX = 4096 };

/* The timed steps: the extractor's stages; the search by the index; reranking and decision with
 * templates from the file, and with templates in memory; search and reranking from the file
 * together; and all steps except the reranking from memory. */
enum { SEARCH = ISO_STAGES, RERANK, RERANK_KEPT, ONE_TO_MANY, TOTAL, TIMED };

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
    clock_function *clock; /* the one in use */
    char path[PLACE_MAX];  /* of the gallery, in a temporary directory */
    struct iso_key_ring *ring;
    struct iso_gallery *gallery;
    struct iso_reranker *reranker;
    uint64_t version;           /* of the gallery, as the reranker sees it */
    size_t people;              /* to enrol */
    struct iso_template *faces; /* [FACES_MAX] of the corpus */
    size_t n_faces;
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

/* Calls `each` with the frames of the rows of one kind: gallery, or not. */
static int read_rows(struct bench *bench, bool gallery, bench_frame_function *each,
                     struct iso_fault *fault)
{
    int error = 0;
    for (size_t i = 0; !error && i < bench->corpus->n_rows; i++) {
        const struct sim_corpus_row *row = &bench->corpus->rows[i];
        if ((row->role == SIM_ROLE_GALLERY) == gallery) {
            error = bench_frames_of_row(bench->directory, row, each, bench, fault);
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

static int keep_face(void *context, const struct iso_frame *frame, struct iso_fault *fault)
{
    struct bench *bench = context;
    struct iso_extraction extraction;
    if (bench->n_faces == FACES_MAX || bench->n_faces == bench->people) {
        return 0;
    }
    const int error = extract(bench, frame, &extraction, fault);
    if (!error && extraction.outcome == ISO_CAPTURE_OK) {
        bench->faces[bench->n_faces++] = extraction.tmpl;
    }
    return error == -ENODATA ? 0 : error;
}

/* A person has the template of a face of the corpus, or made-up isotherms with the upper face of
 * one.
 */
static struct iso_template template_of(const void *context, size_t person, size_t number)
{
    const struct bench *bench = context;
    if (person < bench->n_faces) {
        return bench->faces[person];
    }
    struct iso_template made_up = bench_template(bench->metric, person, number);
    made_up.upper = bench->faces[person % bench->n_faces].upper;
    return made_up;
}

static int open_gallery(struct bench *bench, struct iso_fault *fault)
{
    return bench_gallery_open(bench->path, bench->people, bench->metric, bench->ring,
                              &bench->gallery, fault);
}

/* Makes the gallery, closes it and opens it again, as a daemon does that starts. */
static int make_gallery(struct bench *bench, struct iso_fault *fault)
{
    if (bench->n_faces == 0) {
        return iso_fault_set(fault, -ENODATA, "%s: no usable face", bench->directory);
    }
    int error = open_gallery(bench, fault);
    if (!error) {
        error = bench_gallery_fill(bench->gallery, bench->people, 1000, 1, template_of, bench,
                                   fault);
    }
    iso_gallery_close(bench->gallery);
    bench->gallery = NULL;
    return error ? error : open_gallery(bench, fault);
}

static void decide(struct bench *bench, const struct iso_search_hit *hits)
{
    struct iso_verdict verdict;
    const struct iso_decision_frame face = {bench->t_ns,   hits[0].person, hits[0].score,
                                            hits[1].score, true,           1};
    (void)iso_decision_time(&bench->decision, bench->t_ns, &verdict);
    (void)iso_decision_track(&bench->decision, 1, &verdict);
    (void)iso_decision_face(&bench->decision, &face, &verdict);
}

/* Searches, reranks and decides. end_ns[SEARCH...] are the times at which these steps ended. */
static int recognise(struct bench *bench, const struct iso_extraction *extraction, int64_t *end_ns)
{
    struct iso_search_hit hits[ISO_RERANK_CANDIDATES];
    struct iso_metric_vector probe;
    struct iso_candidate_list among = iso_gallery_everybody(bench->gallery);
    int n = 0;
    int error = iso_metric_project(bench->metric, &extraction->tmpl, &probe);
    if (!error) {
        error = iso_index_search(among.index, &probe, hits, ISO_RERANK_CANDIDATES, &n);
    }
    end_ns[SEARCH] = bench->clock(NULL);
    among.version = ++bench->version; /* the reranker drops its templates */
    for (int kept = RERANK; !error && kept <= RERANK_KEPT; kept++) {
        struct iso_search_hit best[ISO_RERANK_CANDIDATES];
        memcpy(best, hits, sizeof best);
        error = iso_reranker_take(bench->reranker, bench->metric, &among, &extraction->tmpl, best,
                                  n);
        if (!error) {
            decide(bench, best);
        }
        end_ns[kept] = bench->clock(NULL);
    }
    return error;
}

static int time_frame(void *context, const struct iso_frame *frame, struct iso_fault *fault)
{
    struct bench *bench = context;
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
        int64_t end_ns[TIMED] = {0};
        const int64_t extracted_ns = bench->clock(NULL);
        error = recognise(bench, &extraction, end_ns);
        if (error) {
            return error == -ENODATA ? 0
                                     : iso_fault_set(fault, error, "search: %s", strerror(-error));
        }
        for (int s = 0; s < ISO_STAGES; s++) {
            bench->times_ns[c][s][bench->n_timed] = extraction.stage_ns[s];
        }
        const int64_t times_ns[TIMED] = {
            [SEARCH] = end_ns[SEARCH] - extracted_ns,
            [RERANK] = end_ns[RERANK] - end_ns[SEARCH],
            [RERANK_KEPT] = end_ns[RERANK_KEPT] - end_ns[RERANK],
            [ONE_TO_MANY] = end_ns[RERANK] - extracted_ns,
            [TOTAL] = end_ns[RERANK] - begin_ns,
        };
        for (int s = SEARCH; s < TIMED; s++) {
            bench->times_ns[c][s][bench->n_timed] = times_ns[s];
        }
    }
    bench->n_timed++;
    return 0;
}

/* Makes a directory and keys for the gallery. */
static int open_ring(struct bench *bench, struct iso_fault *fault)
{
    const char *temporary = getenv("TMPDIR");
    char directory[PLACE_MAX - 16];
    const int length = snprintf(directory, sizeof directory, "%s/bench_frame-XXXXXX",
                                temporary ? temporary : "/tmp");
    if ((size_t)length >= sizeof directory) {
        return iso_fault_set(fault, -ENAMETOOLONG, "TMPDIR: the name is too long");
    }
    if (!mkdtemp(directory)) {
        return iso_fault_set(fault, -errno, "%s: %s", directory, strerror(errno));
    }
    (void)snprintf(bench->path, sizeof bench->path, "%s/gallery.db", directory);
    const int error = iso_seal_start(fault);
    return error ? error : bench_ring_open(bench->path, &bench->ring, fault);
}

static void remove_gallery(struct bench *bench)
{
    bench_gallery_remove(bench->path);
    (void)rmdir(dirname(bench->path));
}

/* Loads the data files and allocates room for the times of all frames. */
static int prepare(struct bench *bench, struct iso_fault *fault)
{
    int error = iso_head_model_load(bench->model_path, &bench->model, fault);
    if (!error) {
        error = iso_metric_load(bench->metric_path, &bench->metric, fault);
    }
    if (!error) {
        error = sim_corpus_read(bench->directory, &bench->corpus, fault);
    }
    if (error) {
        return error;
    }
    const size_t n_frames = bench_frames_in(bench->corpus);
    error = open_ring(bench, fault);
    if (error) {
        return error;
    }
    bench->faces = calloc(FACES_MAX, sizeof *bench->faces);
    error = bench->faces ? iso_reranker_new(&bench->reranker) : -ENOMEM;
    iso_decision_init(&bench->decision,
                      &(struct iso_decision_options){3.0, 0.5, 2, 10, 3, ISO_NS_PER_S, ISO_NS_PER_S,
                                                     ISO_NS_PER_S});
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

/* Enrols the faces of the gallery's rows, then those of the other rows, then made-up people. Then
 * it times the other rows. */
static int run(struct bench *bench, struct iso_fault *fault)
{
    int error = read_rows(bench, true, keep_face, fault);
    if (!error) {
        error = read_rows(bench, false, keep_face, fault);
    }
    if (!error) {
        error = make_gallery(bench, fault);
    }
    return error ? error : read_rows(bench, false, time_frame, fault);
}

static void release(struct bench *bench)
{
    for (int i = 0; i < CLOCKS * TIMED; i++) {
        free(bench->times_ns[i / TIMED][i % TIMED]);
    }
    iso_reranker_free(bench->reranker);
    iso_gallery_close(bench->gallery);
    iso_key_ring_close(bench->ring);
    if (bench->ring) {
        remove_gallery(bench);
    }
    free(bench->faces);
    iso_extractor_free(bench->extractor);
    sim_corpus_free(bench->corpus);
    iso_metric_free(bench->metric);
    iso_head_model_free(bench->model);
}

static void print_table(struct bench *bench)
{
    static const char *const more[TIMED] = {
        [SEARCH] = "search",   [RERANK] = "rerank", [RERANK_KEPT] = "... kept",
        [ONE_TO_MANY] = "1:N", [TOTAL] = "total",
    };
    bench_print_machine();
    printf("%zu of %zu frames usable; %zu people enrolled, metric of %d numbers; one thread\n\n",
           bench->n_timed, bench->n_frames, bench->people, bench->metric->n_dimensions);
    printf("ms                  wall              processor\n"
           "stage         median      p95      median      p95\n");
    for (int s = 0; s < TIMED; s++) {
        struct sim_latency wall = sim_latency_of(bench->times_ns[0][s], bench->n_timed);
        struct sim_latency cpu = sim_latency_of(bench->times_ns[1][s], bench->n_timed);
        const char *name = s < ISO_STAGES ? iso_stage_name((enum iso_stage)s) : more[s];
        printf("%-10s %9.2f %8.2f   %9.2f %8.2f\n", name, wall.median_ms, wall.p95_ms,
               cpu.median_ms, cpu.p95_ms);
    }
}

#define FIELD(name) offsetof(struct bench, name)

static const struct sim_option own_options[] = {
    {"corpus", "DIR", "recordings and manifest.csv", sim_option_text, FIELD(directory)},
    {"model", "FILE", "head model", sim_option_text, FIELD(model_path)},
    {"metric", "FILE", "learned metric", sim_option_text, FIELD(metric_path)},
    {"people", "N", "number of enrolled people (1000)", sim_option_count, FIELD(people)},
};

int main(int argc, char **argv)
{
    struct bench bench = {
        .model_path = iso_shipped_model(),
        .metric_path = iso_shipped_metric(),
        .extract = iso_extract_options_default(),
        .match = iso_match_options_default(),
        .clock = sim_wall_ns,
        .people = ENROLLED,
    };
    const struct sim_option_set sets[] = {
        {own_options, sizeof own_options / sizeof *own_options, &bench},
        sim_extract_option_set(&bench.extract),
        sim_match_option_set(&bench.match),
    };
    size_t n_sets = sizeof sets / sizeof *sets;
    struct iso_fault fault = {.text = "--corpus is needed"};
    enum sim_options_outcome outcome = sim_options_parse(argc, argv, sets, n_sets, &fault);
    if (outcome == SIM_OPTIONS_HELP) {
        puts("Usage: bench_frame --corpus DIR [OPTION...]\n");
        sim_options_help(sets, n_sets, stdout);
        return EXIT_SUCCESS;
    }
    bool read = outcome == SIM_OPTIONS_READ && bench.directory && bench.people > 0;
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

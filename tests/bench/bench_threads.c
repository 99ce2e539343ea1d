/* What a second thread saves: the heat stage of whole frames, one thread and two in turn, frame by
 * frame with the rest of a frame's work and its pause in between, so that a helper is asleep when
 * heat begins, as in the daemon. First on the machine as it is, then with a process for each
 * processor that never rests. Wall time.
 *
 * Processors that a host shares with others are not equally fast: one thread on the faster of two
 * is not what two threads on both are to be compared with. So on the machine as it is the caller
 * works on each of them in turn, ten pairs at a time; who helps goes where it likes. */
#include <errno.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "core/extract/extract.h"
#include "drivers/base/shipped.h"
#include "drivers/base/times.h"
#include "firmware/recognise/crew.h"
#include "sim/base/data_file.h"
#include "sim/base/options.h"
#include "sim/corpus/corpus.h"
#include "sim/lab/match/latency.h"
#include "tests/bench/frames.h"
#include "tests/bench/machine.h"

enum { SIDES = 2, LOAD_MAX = 64, PAIRS_OF_A_TURN = 10 };

struct bench {
    const char *directory, *model_path;
    int interval_ms;
    size_t pairs; /* at most, of a machine's state */
    struct iso_head_model *model;
    struct sim_corpus *corpus;
    struct iso_crew *crew;
    struct iso_extractor *extractor[SIDES]; /* one thread, two threads */
    int64_t *heat_ns[SIDES], *ratio_ppm;
    size_t n_frames, n_timed; /* read; of those usable, in this run */
    cpu_set_t processors;     /* that this process may use */
    bool turns;               /* the caller works on each of these in turn */
    int64_t next_ns;
};

/* Waits for the next frame, as who reads a camera does. */
static void wait_for_frame(struct bench *bench)
{
    const struct timespec at = {bench->next_ns / ISO_NS_PER_S, bench->next_ns % ISO_NS_PER_S};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, NULL) == EINTR) {
    }
    const int64_t now_ns = sim_wall_ns(NULL);
    const int64_t next_ns = bench->next_ns + bench->interval_ms * ISO_NS_PER_MS;
    bench->next_ns = next_ns > now_ns ? next_ns : now_ns;
}

/* The processor whose turn it is, for the caller. */
static void take_turn(const struct bench *bench)
{
    const size_t n = (size_t)CPU_COUNT(&bench->processors);
    size_t skip = bench->n_timed / PAIRS_OF_A_TURN % (n > 0 ? n : 1);
    for (size_t i = 0; i < CPU_SETSIZE; i++) {
        if (CPU_ISSET(i, &bench->processors) && skip-- == 0) {
            cpu_set_t one;
            CPU_ZERO(&one);
            CPU_SET(i, &one);
            (void)sched_setaffinity(0, sizeof one, &one);
            return;
        }
    }
}

static int time_frame(void *context, const struct iso_frame *frame, struct iso_fault *fault)
{
    struct bench *bench = context;
    int64_t heat_ns[SIDES] = {0};
    if (bench->n_timed == bench->pairs) {
        return 0;
    }
    if (bench->turns) {
        take_turn(bench);
    }
    for (int i = 0; i < SIDES; i++) {
        const int side = (i + (int)bench->n_frames) % SIDES;
        struct iso_extraction extraction;
        wait_for_frame(bench);
        const int error = iso_extractor_run(bench->extractor[side], frame, &extraction);
        if (error) {
            return iso_fault_set(fault, error, "extractor: %s", strerror(-error));
        }
        heat_ns[side] = extraction.outcome == ISO_CAPTURE_OK ? extraction.stage_ns[ISO_STAGE_HEAT]
                                                             : 0;
        iso_template_wipe(&extraction.tmpl);
    }
    bench->n_frames++;
    if (heat_ns[0] > 0 && heat_ns[1] > 0) {
        bench->heat_ns[0][bench->n_timed] = heat_ns[0];
        bench->heat_ns[1][bench->n_timed] = heat_ns[1];
        bench->ratio_ppm[bench->n_timed++] = heat_ns[0] * 1000000 / heat_ns[1];
    }
    return 0;
}

static double mean_ms(const int64_t *times_ns, size_t n)
{
    double sum_ns = 0.0;
    for (size_t i = 0; i < n; i++) {
        sum_ns += (double)times_ns[i];
    }
    return n > 0 ? sum_ns / (double)n * 1e-6 : 0.0;
}

/* Processor time that everybody on the machine had so far, this process, and could have had, s. */
struct use {
    double all, own, there;
};

static struct use use_now(void)
{
    const double tick_s = 1.0 / (double)sysconf(_SC_CLK_TCK);
    long long ticks[8] = {0}; /* user, nice, system, idle, waiting, interrupts (2), taken away */
    struct rusage own = {0};
    FILE *file = fopen("/proc/stat", "re");
    if (file) {
        (void)fscanf(file, "cpu %lld %lld %lld %lld %lld %lld %lld %lld", &ticks[0], &ticks[1],
                     &ticks[2], &ticks[3], &ticks[4], &ticks[5], &ticks[6], &ticks[7]);
        (void)fclose(file);
    }
    (void)getrusage(RUSAGE_SELF, &own);
    const long long idle = ticks[3] + ticks[4];
    const long long busy = ticks[0] + ticks[1] + ticks[2] + ticks[5] + ticks[6] + ticks[7];
    return (struct use){
        .all = (double)busy * tick_s,
        .own = (double)(own.ru_utime.tv_sec + own.ru_stime.tv_sec) +
               (double)(own.ru_utime.tv_usec + own.ru_stime.tv_usec) * 1e-6,
        .there = (double)(idle + busy) * tick_s,
    };
}

static int time_corpus(struct bench *bench, const char *what, struct iso_fault *fault)
{
    int error = 0;
    const struct use before = use_now();
    bench->n_timed = 0;
    bench->next_ns = sim_wall_ns(NULL);
    for (size_t i = 0; !error && i < bench->corpus->n_rows; i++) {
        error = bench_frames_of_row(bench->directory, &bench->corpus->rows[i], time_frame, bench,
                                    fault);
    }
    if (error) {
        return error;
    }
    const struct use after = use_now();
    const double others = (after.all - before.all - after.own + before.own) /
                          (after.there - before.there);
    const double mean[SIDES] = {mean_ms(bench->heat_ns[0], bench->n_timed),
                                mean_ms(bench->heat_ns[1], bench->n_timed)};
    const struct sim_latency one = sim_latency_of(bench->heat_ns[0], bench->n_timed);
    const struct sim_latency two = sim_latency_of(bench->heat_ns[1], bench->n_timed);
    const struct sim_latency ratio = sim_latency_of(bench->ratio_ppm, bench->n_timed);
    printf("%-10s %5.0f %% %5zu  %8.3f %8.3f %8.3f  %8.3f %8.3f %8.3f  %7.2f %7.2f %7.2f\n", what,
           100.0 * others, bench->n_timed, one.median_ms, one.p95_ms, mean[0], two.median_ms,
           two.p95_ms, mean[1], one.median_ms / two.median_ms, ratio.median_ms, mean[0] / mean[1]);
    (void)fflush(stdout);
    return 0;
}

/* A process for each processor, at work until it is stopped or this one ends. */
static int start_load(pid_t load[LOAD_MAX])
{
    const long n_processors = sysconf(_SC_NPROCESSORS_ONLN);
    int n = 0;
    (void)fflush(NULL);
    while (n < n_processors && n < LOAD_MAX) {
        const pid_t child = fork();
        if (child == 0) {
            (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
            for (volatile unsigned i = 0;; i++) {
            }
        }
        if (child < 0) {
            break;
        }
        load[n++] = child;
    }
    return n;
}

static void stop_load(const pid_t load[LOAD_MAX], int n)
{
    for (int i = 0; i < n; i++) {
        (void)kill(load[i], SIGKILL);
        (void)waitpid(load[i], NULL, 0);
    }
}

static int prepare(struct bench *bench, struct iso_fault *fault)
{
    struct iso_extract_options options = iso_extract_options_default();
    options.now_ns = sim_wall_ns;
    int error = sim_head_model_load(bench->model_path, &bench->model, fault);
    error = error ? error : sim_corpus_read(bench->directory, &bench->corpus, fault);
    if (error) {
        return error;
    }
    const size_t n_frames = bench_frames_in(bench->corpus);
    error = iso_crew_new(SIDES, &bench->crew);
    for (int side = 0; !error && side < SIDES; side++) {
        options.tasks = side == 0 ? NULL : iso_crew_tasks(bench->crew);
        error = iso_extractor_new(bench->model, &options, &bench->extractor[side]);
        bench->heat_ns[side] = calloc(n_frames, sizeof *bench->heat_ns[side]);
        error = error || bench->heat_ns[side] ? error : -ENOMEM;
    }
    bench->ratio_ppm = calloc(n_frames, sizeof *bench->ratio_ppm);
    error = error || bench->ratio_ppm ? error : -ENOMEM;
    return error ? iso_fault_set(fault, error, "extractors: %s", strerror(-error)) : 0;
}

static int run(struct bench *bench, struct iso_fault *fault)
{
    bench_print_machine();
    printf("Heat of a frame by one thread and two in turn, a frame every %d ms; wall ms\n\n"
           "%-10s %7s %5s  %8s %8s %8s  %8s %8s %8s  %7s %7s %7s\n",
           bench->interval_ms, "machine", "others", "pairs", "one", "p95", "mean", "two", "p95",
           "mean", "medians", "pairs", "means");
    bench->turns = sched_getaffinity(0, sizeof bench->processors, &bench->processors) == 0;
    int error = time_corpus(bench, "as it is", fault);
    if (bench->turns) {
        (void)sched_setaffinity(0, sizeof bench->processors, &bench->processors);
        bench->turns = false;
    }
    if (!error) {
        pid_t load[LOAD_MAX];
        const int n = start_load(load);
        error = n > 0 ? time_corpus(bench, "full", fault) : -EAGAIN;
        stop_load(load, n);
    }
    return error;
}

static void release(struct bench *bench)
{
    for (int side = 0; side < SIDES; side++) {
        iso_extractor_free(bench->extractor[side]);
        free(bench->heat_ns[side]);
    }
    free(bench->ratio_ppm);
    iso_crew_free(bench->crew);
    sim_corpus_free(bench->corpus);
    iso_head_model_free(bench->model);
}

#define FIELD(name) offsetof(struct bench, name)

static const struct sim_option own_options[] = {
    {"corpus", "DIR", "recordings and manifest.csv", sim_option_text, FIELD(directory)},
    {"model", "FILE", "head model", sim_option_text, FIELD(model_path)},
    {"pairs", "N", "of frames, at most", sim_option_count, FIELD(pairs)},
    {"interval", "MS", "from frame to frame", sim_option_int, FIELD(interval_ms)},
};

int main(int argc, char **argv)
{
    struct bench bench = {.model_path = iso_shipped_model(), .interval_ms = 33, .pairs = 200};
    const struct sim_option_set set = {own_options, sizeof own_options / sizeof *own_options,
                                       &bench};
    struct iso_fault fault = {.text = "--corpus is needed"};
    const enum sim_options_outcome outcome = sim_options_parse(argc, argv, &set, 1, &fault);
    if (outcome == SIM_OPTIONS_HELP) {
        puts("Usage: bench_threads --corpus DIR [OPTION...]\n");
        sim_options_help(&set, 1, stdout);
        return EXIT_SUCCESS;
    }
    const bool read = outcome == SIM_OPTIONS_READ && bench.directory;
    int error = read ? prepare(&bench, &fault) : -EINVAL;
    error = error ? error : run(&bench, &fault);
    if (error) {
        (void)fprintf(stderr, "bench_threads: %s\n", fault.text);
    }
    release(&bench);
    return error ? EXIT_FAILURE : EXIT_SUCCESS;
}

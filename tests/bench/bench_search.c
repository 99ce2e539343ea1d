/* Compares the 1:N search with two alternatives: the exact score of all people, and FLANN's nearest
 * neighbours. The latter is equivalent to the score if all people have the same number of
 * templates: the score falls with the distance between x / sqrt(same) and shrink y / sqrt(same)
 * (index.h). One thread, processor time. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef HAVE_FLANN
#include <flann/flann.h>
#endif

#include "drivers/base/shipped.h"
#include "drivers/model/model_file.h"
#include "isotherm/index.h"
#include "sim/base/options.h"
#include "sim/lab/draw/plot.h"
#include "sim/lab/match/latency.h"
#include "tests/bench/crowd.h"
#include "tests/bench/machine.h"

enum { SIZES = 5, SHORTLIST = 10, PROBES_MAX = 200, METHODS = 5 };

static const size_t sizes[SIZES] = {100, 1000, 10000, 100000, 1000000};

static const char *const method_names[METHODS] = {
    "index", "exact score of everybody", "FLANN, linear", "FLANN, 4 k-d trees", "FLANN, k-means",
};
enum { INDEX, EXHAUSTIVE, FLANN_FIRST };

struct bench {
    const char *metric_path, *out;
    size_t probes;
    struct iso_metric *metric;
    size_t people;
    struct iso_metric_vector *enrolled, probe[PROBES_MAX];
    int64_t mate[PROBES_MAX];           /* the person of the probe; -1: a stranger */
    double best[PROBES_MAX][SHORTLIST]; /* exact scores of the best */
    double median_ms[METHODS][SIZES];   /* NaN: not measured */
};

struct hits {
    int n;
    int64_t person[SHORTLIST];
};

/* Every other probe is of a person who is not enrolled. */
static void make_people(struct bench *bench)
{
    for (size_t i = 0; i < bench->people; i++) {
        bench->enrolled[i] = bench_vector(bench->metric, i, 0);
    }
    for (size_t i = 0; i < bench->probes; i++) {
        const size_t person = i % 2 ? bench->people + i : i * 7919u % bench->people;
        bench->probe[i] = bench_vector(bench->metric, person, 1);
        bench->mate[i] = i % 2 ? -1 : (int64_t)person;
    }
}

static void search_exhaustively(const struct bench *bench, size_t probe, struct hits *hits,
                                double *scores)
{
    hits->n = 0;
    for (size_t i = 0; i < bench->people; i++) {
        const double score = iso_metric_score(bench->metric, &bench->enrolled[i],
                                              &bench->probe[probe]);
        if (hits->n < SHORTLIST || score > scores[SHORTLIST - 1]) {
            int at = hits->n < SHORTLIST ? hits->n++ : SHORTLIST - 1;
            for (; at > 0 && scores[at - 1] < score; at--) {
                scores[at] = scores[at - 1];
                hits->person[at] = hits->person[at - 1];
            }
            scores[at] = score;
            hits->person[at] = (int64_t)i;
        }
    }
}

struct recall {
    size_t found, wanted;      /* how many of the best people are in the shortlist, of how many */
    size_t mates, mates_found; /* probes of enrolled people; those whose person was found */
};

/* A person with the score of the last one, except for rounding, is as good. */
static void add_recall(const struct bench *bench, size_t probe, const struct hits *hits,
                       struct recall *recall)
{
    const int wanted = bench->people < SHORTLIST ? (int)bench->people : SHORTLIST;
    int found = 0;
    bool mate = false;
    for (int k = 0; k < hits->n; k++) {
        const double score = iso_metric_score(bench->metric, &bench->enrolled[hits->person[k]],
                                              &bench->probe[probe]);
        found += score >= bench->best[probe][wanted - 1] - 1e-4;
        mate = mate || hits->person[k] == bench->mate[probe];
    }
    recall->wanted += (size_t)wanted;
    recall->found += (size_t)(found < wanted ? found : wanted);
    recall->mates += bench->mate[probe] >= 0;
    recall->mates_found += mate && bench->mate[probe] >= 0;
}

static void print_method(struct bench *bench, int method, int size, int64_t *took_ns,
                         const struct recall *recall, double built_ms, double bytes)
{
    const struct sim_latency took = sim_latency_of(took_ns, bench->probes);
    bench->median_ms[method][size] = took.median_ms;
    printf("%8zu  %-26s %9.3f %9.3f %11.3f%% %10.2f%% %10.0f %9.0f\n", bench->people,
           method_names[method], took.median_ms, took.p95_ms,
           100.0 * (double)recall->found / (double)recall->wanted,
           100.0 * (double)recall->mates_found / (double)recall->mates, built_ms, bytes);
    (void)fflush(stdout);
}

static void time_exhaustive(struct bench *bench, int size)
{
    static int64_t took_ns[PROBES_MAX];
    struct recall recall = {0};
    for (size_t p = 0; p < bench->probes; p++) {
        struct hits hits;
        const int64_t begin_ns = sim_thread_cpu_ns(NULL);
        search_exhaustively(bench, p, &hits, bench->best[p]);
        took_ns[p] = sim_thread_cpu_ns(NULL) - begin_ns;
        add_recall(bench, p, &hits, &recall);
    }
    print_method(bench, EXHAUSTIVE, size, took_ns, &recall, 0.0, sizeof *bench->enrolled);
}

static int time_index(struct bench *bench, int size)
{
    static int64_t took_ns[PROBES_MAX];
    struct iso_index *index = NULL;
    struct recall recall = {0};
    const int64_t begin_ns = sim_thread_cpu_ns(NULL);
    int error = iso_index_new(bench->metric, &index);
    if (!error) {
        error = iso_index_reserve(index, bench->people);
    }
    for (size_t i = 0; !error && i < bench->people; i++) {
        error = iso_index_put(index, (int64_t)i, &bench->enrolled[i]);
    }
    const double built_ms = (double)(sim_thread_cpu_ns(NULL) - begin_ns) * 1e-6;
    for (size_t p = 0; !error && p < bench->probes; p++) {
        struct iso_search_hit found[SHORTLIST];
        struct hits hits = {.n = 0};
        const int64_t start_ns = sim_thread_cpu_ns(NULL);
        error = iso_index_search(index, &bench->probe[p], found, SHORTLIST, &hits.n);
        took_ns[p] = sim_thread_cpu_ns(NULL) - start_ns;
        for (int k = 0; !error && k < hits.n; k++) {
            hits.person[k] = found[k].person;
        }
        add_recall(bench, p, &hits, &recall);
    }
    if (!error) {
        const int stride = (bench->metric->n_dimensions + 7) / 8 * 8;
        print_method(bench, INDEX, size, took_ns, &recall, built_ms, 4.0 * stride + 88.25);
    }
    iso_index_free(index);
    return error;
}

#ifdef HAVE_FLANN
/* Coordinates in which the score is a distance: of a probe, or of a person with one template. */
static void flann_point(const struct iso_metric *metric, const struct iso_metric_vector *vector,
                        bool enrolled, float *out)
{
    for (int d = 0; d < metric->n_dimensions; d++) {
        const double b = (double)metric->between[d], same = 1.0 + b / (1.0 + b);
        const double x = (double)(vector->scale * vector->mean[d]);
        out[d] = (float)((enrolled ? b / (1.0 + b) : 1.0) * x / sqrt(same));
    }
}

static int time_flann(struct bench *bench, int size, int method)
{
    static const enum flann_algorithm_t algorithms[] = {FLANN_INDEX_LINEAR, FLANN_INDEX_KDTREE,
                                                        FLANN_INDEX_KMEANS};
    static int64_t took_ns[PROBES_MAX];
    const int n = bench->metric->n_dimensions;
    struct FLANNParameters parameters = DEFAULT_FLANN_PARAMETERS;
    struct recall recall = {0};
    float speedup = 0.0f;
    float *points = malloc(bench->people * (size_t)n * sizeof *points);
    if (!points) {
        return -ENOMEM;
    }
    for (size_t i = 0; i < bench->people; i++) {
        flann_point(bench->metric, &bench->enrolled[i], true, &points[i * (size_t)n]);
    }
    parameters.algorithm = algorithms[method - FLANN_FIRST];
    parameters.checks = 512;
    parameters.trees = 4;
    parameters.branching = 32;
    parameters.cores = 1;
    parameters.random_seed = 1;
    parameters.log_level = FLANN_LOG_NONE;
    const int64_t begin_ns = sim_thread_cpu_ns(NULL);
    flann_index_t index = flann_build_index_float(points, (int)bench->people, n, &speedup,
                                                  &parameters);
    const double built_ms = (double)(sim_thread_cpu_ns(NULL) - begin_ns) * 1e-6;
    for (size_t p = 0; p < bench->probes; p++) {
        float probe[ISO_METRIC_DIMENSIONS_MAX], distances[SHORTLIST];
        int found[SHORTLIST];
        struct hits hits = {.n = SHORTLIST};
        const int64_t start_ns = sim_thread_cpu_ns(NULL);
        flann_point(bench->metric, &bench->probe[p], false, probe);
        (void)flann_find_nearest_neighbors_index_float(index, probe, 1, found, distances, SHORTLIST,
                                                       &parameters);
        took_ns[p] = sim_thread_cpu_ns(NULL) - start_ns;
        for (int k = 0; k < SHORTLIST; k++) {
            hits.person[k] = found[k] >= 0 ? found[k] : 0;
        }
        add_recall(bench, p, &hits, &recall);
    }
    print_method(bench, method, size, took_ns, &recall, built_ms, 4.0 * n);
    (void)flann_free_index_float(index, &parameters);
    free(points);
    return 0;
}
#endif

static int run_size(struct bench *bench, int size)
{
    const size_t most = bench->probes;
    bench->people = sizes[size];
    /* Among a million people an exhaustive search takes more than a second. */
    const size_t enough = bench->people >= 1000000 ? 20 : bench->people >= 100000 ? 60 : most;
    bench->probes = enough < most ? enough : most;
    bench->enrolled = calloc(bench->people, sizeof *bench->enrolled);
    if (!bench->enrolled) {
        return -ENOMEM;
    }
    make_people(bench);
    time_exhaustive(bench, size);
    int error = time_index(bench, size);
#ifdef HAVE_FLANN
    /* A tree of a million people takes minutes to make. */
    const int end = bench->people >= 1000000 ? FLANN_FIRST + 1 : METHODS;
    for (int m = FLANN_FIRST; !error && m < end; m++) {
        error = time_flann(bench, size, m);
    }
#endif
    free(bench->enrolled);
    bench->probes = most;
    return error;
}

static int plot(const struct bench *bench, struct iso_fault *fault)
{
    struct sim_series series[METHODS];
    double people[SIZES], low = INFINITY, high = 0.0;
    size_t n = 0;
    for (int s = 0; s < SIZES; s++) {
        people[s] = (double)sizes[s];
    }
    for (int m = 0; m < METHODS; m++) {
        if (!isnan(bench->median_ms[m][0])) {
            series[n++] = (struct sim_series){method_names[m], SIM_SERIES_MARKED, SIZES, people,
                                              bench->median_ms[m]};
            low = fmin(low, bench->median_ms[m][0]);
            high = fmax(high, bench->median_ms[m][SIZES - 2]);
        }
    }
    const struct sim_plot drawing = {
        .title = "The ten best of so many people",
        .subtitle = "one thread, median processor time",
        .legend = SIM_LEGEND_UPPER,
        .x = {"people", SIM_SCALE_LOG, 80, 1250000},
        .y = {"milliseconds", SIM_SCALE_LOG, low * 0.5, high * 60.0},
        .n_series = n,
        .series = series,
    };
    char path[4096];
    (void)snprintf(path, sizeof path, "%s/search_people.png", bench->out);
    return sim_plot_write(&drawing, path, fault);
}

static const struct sim_option own_options[] = {
    {"metric", "FILE", "learned metric", sim_option_text, offsetof(struct bench, metric_path)},
    {"out", "DIR", "an existing directory for the plot; without it there is no plot",
     sim_option_text, offsetof(struct bench, out)},
    {"probes", "N", "searches at each size, 2 to 200 (200); half of them are of strangers",
     sim_option_count, offsetof(struct bench, probes)},
};

int main(int argc, char **argv)
{
    static struct bench bench = {.probes = PROBES_MAX};
    bench.metric_path = iso_shipped_metric();
    const struct sim_option_set set = {own_options, sizeof own_options / sizeof *own_options,
                                       &bench};
    struct iso_fault fault = {.text = "--probes: 2 to 200"};
    const enum sim_options_outcome outcome = sim_options_parse(argc, argv, &set, 1, &fault);
    if (outcome == SIM_OPTIONS_HELP) {
        puts("Usage: bench_search [OPTION...]\n");
        sim_options_help(&set, 1, stdout);
        return EXIT_SUCCESS;
    }
    const bool read = outcome == SIM_OPTIONS_READ && bench.probes >= 2 &&
                      bench.probes <= PROBES_MAX;
    int error = read ? iso_metric_load(bench.metric_path, &bench.metric, &fault) : -EINVAL;
    for (int i = 0; i < METHODS * SIZES; i++) {
        bench.median_ms[i / SIZES][i % SIZES] = NAN;
    }
    if (!error) {
        bench_print_machine();
        printf("The %d best by a metric of %d numbers; made-up people, one template each\n\n"
               "%8s  %-26s %9s %9s %12s %11s %10s %9s\n",
               SHORTLIST, bench.metric->n_dimensions, "people", "", "median ms", "p95 ms",
               "of the best", "of mates", "ms to make", "bytes");
        for (int s = 0; !error && s < SIZES; s++) {
            error = run_size(&bench, s);
        }
        error = error ? iso_fault_set(&fault, error, "%s", strerror(-error)) : 0;
    }
    if (!error && bench.out) {
        error = plot(&bench, &fault);
    }
    if (error) {
        (void)fprintf(stderr, "bench_search: %s\n", fault.text);
    }
    iso_metric_free(bench.metric);
    return error ? EXIT_FAILURE : EXIT_SUCCESS;
}

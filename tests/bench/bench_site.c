/* Measures the adaptation of the metric to the people of a site (firmware/site/site_index.h): the
 * time from the last change until the new metric is complete, the memory, and the time that a
 * search takes with the best people scored by the adapted metric. */
#include <stdio.h>
#include <stdlib.h>

#include "drivers/base/shipped.h"
#include "drivers/model/model_file.h"
#include "firmware/site/site_index.h"
#include "sim/base/options.h"
#include "sim/lab/match/latency.h"
#include "tests/bench/crowd.h"
#include "tests/bench/machine.h"

enum { SIZES = 4, TEMPLATES = 5, SHORTLIST = 10, PROBES = 200 };

static const size_t sizes[SIZES] = {10, 100, 1000, 10000};

static int fill_site(struct iso_site_index *site, const struct iso_metric *metric, size_t people)
{
    int error = 0;
    for (size_t p = 0; !error && p < people; p++) {
        for (uint64_t take = 0; !error && take < TEMPLATES; take++) {
            const struct iso_metric_vector vector = bench_vector(metric, p, take);
            error = iso_site_index_reserve(site, 1);
            error = error ? error : iso_site_index_add(site, (int64_t)p, 1, "astra", &vector);
        }
    }
    return error;
}

/* The time of a search by the shipped metric, and of scoring the best people by the adapted one. */
static int time_search(const struct iso_site_index *site, const struct iso_metric *metric,
                       struct sim_latency *search, struct sim_latency *again)
{
    static int64_t search_ns[PROBES], again_ns[PROBES];
    const struct iso_site_metric *adapted = iso_site_index_metric(site);
    const struct iso_index *index = iso_site_index_current(site);
    int error = 0;
    for (size_t p = 0; !error && p < PROBES; p++) {
        const struct iso_metric_vector shipped = bench_vector(metric, p, TEMPLATES);
        struct iso_metric_vector probe, person;
        struct iso_search_hit hits[SHORTLIST];
        int n = 0;
        const int64_t begin_ns = sim_thread_cpu_ns(NULL);
        error = iso_index_search(index, &shipped, hits, SHORTLIST, &n);
        const int64_t middle_ns = sim_thread_cpu_ns(NULL);
        iso_site_turn(adapted, &shipped, &probe);
        for (int i = 0; !error && i < n; i++) {
            error = iso_site_index_person(site, hits[i].person, &person);
            hits[i].score = iso_site_score(adapted, hits[i].person, &person, &probe);
        }
        search_ns[p] = middle_ns - begin_ns;
        again_ns[p] = sim_thread_cpu_ns(NULL) - middle_ns;
    }
    *search = sim_latency_of(search_ns, PROBES);
    *again = sim_latency_of(again_ns, PROBES);
    return error;
}

static int bench_size(const struct iso_metric *metric, size_t people)
{
    struct sim_latency search, again;
    struct iso_site_index *site = NULL;
    int error = iso_site_index_new(metric, true, &site);
    if (!error) {
        error = fill_site(site, metric, people);
    }
    const int64_t begin_ns = sim_wall_ns(NULL);
    if (!error) {
        error = iso_site_index_start(site);
    }
    if (!error) {
        error = iso_site_index_settle(site);
    }
    const double took_ms = (double)(sim_wall_ns(NULL) - begin_ns) * 1e-6;
    if (!error) {
        error = time_search(site, metric, &search, &again);
    }
    if (!error) {
        printf("%8zu %10zu %12.1f %12.3f %12.3f\n", people, people * TEMPLATES, took_ms,
               search.median_ms, again.median_ms);
        (void)fflush(stdout);
        bench_print_memory();
    }
    iso_site_index_free(site);
    return error;
}

/* The argument is the metric's file; without one, it is the installed metric. */
int main(int argc, char *argv[])
{
    struct iso_metric *metric = NULL;
    struct iso_fault fault = {.text = ""};
    int error = iso_metric_load(argc > 1 ? argv[1] : iso_shipped_metric(), &metric, &fault);
    if (error) {
        fprintf(stderr, "%s\n", fault.text);
        return EXIT_FAILURE;
    }
    bench_print_machine();
    printf("%8s %10s %12s %12s %12s\n", "people", "templates", "adapted, ms", "search, ms",
           "again, ms");
    for (int i = 0; !error && i < SIZES; i++) {
        error = bench_size(metric, sizes[i]);
    }
    iso_metric_free(metric);
    if (error) {
        fprintf(stderr, "bench_site: error %d\n", error);
    }
    return error ? EXIT_FAILURE : EXIT_SUCCESS;
}

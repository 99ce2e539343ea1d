/* Measures a gallery with many people, which is filled by an import. Prints how long the daemon
 * needs to open keys, gallery and log, which it does before it opens its sensor, at the first
 * start, which makes and stores the vectors of all templates, and at later ones; how long a search
 * takes, and reading the templates of a shortlist; and the size of the gallery on the disk and in
 * memory.
 * --keep leaves the gallery on the disk, so that a daemon can be started with it (resident.sh). */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "drivers/base/shipped.h"
#include "drivers/base/times.h"
#include "drivers/model/model_file.h"
#include "firmware/audit/audit.h"
#include "firmware/keys/seal.h"
#include "sim/base/options.h"
#include "sim/lab/match/latency.h"
#include "tests/bench/crowd.h"
#include "tests/bench/enrolled.h"
#include "tests/bench/machine.h"

enum { SHORTLIST = 10, TIMES = 200, STARTS = 3 };

/* The stores, in the order in which they are opened. */
enum { KEYS, GALLERY, LOG, PARTS };

typedef int64_t clock_function(void *context);

static clock_function *const clocks[] = {sim_wall_ns, sim_thread_cpu_ns};
enum { CLOCKS = sizeof clocks / sizeof *clocks };

struct bench {
    const char *directory, *metric_path;
    size_t people, templates; /* people of the gallery, templates of a person */
    size_t batch;             /* people of one import */
    size_t keep;              /* not 0: do not delete the gallery */
    char path[4096];
    struct iso_times times;
    struct iso_metric *metric;
    struct iso_key_ring *ring;
    struct iso_gallery *gallery;
    struct iso_audit *audit;
};

static struct iso_template template_of(const void *context, size_t person, size_t number)
{
    const struct bench *bench = context;
    return bench_template(bench->metric, person, number);
}

static int open_gallery(struct bench *bench, struct iso_fault *fault)
{
    return bench_gallery_open(bench->path, bench->people, bench->metric, bench->ring,
                              &bench->gallery, fault);
}

static int open_ring(struct bench *bench, struct iso_fault *fault)
{
    return bench_ring_open(bench->path, &bench->ring, fault);
}

static int open_log(struct bench *bench, struct iso_fault *fault)
{
    char path[4200];
    (void)snprintf(path, sizeof path, "%s.log", bench->path);
    const struct iso_audit_options options = {.path = path, .sync = true, .ring = bench->ring};
    return iso_audit_open(&options, &bench->times, &bench->audit, fault);
}

static void close_all(struct bench *bench)
{
    iso_audit_close(bench->audit);
    iso_gallery_close(bench->gallery);
    iso_key_ring_close(bench->ring);
    bench->audit = NULL;
    bench->gallery = NULL;
    bench->ring = NULL;
}

/* Opens all stores. Times that are shorter than those in least_ns replace them. */
static int open_all(struct bench *bench, int64_t least_ns[CLOCKS][PARTS + 1],
                    struct iso_fault *fault)
{
    static int (*const open_part[PARTS])(struct bench *, struct iso_fault *) = {
        [KEYS] = open_ring, [GALLERY] = open_gallery, [LOG] = open_log};
    int64_t at_ns[CLOCKS][PARTS + 1];
    int error = 0;
    for (int part = 0; !error && part <= PARTS; part++) {
        for (int c = 0; c < CLOCKS; c++) {
            at_ns[c][part] = clocks[c](NULL);
        }
        error = part < PARTS ? open_part[part](bench, fault) : 0;
    }
    for (int i = 0; !error && i < CLOCKS * (PARTS + 1); i++) {
        const int c = i / (PARTS + 1), part = i % (PARTS + 1);
        const int64_t took_ns = part < PARTS ? at_ns[c][part + 1] - at_ns[c][part]
                                             : at_ns[c][PARTS] - at_ns[c][0];
        least_ns[c][part] = took_ns < least_ns[c][part] ? took_ns : least_ns[c][part];
    }
    return error;
}

static int fill(struct bench *bench, struct iso_fault *fault)
{
    int error = open_ring(bench, fault);
    if (!error) {
        error = open_gallery(bench, fault);
    }
    if (error) {
        return error;
    }
    const int64_t begin_ns = sim_wall_ns(NULL), begin_cpu_ns = sim_thread_cpu_ns(NULL);
    error = bench_gallery_fill(bench->gallery, bench->people, bench->batch, bench->templates,
                               template_of, bench, fault);
    if (!error) {
        printf("import of %zu people, %zu at a time: %.2f s wall, %.2f s processor\n",
               bench->people, bench->batch, (double)(sim_wall_ns(NULL) - begin_ns) * 1e-9,
               (double)(sim_thread_cpu_ns(NULL) - begin_cpu_ns) * 1e-9);
    }
    return error;
}

static int time_search(const struct bench *bench, size_t *wrong, struct iso_fault *fault)
{
    static int64_t project_ns[TIMES], scan_ns[TIMES], fetch_ns[TIMES];
    static struct iso_template found[SHORTLIST * BENCH_TEMPLATES_MAX];
    const struct iso_candidate_list all = iso_gallery_everybody(bench->gallery);
    *wrong = 0;
    for (int i = 0; i < TIMES; i++) {
        const size_t person = (size_t)i * 7919u % bench->people;
        const struct iso_template tmpl = bench_template(bench->metric, person, BENCH_TEMPLATES_MAX);
        struct iso_search_hit hits[SHORTLIST];
        struct iso_metric_vector probe;
        int n = 0;
        const int64_t begin_ns = sim_wall_ns(NULL);
        int error = iso_metric_project(bench->metric, &tmpl, &probe);
        const int64_t projected_ns = sim_wall_ns(NULL);
        if (!error) {
            error = iso_index_search(all.index, &probe, hits, SHORTLIST, &n);
        }
        const int64_t searched_ns = sim_wall_ns(NULL);
        for (int k = 0; !error && k < n; k++) {
            int m = 0;
            error = iso_gallery_templates(bench->gallery, hits[k].person,
                                          &found[k * BENCH_TEMPLATES_MAX], BENCH_TEMPLATES_MAX, &m,
                                          fault);
        }
        if (error) {
            return error;
        }
        project_ns[i] = projected_ns - begin_ns;
        scan_ns[i] = searched_ns - projected_ns;
        fetch_ns[i] = sim_wall_ns(NULL) - searched_ns;
        const struct iso_person *best = iso_gallery_find_id(bench->gallery, hits[0].person);
        char name[32];
        (void)snprintf(name, sizeof name, "person %zu", person);
        *wrong += !best || strcmp(best->name, name) != 0;
    }
    const struct sim_latency project = sim_latency_of(project_ns, TIMES);
    const struct sim_latency scan = sim_latency_of(scan_ns, TIMES);
    const struct sim_latency fetch = sim_latency_of(fetch_ns, TIMES);
    printf("%d searches, wall ms             median      p95\n"
           "  probe's vector            %9.3f %8.3f\n"
           "  scan of the index         %9.3f %8.3f\n"
           "  templates of %2d people    %9.3f %8.3f\n",
           TIMES, project.median_ms, project.p95_ms, scan.median_ms, scan.p95_ms, SHORTLIST,
           fetch.median_ms, fetch.p95_ms);
    return 0;
}

/* The least times of some starts, of each clock and each store. */
struct starts {
    int64_t least_ns[CLOCKS][PARTS + 1];
};

/* Closes and opens all stores n times. */
static int time_starts(struct bench *bench, int n, struct starts *out, struct iso_fault *fault)
{
    for (int i = 0; i < CLOCKS * (PARTS + 1); i++) {
        out->least_ns[i / (PARTS + 1)][i % (PARTS + 1)] = INT64_MAX;
    }
    for (int i = 0; i < n; i++) {
        close_all(bench);
        const int error = open_all(bench, out->least_ns, fault);
        if (error) {
            return error;
        }
    }
    return 0;
}

static void print_starts(const struct starts *first, const struct starts *later)
{
    static const char *const names[PARTS + 1] = {"keys", "gallery", "log", "all"};
    printf("opening, ms                first start          later (least of %d)\n"
           "                          wall   processor        wall   processor\n",
           STARTS);
    for (int part = 0; part <= PARTS; part++) {
        printf("  %-18s", names[part]);
        for (int i = 0; i < 2; i++) {
            const struct starts *starts = i == 0 ? first : later;
            printf("  %10.1f  %10.1f", (double)starts->least_ns[0][part] * 1e-6,
                   (double)starts->least_ns[1][part] * 1e-6);
        }
        printf("\n");
    }
}

static int measure(struct bench *bench, struct iso_fault *fault)
{
    struct starts first, later;
    struct stat status = {0};
    size_t wrong = 0;
    int error = time_starts(bench, 1, &first, fault);
    if (!error) {
        error = time_starts(bench, STARTS, &later, fault);
    }
    if (error) {
        return error;
    }
    (void)stat(bench->path, &status);
    printf("%zu people, %zu templates each: %.1f MiB on the disk\n", bench->people,
           bench->templates, (double)status.st_size / (1 << 20));
    print_starts(&first, &later);
    error = time_search(bench, &wrong, fault);
    if (!error) {
        printf("the best hit is another person: %zu of %d\n", wrong, TIMES);
        bench_print_memory();
    }
    return error;
}

/* Deletes the log, and without --keep the gallery and its keys, too. */
static void remove_files(const struct bench *bench)
{
    static const char *const ends[] = {".log", ".log.anchor"};
    char path[4200];
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        (void)snprintf(path, sizeof path, "%s%s", bench->path, ends[i]);
        (void)unlink(path);
    }
    if (!bench->keep) {
        bench_gallery_remove(bench->path);
    }
}

static const struct sim_option own_options[] = {
    {"dir", "DIR", "an existing directory for the gallery", sim_option_text,
     offsetof(struct bench, directory)},
    {"people", "N", "people in the gallery (10000)", sim_option_count,
     offsetof(struct bench, people)},
    {"templates", "N", "templates of each person, 1 to 16 (1)", sim_option_count,
     offsetof(struct bench, templates)},
    {"batch", "N", "people of one import (100)", sim_option_count, offsetof(struct bench, batch)},
    {"metric", "FILE", "learned metric", sim_option_text, offsetof(struct bench, metric_path)},
    {"keep", "0|1", "1: do not delete the gallery (0)", sim_option_count,
     offsetof(struct bench, keep)},
};

int main(int argc, char **argv)
{
    struct bench bench = {.metric_path = iso_shipped_metric(),
                          .people = 10000,
                          .templates = 1,
                          .batch = 100,
                          .times = iso_times_system()};
    const struct sim_option_set set = {own_options, sizeof own_options / sizeof *own_options,
                                       &bench};
    struct iso_fault fault = {.text = "--dir is needed, and people"};
    const enum sim_options_outcome outcome = sim_options_parse(argc, argv, &set, 1, &fault);
    if (outcome == SIM_OPTIONS_HELP) {
        puts("Usage: bench_gallery --dir DIR [OPTION...]\n");
        sim_options_help(&set, 1, stdout);
        return EXIT_SUCCESS;
    }
    const bool read = outcome == SIM_OPTIONS_READ && bench.directory && bench.people > 0 &&
                      bench.batch > 0 && bench.templates >= 1 &&
                      bench.templates <= BENCH_TEMPLATES_MAX;
    int error = read ? iso_seal_start(&fault) : -EINVAL;
    if (!error) {
        error = iso_metric_load(bench.metric_path, &bench.metric, &fault);
    }
    if (!error) {
        (void)snprintf(bench.path, sizeof bench.path, "%s/gallery.db", bench.directory);
        bench_print_machine();
        error = fill(&bench, &fault);
        if (!error) {
            error = measure(&bench, &fault);
        }
    }
    if (error) {
        (void)fprintf(stderr, "bench_gallery: %s\n", fault.text);
    }
    close_all(&bench);
    iso_metric_free(bench.metric);
    if (bench.path[0]) {
        remove_files(&bench);
    }
    return error ? EXIT_FAILURE : EXIT_SUCCESS;
}

/* A gallery of so many people, filled as an import fills it: how long it keeps a daemon from
 * starting, which opens keys, gallery and log before its sensor; what it takes to search, and to
 * fetch the templates of a shortlist; how large it is on the disk and in memory. With --keep it
 * stays, for a daemon to be started on it (resident.sh). */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "drivers/base/shipped.h"
#include "drivers/base/times.h"
#include "firmware/audit/audit.h"
#include "firmware/gallery/gallery.h"
#include "firmware/keys/seal.h"
#include "sim/base/data_file.h"
#include "sim/base/options.h"
#include "sim/lab/match/latency.h"
#include "tests/bench/crowd.h"
#include "tests/bench/machine.h"

enum { BATCH = 1000, SHORTLIST = 10, TIMES = 200, STARTS = 3, TEMPLATES_MAX = 16 };

/* What is opened, in this order. */
enum { KEYS, GALLERY, LOG, PARTS };

typedef int64_t clock_function(void *context);

static clock_function *const clocks[] = {sim_wall_ns, sim_thread_cpu_ns};
enum { CLOCKS = sizeof clocks / sizeof *clocks };

struct bench {
    const char *directory, *metric_path;
    size_t people, templates; /* of a person */
    size_t keep;              /* not 0: leave it there */
    char path[4096];
    struct iso_times times;
    struct iso_metric *metric;
    struct iso_key_ring *ring;
    struct iso_gallery *gallery;
    struct iso_audit *audit;
};

struct batch {
    struct iso_gallery_item items[BATCH];
    uint8_t bytes[BATCH][TEMPLATES_MAX][ISO_TEMPLATE_BYTES_MAX];
};

static int make_item(const struct bench *bench, size_t person, struct batch *batch, size_t at)
{
    struct iso_gallery_item *item = &batch->items[at];
    *item = (struct iso_gallery_item){.person = {.enrolled_s = 1}, .n = bench->templates};
    (void)snprintf(item->person.name, sizeof item->person.name, "person %zu", person);
    for (size_t k = 0; k < item->n; k++) {
        const struct iso_template tmpl = bench_template(bench->metric, person, k);
        const int size = iso_template_serialise(&tmpl, batch->bytes[at][k],
                                                sizeof batch->bytes[at][k]);
        if (size < 0) {
            return size;
        }
        item->templates[k].algorithm = tmpl.algorithm;
        item->templates[k].bytes = batch->bytes[at][k];
        item->templates[k].size = (size_t)size;
    }
    return 0;
}

static int open_gallery(struct bench *bench, struct iso_fault *fault)
{
    const struct iso_gallery_options options = {
        .path = bench->path,
        .capacity = (int)bench->people,
        .algorithm = bench->metric->algorithm,
        .metric = bench->metric,
        .ring = bench->ring,
    };
    return iso_gallery_open(&options, &bench->gallery, fault);
}

static int open_ring(struct bench *bench, struct iso_fault *fault)
{
    char ring[4200], key[4200];
    (void)snprintf(ring, sizeof ring, "%s.keys", bench->path);
    (void)snprintf(key, sizeof key, "%s.key", bench->path);
    const struct iso_key_place place = {.ring = ring, .file = key};
    return iso_key_ring_open(&place, &bench->ring, fault);
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

/* Opens everything; least_ns[] is lowered to what it took. */
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
    struct batch *batch = malloc(sizeof *batch);
    int error = batch ? open_ring(bench, fault) : -ENOMEM;
    error = error ? error : open_gallery(bench, fault);
    for (size_t first = 0; !error && first < bench->people; first += BATCH) {
        size_t n = 0, added = 0;
        for (; !error && n < BATCH && first + n < bench->people; n++) {
            error = make_item(bench, first + n, batch, n);
        }
        error = error ? error
                      : iso_gallery_import(bench->gallery, batch->items, n, false, NULL, &added,
                                           fault);
    }
    free(batch);
    return error;
}

static int time_search(const struct bench *bench, size_t *wrong, struct iso_fault *fault)
{
    static int64_t project_ns[TIMES], scan_ns[TIMES], fetch_ns[TIMES];
    static struct iso_template found[SHORTLIST * TEMPLATES_MAX];
    const struct iso_candidate_list all = iso_gallery_everybody(bench->gallery);
    *wrong = 0;
    for (int i = 0; i < TIMES; i++) {
        const size_t person = (size_t)i * 7919u % bench->people;
        const struct iso_template tmpl = bench_template(bench->metric, person, TEMPLATES_MAX);
        struct iso_search_hit hits[SHORTLIST];
        struct iso_metric_vector probe;
        int n = 0;
        const int64_t begin_ns = sim_wall_ns(NULL);
        int error = iso_metric_project(bench->metric, &tmpl, &probe);
        const int64_t projected_ns = sim_wall_ns(NULL);
        error = error ? error : iso_index_search(all.index, &probe, hits, SHORTLIST, &n);
        const int64_t searched_ns = sim_wall_ns(NULL);
        for (int k = 0; !error && k < n; k++) {
            int m = 0;
            error = iso_gallery_templates(bench->gallery, hits[k].person, &found[k * TEMPLATES_MAX],
                                          TEMPLATES_MAX, &m, fault);
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

static int measure(struct bench *bench, struct iso_fault *fault)
{
    static const char *const names[PARTS + 1] = {"keys", "gallery", "log", "all"};
    int64_t least_ns[CLOCKS][PARTS + 1];
    struct stat status = {0};
    size_t wrong = 0;
    for (int i = 0; i < CLOCKS * (PARTS + 1); i++) {
        least_ns[i / (PARTS + 1)][i % (PARTS + 1)] = INT64_MAX;
    }
    for (int i = 0; i < STARTS; i++) {
        close_all(bench);
        const int error = open_all(bench, least_ns, fault);
        if (error) {
            return error;
        }
    }
    (void)stat(bench->path, &status);
    printf("%zu people, %zu templates each: %.1f MiB on the disk\n"
           "opening, ms (least of %d)        wall   processor\n",
           bench->people, bench->templates, (double)status.st_size / (1 << 20), STARTS);
    for (int part = 0; part <= PARTS; part++) {
        printf("  %-23s %10.1f  %10.1f\n", names[part], (double)least_ns[0][part] * 1e-6,
               (double)least_ns[1][part] * 1e-6);
    }
    const int error = time_search(bench, &wrong, fault);
    if (!error) {
        printf("the best hit is somebody else: %zu of %d\n", wrong, TIMES);
        bench_print_memory();
    }
    return error;
}

/* Of the log nothing is left; without --keep of the rest neither. */
static void remove_files(const struct bench *bench)
{
    static const char *const ends[] = {".log", ".log.anchor", "", ".anchor", ".keys", ".key"};
    const size_t n = bench->keep ? 2 : sizeof ends / sizeof *ends;
    char path[4200];
    for (size_t i = 0; i < n; i++) {
        (void)snprintf(path, sizeof path, "%s%s", bench->path, ends[i]);
        (void)unlink(path);
    }
}

static const struct sim_option own_options[] = {
    {"dir", "DIR", "an existing directory for the gallery", sim_option_text,
     offsetof(struct bench, directory)},
    {"people", "N", "in it", sim_option_count, offsetof(struct bench, people)},
    {"templates", "N", "of each, 1 to 16", sim_option_count, offsetof(struct bench, templates)},
    {"metric", "FILE", "learned metric", sim_option_text, offsetof(struct bench, metric_path)},
    {"keep", "0|1", "leave it there", sim_option_count, offsetof(struct bench, keep)},
};

int main(int argc, char **argv)
{
    struct bench bench = {.metric_path = iso_shipped_metric(),
                          .people = 10000,
                          .templates = 1,
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
                      bench.templates >= 1 && bench.templates <= TEMPLATES_MAX;
    int error = read ? iso_seal_start(&fault) : -EINVAL;
    error = error ? error : sim_metric_load(bench.metric_path, &bench.metric, &fault);
    if (!error) {
        (void)snprintf(bench.path, sizeof bench.path, "%s/gallery.db", bench.directory);
        bench_print_machine();
        error = fill(&bench, &fault);
        error = error ? error : measure(&bench, &fault);
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

/* A gallery of so many people, filled as an import fills it: what it takes to open, to search, and
 * to fetch the templates of a shortlist; how large it is on the disk and in memory. With --keep it
 * stays, for a daemon to be started on it (resident.sh). */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "firmware/gallery.h"
#include "firmware/seal.h"
#include "sim/data_file.h"
#include "sim/eval/latency.h"
#include "sim/options.h"
#include "tests/bench/crowd.h"
#include "tests/bench/machine.h"

enum { BATCH = 1000, SHORTLIST = 10, TIMES = 200, TEMPLATES_MAX = 16 };

struct bench {
    const char *directory, *metric_path;
    size_t people, templates; /* of a person */
    size_t keep;              /* not 0: leave it there */
    char path[4096];
    struct iso_metric *metric;
    struct iso_key_ring *ring;
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

static int open_gallery(const struct bench *bench, struct iso_gallery **out,
                        struct iso_fault *fault)
{
    const struct iso_gallery_options options = {
        .path = bench->path,
        .capacity = (int)bench->people,
        .algorithm = bench->metric->algorithm,
        .metric = bench->metric,
        .ring = bench->ring,
    };
    return iso_gallery_open(&options, out, fault);
}

static int fill(const struct bench *bench, struct iso_fault *fault)
{
    struct iso_gallery *gallery = NULL;
    struct batch *batch = malloc(sizeof *batch);
    int error = batch ? open_gallery(bench, &gallery, fault) : -ENOMEM;
    for (size_t first = 0; !error && first < bench->people; first += BATCH) {
        size_t n = 0, added = 0;
        for (; !error && n < BATCH && first + n < bench->people; n++) {
            error = make_item(bench, first + n, batch, n);
        }
        error = error ? error : iso_gallery_import(gallery, batch->items, n, false, &added, fault);
    }
    iso_gallery_close(gallery);
    free(batch);
    return error;
}

static int open_ring(struct bench *bench, struct iso_fault *fault)
{
    char ring[4200], key[4200];
    (void)snprintf(bench->path, sizeof bench->path, "%s/gallery.db", bench->directory);
    (void)snprintf(ring, sizeof ring, "%s.keys", bench->path);
    (void)snprintf(key, sizeof key, "%s.key", bench->path);
    const struct iso_key_place place = {.ring = ring, .file = key};
    return iso_key_ring_open(&place, &bench->ring, fault);
}

static int time_search(const struct bench *bench, struct iso_gallery *gallery, size_t *wrong,
                       struct iso_fault *fault)
{
    static int64_t project_ns[TIMES], scan_ns[TIMES], fetch_ns[TIMES];
    static struct iso_template found[SHORTLIST * TEMPLATES_MAX];
    const struct iso_candidates all = iso_gallery_everybody(gallery);
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
            error = iso_gallery_templates(gallery, hits[k].person, &found[k * TEMPLATES_MAX],
                                          TEMPLATES_MAX, &m, fault);
        }
        if (error) {
            return error;
        }
        project_ns[i] = projected_ns - begin_ns;
        scan_ns[i] = searched_ns - projected_ns;
        fetch_ns[i] = sim_wall_ns(NULL) - searched_ns;
        const struct iso_person *best = iso_gallery_find_id(gallery, hits[0].person);
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

static int measure(const struct bench *bench, struct iso_fault *fault)
{
    struct iso_gallery *gallery = NULL;
    struct stat status = {0};
    int64_t best_ns = INT64_MAX;
    for (int i = 0; i < 3; i++) {
        iso_gallery_close(gallery);
        gallery = NULL;
        const int64_t begin_ns = sim_thread_cpu_ns(NULL);
        const int error = open_gallery(bench, &gallery, fault);
        if (error) {
            return error;
        }
        const int64_t took_ns = sim_thread_cpu_ns(NULL) - begin_ns;
        best_ns = took_ns < best_ns ? took_ns : best_ns;
    }
    (void)stat(bench->path, &status);
    printf("%zu people, %zu templates each: %.1f MiB on the disk; opened in %.0f ms of processor "
           "time (best of 3)\n",
           bench->people, bench->templates, (double)status.st_size / (1 << 20),
           (double)best_ns * 1e-6);
    size_t wrong = 0;
    const int error = time_search(bench, gallery, &wrong, fault);
    iso_gallery_close(gallery);
    if (!error) {
        printf("the best hit is somebody else: %zu of %d\n", wrong, TIMES);
        bench_print_memory();
    }
    return error;
}

/* Without --keep nothing is left of it. */
static void remove_all(const struct bench *bench)
{
    static const char *const ends[] = {"", ".anchor", ".keys", ".key"};
    char path[4200];
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
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
    struct bench bench = {.metric_path = SIM_DATA_FILE_METRIC, .people = 10000, .templates = 1};
    const struct sim_option_set set = {own_options, sizeof own_options / sizeof *own_options,
                                       &bench};
    struct iso_fault fault = {"--dir is needed, and people"};
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
    error = error ? error : open_ring(&bench, &fault);
    if (!error) {
        bench_print_machine();
        error = fill(&bench, &fault);
        error = error ? error : measure(&bench, &fault);
    }
    if (error) {
        (void)fprintf(stderr, "bench_gallery: %s\n", fault.text);
    }
    iso_key_ring_close(bench.ring);
    iso_metric_free(bench.metric);
    if (bench.ring && !bench.keep) {
        remove_all(&bench);
    }
    return error ? EXIT_FAILURE : EXIT_SUCCESS;
}

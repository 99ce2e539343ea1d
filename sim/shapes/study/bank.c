#include "sim/shapes/study/bank.h"

#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

#include "core/shape/describe/describe.h"
#include "drivers/base/path.h"
#include "sim/base/make_directory.h"
#include "sim/base/progress.h"
#include "sim/lab/match/parallel.h"
#include "sim/shapes/describe/cache.h"
#include "sim/shapes/describe/description_file.h"

struct work {
    const struct sim_bank_options *options;
    struct sim_bank *bank;
    pthread_mutex_t lock; /* protects the sums, the fault and `good` */
    struct iso_fault *fault;
    uint8_t *good; /* [bank->n]: 1 for a shape that was described */
};

static double seconds_of(clockid_t clock)
{
    struct timespec now;
    (void)clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

int sim_bank_read(const struct sim_bank_options *options, int32_t row,
                  struct iso_coloured_mesh *out, struct iso_fault *fault)
{
    const char *file = options->manifest->rows[row].file;
    char path[PATH_MAX];
    const int error = iso_path_join(options->corpus, file, path, fault);
    return error ? error : sim_source_read(path, file, &options->source, NULL, out, fault);
}

/* One shape on its way. */
struct item {
    const struct work *work;
    const char *path;
    struct iso_shape_description **made; /* [n_methods] */
    double *seconds;                     /* [n_methods] */
    double shape_seconds;
    int32_t n_vertices, n_known;
    struct sim_cache_subject subject; /* only with a cache */
    struct iso_fault *fault;
};

static bool need_colours(const struct sim_bank_options *options)
{
    for (int m = 0; m < options->n_methods; m++) {
        if (options->methods[m]->colour) {
            return true;
        }
    }
    return false;
}

/* Takes from the cache what is there. A damaged file is made again. */
static int look_up(struct item *item, const char *file)
{
    const struct sim_bank_options *options = item->work->options;
    char name[SIM_CACHE_NAME_SIZE], path[PATH_MAX];
    struct iso_fault ignored;
    item->subject = (struct sim_cache_subject){.name = file,
                                               .source = &options->source,
                                               .n_pairs = options->n_pairs,
                                               .colours = need_colours(options),
                                               .times = options->times};
    int error = sim_cache_hash(item->path, item->subject.content, item->fault);
    for (int m = 0; m < options->n_methods && !error; m++) {
        sim_cache_name(&item->subject, options->methods[m], name);
        error = iso_path_join(options->cache, name, path, item->fault);
        if (!error &&
            sim_description_read(path, &item->n_vertices, &item->made[m], &ignored) == 0) {
            item->n_known++;
        }
    }
    return error;
}

/* Describes by one method, or shares what an earlier method has made. */
static int describe_by(struct item *item, const struct iso_shape *shape, int m)
{
    const struct iso_shape_method *const *methods = item->work->options->methods;
    for (int earlier = 0; earlier < m; earlier++) {
        const int error = iso_describe_share(methods[m], methods[earlier], item->made[earlier],
                                             &item->made[m]);
        if (error != -EINVAL) {
            return error;
        }
    }
    return iso_shape_describe_at(methods[m], shape, &item->work->options->times, &item->made[m]);
}

static int describe(struct item *item, const struct iso_shape *shape)
{
    const struct sim_bank_options *options = item->work->options;
    char name[SIM_CACHE_NAME_SIZE];
    int error = 0;
    for (int m = 0; m < options->n_methods && !error; m++) {
        if (item->made[m]) {
            continue;
        }
        const double start = seconds_of(CLOCK_THREAD_CPUTIME_ID);
        error = describe_by(item, shape, m);
        item->seconds[m] = seconds_of(CLOCK_THREAD_CPUTIME_ID) - start;
        if (error) {
            return iso_fault_set(item->fault, error, "%s: %s: %s", item->path,
                                 options->methods[m]->name, strerror(-error));
        }
        if (options->cache) {
            sim_cache_name(&item->subject, options->methods[m], name);
            error = sim_description_write(options->cache, name, item->n_vertices, item->made[m],
                                          item->fault);
        }
    }
    return error;
}

static int make_shape(struct item *item, int32_t row, struct iso_shape **shape)
{
    const struct sim_bank_options *options = item->work->options;
    struct iso_coloured_mesh mesh = {NULL, NULL};
    int error = sim_bank_read(options, row, &mesh, item->fault);
    if (!error) {
        item->n_vertices = mesh.mesh->n_vertices;
        const struct sim_shape_options shape_options = {.neighbours = options->source.neighbours,
                                                        .colours = need_colours(options),
                                                        .mend = options->source.mend,
                                                        .n_pairs = options->n_pairs};
        error = sim_source_shape(item->path, &mesh, &shape_options, shape, item->fault);
    }
    iso_coloured_mesh_done(&mesh);
    return error;
}

static int describe_item(struct item *item, int32_t row)
{
    const struct sim_bank_options *options = item->work->options;
    const double start = seconds_of(CLOCK_THREAD_CPUTIME_ID);
    struct iso_shape *shape = NULL;
    int error = options->cache ? look_up(item, options->manifest->rows[row].file) : 0;
    if (!error && item->n_known < options->n_methods) {
        error = make_shape(item, row, &shape);
    }
    item->shape_seconds = seconds_of(CLOCK_THREAD_CPUTIME_ID) - start;
    if (!error && shape) {
        error = describe(item, shape);
    }
    iso_shape_free(shape);
    return error;
}

/* Adds the results of a shape to the bank, or records why there are none. */
static int keep_item(struct work *work, const struct item *item, size_t number, int error)
{
    struct sim_bank *bank = work->bank;
    const bool skipped = error && work->options->skip && error != -ENOMEM;
    (void)pthread_mutex_lock(&work->lock);
    if (error && work->fault->text[0] == '\0') {
        *work->fault = *item->fault;
    }
    if (skipped) {
        sim_progress_pause();
        fprintf(stderr, "isotherm-sim: left out: %s\n", item->fault->text);
        sim_progress_resume();
    }
    for (int m = 0; m < bank->n_methods; m++) {
        bank->description[(size_t)m * (size_t)bank->n + number] = item->made[m];
        bank->seconds[m] += item->seconds[m];
    }
    bank->shape_seconds += item->shape_seconds;
    bank->mean_vertices += error ? 0.0 : (double)item->n_vertices;
    bank->n_known += item->n_known;
    work->good[number] = !error;
    (void)pthread_mutex_unlock(&work->lock);
    return skipped ? 0 : error;
}

static int describe_one(void *context, int worker, size_t number)
{
    struct work *work = context;
    const struct sim_bank_options *options = work->options;
    const int32_t row = work->bank->row[number];
    const size_t n_methods = (size_t)options->n_methods;
    struct iso_fault fault = {.text = ""};
    char path[PATH_MAX];
    struct item item = {.work = work, .path = path, .fault = &fault};
    (void)worker;
    item.made = calloc(n_methods, sizeof *item.made);
    item.seconds = calloc(n_methods, sizeof *item.seconds);
    if (!item.made || !item.seconds) {
        free(item.made);
        free(item.seconds);
        return -ENOMEM;
    }
    int error = iso_path_join(options->corpus, options->manifest->rows[row].file, path, &fault);
    if (!error) {
        error = describe_item(&item, row);
    }
    error = keep_item(work, &item, number, error);
    free(item.made);
    free(item.seconds);
    return error;
}

/* Removes the shapes that could not be described. */
static void drop_failed(struct sim_bank *bank, const uint8_t *good)
{
    int32_t n = 0;
    for (int32_t i = 0; i < bank->n; i++) {
        n += good[i];
    }
    for (int32_t m = 0, to = 0; m < bank->n_methods; m++) {
        for (int32_t i = 0; i < bank->n; i++) {
            struct iso_shape_description *d = bank->description[m * bank->n + i];
            if (good[i]) {
                bank->description[to++] = d;
            } else {
                iso_shape_description_free(d);
            }
        }
    }
    for (int32_t i = 0, to = 0; i < bank->n; i++) {
        if (good[i]) {
            bank->row[to++] = bank->row[i];
        }
    }
    bank->n = n;
}

static int allocate(const struct sim_bank_options *options, struct sim_bank **out)
{
    struct sim_bank *bank = calloc(1, sizeof *bank);
    if (!bank) {
        return -ENOMEM;
    }
    bank->n_methods = options->n_methods;
    bank->n = options->rows ? options->n_rows : options->manifest->n;
    const size_t n = (size_t)bank->n, n_methods = (size_t)bank->n_methods;
    bank->row = calloc(n, sizeof *bank->row);
    bank->description = calloc(n * n_methods, sizeof(void *));
    bank->seconds = calloc(n_methods, sizeof *bank->seconds);
    if (!bank->row || !bank->description || !bank->seconds) {
        sim_bank_free(bank);
        return -ENOMEM;
    }
    for (int32_t i = 0; i < bank->n; i++) {
        bank->row[i] = options->rows ? options->rows[i] : i;
    }
    *out = bank;
    return 0;
}

static int fill(struct work *work)
{
    const struct sim_bank_options *options = work->options;
    int error = options->cache ? sim_make_directory(options->cache, work->fault) : 0;
    if (error) {
        return error;
    }
    error = sim_parallel(options->threads, "describing shapes", (size_t)work->bank->n, describe_one,
                         work);
    if (!error) {
        drop_failed(work->bank, work->good);
        error = work->bank->n > 0 ? 0 : -ENODATA;
    }
    if (error && work->fault->text[0] == '\0') {
        (void)iso_fault_set(work->fault, error, "%s: %s", options->corpus, strerror(-error));
    }
    return error;
}

int sim_bank_new(const struct sim_bank_options *options, struct sim_bank **out,
                 struct iso_fault *fault)
{
    struct iso_fault unread = {.text = ""};
    struct work work = {
        .options = options, .fault = fault ? fault : &unread, .lock = PTHREAD_MUTEX_INITIALIZER};
    const double start = seconds_of(CLOCK_MONOTONIC);
    work.fault->text[0] = '\0';
    int error = allocate(options, &work.bank);
    work.good = error ? NULL : calloc((size_t)work.bank->n, 1);
    if (!error) {
        error = work.good ? fill(&work) : -ENOMEM;
    }
    free(work.good);
    if (error) {
        sim_bank_free(work.bank);
        return error;
    }
    struct rusage usage;
    (void)getrusage(RUSAGE_SELF, &usage);
    work.bank->mean_vertices /= work.bank->n;
    work.bank->peak_kib = usage.ru_maxrss;
    work.bank->elapsed_seconds = seconds_of(CLOCK_MONOTONIC) - start;
    work.fault->text[0] = '\0';
    *out = work.bank;
    return 0;
}

int sim_bank_match(struct sim_bank *bank, struct sim_shape_manifest *manifest)
{
    uint8_t *keep = calloc((size_t)manifest->n, 1);
    if (!keep) {
        return -ENOMEM;
    }
    for (int32_t i = 0; i < bank->n; i++) {
        keep[bank->row[i]] = 1;
        bank->row[i] = i;
    }
    sim_shape_manifest_keep(manifest, keep);
    free(keep);
    return 0;
}

void sim_bank_free(struct sim_bank *bank)
{
    if (!bank) {
        return;
    }
    for (int32_t i = 0; bank->description && i < bank->n_methods * bank->n; i++) {
        iso_shape_description_free(bank->description[i]);
    }
    free(bank->description);
    free(bank->row);
    free(bank->seconds);
    free(bank);
}

const struct iso_shape_description *const *sim_bank_of(const struct sim_bank *bank, int method)
{
    return (const struct iso_shape_description *const *)&bank
        ->description[(size_t)method * (size_t)bank->n];
}

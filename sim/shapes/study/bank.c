#include "sim/shapes/study/bank.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

#include "drivers/base/path.h"
#include "sim/lab/match/parallel.h"
#include "sim/shapes/make/smooth.h"
#include "sim/shapes/make/thin.h"

struct work {
    const struct sim_bank_options *options;
    struct sim_bank *bank;
    pthread_mutex_t lock; /* protects the sums and the fault */
    struct iso_fault *fault;
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
    struct iso_coloured_mesh mesh = {NULL, NULL};
    int error = iso_path_join(options->corpus, file, path, fault);
    if (!error) {
        error = iso_mesh_file_read(path, &mesh, fault);
    }
    if (error) {
        return error;
    }
    if (options->vertices > 0 && mesh.mesh->n_vertices > options->vertices) {
        error = sim_thin(&mesh, options->vertices);
    }
    if (!error && options->distortion) {
        struct sim_random random = sim_random_seeded(options->seed, sim_random_hash(file),
                                                     (uint64_t)options->distortion->kind);
        error = sim_distort(*options->distortion, &random, &mesh);
    }
    if (!error && options->smooth > 0) {
        error = sim_smooth(mesh.mesh, options->smooth);
    }
    if (error) {
        iso_coloured_mesh_done(&mesh);
        return iso_fault_set(fault, error, "%s: %s", path, strerror(-error));
    }
    *out = mesh;
    return 0;
}

/* Describes one shape by all methods; seconds[n_methods]. */
static int describe(const struct work *work, const struct iso_shape *shape, int32_t number,
                    double *seconds)
{
    const struct sim_bank_options *options = work->options;
    for (int m = 0; m < options->n_methods; m++) {
        const double start = seconds_of(CLOCK_THREAD_CPUTIME_ID);
        const int error = iso_shape_describe(
            options->methods[m], shape,
            &work->bank->description[(size_t)m * (size_t)work->bank->n + (size_t)number]);
        if (error) {
            return error;
        }
        seconds[m] = seconds_of(CLOCK_THREAD_CPUTIME_ID) - start;
    }
    return 0;
}

static int make_shape(const struct work *work, int32_t row, struct iso_shape **shape,
                      int32_t *n_vertices, struct iso_fault *fault)
{
    struct iso_coloured_mesh mesh = {NULL, NULL};
    int error = sim_bank_read(work->options, row, &mesh, fault);
    if (error) {
        return error;
    }
    bool colour = false;
    for (int m = 0; m < work->options->n_methods; m++) {
        colour = colour || work->options->methods[m]->colour;
    }
    *n_vertices = mesh.mesh->n_vertices;
    error = iso_shape_new(mesh.mesh, colour ? mesh.colour : NULL, 0, shape);
    iso_coloured_mesh_done(&mesh);
    return error;
}

static int describe_one(void *context, int worker, size_t number)
{
    struct work *work = context;
    int32_t row = work->bank->row[number], n_vertices = 0;
    struct iso_shape *shape = NULL;
    struct iso_fault fault = {.text = ""};
    double *seconds = calloc((size_t)work->options->n_methods, sizeof *seconds);
    const double start = seconds_of(CLOCK_THREAD_CPUTIME_ID);
    (void)worker;
    int error = seconds ? make_shape(work, row, &shape, &n_vertices, &fault) : -ENOMEM;
    const double shape_seconds = seconds_of(CLOCK_THREAD_CPUTIME_ID) - start;
    if (!error) {
        error = describe(work, shape, (int32_t)number, seconds);
    }
    iso_shape_free(shape);
    (void)pthread_mutex_lock(&work->lock);
    if (error && work->fault && work->fault->text[0] == '\0') {
        (void)iso_fault_set(work->fault, error, "%s: %s", work->options->manifest->rows[row].file,
                            error == -ENODATA ? "too small, or without colours" : strerror(-error));
        *work->fault = fault.text[0] ? fault : *work->fault;
    }
    for (int m = 0; !error && m < work->options->n_methods; m++) {
        work->bank->seconds[m] += seconds[m];
    }
    work->bank->shape_seconds += shape_seconds;
    work->bank->mean_vertices += (double)n_vertices / work->bank->n;
    (void)pthread_mutex_unlock(&work->lock);
    free(seconds);
    return error;
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

int sim_bank_new(const struct sim_bank_options *options, struct sim_bank **out,
                 struct iso_fault *fault)
{
    struct work work = {.options = options, .fault = fault, .lock = PTHREAD_MUTEX_INITIALIZER};
    const double start = seconds_of(CLOCK_MONOTONIC);
    if (fault) {
        fault->text[0] = '\0';
    }
    int error = allocate(options, &work.bank);
    if (!error) {
        error = sim_parallel(options->threads, "describing shapes", (size_t)work.bank->n,
                             describe_one, &work);
    }
    if (error) {
        if (fault && fault->text[0] == '\0') {
            (void)iso_fault_set(fault, error, "%s: %s", options->corpus, strerror(-error));
        }
        sim_bank_free(work.bank);
        return error;
    }
    struct rusage usage;
    (void)getrusage(RUSAGE_SELF, &usage);
    work.bank->peak_kib = usage.ru_maxrss;
    work.bank->elapsed_seconds = seconds_of(CLOCK_MONOTONIC) - start;
    *out = work.bank;
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

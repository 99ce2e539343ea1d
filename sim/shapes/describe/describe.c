#include "sim/shapes/describe/describe.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/base/path.h"
#include "drivers/file/text.h"
#include "sim/base/make_directory.h"
#include "sim/base/progress.h"
#include "sim/lab/match/parallel.h"
#include "sim/shapes/describe/describe_parameters.h"
#include "sim/shapes/describe/function_picture.h"
#include "sim/shapes/describe/view_picture.h"

enum { NAMES_MAX = 64 };

/* ---- the names ------------------------------------------------------------------------------ */

static int choose(struct sim_describe_choice *choice, const char *name, struct iso_fault *fault)
{
    const struct sim_quantity *quantity = sim_quantity_find(name);
    const struct iso_shape_method *method = quantity ? NULL : iso_shape_method_find(name);
    if (quantity && choice->n_quantities < SIM_DESCRIBE_MAX) {
        choice->quantity[choice->n_quantities++] = quantity;
    } else if (method && choice->n_methods < SIM_DESCRIBE_MAX) {
        choice->method[choice->n_methods++] = method;
        choice->colours = choice->colours || method->colour;
    } else {
        return iso_fault_set(fault, -EINVAL,
                             "--what: '%s' is unknown; `shapes describe --help` lists all names",
                             name);
    }
    return 0;
}

static int choose_all(struct sim_describe_choice *choice, struct iso_fault *fault)
{
    int error = 0;
    for (const struct sim_quantity *q = sim_quantities; q->name && !error; q++) {
        error = choose(choice, q->name, fault);
    }
    for (int m = 0; iso_shape_methods[m] && !error; m++) {
        error = choose(choice, iso_shape_methods[m]->name, fault);
    }
    choice->as_colours_allow = true;
    return error;
}

static int choose_names(const char *what, struct sim_describe_choice *choice,
                        struct iso_fault *fault)
{
    if (strcmp(what, "all") == 0) {
        return choose_all(choice, fault);
    }
    char *copy = strdup(what), *names[NAMES_MAX];
    if (!copy) {
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    const size_t n = iso_text_split(copy, ',', names, NAMES_MAX);
    int error = n <= NAMES_MAX ? 0 : iso_fault_set(fault, -EINVAL, "--what: too many names");
    for (size_t i = 0; i < n && !error; i++) {
        error = choose(choice, names[i], fault);
    }
    free(copy);
    return error;
}

void sim_describe_names(FILE *out)
{
    fputs("\nNames for --what, besides all:\n", out);
    for (const struct sim_quantity *q = sim_quantities; q->name; q++) {
        fprintf(out, "  %-13s %s\n", q->name, q->help);
    }
    for (int m = 0; iso_shape_methods[m]; m++) {
        fprintf(out, "  %-13s the whole shape by %s (%s)\n", iso_shape_methods[m]->name,
                iso_shape_methods[m]->title, iso_shape_methods[m]->source);
    }
}

/* ---- one mesh ------------------------------------------------------------------------------- */

struct work {
    const struct sim_describe_options *options;
    struct sim_describe_choice choice;
    enum sim_array_format format;
    enum sim_laplacian laplacian;
    struct sim_quantity_options quantity; /* of the options, with the score of views */
    FILE *out;
    pthread_mutex_t lock; /* protects the output and the members below */
    struct iso_fault *fault;
    int last_error, n_described;
};

static int refuse_quantity(const char *path, const char *name, const struct iso_shape *shape,
                           int error, struct iso_fault *fault)
{
    switch (error) {
    case 0:
        return 0;
    case -EINVAL:
        return iso_fault_set(fault, error,
                             "%s: %s: --times, --time-first, --time-last, --energies or "
                             "--persistence is out of range for this shape",
                             path, name);
    case -ERANGE:
        return iso_fault_set(fault, -EINVAL,
                             "%s: --source is out of range: the shape has the vertices 0 to %d",
                             path, shape->mesh->n_vertices - 1);
    case -ENOTSUP:
        return iso_fault_set(fault, error, "%s: %s: a cloud of points has no surface to look at",
                             path, name);
    default:
        return iso_fault_set(fault, error, "%s: %s: %s", path, name, strerror(-error));
    }
}

/* Whether a quantity is left out of `all`, because this shape does not have it. */
static bool is_left_out(const struct sim_describe_choice *choice, int error)
{
    return choice->as_colours_allow && error == -ENOTSUP;
}

/* Describes by the methods that need colours, or by the others. *name receives the last one. */
static int add_methods(const struct sim_describe_choice *choice, const struct iso_shape *shape,
                       bool colour, struct sim_arrays *arrays, const char **name)
{
    int error = 0;
    for (int m = 0; m < choice->n_methods && !error; m++) {
        if (choice->method[m]->colour == colour &&
            (!colour || shape->colour || !choice->as_colours_allow)) {
            *name = choice->method[m]->name;
            error = sim_quantity_method(shape, choice->method[m], arrays);
        }
    }
    return error;
}

/* What needs colours comes first: without them and their eigenpairs there is room for the rest. */
static int fill_arrays(const struct work *work, struct iso_shape *shape, struct sim_arrays *arrays,
                       const char *path, struct iso_fault *fault)
{
    const struct sim_describe_choice *choice = &work->choice;
    const char *name = "mesh";
    int error = sim_quantity_mesh(shape, arrays);
    if (!error) {
        error = add_methods(choice, shape, true, arrays, &name);
    }
    if (!error) {
        iso_shape_drop_colours(shape);
    }
    for (int q = 0; q < choice->n_quantities && !error; q++) {
        name = choice->quantity[q]->name;
        error = choice->quantity[q]->compute(shape, &work->quantity, arrays);
        error = is_left_out(choice, error) ? 0 : error;
    }
    if (!error) {
        error = add_methods(choice, shape, false, arrays, &name);
    }
    return refuse_quantity(path, name, shape, error, fault);
}

static int write_pictures(const struct sim_describe_subject *subject, struct iso_fault *fault)
{
    char path[PATH_MAX];
    int error = iso_path_join(subject->directory, "functions.png", path, fault);
    if (!error) {
        error = sim_function_picture(subject->shape, subject->arrays, path, fault);
    }
    if (!error) {
        error = iso_path_join(subject->directory, "views.png", path, fault);
    }
    return error ? error : sim_view_picture(subject->shape, subject->arrays, path, fault);
}

static int write_results(const struct work *work, const struct sim_describe_subject *subject,
                         struct iso_fault *fault)
{
    char path[PATH_MAX];
    int error = sim_make_directory(subject->directory, fault);
    if (!error) {
        error = sim_arrays_write(subject->arrays, work->format, subject->directory, fault);
    }
    if (!error) {
        error = iso_path_join(subject->directory, "parameters.json", path, fault);
    }
    if (!error) {
        error = sim_describe_parameters(work->options, work->format, subject, path, fault);
    }
    return error || work->options->no_pictures ? error : write_pictures(subject, fault);
}

/* The file's name without directories and ending, below `out`. */
static int directory_of(const struct work *work, const char *mesh, char path[PATH_MAX],
                        struct iso_fault *fault)
{
    char name[NAME_MAX + 1];
    const char *slash = strrchr(mesh, '/'), *base = slash ? slash + 1 : mesh;
    const char *dot = strrchr(base, '.');
    (void)snprintf(name, sizeof name, "%.*s", (int)(dot ? dot - base : (long)strlen(base)), base);
    return iso_path_join(work->options->out, name, path, fault);
}

static void report(struct work *work, const struct sim_describe_subject *subject)
{
    char left_out[256];
    sim_source_left_out(&subject->look, left_out, sizeof left_out);
    fprintf(work->out, "%s: %d %s, %d eigenpairs, %d arrays%s%s\n", subject->path,
            subject->shape->mesh->n_vertices, subject->shape->is_cloud ? "points" : "vertices",
            subject->shape->pairs->k, subject->arrays->n, left_out[0] ? "; " : "", left_out);
    work->n_described++;
}

static int describe_mesh(struct work *work, const char *path, struct iso_fault *fault)
{
    const struct sim_describe_options *options = work->options;
    const struct sim_source_options how = {.vertices = options->vertices,
                                           .mend = options->mend,
                                           .neighbours = options->neighbours,
                                           .smooth = options->smooth};
    char directory[PATH_MAX];
    struct iso_coloured_mesh mesh = {NULL, NULL};
    struct iso_shape *shape = NULL;
    struct sim_arrays *arrays = calloc(1, sizeof *arrays);
    struct sim_describe_subject subject = {path, directory, {.colours = false}, NULL, arrays};
    int error = arrays ? directory_of(work, path, directory, fault)
                       : iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
    if (!error) {
        error = sim_source_read(path, path, &how, &subject.look, &mesh, fault);
    }
    if (!error) {
        const bool colours = work->choice.colours &&
                             (mesh.colour || !work->choice.as_colours_allow);
        const struct sim_shape_options shape_options = {.laplacian = work->laplacian,
                                                        .neighbours = options->neighbours,
                                                        .colours = colours,
                                                        .mend = options->mend,
                                                        .n_pairs = options->pairs};
        error = sim_source_shape(path, &mesh, &shape_options, &shape, fault);
    }
    iso_coloured_mesh_done(&mesh); /* the shape has what is needed of it */
    if (!error) {
        subject.shape = shape;
        sim_source_look_at_shape(&subject.look, shape);
        error = fill_arrays(work, shape, arrays, path, fault);
    }
    if (!error) {
        error = write_results(work, &subject, fault);
    }
    if (!error) {
        (void)pthread_mutex_lock(&work->lock);
        report(work, &subject);
        (void)pthread_mutex_unlock(&work->lock);
    }
    if (arrays) {
        sim_arrays_done(arrays);
    }
    free(arrays);
    iso_shape_free(shape);
    return error;
}

static int describe_one(void *context, int worker, size_t number)
{
    struct work *work = context;
    struct iso_fault fault = {.text = ""};
    const int error = describe_mesh(work, work->options->meshes.text[number], &fault);
    (void)worker;
    if (!error) {
        return 0;
    }
    (void)pthread_mutex_lock(&work->lock);
    work->last_error = error;
    *work->fault = fault;
    if (!work->options->strict && work->options->meshes.n > 1) {
        sim_progress_pause();
        fprintf(stderr, "isotherm-sim: left out: %s\n", fault.text);
        sim_progress_resume();
    }
    (void)pthread_mutex_unlock(&work->lock);
    return work->options->strict ? error : 0;
}

/* ---- all meshes ----------------------------------------------------------------------------- */

static int check_names(const struct work *work, struct iso_fault *fault)
{
    const struct sim_option_texts *meshes = &work->options->meshes;
    char mine[PATH_MAX], other[PATH_MAX];
    int error = 0;
    for (size_t i = 1; i < meshes->n && !error; i++) {
        error = directory_of(work, meshes->text[i], mine, fault);
        for (size_t j = 0; j < i && !error; j++) {
            error = directory_of(work, meshes->text[j], other, fault);
            if (!error && strcmp(mine, other) == 0) {
                error = iso_fault_set(fault, -EINVAL, "%s and %s would both be described in %s",
                                      meshes->text[j], meshes->text[i], mine);
            }
        }
    }
    return error;
}

static int find_format(const char *name, enum sim_array_format *out, struct iso_fault *fault)
{
    for (int f = 0; f < SIM_ARRAY_FORMATS; f++) {
        if (strcmp(name, sim_array_format_name((enum sim_array_format)f)) == 0) {
            *out = (enum sim_array_format)f;
            return 0;
        }
    }
    return iso_fault_set(fault, -EINVAL, "--format: '%s' is none of npy, csv, mat5", name);
}

static int find_laplacian(const char *name, enum sim_laplacian *out, struct iso_fault *fault)
{
    const bool robust = strcmp(name, "robust") == 0;
    *out = robust ? SIM_LAPLACIAN_ROBUST : SIM_LAPLACIAN_PLAIN;
    return robust || strcmp(name, "plain") == 0
               ? 0
               : iso_fault_set(fault, -EINVAL, "--laplacian: '%s' is none of plain, robust", name);
}

static int find_view_score(const char *name, enum iso_view_score *out, struct iso_fault *fault)
{
    const bool divergence = strcmp(name, "divergence") == 0;
    *out = divergence ? ISO_VIEW_DIVERGENCE : ISO_VIEW_ENTROPY;
    return divergence || strcmp(name, "entropy") == 0
               ? 0
               : iso_fault_set(fault, -EINVAL, "--view-score: '%s' is none of entropy, divergence",
                               name);
}

static int check_numbers(const struct sim_describe_options *options, struct iso_fault *fault)
{
    const int views = options->quantity.views;
    if (views < 0 || views > SIM_QUANTITY_VIEWS_MAX) {
        return iso_fault_set(fault, -EINVAL, "--views: %d is not in 1..%d", views,
                             (int)SIM_QUANTITY_VIEWS_MAX);
    }
    return sim_neighbours_check(options->neighbours, fault);
}

static int prepare(struct work *work, struct iso_fault *fault)
{
    const struct sim_describe_options *options = work->options;
    work->quantity = options->quantity;
    int error = check_numbers(options, fault);
    if (!error) {
        error = find_format(options->format, &work->format, fault);
    }
    if (!error) {
        error = find_laplacian(options->laplacian, &work->laplacian, fault);
    }
    if (!error) {
        error = find_view_score(options->view_score, &work->quantity.view_score, fault);
    }
    if (!error) {
        error = choose_names(options->what, &work->choice, fault);
    }
    if (!error) {
        error = check_names(work, fault);
    }
    return error ? error : sim_make_directory(options->out, fault);
}

int sim_shapes_describe(const struct sim_describe_options *options, FILE *out,
                        struct iso_fault *fault)
{
    struct iso_fault last = {.text = ""};
    struct work work = {
        .options = options, .out = out, .lock = PTHREAD_MUTEX_INITIALIZER, .fault = &last};
    if (options->meshes.n == 0) {
        return iso_fault_set(fault, -EINVAL, "no mesh is given");
    }
    int error = prepare(&work, fault);
    if (error) {
        return error;
    }
    error = sim_parallel(options->threads, "describing shapes", options->meshes.n, describe_one,
                         &work);
    if (error) {
        return iso_fault_set(fault, error, "%s", last.text[0] ? last.text : strerror(-error));
    }
    if (work.n_described == 0) {
        return iso_fault_set(fault, work.last_error, "%s",
                             options->meshes.n == 1 ? last.text : "no mesh could be described");
    }
    return 0;
}

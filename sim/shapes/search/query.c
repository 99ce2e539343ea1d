#include "sim/shapes/search/query.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "core/shape/classify/feature_distance.h"
#include "drivers/base/path.h"
#include "sim/base/make_directory.h"
#include "sim/base/result_file.h"
#include "sim/shapes/study/sheet.h"

enum { MATCHES_MAX = 100, NAME_SIZE = 256 };

struct match {
    int32_t item;
    double distance;
};

/* By rising distance; the first one in the index of equal ones is first. */
static int compare(const void *a, const void *b)
{
    const struct match *p = a, *q = b;
    if (p->distance != q->distance) {
        return p->distance < q->distance ? -1 : 1;
    }
    return (p->item > q->item) - (p->item < q->item);
}

static int describe(const struct sim_index *index, const char *path, struct sim_source_look *look,
                    struct iso_shape_description **out, struct iso_fault *fault)
{
    struct iso_coloured_mesh mesh = {NULL, NULL};
    struct iso_shape *shape = NULL;
    int error = sim_source_read(path, path, &index->source, look, &mesh, fault);
    if (!error) {
        const struct sim_shape_options shape_options = {.neighbours = index->source.neighbours,
                                                        .colours = index->method->colour,
                                                        .mend = index->source.mend,
                                                        .n_pairs = index->n_pairs};
        error = sim_source_shape(path, &mesh, &shape_options, &shape, fault);
    }
    if (!error) {
        sim_source_look_at_shape(look, shape);
        error = iso_shape_describe_at(index->method, shape, &index->times, out);
        if (error) {
            (void)iso_fault_set(fault, error, "%s: %s", path, strerror(-error));
        }
    }
    iso_shape_free(shape);
    iso_coloured_mesh_done(&mesh);
    return error;
}

/* match [index->n] by rising distance. `look` receives what was found in the file. */
static int rank(const struct sim_index *index, const char *path, struct sim_source_look *look,
                struct match *match, struct iso_fault *fault)
{
    const struct iso_feature_layout *layout = iso_shape_coder_layout(index->coder);
    struct iso_shape_description *description = NULL;
    float *feature = calloc((size_t)layout->size, sizeof *feature);
    double *distance = calloc((size_t)index->n, sizeof *distance);
    int error = feature && distance ? describe(index, path, look, &description, fault)
                                    : iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
    if (!error) {
        error = iso_shape_code(index->coder, description, feature);
        if (!error) {
            error = iso_feature_distances(layout, layout->norm, feature, index->feature, index->n,
                                          -1, distance);
        }
        if (error) {
            (void)iso_fault_set(fault, error, "%s: %s", path, strerror(-error));
        }
    }
    for (int32_t i = 0; i < index->n && !error; i++) {
        match[i] = (struct match){i, distance[i]};
    }
    if (!error) {
        qsort(match, (size_t)index->n, sizeof *match, compare);
    }
    iso_shape_description_free(description);
    free(feature);
    free(distance);
    return error;
}

struct ranking {
    const struct sim_index *index;
    const struct match *match;
};

static void write_ranking(const void *context, FILE *out)
{
    const struct ranking *ranking = context;
    const struct sim_index *index = ranking->index;
    fputs("rank,distance,file,class\n", out);
    for (int32_t i = 0; i < index->n; i++) {
        const struct match *m = &ranking->match[i];
        fprintf(out, "%d,%.7g,%s,%s\n", i + 1, m->distance, index->file[m->item],
                index->class_name[m->item]);
    }
}

/* The mesh, then its matches. Files that can no longer be read are left out of the picture. */
static int draw(const struct sim_query_options *options, const struct ranking *ranking,
                const char *mesh, const char *path, struct iso_fault *fault)
{
    const struct sim_index *index = ranking->index;
    const int most = options->matches < index->n ? options->matches : index->n;
    char(*name)[PATH_MAX] = calloc((size_t)most, sizeof *name);
    struct sim_sheet_file *file = calloc((size_t)most + 1, sizeof *file);
    int n = 1, error = name && file ? 0 : iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
    if (!error) {
        file[0] = (struct sim_sheet_file){mesh, "looked for", true};
    }
    for (int i = 0; i < most && !error; i++) {
        const int32_t item = ranking->match[i].item;
        struct sim_source_look look;
        struct iso_fault ignored;
        if (iso_path_join(index->corpus, index->file[item], name[i], &ignored) == 0 &&
            sim_source_look(name[i], &index->source, &look, &ignored) == 0) {
            file[n++] = (struct sim_sheet_file){name[i], index->class_name[item], false};
        }
    }
    if (!error) {
        error = sim_sheet_files(&index->source, file, n, path, fault);
    }
    free(name);
    free(file);
    return error;
}

static int write_files(const struct sim_query_options *options, const struct ranking *ranking,
                       const char *mesh, struct iso_fault *fault)
{
    const char *slash = strrchr(mesh, '/'), *base = slash ? slash + 1 : mesh;
    const char *dot = strrchr(base, '.');
    const int length = (int)(dot ? dot - base : (long)strlen(base));
    char csv[NAME_SIZE], png[NAME_SIZE], path[PATH_MAX];
    (void)snprintf(csv, sizeof csv, "%.*s.csv", length, base);
    (void)snprintf(png, sizeof png, "%.*s.png", length, base);
    int error = sim_make_directory(options->out, fault);
    if (!error) {
        error = sim_result_file(options->out, csv, write_ranking, ranking, fault);
    }
    if (!error) {
        error = iso_path_join(options->out, png, path, fault);
    }
    return error ? error : draw(options, ranking, mesh, path, fault);
}

static int answer(const struct sim_query_options *options, const struct sim_index *index,
                  const char *mesh, FILE *out, struct iso_fault *fault)
{
    struct match *match = calloc((size_t)index->n, sizeof *match);
    const struct ranking ranking = {index, match};
    struct sim_source_look look = {.points = 0};
    char left_out[256];
    int error = match ? rank(index, mesh, &look, match, fault)
                      : iso_fault_set(fault, -ENOMEM, "%s: out of memory", mesh);
    if (!error) {
        sim_source_left_out(&look, left_out, sizeof left_out);
        fprintf(out, "%s, by %s%s%s:\n", mesh, index->method->name, left_out[0] ? "; " : "",
                left_out);
    }
    for (int i = 0; !error && i < options->matches && i < index->n; i++) {
        fprintf(out, "%4d  %-9.4g %s (%s)\n", i + 1, match[i].distance, index->file[match[i].item],
                index->class_name[match[i].item]);
    }
    if (!error && options->out) {
        error = write_files(options, &ranking, mesh, fault);
    }
    free(match);
    return error;
}

int sim_shapes_query(const struct sim_query_options *options, FILE *out, struct iso_fault *fault)
{
    struct sim_index *index = NULL;
    if (options->meshes.n == 0) {
        return iso_fault_set(fault, -EINVAL, "no mesh is given");
    }
    if (options->matches < 1 || options->matches > MATCHES_MAX) {
        return iso_fault_set(fault, -EINVAL, "--matches: outside 1..%d", (int)MATCHES_MAX);
    }
    int error = sim_index_open(options->index, &index, fault);
    if (!error) {
        index->source.mend = index->source.mend || options->mend;
    }
    for (size_t i = 0; i < options->meshes.n && !error; i++) {
        error = answer(options, index, options->meshes.text[i], out, fault);
    }
    sim_index_close(index);
    return error;
}

#include "sim/shapes/search/index.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "drivers/base/path.h"
#include "drivers/file/text.h"
#include "drivers/terminal/words.h"
#include "sim/base/make_directory.h"
#include "sim/lab/report/json.h"
#include "sim/shapes/describe/corpus.h"
#include "sim/shapes/describe/description_file.h"
#include "sim/shapes/study/bank.h"
#include "sim/shapes/study/choice.h"
#include "sim/shapes/study/times.h"

enum { SHAPES_MAX = 100000, BYTES_MAX = 64 << 20, SEED = 1 };

/* The first format had no times of heat. A program that knows only that one refuses the second one,
 * instead of describing what it looks for at other times. */
static const char format[] = "isotherm shapes index 2";
static const char first_format[] = "isotherm shapes index 1";

static void number_name(size_t number, char name[SIM_SHAPE_NAME_MAX])
{
    (void)snprintf(name, SIM_SHAPE_NAME_MAX, "%zu.description", number);
}

/* ---- writing -------------------------------------------------------------------------------- */

static int write_list(const struct sim_index_options *options,
                      const struct iso_shape_method *method, const struct sim_bank *bank,
                      const struct sim_shape_manifest *manifest, struct iso_fault *fault)
{
    char path[PATH_MAX], real[PATH_MAX];
    if (!realpath(options->corpus, real)) {
        return iso_fault_set(fault, -errno, "%s: %s", options->corpus, strerror(errno));
    }
    json_t *shapes = json_array();
    for (int32_t i = 0; i < bank->n; i++) {
        const struct sim_shape_row *row = &manifest->rows[bank->row[i]];
        (void)json_array_append_new(
            shapes, json_pack("{s:s, s:s}", "file", row->file, "class", row->class_name));
    }
    json_t *document = json_pack(
        "{s:s, s:s, s:s, s:s, s:o, s:i, s:i, s:i, s:i, s:b, s:o}", "format", format, "version",
        ISOTHERM_VERSION, "corpus", real, "method", method->name, "times_in_areas",
        sim_times_json(method, &options->times), "pairs", options->pairs, "vertices",
        options->vertices, "smooth", options->smooth, "neighbours",
        options->neighbours ? options->neighbours : ISO_CLOUD_NEIGHBOURS, "mend", options->mend,
        "shapes", shapes);
    const int error = iso_path_join(options->out, "index.json", path, fault);
    if (error) {
        json_decref(document);
        return error;
    }
    return sim_json_file_exact(document, path, fault);
}

static int write_index(const struct sim_index_options *options,
                       const struct iso_shape_method *method, const struct sim_bank *bank,
                       const struct sim_shape_manifest *manifest, struct iso_fault *fault)
{
    /* An index that is replaced has no list until its descriptions are complete. */
    char list[PATH_MAX];
    int error = iso_path_join(options->out, "index.json", list, fault);
    if (!error && unlink(list) != 0 && errno != ENOENT) {
        error = iso_fault_set(fault, -errno, "%s: %s", list, strerror(errno));
    }
    for (int32_t i = 0; i < bank->n && !error; i++) {
        char name[SIM_SHAPE_NAME_MAX];
        number_name((size_t)i, name);
        error = sim_description_write(options->out, name, 0, bank->description[i], fault);
    }
    return error ? error : write_list(options, method, bank, manifest, fault);
}

static int make_index(const struct sim_index_options *options,
                      const struct iso_shape_method *method, struct sim_shape_manifest *manifest,
                      FILE *out, struct iso_fault *fault)
{
    const struct sim_corpus_look look = {.directory = options->corpus,
                                         .neighbours = options->neighbours,
                                         .mend = options->mend,
                                         .strict = options->strict,
                                         .colours_needed = method->colour,
                                         .threads = options->threads};
    const struct sim_bank_options how = {
        .corpus = options->corpus,
        .manifest = manifest,
        .methods = &method,
        .n_methods = 1,
        .source = {.vertices = options->vertices,
                   .mend = options->mend,
                   .neighbours = options->neighbours,
                   .smooth = options->smooth},
        .n_pairs = options->pairs,
        .times = options->times,
        .skip = !options->strict,
        .threads = options->threads,
    };
    struct sim_bank *bank = NULL;
    int32_t coloured = 0;
    int error = sim_corpus_look(&look, manifest, options->out, &coloured, fault);
    if (!error) {
        error = sim_bank_new(&how, &bank, fault);
    }
    if (!error) {
        error = write_index(options, method, bank, manifest, fault);
    }
    if (!error) {
        fprintf(out, "%d %s by %s in %s\n", bank->n,
                iso_plural((uint64_t)bank->n, "shape", "shapes"), method->name, options->out);
    }
    sim_bank_free(bank);
    return error;
}

/* The name of an index beside its folder; free() it. NULL: no memory. */
static char *name_beside(const char *corpus)
{
    char *name = NULL;
    size_t length = strlen(corpus);
    while (length > 1 && corpus[length - 1] == '/') {
        length--;
    }
    return asprintf(&name, "%.*s.index", (int)length, corpus) < 0 ? NULL : name;
}

static int index_into(const struct sim_index_options *options, FILE *out, struct iso_fault *fault)
{
    const struct iso_shape_method *method = NULL;
    struct sim_shape_manifest *manifest = NULL;
    int error = sim_neighbours_check(options->neighbours, fault);
    if (!error) {
        error = sim_choice_method(options->method, &method, fault);
    }
    if (!error) {
        error = sim_times_check_own(method, &options->times, fault);
    }
    if (!error) {
        error = sim_shape_manifest_read(options->corpus, &manifest, fault);
    }
    if (!error) {
        error = sim_make_directory(options->out, fault);
    }
    if (!error) {
        error = make_index(options, method, manifest, out, fault);
    }
    sim_shape_manifest_free(manifest);
    return error;
}

int sim_shapes_index(const struct sim_index_options *options, FILE *out, struct iso_fault *fault)
{
    struct sim_index_options named = *options;
    char *name = options->out ? NULL : name_beside(options->corpus);
    named.out = options->out ? options->out : name;
    const int error = named.out ? index_into(&named, out, fault)
                                : iso_fault_set(fault, -ENOMEM, "out of memory");
    free(name);
    return error;
}

/* ---- reading -------------------------------------------------------------------------------- */

static int take_list(json_t *document, struct sim_index *index)
{
    const char *name = NULL, *corpus = NULL, *method = NULL;
    json_t *shapes = NULL, *times = NULL;
    int mend = 0, pairs = 0, vertices = 0, smooth = 0;
    int neighbours = 0; /* an index without clouds of an earlier version does not have it */
    if (json_unpack(document, "{s:s, s:s, s:s, s?o, s:i, s:i, s:i, s?i, s:b, s:o}", "format", &name,
                    "corpus", &corpus, "method", &method, "times_in_areas", &times, "pairs", &pairs,
                    "vertices", &vertices, "smooth", &smooth, "neighbours", &neighbours, "mend",
                    &mend, "shapes", &shapes) != 0 ||
        (strcmp(name, format) != 0 && strcmp(name, first_format) != 0) ||
        json_array_size(shapes) == 0 || json_array_size(shapes) > SHAPES_MAX ||
        sim_neighbours_check(neighbours, NULL)) {
        return -EBADMSG;
    }
    const size_t n = json_array_size(shapes);
    index->source = (struct sim_source_options){
        .vertices = vertices, .mend = mend != 0, .neighbours = neighbours, .smooth = smooth};
    index->n_pairs = pairs;
    index->method = iso_shape_method_find(method);
    /* An index of the first format has no times. Those of the method are used. */
    const bool has_times = strcmp(name, first_format) != 0;
    if (!index->method || (has_times && sim_times_read(index->method, times, &index->times) != 0)) {
        return -EBADMSG;
    }
    index->corpus = strdup(corpus);
    index->file = calloc(n, sizeof *index->file);
    index->class_name = calloc(n, sizeof *index->class_name);
    if (!index->corpus || !index->file || !index->class_name) {
        return -ENOMEM;
    }
    for (size_t i = 0; i < n; i++) {
        const char *file = NULL, *class_name = NULL;
        if (json_unpack(json_array_get(shapes, i), "{s:s, s:s}", "file", &file, "class",
                        &class_name) != 0) {
            return -EBADMSG;
        }
        index->file[i] = strdup(file);
        index->class_name[i] = strdup(class_name);
        index->n++;
        if (!index->file[i] || !index->class_name[i]) {
            return -ENOMEM;
        }
    }
    return 0;
}

static int read_list(const char *directory, struct sim_index *index, struct iso_fault *fault)
{
    char path[PATH_MAX], *text = NULL;
    int error = iso_path_join(directory, "index.json", path, fault);
    if (!error) {
        error = iso_text_read(path, BYTES_MAX, &text, fault);
    }
    if (error) {
        return error;
    }
    json_t *document = json_loads(text, 0, NULL);
    error = document ? take_list(document, index) : -EBADMSG;
    json_decref(document);
    free(text);
    return error ? iso_fault_set(fault, error, "%s: %s", path,
                                 error == -ENOMEM ? "out of memory" : "no index of shapes")
                 : 0;
}

/* Learns what the method learns, and codes all shapes. */
static int learn(struct sim_index *index, struct iso_shape_description *const *description)
{
    int error = iso_shape_coder_new(index->method,
                                    (const struct iso_shape_description *const *)description,
                                    index->n, 0, SEED, &index->coder);
    if (error) {
        return error;
    }
    const size_t size = (size_t)iso_shape_coder_layout(index->coder)->size;
    index->feature = calloc((size_t)index->n * size, sizeof *index->feature);
    error = index->feature ? 0 : -ENOMEM;
    for (int32_t i = 0; i < index->n && !error; i++) {
        error = iso_shape_code(index->coder, description[i], &index->feature[(size_t)i * size]);
    }
    return error;
}

static int read_descriptions(const char *directory, struct sim_index *index,
                             struct iso_fault *fault)
{
    struct iso_shape_description **description = calloc((size_t)index->n, sizeof *description);
    int error = description ? 0 : iso_fault_set(fault, -ENOMEM, "%s: out of memory", directory);
    for (int32_t i = 0; i < index->n && !error; i++) {
        char name[SIM_SHAPE_NAME_MAX], path[PATH_MAX];
        int32_t n_vertices = 0;
        number_name((size_t)i, name);
        error = iso_path_join(directory, name, path, fault);
        if (!error) {
            error = sim_description_read(path, &n_vertices, &description[i], fault);
        }
    }
    if (!error) {
        error = learn(index, description);
        if (error) {
            (void)iso_fault_set(fault, error == -EINVAL ? -EBADMSG : error,
                                "%s: its descriptions do not belong together", directory);
        }
    }
    for (int32_t i = 0; description && i < index->n; i++) {
        iso_shape_description_free(description[i]);
    }
    free(description);
    return error == -EINVAL ? -EBADMSG : error;
}

int sim_index_open(const char *directory, struct sim_index **out, struct iso_fault *fault)
{
    struct sim_index *index = calloc(1, sizeof *index);
    if (!index) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", directory);
    }
    int error = read_list(directory, index, fault);
    if (!error) {
        error = read_descriptions(directory, index, fault);
    }
    if (error) {
        sim_index_close(index);
        return error;
    }
    *out = index;
    return 0;
}

void sim_index_close(struct sim_index *index)
{
    if (index) {
        for (int32_t i = 0; i < index->n; i++) {
            free(index->file[i]);
            free(index->class_name[i]);
        }
        free(index->file);
        free(index->class_name);
        free(index->corpus);
        free(index->feature);
        iso_shape_coder_free(index->coder);
        free(index);
    }
}

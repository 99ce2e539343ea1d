#include "sim/shapes/study/study.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/base/path.h"
#include "sim/base/make_directory.h"
#include "sim/shapes/describe/corpus.h"
#include "sim/shapes/study/study_data.h"

/* ---- the corpus --------------------------------------------------------------------------- */

/* Whether a method that was named needs colours. */
static bool need_colours(const struct sim_choice *choice)
{
    for (int m = 0; m < choice->n_methods && !choice->all_methods; m++) {
        if (choice->method[m]->colour) {
            return true;
        }
    }
    return false;
}

/* Retrieval needs somebody else to be found, and another class to be mistaken for. */
static int check_classes(const struct sim_study *study, struct iso_fault *fault)
{
    const struct sim_shape_manifest *manifest = study->manifest;
    const char *corpus = study->options->corpus;
    if (manifest->n < 2) {
        return iso_fault_set(fault, -ENODATA,
                             "%s: one shape; nothing can be retrieved from it (`shapes describe` "
                             "describes a single mesh)",
                             corpus);
    }
    if (manifest->n_classes < 2) {
        return iso_fault_set(fault, -ENODATA,
                             "%s: all %d shapes are of one class, '%.40s': put the meshes of each "
                             "class into a folder, or name the classes in manifest.csv",
                             corpus, manifest->n, manifest->class_name[0]);
    }
    return 0;
}

static int open_corpus(struct sim_study *study, struct iso_fault *fault)
{
    const struct sim_shapes_study_options *options = study->options;
    const struct sim_corpus_look how = {.directory = options->corpus,
                                        .neighbours = options->neighbours,
                                        .mend = options->mend,
                                        .strict = options->strict,
                                        .colours_needed = need_colours(&study->choice),
                                        .threads = options->threads};
    int32_t coloured = 0;
    int error = sim_shape_manifest_read(options->corpus, &study->manifest, fault);
    if (!error) {
        error = check_classes(study, fault);
    }
    if (!error) {
        error = sim_make_directory(options->out, fault);
    }
    if (!error) {
        error = sim_corpus_look(&how, study->manifest, options->out, &coloured, fault);
    }
    if (!error) {
        error = check_classes(study, fault);
    }
    if (!error && coloured < study->manifest->n) {
        sim_choice_without_colours(&study->choice);
    }
    return error;
}

/* ---- the whole study ---------------------------------------------------------------------- */

static void print_bank(const struct sim_study *study, FILE *out)
{
    const struct sim_bank *bank = study->items;
    fprintf(out, "%d shapes of %d classes, %.0f vertices in the mean\n", bank->n,
            study->manifest->n_classes, bank->mean_vertices);
    fprintf(out,
            "described in %.1f s by %d threads; processor time %.1f s for eigenpairs; memory "
            "%.0f MB; %d of %d descriptions were in the cache\n",
            bank->elapsed_seconds, study->options->threads, bank->shape_seconds,
            (double)bank->peak_kib / 1024.0, bank->n_known, bank->n * bank->n_methods);
    for (int m = 0; m < bank->n_methods; m++) {
        fprintf(out, "  %-13s %7.2f s\n", study->choice.method[m]->name, bank->seconds[m]);
    }
}

/* Describes the queries, if they are not all items as they are. */
static int describe_queries(struct sim_study *study, struct iso_fault *fault)
{
    const struct sim_shapes_study_options *options = study->options;
    struct sim_bank_options *how = &study->queries_how;
    how->source.distortion = options->distortion.level > 0 ? &options->distortion : NULL;
    study->query_row = calloc((size_t)study->manifest->n, sizeof *study->query_row);
    int error = study->query_row ? sim_shape_manifest_turns(study->manifest, options->queries,
                                                            study->query_row, &how->n_rows)
                                 : -ENOMEM;
    if (!error) {
        how->rows = study->query_row;
        error = sim_bank_new(how, &study->queries, fault);
    }
    return error;
}

static int describe_shapes(struct sim_study *study, FILE *out, struct iso_fault *fault)
{
    const struct sim_shapes_study_options *options = study->options;
    char cache[PATH_MAX];
    int error = iso_path_join(options->out, "cache", cache, fault);
    if (error) {
        return error;
    }
    const char *given = options->cache ? options->cache : cache;
    study->items_how = (struct sim_bank_options){
        .corpus = options->corpus,
        .manifest = study->manifest,
        .methods = study->choice.method,
        .n_methods = study->choice.n_methods,
        .source = {.vertices = options->vertices,
                   .mend = options->mend,
                   .neighbours = options->neighbours,
                   .seed = options->seed,
                   .smooth = options->smooth},
        .n_pairs = options->pairs,
        .times = options->times,
        .cache = given[0] ? given : NULL,
        .skip = !options->strict,
        .threads = options->threads,
    };
    study->queries_how = study->items_how;
    error = sim_bank_new(&study->items_how, &study->items, fault);
    if (!error) {
        error = sim_bank_match(study->items, study->manifest);
    }
    if (!error) {
        error = check_classes(study, fault);
    }
    if (!error && (options->distortion.level > 0 || options->queries > 0)) {
        error = describe_queries(study, fault);
    }
    if (!error) {
        print_bank(study, out);
    }
    study->items_how.cache = study->queries_how.cache = NULL; /* it ends with this function */
    return error;
}

static int run_study(struct sim_study *study, FILE *out, struct iso_fault *fault)
{
    int error = sim_neighbours_check(study->options->neighbours, fault);
    if (!error) {
        error = sim_choice_read(&study->options->methods, &study->options->classifiers,
                                &study->choice, fault);
    }
    if (!error) {
        error = sim_study_check_times(study, fault);
    }
    if (!error) {
        error = open_corpus(study, fault);
    }
    if (!error) {
        error = describe_shapes(study, out, fault);
    }
    if (!error) {
        fputs("\nmethod        classifier    NN    [95 %]        1-tier 2-tier e      DCG    ADR"
              "     TP     FP     prec.  recall ROC\n",
              out);
    }
    for (int m = 0; !error && m < study->choice.n_methods; m++) {
        error = sim_study_run_method(study, m, out, fault);
    }
    if (error) {
        return error;
    }
    return sim_study_save(study, fault);
}

int sim_shapes_study(const struct sim_shapes_study_options *options, FILE *out,
                     struct iso_fault *fault)
{
    struct iso_fault unread = {.text = ""};
    struct sim_study *study = calloc(1, sizeof *study);
    fault = fault ? fault : &unread;
    fault->text[0] = '\0';
    if (!study) {
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    study->options = options;
    const int error = run_study(study, out, fault);
    if (error && fault->text[0] == '\0') {
        (void)iso_fault_set(fault, error, "%s: %s", options->corpus, strerror(-error));
    }
    sim_bank_free(study->items);
    sim_bank_free(study->queries);
    free(study->query_row);
    sim_shape_manifest_free(study->manifest);
    free(study);
    return error;
}

#include "sim/shapes/study/study.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "sim/base/make_directory.h"
#include "sim/shapes/learn/learn.h"
#include "sim/shapes/study/study_data.h"

/* ---- the requested methods and classifiers ---------------------------------------------- */

/* Whether the first shape of the corpus has colours. */
static int find_colours(const struct sim_study *study, bool *coloured, struct iso_fault *fault)
{
    struct sim_bank_options plain = {.corpus = study->options->corpus, .manifest = study->manifest};
    struct iso_coloured_mesh mesh = {NULL, NULL};
    const int error = sim_bank_read(&plain, 0, &mesh, fault);
    *coloured = mesh.colour != NULL;
    iso_coloured_mesh_done(&mesh);
    return error;
}

static int choose_methods(struct sim_study *study, struct iso_fault *fault)
{
    const char *name = study->options->method;
    bool coloured = false;
    if (strcmp(name, "all") != 0) {
        study->method[0] = iso_shape_method_find(name);
        study->n_methods = 1;
        return study->method[0] ? 0
                                : iso_fault_set(fault, -EINVAL, "--method: '%s' is unknown", name);
    }
    const int error = find_colours(study, &coloured, fault);
    for (int m = 0; !error && iso_shape_methods[m] && study->n_methods < SIM_STUDY_METHODS_MAX;
         m++) {
        if (coloured || !iso_shape_methods[m]->colour) {
            study->method[study->n_methods++] = iso_shape_methods[m];
        }
    }
    return error;
}

/* A classifier whose module is not installed is skipped. */
static int add_if_there(struct sim_study *study, const struct iso_classifier_ops *classifier,
                        struct iso_fault *fault)
{
    struct iso_fault why = {.text = ""};
    const int error = iso_learn_load(classifier, &why);
    if (error == -ENOENT) {
        fprintf(stderr, "isotherm-sim: %s left out: %s\n", classifier->name, why.text);
        return 0;
    }
    study->classifier[study->n_classifiers++] = classifier;
    return error ? iso_fault_set(fault, error, "%s", why.text) : 0;
}

static int choose_classifiers(struct sim_study *study, struct iso_fault *fault)
{
    const struct iso_classifier_ops *const *const tables[] = {iso_classifiers,
                                                              iso_learn_classifiers};
    const char *name = study->options->classifier;
    if (!name) {
        return 0;
    }
    if (strcmp(name, "all") != 0) {
        study->classifier[0] = iso_learn_find(name);
        study->n_classifiers = 1;
        return study->classifier[0]
                   ? iso_learn_load(study->classifier[0], fault)
                   : iso_fault_set(fault, -EINVAL, "--classifier: '%s' is unknown", name);
    }
    int error = 0;
    for (size_t t = 0; t < sizeof tables / sizeof *tables; t++) {
        for (int c = 0; !error && tables[t][c] && study->n_classifiers < SIM_STUDY_CLASSIFIERS_MAX;
             c++) {
            error = add_if_there(study, tables[t][c], fault);
        }
    }
    return error;
}

/* ---- the whole study ---------------------------------------------------------------------- */

static int describe_shapes(struct sim_study *study, FILE *out, struct iso_fault *fault)
{
    const struct sim_shapes_study_options *options = study->options;
    study->items_how = (struct sim_bank_options){
        .corpus = options->corpus,
        .manifest = study->manifest,
        .methods = study->method,
        .n_methods = study->n_methods,
        .seed = options->seed,
        .smooth = options->smooth,
        .vertices = options->vertices,
        .threads = options->threads,
    };
    study->queries_how = study->items_how;
    int error = sim_bank_new(&study->items_how, &study->items, fault);
    if (!error && options->distortion.level > 0) {
        study->queries_how.distortion = &options->distortion;
        error = sim_bank_new(&study->queries_how, &study->distorted, fault);
    }
    if (error) {
        return error;
    }
    const struct sim_bank *bank = study->items;
    fprintf(out, "%d shapes of %d classes, %.0f vertices in the mean\n", bank->n,
            study->manifest->n_classes, bank->mean_vertices);
    fprintf(out,
            "described in %.1f s by %d threads; processor time %.1f s for eigenpairs; memory "
            "%.0f MB\n",
            bank->elapsed_seconds, options->threads, bank->shape_seconds,
            (double)bank->peak_kib / 1024.0);
    for (int m = 0; m < study->n_methods; m++) {
        fprintf(out, "  %-13s %7.2f s\n", study->method[m]->name, bank->seconds[m]);
    }
    return 0;
}

static int run_study(struct sim_study *study, FILE *out, struct iso_fault *fault)
{
    int error = sim_make_directory(study->options->out, fault);
    if (!error) {
        error = sim_shape_manifest_read(study->options->corpus, &study->manifest, fault);
    }
    if (!error) {
        error = choose_methods(study, fault);
    }
    if (!error) {
        error = choose_classifiers(study, fault);
    }
    if (!error) {
        error = describe_shapes(study, out, fault);
    }
    if (!error) {
        fputs("\nmethod        classifier    NN    [95 %]        1-tier 2-tier e      DCG    ADR"
              "     TP     FP     prec.  recall ROC\n",
              out);
    }
    for (int m = 0; !error && m < study->n_methods; m++) {
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
    sim_bank_free(study->distorted);
    sim_shape_manifest_free(study->manifest);
    free(study);
    return error;
}

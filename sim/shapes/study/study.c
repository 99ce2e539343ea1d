#include "sim/shapes/study/study.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "drivers/base/path.h"
#include "sim/lab/draw/plot.h"
#include "sim/lab/measure/rate.h"
#include "sim/lab/report/report_file.h"
#include "sim/shapes/learn/learn.h"
#include "sim/shapes/study/retrieve.h"
#include "sim/shapes/study/sheet.h"

enum { METHODS_MAX = 24, CLASSIFIERS_MAX = 12, RESULTS_MAX = METHODS_MAX * CLASSIFIERS_MAX };

/* What one method and classifier came to. */
struct result {
    const struct iso_shape_method *method;
    const struct iso_classifier_ops *classifier;
    bool ranked;
    struct iso_retrieval retrieval;
    struct iso_confusion_rates rates;
};

struct study {
    const struct sim_shapes_study_options *options;
    struct sim_shape_manifest *manifest;
    struct sim_bank_options items_how, queries_how;
    const struct iso_shape_method *method[METHODS_MAX];
    const struct iso_classifier_ops *classifier[CLASSIFIERS_MAX];
    int n_methods, n_classifiers; /* no classifiers: each method's own */
    struct sim_bank *items, *distorted;
    int n_results;
    struct result result[RESULTS_MAX];
};

/* ---- what was asked for ---------------------------------------------------------- */

/* Whether the first shape of the corpus has colours. */
static int find_colours(const struct study *study, bool *coloured, struct iso_fault *fault)
{
    struct sim_bank_options plain = {.corpus = study->options->corpus, .manifest = study->manifest};
    struct iso_coloured_mesh mesh = {NULL, NULL};
    int error = sim_bank_read(&plain, 0, &mesh, fault);
    *coloured = mesh.colour != NULL;
    iso_coloured_mesh_done(&mesh);
    return error;
}

static int choose_methods(struct study *study, struct iso_fault *fault)
{
    const char *name = study->options->method;
    bool coloured = false;
    if (strcmp(name, "all") != 0) {
        study->method[0] = iso_shape_method_find(name);
        study->n_methods = 1;
        return study->method[0] ? 0
                                : iso_fault_set(fault, -EINVAL, "--method: '%s' is unknown", name);
    }
    int error = find_colours(study, &coloured, fault);
    for (int m = 0; !error && iso_shape_methods[m] && study->n_methods < METHODS_MAX; m++) {
        if (coloured || !iso_shape_methods[m]->colour) {
            study->method[study->n_methods++] = iso_shape_methods[m];
        }
    }
    return error;
}

/* One whose module is not installed is left out. */
static int add_if_there(struct study *study, const struct iso_classifier_ops *classifier,
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

static int choose_classifiers(struct study *study, struct iso_fault *fault)
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
        for (int c = 0; !error && tables[t][c] && study->n_classifiers < CLASSIFIERS_MAX; c++) {
            error = add_if_there(study, tables[t][c], fault);
        }
    }
    return error;
}

/* ---- results ----------------------------------------------------------------------- */

struct matrix {
    const struct sim_features *features;
    const double *distance;
};

static void write_matrix(const void *context, FILE *out)
{
    const struct matrix *matrix = context;
    const struct sim_features *f = matrix->features;
    fputs("query", out);
    for (int32_t i = 0; i < f->items->n; i++) {
        fprintf(out, ",%s", f->manifest->rows[f->items->row[i]].file);
    }
    fputc('\n', out);
    for (int32_t q = 0; q < f->queries->n; q++) {
        fputs(f->manifest->rows[f->queries->row[q]].file, out);
        for (int32_t i = 0; i < f->items->n; i++) {
            fprintf(out, ",%.7g", matrix->distance[(size_t)q * (size_t)f->items->n + (size_t)i]);
        }
        fputc('\n', out);
    }
}

struct confusion {
    const struct sim_shape_manifest *manifest;
    const int32_t *count;
};

static void write_confusion(const void *context, FILE *out)
{
    const struct confusion *confusion = context;
    int32_t n = confusion->manifest->n_classes;
    fputs("class", out);
    for (int32_t told = 0; told < n; told++) {
        fprintf(out, ",%s", confusion->manifest->class_name[told]);
    }
    fputc('\n', out);
    for (int32_t c = 0; c < n; c++) {
        fputs(confusion->manifest->class_name[c], out);
        for (int32_t told = 0; told < n; told++) {
            fprintf(out, ",%d", confusion->count[c * n + told]);
        }
        fputc('\n', out);
    }
}

static int make_directory(const char *path, struct iso_fault *fault)
{
    return mkdir(path, 0777) == 0 || errno == EEXIST ? 0
                                                     : iso_fault_set(fault, -errno, "%s: %m", path);
}

/* OUT/METHOD-CLASSIFIER, made if it is missing. */
static int directory_of(const struct study *study, const struct result *result,
                        char directory[PATH_MAX], struct iso_fault *fault)
{
    char name[128];
    (void)snprintf(name, sizeof name, "%s-%s", result->method->name, result->classifier->name);
    int error = iso_path_join(study->options->out, name, directory, fault);
    return error ? error : make_directory(directory, fault);
}

/* The distances and a picture of them. */
static int save_matrix(const struct study *study, const struct result *result,
                       const struct matrix *matrix, struct iso_fault *fault)
{
    char directory[PATH_MAX], path[PATH_MAX];
    int error = directory_of(study, result, directory, fault);
    error = error ? error
                  : sim_report_file(directory, "distances.csv", write_matrix, matrix, fault);
    if (!error && study->options->pictures > 0) {
        error = iso_path_join(directory, "matches.png", path, fault);
        error = error ? error
                      : sim_sheet_matches(&study->queries_how, matrix->features, matrix->distance,
                                          study->options->pictures + 1, path, fault);
    }
    return error;
}

static int measure_classes(const struct study *study, const struct sim_features *features,
                           struct result *result, struct iso_fault *fault)
{
    size_t n = (size_t)study->manifest->n_classes;
    int32_t *count = calloc(n * n, sizeof *count);
    char directory[PATH_MAX];
    int error = count ? sim_features_classify(features, result->classifier, study->options->seed,
                                              study->options->threads, count, &result->rates)
                      : -ENOMEM;
    if (!error) {
        const struct confusion confusion = {study->manifest, count};
        error = directory_of(study, result, directory, fault);
        error = error ? error
                      : sim_report_file(directory, "confusion.csv", write_confusion, &confusion,
                                        fault);
    }
    free(count);
    return error;
}

static int measure_ranking(const struct study *study, const struct sim_features *features,
                           struct result *result, struct iso_fault *fault)
{
    double *distance = calloc((size_t)features->queries->n * (size_t)features->items->n,
                              sizeof *distance);
    if (!distance) {
        return -ENOMEM;
    }
    int error = sim_features_rank(features, result->classifier, study->options->threads, distance);
    error = error ? error : sim_features_measure(features, distance, &result->retrieval);
    if (!error) {
        const struct matrix matrix = {features, distance};
        result->ranked = true;
        error = save_matrix(study, result, &matrix, fault);
    }
    free(distance);
    return error;
}

static void print_result(const struct result *result, FILE *out)
{
    const struct iso_retrieval *r = &result->retrieval;
    const struct iso_confusion_rates *t = &result->rates;
    fprintf(out, "%-13s %-13s", result->method->name, result->classifier->name);
    if (result->ranked) {
        struct sim_rate rate = {(size_t)lrint(r->nearest * r->n_queries), (size_t)r->n_queries};
        struct sim_interval interval = sim_rate_interval(rate);
        fprintf(out, " %.3f [%.3f %.3f] %.3f  %.3f  %.3f  %.3f  %.3f ", r->nearest, interval.low,
                interval.high, r->first_tier, r->second_tier, r->e_measure, r->dcg, r->adr);
    } else {
        fprintf(out, " %-52s", "does not rank");
    }
    fprintf(out, " %.3f  %.3f  %.3f  %.3f  %.3f\n", t->tp_rate, t->fp_rate, t->precision, t->recall,
            t->roc_area);
    (void)fflush(out);
}

static int run_classifier(struct study *study, const struct sim_features *features,
                          const struct iso_shape_method *method,
                          const struct iso_classifier_ops *classifier, FILE *out,
                          struct iso_fault *fault)
{
    struct result *result = &study->result[study->n_results];
    *result = (struct result){.method = method, .classifier = classifier};
    int error = classifier->rank ? measure_ranking(study, features, result, fault) : 0;
    error = error ? error : measure_classes(study, features, result, fault);
    if (error) {
        return fault->text[0] ? error
                              : iso_fault_set(fault, error, "%s by %s: %s", method->name,
                                              classifier->name, strerror(-error));
    }
    study->n_results++;
    print_result(result, out);
    return 0;
}

static int run_method(struct study *study, int m, FILE *out, struct iso_fault *fault)
{
    const struct iso_shape_method *method = study->method[m];
    const struct sim_features_options options = {
        .method = method, .index = m, .seed = study->options->seed};
    const struct iso_classifier_ops *own = iso_learn_find(method->classifier);
    struct sim_features *features = NULL;
    int error = sim_features_new(study->manifest, study->items, &options, &features);
    if (!error && study->distorted) {
        error = sim_features_ask(features, study->distorted);
    }
    if (error) {
        (void)iso_fault_set(fault, error, "%s: %s", method->name, strerror(-error));
    }
    for (int c = 0; !error && c < study->n_classifiers; c++) {
        error = run_classifier(study, features, method, study->classifier[c], out, fault);
    }
    if (!error && study->n_classifiers == 0) {
        error = own ? iso_learn_load(own, fault)
                    : iso_fault_set(fault, -ENOTSUP, "this build has no classifier '%s'",
                                    method->classifier);
        error = error ? error : run_classifier(study, features, method, own, out, fault);
    }
    sim_features_free(features);
    return error;
}

/* ---- files of the whole ---------------------------------------------------------------- */

static void write_measures(const void *context, FILE *out)
{
    const struct study *study = context;
    fputs("method,classifier,queries,nn,first_tier,second_tier,e_measure,dcg,adr,"
          "tp_rate,fp_rate,precision,recall,roc_area,describe_s,eigenpairs_s\n",
          out);
    for (int i = 0; i < study->n_results; i++) {
        const struct result *r = &study->result[i];
        const struct iso_retrieval *m = &r->retrieval;
        int method = 0;
        while (study->method[method] != r->method) {
            method++;
        }
        fprintf(out, "%s,%s,", r->method->name, r->classifier->name);
        if (r->ranked) {
            fprintf(out, "%d,%.6f,%.6f,%.6f,%.6f,%.6f,%.6f", m->n_queries, m->nearest,
                    m->first_tier, m->second_tier, m->e_measure, m->dcg, m->adr);
        } else {
            fputs(",,,,,,", out);
        }
        fprintf(out, ",%.6f,%.6f,%.6f,%.6f,%.6f,%.3f,%.3f\n", r->rates.tp_rate, r->rates.fp_rate,
                r->rates.precision, r->rates.recall, r->rates.roc_area,
                study->items->seconds[method], study->items->shape_seconds);
    }
}

static int plot_curves(const struct study *study, struct iso_fault *fault)
{
    enum { CURVES_MAX = 12 };
    char path[PATH_MAX], label[CURVES_MAX][64];
    double recall[ISO_RECALL_LEVELS];
    struct sim_series series[CURVES_MAX];
    size_t n = 0;
    for (int i = 0; i < ISO_RECALL_LEVELS; i++) {
        recall[i] = (i + 1.0) / ISO_RECALL_LEVELS;
    }
    for (int i = 0; i < study->n_results && n < CURVES_MAX; i++) {
        const struct result *r = &study->result[i];
        if (r->ranked) {
            (void)snprintf(label[n], sizeof label[n], "%s, %s", r->method->title,
                           r->classifier->title);
            series[n] = (struct sim_series){label[n], SIM_SERIES_LINE, ISO_RECALL_LEVELS, recall,
                                            r->retrieval.precision};
            n++;
        }
    }
    const struct sim_plot plot = {
        .title = "Precision and recall",
        .legend = SIM_LEGEND_LOWER,
        .x = {"recall", SIM_SCALE_LINEAR, 0.0, 1.0},
        .y = {"precision", SIM_SCALE_LINEAR, 0.0, 1.0},
        .n_series = n,
        .series = series,
    };
    int error = iso_path_join(study->options->out, "precision-recall.png", path, fault);
    return error || n == 0 ? error : sim_plot_write(&plot, path, fault);
}

static int save(const struct study *study, struct iso_fault *fault)
{
    char path[PATH_MAX];
    int error = sim_report_file(study->options->out, "measures.csv", write_measures, study, fault);
    error = error ? error : plot_curves(study, fault);
    if (!error && study->options->pictures > 0) {
        error = iso_path_join(study->options->out, "shapes.png", path, fault);
        error = error ? error
                      : sim_sheet_classes(&study->items_how, study->options->pictures + 1, path,
                                          fault);
    }
    return error;
}

/* ---- all of it ---------------------------------------------------------------------- */

static int describe(struct study *study, FILE *out, struct iso_fault *fault)
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

static int run(struct study *study, FILE *out, struct iso_fault *fault)
{
    int error = make_directory(study->options->out, fault);
    error = error ? error
                  : sim_shape_manifest_read(study->options->corpus, &study->manifest, fault);
    error = error ? error : choose_methods(study, fault);
    error = error ? error : choose_classifiers(study, fault);
    error = error ? error : describe(study, out, fault);
    if (!error) {
        fputs("\nmethod        classifier    NN    [95 %]        1-tier 2-tier e      DCG    ADR"
              "     TP     FP     prec.  recall ROC\n",
              out);
    }
    for (int m = 0; !error && m < study->n_methods; m++) {
        error = run_method(study, m, out, fault);
    }
    return error ? error : save(study, fault);
}

int sim_shapes_study(const struct sim_shapes_study_options *options, FILE *out,
                     struct iso_fault *fault)
{
    struct iso_fault unread = {.text = ""};
    struct study *study = calloc(1, sizeof *study);
    fault = fault ? fault : &unread;
    fault->text[0] = '\0';
    if (!study) {
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    study->options = options;
    int error = run(study, out, fault);
    if (error && fault->text[0] == '\0') {
        (void)iso_fault_set(fault, error, "%s: %s", options->corpus, strerror(-error));
    }
    sim_bank_free(study->items);
    sim_bank_free(study->distorted);
    sim_shape_manifest_free(study->manifest);
    free(study);
    return error;
}

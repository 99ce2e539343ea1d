#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/base/path.h"
#include "sim/base/make_directory.h"
#include "sim/base/result_file.h"
#include "sim/lab/measure/rate.h"
#include "sim/shapes/learn/learn.h"
#include "sim/shapes/study/sheet.h"
#include "sim/shapes/study/study_data.h"

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
    const int32_t n = confusion->manifest->n_classes;
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

/* Creates OUT/METHOD-CLASSIFIER if it is missing. */
static int directory_of(const struct sim_study *study, const struct sim_study_result *result,
                        char directory[PATH_MAX], struct iso_fault *fault)
{
    char name[128];
    (void)snprintf(name, sizeof name, "%s-%s", result->method->name, result->classifier->name);
    const int error = iso_path_join(study->options->out, name, directory, fault);
    if (error) {
        return error;
    }
    return sim_make_directory(directory, fault);
}

/* Writes the distances and, if pictures are wanted, a picture of the first matches. */
static int save_matrix(const struct sim_study *study, const struct sim_study_result *result,
                       const struct matrix *matrix, struct iso_fault *fault)
{
    char directory[PATH_MAX], path[PATH_MAX];
    int error = directory_of(study, result, directory, fault);
    if (!error) {
        error = sim_result_file(directory, "distances.csv", write_matrix, matrix, fault);
    }
    if (!error && study->options->pictures > 0) {
        error = iso_path_join(directory, "matches.png", path, fault);
        if (!error) {
            error = sim_sheet_matches(&study->queries_how, matrix->features, matrix->distance,
                                      study->options->pictures + 1, path, fault);
        }
    }
    return error;
}

static int measure_classes(const struct sim_study *study, const struct sim_features *features,
                           struct sim_study_result *result, struct iso_fault *fault)
{
    const size_t n = (size_t)study->manifest->n_classes;
    int32_t *count = calloc(n * n, sizeof *count);
    char directory[PATH_MAX];
    int error = count ? sim_features_classify(features, result->classifier, study->options->seed,
                                              study->options->threads, count, &result->rates)
                      : -ENOMEM;
    if (!error) {
        const struct confusion confusion = {study->manifest, count};
        error = directory_of(study, result, directory, fault);
        if (!error) {
            error = sim_result_file(directory, "confusion.csv", write_confusion, &confusion, fault);
        }
    }
    free(count);
    return error;
}

static int measure_ranking(const struct sim_study *study, const struct sim_features *features,
                           struct sim_study_result *result, struct iso_fault *fault)
{
    double *distance = calloc((size_t)features->queries->n * (size_t)features->items->n,
                              sizeof *distance);
    if (!distance) {
        return -ENOMEM;
    }
    int error = sim_features_rank(features, result->classifier, study->options->threads, distance);
    if (!error) {
        error = sim_features_measure(features, distance, &result->retrieval);
    }
    if (!error) {
        const struct matrix matrix = {features, distance};
        result->ranked = true;
        error = save_matrix(study, result, &matrix, fault);
    }
    free(distance);
    return error;
}

static void print_result(const struct sim_study_result *result, FILE *out)
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

static int run_classifier(struct sim_study *study, const struct sim_features *features,
                          const struct iso_shape_method *method,
                          const struct iso_classifier_ops *classifier, FILE *out,
                          struct iso_fault *fault)
{
    struct sim_study_result *result = &study->result[study->n_results];
    *result = (struct sim_study_result){.method = method, .classifier = classifier};
    int error = classifier->rank ? measure_ranking(study, features, result, fault) : 0;
    if (!error) {
        error = measure_classes(study, features, result, fault);
    }
    if (error) {
        return fault->text[0] ? error
                              : iso_fault_set(fault, error, "%s by %s: %s", method->name,
                                              classifier->name, strerror(-error));
    }
    study->n_results++;
    print_result(result, out);
    return 0;
}

int sim_study_run_method(struct sim_study *study, int m, FILE *out, struct iso_fault *fault)
{
    const struct iso_shape_method *method = study->choice.method[m];
    const struct sim_features_options options = {.method = method,
                                                 .index = m,
                                                 .size = method->size > 0 ? study->options->words
                                                                          : 0,
                                                 .seed = study->options->seed};
    const struct iso_classifier_ops *own = iso_learn_find(method->classifier);
    struct sim_features *features = NULL;
    int error = sim_features_new(study->manifest, study->items, &options, &features);
    if (!error && study->queries) {
        error = sim_features_ask(features, study->queries);
    }
    if (error) {
        (void)iso_fault_set(fault, error, "%s: %s", method->name, strerror(-error));
    }
    for (int c = 0; !error && c < study->choice.n_classifiers; c++) {
        if (sim_choice_fits(method, study->choice.classifier[c])) {
            error = run_classifier(study, features, method, study->choice.classifier[c], out,
                                   fault);
        }
    }
    if (!error && study->choice.n_classifiers == 0) {
        error = own ? iso_learn_load(own, fault)
                    : iso_fault_set(fault, -ENOTSUP, "this build has no classifier '%s'",
                                    method->classifier);
        if (!error) {
            error = run_classifier(study, features, method, own, out, fault);
        }
    }
    sim_features_free(features);
    return error;
}

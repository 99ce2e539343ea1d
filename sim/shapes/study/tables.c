#include "sim/shapes/study/tables.h"

#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "sim/base/make_directory.h"
#include "sim/base/result_file.h"
#include "sim/shapes/learn/learn.h"
#include "sim/shapes/study/paper.h"
#include "sim/shapes/study/tables_corpus.h"

/* A measured row. */
struct measured {
    bool done;
    int32_t n_queries;
    double figure[SIM_PAPER_FIGURES];
};

struct tables {
    const struct sim_tables_options *options;
    struct sim_tables_corpus corpus[SIM_PAPER_SETS], *of_set[SIM_PAPER_SETS];
    struct measured *measured[SIM_PAPER_TABLES]; /* [n_rows] */
};

/* ---- rows ---------------------------------------------------------------------------- */

static int measure_retrieval(const struct sim_features *features,
                             const struct iso_classifier_ops *classifier, int threads,
                             enum sim_paper_columns columns, double *figure)
{
    struct iso_retrieval r;
    double *distance = calloc((size_t)features->queries->n * (size_t)features->items->n,
                              sizeof *distance);
    int error = distance ? sim_features_rank(features, classifier, threads, distance) : -ENOMEM;
    if (!error) {
        error = sim_features_measure(features, distance, &r);
    }
    if (!error) {
        figure[0] = r.nearest;
        figure[1] = r.first_tier;
        figure[2] = r.second_tier;
        figure[3] = columns == SIM_PAPER_TEXTURED ? r.adr : r.e_measure;
        figure[4] = r.dcg;
    }
    free(distance);
    return error;
}

static int measure_row(const struct tables *tables, struct sim_tables_corpus *corpus,
                       enum sim_paper_columns columns, const struct sim_paper_row *row,
                       struct measured *out, struct iso_fault *fault)
{
    const struct iso_classifier_ops *classifier = iso_learn_find(row->classifier);
    const struct sim_bank *queries = NULL;
    struct sim_features *features = NULL;
    int error = classifier ? iso_learn_load(classifier, fault) : -ENOENT;
    if (error == -ENOENT) {
        fault->text[0] = '\0';
        return 0; /* the library is missing in this build or on this machine; the row stays empty */
    }
    if (!error) {
        error = sim_tables_corpus_queries(corpus, row->distortion, &queries, fault);
    }
    if (!error) {
        error = sim_tables_corpus_features(corpus, row->method, row->size, tables->options->seed,
                                           &features);
    }
    if (!error) {
        error = sim_features_ask(features, queries);
    }
    if (!error && columns == SIM_PAPER_CLASSES) {
        struct iso_confusion_rates told;
        error = sim_features_classify(features, classifier, tables->options->seed,
                                      tables->options->threads, NULL, &told);
        const double figure[] = {told.tp_rate, told.fp_rate, told.precision, told.recall,
                                 told.roc_area};
        memcpy(out->figure, figure, error ? 0 : sizeof figure);
    } else if (!error) {
        error = measure_retrieval(features, classifier, tables->options->threads, columns,
                                  out->figure);
    }
    if (error && fault->text[0] == '\0') {
        (void)iso_fault_set(fault, error, "%s by %s: %s", row->method, row->classifier,
                            strerror(-error));
    }
    out->done = !error;
    out->n_queries = error ? 0 : queries->n;
    return error;
}

/* ---- output ---------------------------------------------------------------------------- */

static bool has_figures(const struct sim_paper_row *row)
{
    return row->figure[0] > 0.0;
}

static void print_figures(const double *figure, int n, bool there, FILE *out)
{
    for (int i = 0; i < n; i++) {
        if (there) {
            fprintf(out, " %6.3f", figure[i]);
        } else {
            fprintf(out, " %6s", "-");
        }
    }
}

static void print_row(const struct sim_paper_table *table, int r, const struct measured *measured,
                      FILE *out)
{
    const struct sim_paper_row *row = &table->rows[r];
    const int n = sim_paper_n_columns(table->columns);
    char what[32] = "";
    if (row->distortion.level > 0) {
        (void)snprintf(what, sizeof what, "%s:%d", sim_distortion_name(row->distortion.kind),
                       row->distortion.level);
    } else if (row->size > 0) {
        (void)snprintf(what, sizeof what, "%d", row->size);
    }
    fprintf(out, "  %-13s %-13s %-9s |", row->method ? row->method : row->title,
            row->classifier ? row->classifier : "", what);
    print_figures(measured->figure, n, measured->done, out);
    fputs(" |", out);
    print_figures(row->figure, n, has_figures(row), out);
    if (measured->done) {
        fprintf(out, " | %d", measured->n_queries);
    }
    fputc('\n', out);
    (void)fflush(out);
}

static void print_header(const struct sim_paper_table *table,
                         const struct sim_tables_corpus *corpus, FILE *out)
{
    static const char *const sets[SIM_PAPER_SETS] = {"nonrigid world", "SHREC'11", "SHREC'13"};
    const int n = sim_paper_n_columns(table->columns);
    fprintf(out, "\nTable %s. %s. Ours: %s; dissertation's: %s\n", table->number, table->title,
            corpus->directory, sets[table->set]);
    fprintf(out, "  %-37s |", "");
    for (int side = 0; side < 2; side++) {
        for (int i = 0; i < n; i++) {
            fprintf(out, " %6s", sim_paper_column_name(table->columns, i));
        }
        fputs(side == 0 ? " |" : " | queries\n", out);
    }
}

static void write_csv(const void *context, FILE *out)
{
    const struct tables *tables = context;
    fputs("table,method,classifier,size,distortion,level,queries,measure,ours,dissertation\n", out);
    for (int t = 0; t < SIM_PAPER_TABLES; t++) {
        const struct sim_paper_table *table = &sim_paper_tables[t];
        for (int r = 0; tables->measured[t] && r < table->n_rows; r++) {
            const struct sim_paper_row *row = &table->rows[r];
            const struct measured *m = &tables->measured[t][r];
            for (int i = 0; i < sim_paper_n_columns(table->columns); i++) {
                const bool distorted = row->distortion.level > 0;
                fprintf(
                    out, "%s,%s,%s,%d,%s,%d,%d,%s,", table->number,
                    row->method ? row->method : row->title, row->classifier ? row->classifier : "",
                    row->size, distorted ? sim_distortion_name(row->distortion.kind) : "",
                    row->distortion.level, m->n_queries, sim_paper_column_name(table->columns, i));
                if (m->done) {
                    fprintf(out, "%.6f", m->figure[i]);
                }
                fputc(',', out);
                if (has_figures(row)) {
                    fprintf(out, "%g", row->figure[i]);
                }
                fputc('\n', out);
            }
        }
    }
}

/* ---- all tables ------------------------------------------------------------------------- */

/* Requests from a corpus the methods that its tables need. */
static void ask_methods(const struct tables *tables, struct sim_tables_corpus *corpus)
{
    for (int t = 0; t < SIM_PAPER_TABLES; t++) {
        const struct sim_paper_table *table = &sim_paper_tables[t];
        for (int r = 0; tables->of_set[table->set] == corpus && r < table->n_rows; r++) {
            if (table->rows[r].method) {
                sim_tables_corpus_ask_method(corpus, table->rows[r].method);
            }
        }
    }
}

/* Selects the corpus that stands for each data set. */
static void assign_corpora(struct tables *tables)
{
    const char *const directories[SIM_PAPER_SETS] = {
        [SIM_PAPER_NONRIGID_WORLD] = tables->options->corpus,
        [SIM_PAPER_SHREC11] = tables->options->large,
        [SIM_PAPER_SHREC13] = tables->options->textured,
    };
    for (int s = 0; s < SIM_PAPER_SETS; s++) {
        tables->corpus[s].directory = directories[s];
        tables->of_set[s] = directories[s] ? &tables->corpus[s] : NULL;
    }
    if (!directories[SIM_PAPER_SHREC11]) {
        tables->of_set[SIM_PAPER_SHREC11] = tables->of_set[SIM_PAPER_NONRIGID_WORLD];
    }
}

static int run_table(struct tables *tables, int t, FILE *out, struct iso_fault *fault)
{
    const struct sim_paper_table *table = &sim_paper_tables[t];
    struct sim_tables_corpus *corpus = tables->of_set[table->set];
    if (!corpus) {
        return 0;
    }
    tables->measured[t] = calloc((size_t)table->n_rows, sizeof *tables->measured[t]);
    if (!tables->measured[t]) {
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    print_header(table, corpus, out);
    int error = 0;
    for (int r = 0; r < table->n_rows && !error; r++) {
        struct measured *measured = &tables->measured[t][r];
        if (table->rows[r].method) {
            error = measure_row(tables, corpus, table->columns, &table->rows[r], measured, fault);
        }
        if (!error) {
            print_row(table, r, measured, out);
        }
    }
    return error;
}

static int run_tables(struct tables *tables, FILE *out, struct iso_fault *fault)
{
    const char *directory = tables->options->out;
    int error = sim_make_directory(directory, fault);
    for (int s = 0; s < SIM_PAPER_SETS && !error; s++) {
        if (tables->of_set[s] == &tables->corpus[s]) {
            ask_methods(tables, &tables->corpus[s]);
            error = sim_tables_corpus_open(&tables->corpus[s], tables->options, out, fault);
        }
    }
    for (int t = 0; t < SIM_PAPER_TABLES && !error; t++) {
        error = run_table(tables, t, out, fault);
    }
    if (error) {
        return error;
    }
    return sim_result_file(directory, "tables.csv", write_csv, tables, fault);
}

int sim_shapes_tables(const struct sim_tables_options *options, FILE *out, struct iso_fault *fault)
{
    struct iso_fault unread = {.text = ""};
    struct tables *tables = calloc(1, sizeof *tables);
    fault = fault ? fault : &unread;
    fault->text[0] = '\0';
    if (!tables) {
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    tables->options = options;
    assign_corpora(tables);
    const int error = run_tables(tables, out, fault);
    if (error && fault->text[0] == '\0') {
        (void)iso_fault_set(fault, error, "%s", strerror(-error));
    }
    for (int s = 0; s < SIM_PAPER_SETS; s++) {
        sim_tables_corpus_close(&tables->corpus[s]);
    }
    for (int t = 0; t < SIM_PAPER_TABLES; t++) {
        free(tables->measured[t]);
    }
    free(tables);
    return error;
}

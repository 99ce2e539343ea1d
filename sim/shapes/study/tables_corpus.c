#include "sim/shapes/study/tables_corpus.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/base/path.h"

static int index_of(const struct sim_tables_corpus *corpus, const char *method)
{
    int m = 0;
    while (m < corpus->n_methods && strcmp(corpus->method[m]->name, method) != 0) {
        m++;
    }
    return m;
}

void sim_tables_corpus_ask_method(struct sim_tables_corpus *corpus, const char *name)
{
    if (index_of(corpus, name) == corpus->n_methods && corpus->n_methods < SIM_TABLES_METHODS_MAX) {
        corpus->method[corpus->n_methods++] = iso_shape_method_find(name);
    }
}

static int choose_queries(const struct sim_tables_options *options,
                          struct sim_tables_corpus *corpus)
{
    corpus->query_row = calloc((size_t)corpus->manifest->n, sizeof *corpus->query_row);
    return corpus->query_row ? sim_shape_manifest_turns(corpus->manifest, options->queries,
                                                        corpus->query_row, &corpus->n_queries)
                             : -ENOMEM;
}

static int name_cache(const struct sim_tables_options *options, struct sim_tables_corpus *corpus,
                      struct iso_fault *fault)
{
    if (!options->cache) {
        return iso_path_join(options->out, "cache", corpus->kept, fault);
    }
    const int n = snprintf(corpus->kept, sizeof corpus->kept, "%s", options->cache);
    return n < (int)sizeof corpus->kept
               ? 0
               : iso_fault_set(fault, -ENAMETOOLONG, "--cache: the name is too long");
}

static void print_bank(const struct sim_tables_corpus *corpus, FILE *out)
{
    const struct sim_bank *bank = corpus->items;
    fprintf(
        out,
        "%s: %d shapes of %d classes, %.0f vertices in the mean; %.1f s by %d threads, %.0f MB; %d "
        "of %d descriptions were in the cache\n",
        corpus->directory, bank->n, corpus->manifest->n_classes, bank->mean_vertices,
        bank->elapsed_seconds, corpus->how.threads, (double)bank->peak_kib / 1024.0, bank->n_known,
        bank->n * bank->n_methods);
    fprintf(out, "  seconds of a processor: eigenpairs %.1f", bank->shape_seconds);
    for (int m = 0; m < bank->n_methods; m++) {
        fprintf(out, ", %s %.1f", corpus->method[m]->name, bank->seconds[m]);
    }
    fputs("\n", out);
    (void)fflush(out);
}

int sim_tables_corpus_open(struct sim_tables_corpus *corpus,
                           const struct sim_tables_options *options, FILE *out,
                           struct iso_fault *fault)
{
    int error = sim_shape_manifest_read(corpus->directory, &corpus->manifest, fault);
    if (!error) {
        error = name_cache(options, corpus, fault);
    }
    if (error) {
        return error;
    }
    corpus->how = (struct sim_bank_options){
        .corpus = corpus->directory,
        .manifest = corpus->manifest,
        .methods = corpus->method,
        .n_methods = corpus->n_methods,
        .source = {.seed = options->seed, .smooth = options->smooth},
        .cache = corpus->kept[0] ? corpus->kept : NULL,
        .skip = !options->strict,
        .threads = options->threads,
    };
    error = sim_bank_new(&corpus->how, &corpus->items, fault);
    if (!error) {
        error = sim_bank_match(corpus->items, corpus->manifest);
    }
    if (!error) {
        error = choose_queries(options, corpus);
    }
    if (!error) {
        print_bank(corpus, out);
    }
    return error;
}

void sim_tables_corpus_close(struct sim_tables_corpus *corpus)
{
    for (int i = 0; i < corpus->n_cached; i++) {
        sim_features_free(corpus->cache[i].features);
    }
    for (int k = 0; k < SIM_DISTORTIONS; k++) {
        for (int l = 0; l < SIM_DISTORTION_LEVELS; l++) {
            sim_bank_free(corpus->distorted[k][l]);
        }
    }
    sim_bank_free(corpus->items);
    sim_shape_manifest_free(corpus->manifest);
    free(corpus->query_row);
}

int sim_tables_corpus_queries(struct sim_tables_corpus *corpus, struct sim_distortion distortion,
                              const struct sim_bank **out, struct iso_fault *fault)
{
    if (distortion.level == 0) {
        *out = corpus->items;
        return 0;
    }
    struct sim_bank **known = &corpus->distorted[distortion.kind][distortion.level - 1];
    if (!*known) {
        struct sim_bank_options how = corpus->how;
        how.rows = corpus->query_row;
        how.n_rows = corpus->n_queries;
        how.source.distortion = &distortion;
        const int error = sim_bank_new(&how, known, fault);
        if (error) {
            return error;
        }
    }
    *out = *known;
    return 0;
}

int sim_tables_corpus_features(struct sim_tables_corpus *corpus, const char *method, int size,
                               uint64_t seed, struct sim_features **out)
{
    const int m = index_of(corpus, method);
    for (int i = 0; i < corpus->n_cached; i++) {
        if (corpus->cache[i].method == m && corpus->cache[i].size == size) {
            *out = corpus->cache[i].features;
            return 0;
        }
    }
    if (corpus->n_cached == SIM_TABLES_CACHE_MAX) {
        return -ENOSPC;
    }
    const struct sim_features_options how = {
        .method = corpus->method[m], .index = m, .size = size, .seed = seed};
    const int error = sim_features_new(corpus->manifest, corpus->items, &how, out);
    if (!error) {
        corpus->cache[corpus->n_cached].method = m;
        corpus->cache[corpus->n_cached].size = size;
        corpus->cache[corpus->n_cached++].features = *out;
    }
    return error;
}

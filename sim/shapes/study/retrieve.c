#include "sim/shapes/study/retrieve.h"

#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "sim/lab/match/parallel.h"

enum { FOLDS = 10 };

/* ---- features ------------------------------------------------------------------- */

static int code_all(const struct sim_features *features, const struct sim_bank *bank, float *out)
{
    const struct iso_shape_description *const *description = sim_bank_of(bank, features->index);
    int error = 0;
    for (int32_t i = 0; i < bank->n && !error; i++) {
        error = iso_shape_code(features->coder, description[i],
                               out + (size_t)i * (size_t)features->layout->size);
    }
    return error;
}

static int add_items(struct sim_features *features)
{
    const size_t n = (size_t)features->items->n;
    features->layout = iso_shape_coder_layout(features->coder);
    features->item = calloc(n * (size_t)features->layout->size, sizeof *features->item);
    features->item_class = calloc(n, sizeof *features->item_class);
    features->item_wider = calloc(n, sizeof *features->item_wider);
    if (!features->item || !features->item_class || !features->item_wider) {
        return -ENOMEM;
    }
    for (size_t i = 0; i < n; i++) {
        features->item_class[i] = features->manifest->class_of[features->items->row[i]];
        features->item_wider[i] = features->manifest->wider_of[features->items->row[i]];
    }
    return code_all(features, features->items, features->item);
}

static void drop_queries(struct sim_features *features)
{
    free(features->query);
    free(features->query_class);
    free(features->query_wider);
    free(features->own);
}

int sim_features_ask(struct sim_features *features, const struct sim_bank *queries)
{
    const size_t n = (size_t)queries->n, bytes = (size_t)features->layout->size * sizeof(float);
    struct sim_features asked = *features;
    asked.queries = queries;
    asked.query = calloc(n, bytes);
    asked.query_class = calloc(n, sizeof *asked.query_class);
    asked.query_wider = calloc(n, sizeof *asked.query_wider);
    asked.own = calloc(n, sizeof *asked.own);
    const bool room = asked.query && asked.query_class && asked.query_wider && asked.own;
    int error = room ? 0 : -ENOMEM;
    for (size_t q = 0; room && q < n; q++) {
        asked.query_class[q] = features->manifest->class_of[queries->row[q]];
        asked.query_wider[q] = features->manifest->wider_of[queries->row[q]];
        asked.own[q] = queries->row[q]; /* items are all rows in their order */
    }
    if (!error && queries == features->items) {
        memcpy(asked.query, features->item, n * bytes);
    } else if (!error) {
        error = code_all(&asked, queries, asked.query);
    }
    if (error) {
        drop_queries(&asked);
        return error;
    }
    drop_queries(features);
    *features = asked;
    return 0;
}

int sim_features_new(const struct sim_shape_manifest *manifest, const struct sim_bank *items,
                     const struct sim_features_options *options, struct sim_features **out)
{
    struct sim_features *features = calloc(1, sizeof *features);
    if (!features) {
        return -ENOMEM;
    }
    features->manifest = manifest;
    features->items = items;
    features->index = options->index;
    int error = iso_shape_coder_new(options->method, sim_bank_of(items, options->index), items->n,
                                    options->size, options->seed, &features->coder);
    if (!error) {
        error = add_items(features);
    }
    if (!error) {
        error = sim_features_ask(features, items);
    }
    if (error) {
        sim_features_free(features);
        return error;
    }
    *out = features;
    return 0;
}

void sim_features_free(struct sim_features *features)
{
    if (features) {
        iso_shape_coder_free(features->coder);
        free(features->item);
        free(features->item_class);
        free(features->item_wider);
        drop_queries(features);
        free(features);
    }
}

static struct iso_labelled labelled_items(const struct sim_features *features)
{
    return (struct iso_labelled){
        .layout = features->layout,
        .n = features->items->n,
        .n_classes = features->manifest->n_classes,
        .feature = features->item,
        .label = features->item_class,
    };
}

/* ---- ranking -------------------------------------------------------------------- */

struct ranking {
    const struct sim_features *features;
    const struct iso_classifier *classifier;
    double *distance;
};

static int rank_one(void *context, int worker, size_t query)
{
    const struct ranking *ranking = context;
    const struct sim_features *f = ranking->features;
    (void)worker;
    return iso_classifier_rank(ranking->classifier, f->query + query * (size_t)f->layout->size,
                               f->own[query], ranking->distance + query * (size_t)f->items->n);
}

int sim_features_rank(const struct sim_features *features, const struct iso_classifier_ops *ops,
                      int threads, double *distance)
{
    struct iso_labelled items = labelled_items(features);
    struct iso_classifier *classifier = NULL;
    if (!ops->rank) {
        return -ENOSYS;
    }
    int error = iso_classifier_new(ops, &items, &classifier);
    if (!error) {
        struct ranking ranking = {features, classifier, distance};
        error = sim_parallel(threads, "comparing shapes", (size_t)features->queries->n, rank_one,
                             &ranking);
    }
    iso_classifier_free(classifier);
    return error;
}

int sim_features_measure(const struct sim_features *features, const double *distance,
                         struct iso_retrieval *out)
{
    const struct iso_ranked ranked = {
        .n_queries = features->queries->n,
        .n_items = features->items->n,
        .distance = distance,
        .query_class = features->query_class,
        .item_class = features->item_class,
        .query_wider = features->query_wider,
        .item_wider = features->item_wider,
        .own = features->own,
    };
    return iso_retrieval_measure(&ranked, out);
}

/* ---- classification ----------------------------------------------------------------- */

struct classification {
    const struct sim_features *features;
    const struct iso_classifier_ops *ops;
    double *score; /* [n_queries][n_classes] */
};

/* Scores one query by a classifier that has learned from all items except the query's own. */
static int classify_one(void *context, int worker, size_t query)
{
    const struct classification *c = context;
    const struct sim_features *f = c->features;
    struct iso_labelled others = labelled_items(f);
    const size_t size = (size_t)f->layout->size, own = (size_t)f->own[query], n = (size_t)others.n;
    float *feature = calloc(n * size, sizeof *feature);
    int32_t *labels = calloc(n, sizeof *labels);
    struct iso_classifier *classifier = NULL;
    (void)worker;
    int error = feature && labels ? 0 : -ENOMEM;
    if (!error) {
        memcpy(feature, f->item, own * size * sizeof *feature);
        memcpy(feature + own * size, f->item + (own + 1) * size,
               (n - own - 1) * size * sizeof *feature);
        memcpy(labels, f->item_class, own * sizeof *labels);
        memcpy(labels + own, f->item_class + own + 1, (n - own - 1) * sizeof *labels);
        others.n--;
        others.feature = feature;
        others.label = labels;
        error = iso_classifier_new(c->ops, &others, &classifier);
    }
    if (!error) {
        error = iso_classifier_score(classifier, f->query + query * size,
                                     c->score + query * (size_t)others.n_classes);
    }
    iso_classifier_free(classifier);
    free(feature);
    free(labels);
    return error;
}

int sim_features_classify(const struct sim_features *features, const struct iso_classifier_ops *ops,
                          uint64_t seed, int threads, int32_t *count,
                          struct iso_confusion_rates *out)
{
    struct iso_labelled items = labelled_items(features);
    const int32_t n_queries = features->queries->n;
    double *score = calloc((size_t)n_queries * (size_t)items.n_classes, sizeof *score);
    if (!score) {
        return -ENOMEM;
    }
    int error;
    if (features->queries == features->items) {
        error = iso_cross_validate(ops, &items, FOLDS < items.n ? FOLDS : items.n, seed, score);
    } else {
        struct classification classification = {features, ops, score};
        error = sim_parallel(threads, "classifying shapes", (size_t)n_queries, classify_one,
                             &classification);
    }
    if (!error) {
        error = iso_confusion_measure(score, features->query_class, n_queries, items.n_classes,
                                      count, NULL, out);
    }
    free(score);
    return error;
}

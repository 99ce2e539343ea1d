/* The method `metric`: the learned metric scores every person, and the best ones are reranked by
 * their upper faces (isotherm/metric.h, rerank.h). */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/base/shipped.h"
#include "drivers/model/model_file.h"
#include "firmware/recognise/method/method.h"
#include "firmware/recognise/method/reranker.h"

struct by_metric {
    struct iso_metric *metric;
    struct iso_reranker *reranker;
};

static void metric_close(void *self)
{
    struct by_metric *method = self;
    iso_reranker_free(method->reranker);
    iso_metric_free(method->metric);
    free(method);
}

static int load(struct by_metric *method, const struct iso_method_setup *setup,
                struct iso_fault *fault)
{
    const int error = iso_metric_load(setup->data_path, &method->metric, fault);
    return error ? error : iso_method_check_algorithm(setup, method->metric->algorithm, fault);
}

static int metric_open(const struct iso_method_setup *setup, void **self, struct iso_fault *fault)
{
    struct by_metric *method = calloc(1, sizeof *method);
    if (!method || iso_reranker_new(&method->reranker)) {
        free(method);
        return iso_fault_set(fault, -ENOMEM, "method metric: out of memory");
    }
    const int error = load(method, setup, fault);
    if (error) {
        metric_close(method);
        return error;
    }
    *self = method;
    return 0;
}

/* A probe, as the index and the metric of the site see it. */
struct probe {
    struct iso_metric_vector shipped;
    struct iso_metric_vector turned; /* only if the site has adapted the metric */
};

/* The adapted metric of the site; NULL if the shipped one gives the scores. */
static const struct iso_site_metric *adapted_of(const struct iso_candidate_list *among)
{
    return among->site ? iso_site_index_metric(among->site) : NULL;
}

static int project(const struct by_metric *method, const struct iso_candidate_list *among,
                   const struct iso_template *tmpl, struct probe *probe)
{
    const struct iso_site_metric *adapted = adapted_of(among);
    const int error = iso_metric_project(method->metric, tmpl, &probe->shipped);
    if (!error && adapted) {
        iso_site_turn(adapted, &probe->shipped, &probe->turned);
    }
    return error;
}

/* Compares with one person of an index. False if the index does not have the person. */
static bool score_one(const struct by_metric *method, const struct iso_candidate_list *among,
                      const struct probe *probe, int64_t number, struct iso_search_hit *hit)
{
    const struct iso_site_metric *adapted = adapted_of(among);
    struct iso_metric_vector person;
    if (adapted ? iso_site_index_person(among->site, number, &person)
                : iso_index_find(among->index, number, &person)) {
        return false;
    }
    *hit = (struct iso_search_hit){
        .person = number,
        .distance_mm = NAN,
        .score = adapted ? iso_site_score(adapted, number, &person, &probe->turned)
                         : iso_metric_score(method->metric, &person, &probe->shipped),
    };
    explicit_bzero(&person, sizeof person);
    return true;
}

/* Finds the best people of the index. If the site has adapted the metric, that metric gives these
 * people their scores. */
static int find_best(const struct by_metric *method, const struct iso_candidate_list *among,
                     const struct probe *probe, struct iso_search_hit *hits, int capacity,
                     int *n_hits)
{
    const int error = iso_index_search(among->index, &probe->shipped, hits, capacity, n_hits);
    if (error || !adapted_of(among)) {
        return error;
    }
    for (int i = 0; i < *n_hits; i++) {
        (void)score_one(method, among, probe, hits[i].person, &hits[i]);
    }
    iso_search_sort(hits, (size_t)*n_hits);
    return 0;
}

/* Finds the best people by the metric, and then the best of these after reranking. */
static int search_index(const struct by_metric *method, const struct iso_candidate_list *among,
                        const struct iso_template *tmpl, struct iso_search_hit *hits, int capacity,
                        int *n_hits)
{
    enum { SHORTLIST = ISO_RERANK_CANDIDATES };
    struct iso_search_hit best[SHORTLIST];
    struct probe probe;
    int n = 0;
    int error = project(method, among, tmpl, &probe);
    if (error) {
        return error;
    }
    if (among->person) {
        n = score_one(method, among, &probe, among->person, &best[0]);
    } else {
        error = find_best(method, among, &probe, best, SHORTLIST, &n);
    }
    explicit_bzero(&probe, sizeof probe);
    if (!error && among->templates) {
        error = iso_reranker_take(method->reranker, method->metric, among, tmpl, best, n);
    }
    if (error) {
        return error;
    }
    *n_hits = n < capacity ? n : capacity;
    for (int i = 0; i < *n_hits; i++) {
        hits[i] = best[i];
    }
    return 0;
}

static int metric_search(void *self, const struct iso_candidate_list *among,
                         const struct iso_template *probe, struct iso_search_hit *hits,
                         int capacity, int *n_hits)
{
    const struct by_metric *method = self;
    if (among->index) {
        return search_index(method, among, probe, hits, capacity, n_hits);
    }
    return iso_search_by_metric(iso_reranker_workspace(method->reranker), among->entries,
                                among->n_entries, probe, method->metric, hits, capacity, n_hits);
}

static const struct iso_metric *metric_of(const void *self)
{
    return ((const struct by_metric *)self)->metric;
}

static void metric_forget(void *self)
{
    iso_reranker_forget(((const struct by_metric *)self)->reranker);
}

const struct iso_method_ops iso_method_metric_ops = {
    .name = "metric",
    .data_key = "metric",
    .installed_data = iso_shipped_metric,
    .calibrated = true,
    .open = metric_open,
    .search = metric_search,
    .metric = metric_of,
    .forget = metric_forget,
    .close = metric_close,
};

#include "core/shape/classify/retrieval.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

struct item {
    double distance;
    int32_t index;
};

static int compare_items(const void *a, const void *b)
{
    const struct item *p = a, *q = b;
    if (p->distance != q->distance) {
        return p->distance < q->distance ? -1 : 1;
    }
    return (p->index > q->index) - (p->index < q->index);
}

/* The items of one query, closest first, and which of them are relevant. */
struct ranking {
    int32_t n;         /* items */
    int32_t n_class;   /* items of the query's class */
    int32_t n_wider;   /* items of its wider class, those of its class included */
    struct item *item; /* [n] */
    uint8_t *of_class; /* [n]: 1 for an item of the class */
    uint8_t *of_wider; /* [n]: 1 for an item of the wider class */
};

static void ranking_done(struct ranking *r)
{
    free(r->item);
    free(r->of_class);
    free(r->of_wider);
}

static int ranking_init(struct ranking *r, const struct iso_ranked *ranked, int32_t query)
{
    const size_t room = (size_t)ranked->n_items + 1;
    *r = (struct ranking){.item = calloc(room, sizeof *r->item)};
    r->of_class = calloc(room, 1);
    r->of_wider = calloc(room, 1);
    if (!r->item || !r->of_class || !r->of_wider) {
        ranking_done(r);
        return -ENOMEM;
    }
    const double *distance = &ranked->distance[(size_t)query * (size_t)ranked->n_items];
    for (int32_t i = 0; i < ranked->n_items; i++) {
        if (!ranked->own || i != ranked->own[query]) {
            r->item[r->n++] = (struct item){distance[i], i};
        }
    }
    qsort(r->item, (size_t)r->n, sizeof *r->item, compare_items);
    const bool wider = ranked->query_wider && ranked->item_wider;
    for (int32_t i = 0; i < r->n; i++) {
        const int32_t at = r->item[i].index;
        r->of_class[i] = ranked->item_class[at] == ranked->query_class[query];
        r->of_wider[i] = r->of_class[i] ||
                         (wider && ranked->item_wider[at] == ranked->query_wider[query]);
        r->n_class += r->of_class[i];
        r->n_wider += r->of_wider[i];
    }
    return 0;
}

static int32_t hits_within(const struct ranking *r, int32_t n)
{
    int32_t hits = 0;
    for (int32_t i = 0; i < n && i < r->n; i++) {
        hits += r->of_class[i];
    }
    return hits;
}

static double e_measure(const struct ranking *r)
{
    const int32_t looked_at = r->n < ISO_E_MEASURE_FIRST ? r->n : ISO_E_MEASURE_FIRST;
    const double hits = hits_within(r, looked_at);
    double precision = hits / looked_at, recall = hits / r->n_class;
    return hits > 0.0 ? 2.0 / (1.0 / precision + 1.0 / recall) : 0.0;
}

/* The gain of a hit is 1 in the first place, and 1 / log2 of the place from the second one on. */
static double discounted_gain(const struct ranking *r)
{
    double gain = 0.0, perfect = 0.0;
    for (int32_t i = 0; i < r->n; i++) {
        const double discount = i == 0 ? 1.0 : 1.0 / log2(i + 1.0);
        gain += r->of_class[i] ? discount : 0.0;
        perfect += i < r->n_class ? discount : 0.0;
    }
    return gain / perfect;
}

static double dynamic_recall(const struct ranking *r)
{
    double sum = 0.0;
    int32_t of_class = 0, of_wider = 0;
    for (int32_t i = 0; i < r->n_wider; i++) {
        of_class += r->of_class[i];
        of_wider += r->of_wider[i];
        sum += (double)(i < r->n_class ? of_class : of_wider) / (i + 1);
    }
    return sum / r->n_wider;
}

/* The highest precision at each level of recall or above: from the last hit backwards. */
static void precision_curve(const struct ranking *r, double *precision)
{
    int32_t hits = r->n_class, level = ISO_RECALL_LEVELS;
    double best = 0.0;
    for (int32_t i = r->n - 1; i >= 0; i--) {
        if (!r->of_class[i]) {
            continue;
        }
        /* The levels above the recall of this hit are complete. */
        while (level > 0 && (int64_t)level * r->n_class > (int64_t)hits * ISO_RECALL_LEVELS) {
            precision[--level] = best;
        }
        best = fmax(best, (double)hits / (i + 1));
        hits--;
    }
    while (level > 0) {
        precision[--level] = best;
    }
}

int iso_retrieval_query(const struct iso_ranked *ranked, int32_t query, struct iso_retrieval *out)
{
    struct ranking r;
    const int error = ranking_init(&r, ranked, query);
    if (error) {
        return error;
    }
    struct iso_retrieval m = {0};
    if (r.n_class > 0) {
        m.n_queries = 1;
        m.nearest = r.of_class[0];
        m.first_tier = (double)hits_within(&r, r.n_class) / r.n_class;
        m.second_tier = (double)hits_within(&r, 2 * r.n_class) / r.n_class;
        m.e_measure = e_measure(&r);
        m.dcg = discounted_gain(&r);
        m.adr = dynamic_recall(&r);
        precision_curve(&r, m.precision);
    }
    ranking_done(&r);
    *out = m;
    return 0;
}

/* Adds the measures of one query times `share`. */
static void add(struct iso_retrieval *sum, const struct iso_retrieval *one, double share)
{
    sum->nearest += share * one->nearest;
    sum->first_tier += share * one->first_tier;
    sum->second_tier += share * one->second_tier;
    sum->e_measure += share * one->e_measure;
    sum->dcg += share * one->dcg;
    sum->adr += share * one->adr;
    for (int i = 0; i < ISO_RECALL_LEVELS; i++) {
        sum->precision[i] += share * one->precision[i];
    }
}

int iso_retrieval_measure(const struct iso_ranked *ranked, struct iso_retrieval *out)
{
    const size_t cells = (size_t)ranked->n_queries * (size_t)ranked->n_items;
    for (int32_t q = 0; ranked->own && q < ranked->n_queries; q++) {
        if (ranked->own[q] < -1 || ranked->own[q] >= ranked->n_items) {
            return -EINVAL;
        }
    }
    for (size_t i = 0; i < cells; i++) {
        if (isnan(ranked->distance[i])) {
            return -EINVAL;
        }
    }
    struct iso_retrieval sum = {0}, mean = {0};
    for (int32_t q = 0; q < ranked->n_queries; q++) {
        struct iso_retrieval one;
        const int error = iso_retrieval_query(ranked, q, &one);
        if (error) {
            return error;
        }
        sum.n_queries += one.n_queries;
        add(&sum, &one, 1.0);
    }
    if (sum.n_queries > 0) {
        mean.n_queries = sum.n_queries;
        add(&mean, &sum, 1.0 / sum.n_queries);
    }
    *out = mean;
    return 0;
}

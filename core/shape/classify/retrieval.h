/* How well a matrix of distances retrieves shapes of the same class as the query: the measures of
 * the Princeton Shape Benchmark (Shilane, Min, Kazhdan and Funkhouser, SMI 2004), and the average
 * dynamic recall of SHREC'13 (Cerri et al., "Retrieval on textured 3D models", 3DOR 2013; Typke,
 * Veltkamp and Wiering, ICME 2006).
 *
 * Each row is a query; each column is an item that may be retrieved. Of equal distances the first
 * item comes first. A query without an item of its class does not count. */
#ifndef ISO_CORE_SHAPE_CLASSIFY_RETRIEVAL_H
#define ISO_CORE_SHAPE_CLASSIFY_RETRIEVAL_H

#include <stdint.h>

enum {
    ISO_RECALL_LEVELS = 20,   /* of the precision-recall curve: 1/20, 2/20, ... 1 */
    ISO_E_MEASURE_FIRST = 32, /* items that the E-measure uses */
};

struct iso_retrieval {
    int32_t n_queries;              /* how many queries count */
    double nearest;                 /* NN: share of queries whose first item is of their class */
    double first_tier, second_tier; /* recall within the first C and 2 C items; C: class size */
    double e_measure;               /* 2 / (1 / precision + 1 / recall) over the first 32 items */
    double dcg;                     /* discounted cumulative gain over that of a perfect ranking */
    double adr;                     /* average dynamic recall */
    double precision[ISO_RECALL_LEVELS]; /* highest at this recall or more, mean over queries */
};

struct iso_ranked {
    int32_t n_queries, n_items;
    const double *distance;     /* [n_queries][n_items] */
    const int32_t *query_class; /* [n_queries] */
    const int32_t *item_class;  /* [n_items] */
    /* Wider classes, for ADR. Among the first C items only those of the class are relevant. Among
     * those after them, as many as the wider class has, all items of the wider class are relevant.
     * NULL: the wider class is the class. */
    const int32_t *query_wider, *item_wider;
    /* [n_queries]: the item that is left out of the row of a query, because it is the query itself,
     * or because the query was made from it; -1: none. NULL: no item is left out. */
    const int32_t *own;
};

/* Measures one query. If the query counts, n_queries is 1 and nearest is 0 or 1; otherwise all
 * members are 0. -ENOMEM. */
int iso_retrieval_query(const struct iso_ranked *ranked, int32_t query, struct iso_retrieval *out)
    __attribute__((warn_unused_result));

/* The means over all queries that count. -EINVAL for an own item out of range or distances that are
 * NaN; -ENOMEM. */
int iso_retrieval_measure(const struct iso_ranked *ranked, struct iso_retrieval *out)
    __attribute__((warn_unused_result));

#endif

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "core/heat/block.h"

int iso_ldl_nodes_new(const struct iso_ldl *l, struct iso_ldl_nodes **out)
{
    if (l->n < 1) {
        return -EINVAL;
    }
    struct iso_ldl_nodes *nodes = calloc(1, sizeof *nodes);
    if (!nodes) {
        return -ENOMEM;
    }
    size_t n_rows = 0;
    for (int32_t j = 0; j < l->n; j++) {
        const bool joins = j > 0 && iso_ldl_joins_next(l, j - 1);
        nodes->count += !joins;
        n_rows += joins ? 0 : (size_t)l->count[j];
    }
    nodes->node = calloc((size_t)nodes->count, sizeof *nodes->node);
    nodes->of = calloc((size_t)l->n, sizeof *nodes->of);
    nodes->rows = calloc(n_rows, sizeof *nodes->rows);
    if (!nodes->node || !nodes->of || !nodes->rows) {
        iso_ldl_nodes_free(nodes);
        return -ENOMEM;
    }
    int32_t *row = nodes->rows;
    for (int32_t j = 0, k = -1; j < l->n; j++) {
        if (j > 0 && iso_ldl_joins_next(l, j - 1)) {
            nodes->node[k].width++;
            nodes->node[k].n_below--;
        } else {
            nodes->node[++k] = (struct iso_ldl_node){j, 1, l->count[j] - 1, row};
            memcpy(row, &l->row[l->start[j]], (size_t)l->count[j] * sizeof *row);
            row += l->count[j];
        }
        nodes->of[j] = k;
    }
    *out = nodes;
    return 0;
}

void iso_ldl_nodes_free(struct iso_ldl_nodes *nodes)
{
    if (nodes) {
        free(nodes->node);
        free(nodes->of);
        free(nodes->rows);
        free(nodes);
    }
}

void iso_ldl_reach(const struct iso_ldl_nodes *nodes, int32_t row, bool *reached)
{
    for (int32_t k = nodes->of[row]; !reached[k];) {
        const struct iso_ldl_node *node = &nodes->node[k];
        reached[k] = true;
        if (node->n_below == 0) {
            return; /* a root */
        }
        k = nodes->of[node->row[node->width]];
    }
}

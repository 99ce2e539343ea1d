#include "core/heat/permuted.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

int iso_permuted_new(int32_t n_capacity, int32_t nnz_capacity, struct iso_permuted **out)
{
    if (n_capacity < 1 || nnz_capacity < n_capacity) {
        return -EINVAL;
    }
    struct iso_permuted *m = calloc(1, sizeof *m);
    if (!m) {
        return -ENOMEM;
    }
    const size_t n = (size_t)n_capacity, entries = 2 * (size_t)nnz_capacity - n;
    m->n_capacity = n_capacity;
    m->nnz_capacity = nnz_capacity;
    m->start = calloc(n + 1, sizeof *m->start);
    m->column = calloc(entries, sizeof *m->column);
    m->value = calloc(entries, sizeof *m->value);
    m->place = calloc(n, sizeof *m->place);
    if (!m->start || !m->column || !m->value || !m->place) {
        iso_permuted_free(m);
        return -ENOMEM;
    }
    *out = m;
    return 0;
}

void iso_permuted_free(struct iso_permuted *matrix)
{
    if (matrix) {
        free(matrix->start);
        free(matrix->column);
        free(matrix->value);
        free(matrix->place);
        free(matrix);
    }
}

/* Sets where each row begins, from the numbers of entries. */
static void count_rows(struct iso_permuted *m, const struct iso_symmetric *a)
{
    memset(m->start, 0, ((size_t)a->n + 1) * sizeof *m->start);
    for (int32_t j = 0; j < a->n; j++) {
        m->start[m->place[j] + 1] += a->column_start[j + 1] - a->column_start[j];
        for (int32_t at = a->column_start[j] + 1; at < a->column_start[j + 1]; at++) {
            m->start[m->place[a->row[at]] + 1]++;
        }
    }
    for (int32_t k = 0; k < a->n; k++) {
        m->start[k + 1] += m->start[k];
    }
}

static void put(struct iso_permuted *m, int32_t row, int32_t column, double value)
{
    const int32_t at = m->start[row]++;
    m->column[at] = column;
    m->value[at] = value;
}

int iso_permuted_fill(struct iso_permuted *m, const struct iso_symmetric *a, const int32_t *order,
                      struct iso_rows *out)
{
    if (a->n > m->n_capacity || a->nnz > m->nnz_capacity) {
        return -ENOSPC;
    }
    for (int32_t k = 0; k < a->n; k++) {
        m->place[order[k]] = k;
    }
    count_rows(m, a);
    for (int32_t j = 0; j < a->n; j++) {
        const int32_t to = m->place[j];
        put(m, to, to, a->value[a->column_start[j]]);
        for (int32_t at = a->column_start[j] + 1; at < a->column_start[j + 1]; at++) {
            const int32_t from = m->place[a->row[at]];
            put(m, to, from, a->value[at]);
            put(m, from, to, a->value[at]);
        }
    }
    /* Filling has moved each start to that of the next row. */
    memmove(&m->start[1], m->start, (size_t)a->n * sizeof *m->start);
    m->start[0] = 0;
    *out = (struct iso_rows){a->n, m->start, m->column, m->value};
    return 0;
}

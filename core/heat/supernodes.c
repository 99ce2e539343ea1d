#include "core/heat/supernodes.h"

#include <cblas.h>
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* A piece has at most WIDTH_MAX columns. From WIDTH_BLAS columns and rows on a contribution is
 * computed by BLAS, for which it has to be copied. */
enum { WIDTH_MAX = 48, WIDTH_BLAS = 8, NONE = -1 };

struct iso_supernodes {
    struct iso_ldl l; /* without values */
    const struct iso_block_ops *ops;
    int32_t nnz, count;
    int32_t *first;    /* [count + 1]: the first column of each piece */
    int32_t *piece_of; /* [n]: the piece of each column */
    int32_t *place;    /* [nnz]: where each entry of the matrix lies among the values of L */
    int32_t *waiting;  /* [count]: the first of the pieces that contribute to this one next */
    int32_t *next;     /* [count]: the one behind it in that list */
    int32_t *done;     /* [count]: how many rows of a piece were contributed */
    int32_t *position; /* [n]: a row's place in the piece that is computed */
    int32_t *target;   /* [n]: the same for the rows of a contribution */
    double *product;   /* [rows][WIDTH_MAX], by columns: a contribution */
    double *left;      /* the same size: copied columns */
    double right[WIDTH_MAX * WIDTH_MAX];
};

/* A piece of a supernode: columns first..first + width - 1, and the rows below that they share. */
struct piece {
    int32_t first, width, n_rows;
    const int32_t *row; /* [n_rows] */
};

static struct piece piece_at(const struct iso_supernodes *s, int32_t k)
{
    const int32_t first = s->first[k], last = s->first[k + 1] - 1;
    return (struct piece){first, last + 1 - first, s->l.count[last] - 1,
                          &s->l.row[s->l.start[last] + 1]};
}

/* Where row `r` of the rows below column `c` of a piece lies among the values. */
static size_t below(const struct iso_supernodes *s, const struct piece *p, int32_t c, int32_t r)
{
    return (size_t)s->l.start[p->first + c] + (size_t)(p->width - c + r);
}

/* ---- the pattern ---- */

static void find_pieces(struct iso_supernodes *s)
{
    const struct iso_ldl *l = &s->l;
    s->count = 0;
    for (int32_t j = 0; j < l->n; j++) {
        const bool joins = j > 0 && j - s->first[s->count - 1] < WIDTH_MAX &&
                           iso_ldl_joins_next(l, j - 1);
        if (!joins) {
            s->first[s->count++] = j;
        }
        s->piece_of[j] = s->count - 1;
    }
    s->first[s->count] = l->n;
}

/* The place of entry (row, column) of L among the values; NONE if it has none. */
static int32_t find_entry(const struct iso_ldl *l, int32_t row, int32_t column)
{
    int32_t low = l->start[column], high = low + l->count[column];
    while (low < high) {
        const int32_t middle = low + (high - low) / 2;
        if (l->row[middle] < row) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low < l->start[column] + l->count[column] && l->row[low] == row ? low : NONE;
}

static int find_places(struct iso_supernodes *s, const int32_t *order,
                       const struct iso_symmetric *pattern)
{
    int32_t *row_of = s->position; /* the row of L of each row of the matrix */
    for (int32_t k = 0; k < s->l.n; k++) {
        row_of[order[k]] = k;
    }
    for (int32_t j = 0; j < pattern->n; j++) {
        for (int32_t at = pattern->column_start[j]; at < pattern->column_start[j + 1]; at++) {
            const int32_t a = row_of[pattern->row[at]], b = row_of[j];
            s->place[at] = find_entry(&s->l, a > b ? a : b, a > b ? b : a);
            if (s->place[at] == NONE) {
                return -EINVAL;
            }
        }
    }
    return 0;
}

static int allocate(struct iso_supernodes *s)
{
    const size_t n = (size_t)s->l.n;
    size_t rows = 1;
    for (size_t j = 0; j < n; j++) {
        rows = rows > (size_t)s->l.count[j] ? rows : (size_t)s->l.count[j];
    }
    s->first = malloc((n + 1) * sizeof *s->first);
    s->piece_of = malloc(n * sizeof *s->piece_of);
    s->place = malloc((size_t)(s->nnz ? s->nnz : 1) * sizeof *s->place);
    s->waiting = malloc(n * sizeof *s->waiting);
    s->next = malloc(n * sizeof *s->next);
    s->done = malloc(n * sizeof *s->done);
    s->position = calloc(n, sizeof *s->position);
    s->target = malloc(rows * sizeof *s->target);
    s->product = malloc(rows * WIDTH_MAX * sizeof *s->product);
    s->left = malloc(rows * WIDTH_MAX * sizeof *s->left);
    return s->first && s->piece_of && s->place && s->waiting && s->next && s->done && s->position &&
                   s->target && s->product && s->left
               ? 0
               : -ENOMEM;
}

int iso_supernodes_new(const struct iso_ldl *l, const int32_t *order,
                       const struct iso_symmetric *pattern, struct iso_supernodes **out)
{
    struct iso_supernodes *s = calloc(1, sizeof *s);
    if (!s) {
        return -ENOMEM;
    }
    s->l = *l;
    s->l.value = NULL;
    s->ops = iso_block_ops();
    s->nnz = pattern->nnz;
    int error = allocate(s);
    if (!error) {
        find_pieces(s);
        error = find_places(s, order, pattern);
    }
    if (error) {
        iso_supernodes_free(s);
        return error;
    }
    *out = s;
    return 0;
}

void iso_supernodes_free(struct iso_supernodes *s)
{
    if (s) {
        free(s->first);
        free(s->piece_of);
        free(s->place);
        free(s->waiting);
        free(s->next);
        free(s->done);
        free(s->position);
        free(s->target);
        free(s->product);
        free(s->left);
        free(s);
    }
}

/* ---- the numbers ---- */

/* What an earlier piece contributes to the piece that is computed: n_rows of its rows, from `begin`
 * on. The first n_columns of them are columns of the piece that is computed. */
struct contribution {
    struct piece from;
    int32_t begin, n_columns, n_rows;
};

/* product = L D L' of the rows, by columns; above the diagonal it has no meaning. */
static void multiply_by_blas(struct iso_supernodes *s, const struct contribution *c,
                             const double *value)
{
    for (int32_t k = 0; k < c->from.width; k++) {
        const double pivot = value[s->l.start[c->from.first + k]];
        const double *column = &value[below(s, &c->from, k, c->begin)];
        memcpy(&s->left[(size_t)k * (size_t)c->n_rows], column, (size_t)c->n_rows * sizeof *column);
        for (int32_t t = 0; t < c->n_columns; t++) {
            s->right[k * WIDTH_MAX + t] = pivot * column[t];
        }
    }
    cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, c->n_rows, c->n_columns, c->from.width,
                -1.0, s->left, c->n_rows, s->right, WIDTH_MAX, 0.0, s->product, c->n_rows);
}

/* The same for few columns: column t from row t on. */
static void multiply_by_columns(struct iso_supernodes *s, const struct contribution *c,
                                const double *value)
{
    for (int32_t t = 0; t < c->n_columns; t++) {
        double *to = &s->product[(size_t)t * (size_t)c->n_rows + (size_t)t];
        memset(to, 0, (size_t)(c->n_rows - t) * sizeof *to);
        for (int32_t k = 0; k < c->from.width; k += ISO_BLOCK_COLUMNS) {
            const double *column[ISO_BLOCK_COLUMNS];
            double weight[ISO_BLOCK_COLUMNS];
            int n = 0;
            for (; n < ISO_BLOCK_COLUMNS && k + n < c->from.width; n++) {
                column[n] = &value[below(s, &c->from, k + n, c->begin + t)];
                weight[n] = value[s->l.start[c->from.first + k + n]] * column[n][0];
            }
            s->ops->subtract(c->n_rows - t, n, column, weight, to);
        }
    }
}

/* Subtracts what piece `k` contributes to the piece that is computed, and puts it in the list of
 * the next piece to which it contributes. */
static void contribute(struct iso_supernodes *s, int32_t k, const struct piece *to, double *value)
{
    struct contribution c = {.from = piece_at(s, k), .begin = s->done[k]};
    const int32_t end = to->first + to->width;
    c.n_rows = c.from.n_rows - c.begin;
    while (c.n_columns < c.n_rows && c.from.row[c.begin + c.n_columns] < end) {
        c.n_columns++;
    }
    for (int32_t r = 0; r < c.n_rows; r++) {
        s->target[r] = s->position[c.from.row[c.begin + r]];
    }
    if (c.from.width >= WIDTH_BLAS && c.n_columns >= WIDTH_BLAS) {
        multiply_by_blas(s, &c, value);
    } else {
        multiply_by_columns(s, &c, value);
    }
    for (int32_t t = 0; t < c.n_columns; t++) {
        const int32_t column = s->target[t];
        double *into = &value[s->l.start[to->first + column]];
        const double *product = &s->product[(size_t)t * (size_t)c.n_rows];
        for (int32_t r = t; r < c.n_rows; r++) {
            into[s->target[r] - column] += product[r];
        }
    }
    s->done[k] += c.n_columns;
    if (s->done[k] < c.from.n_rows) {
        const int32_t later = s->piece_of[c.from.row[s->done[k]]];
        s->next[k] = s->waiting[later];
        s->waiting[later] = k;
    }
}

/* LDL' of the columns of a piece, to which everything earlier was contributed. */
static int factorise_piece(struct iso_supernodes *s, const struct piece *p, double *value)
{
    for (int32_t t = 0; t < p->width; t++) {
        double *own = &value[s->l.start[p->first + t]];
        const int32_t n = p->width - t + p->n_rows;
        for (int32_t k = 0; k < t; k += ISO_BLOCK_COLUMNS) {
            const double *column[ISO_BLOCK_COLUMNS];
            double weight[ISO_BLOCK_COLUMNS];
            int n_columns = 0;
            for (; n_columns < ISO_BLOCK_COLUMNS && k + n_columns < t; n_columns++) {
                const int32_t b = k + n_columns;
                column[n_columns] = &value[s->l.start[p->first + b] + t - b];
                weight[n_columns] = value[s->l.start[p->first + b]] * column[n_columns][0];
            }
            s->ops->subtract(n, n_columns, column, weight, own);
        }
        const double inverse = 1.0 / own[0];
        if (!isfinite(inverse) || !isfinite(own[0])) {
            return -EDOM;
        }
        for (int32_t i = 1; i < n; i++) {
            own[i] *= inverse;
        }
    }
    return 0;
}

int iso_supernodes_factorise(struct iso_supernodes *s, const struct iso_symmetric *matrix,
                             double *value)
{
    int error = 0;
    for (int32_t j = 0; j < s->l.n; j++) {
        memset(&value[s->l.start[j]], 0, (size_t)s->l.count[j] * sizeof *value);
    }
    for (int32_t at = 0; at < s->nnz; at++) {
        value[s->place[at]] = matrix->value[at];
    }
    for (int32_t j = 0; j < s->count; j++) {
        s->waiting[j] = NONE;
        s->done[j] = 0;
    }
    for (int32_t j = 0; j < s->count && !error; j++) {
        const struct piece p = piece_at(s, j);
        for (int32_t i = 0; i < p.width; i++) {
            s->position[p.first + i] = i;
        }
        for (int32_t i = 0; i < p.n_rows; i++) {
            s->position[p.row[i]] = p.width + i;
        }
        for (int32_t k = s->waiting[j], after; k != NONE; k = after) {
            after = s->next[k];
            contribute(s, k, &p, value);
        }
        error = factorise_piece(s, &p, value);
        if (p.n_rows > 0) {
            const int32_t later = s->piece_of[p.row[0]];
            s->next[j] = s->waiting[later];
            s->waiting[later] = j;
        }
    }
    return error;
}

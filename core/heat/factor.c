#include "core/heat/factor.h"

#include <cholmod.h>
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "core/heat/block.h"
#include "core/heat/supernodes.h"

struct iso_factor {
    cholmod_common common;
    cholmod_factor *l;                 /* NULL until the first analysis */
    bool dissected;                    /* l has the ordering for a pattern that comes back */
    struct iso_supernodes *nodes;      /* of l; NULL: not known yet */
    struct iso_ldl_nodes *solve_nodes; /* the same, as solves read them */
    struct iso_symmetric *sum;         /* a L + b B, in the pattern that was analysed */
    cholmod_dense *x, *y, *e; /* the solution and two workspaces that cholmod_solve2 reuses */
};

int iso_factor_new(int32_t n_capacity, int32_t nnz_capacity, struct iso_factor **out)
{
    struct iso_factor *f = calloc(1, sizeof *f);
    if (!f) {
        return -ENOMEM;
    }
    cholmod_start(&f->common);
    f->common.supernodal = CHOLMOD_SIMPLICIAL;
    f->common.nmethods = 1;
    f->common.postorder = 1;
    f->common.print = 0;
    f->common.error_handler = NULL;
    const int error = iso_symmetric_new(n_capacity, nnz_capacity, &f->sum);
    if (error) {
        iso_factor_free(f);
        return error;
    }
    *out = f;
    return 0;
}

/* Forgets the factor and what is known of its pattern. */
static void drop_factor(struct iso_factor *f)
{
    iso_supernodes_free(f->nodes);
    f->nodes = NULL;
    iso_ldl_nodes_free(f->solve_nodes);
    f->solve_nodes = NULL;
    cholmod_free_factor(&f->l, &f->common);
}

void iso_factor_free(struct iso_factor *factor)
{
    if (factor) {
        drop_factor(factor);
        cholmod_free_dense(&factor->x, &factor->common);
        cholmod_free_dense(&factor->y, &factor->common);
        cholmod_free_dense(&factor->e, &factor->common);
        cholmod_finish(&factor->common);
        iso_symmetric_free(factor->sum);
        free(factor);
    }
}

static bool same_pattern(const struct iso_symmetric *a, const struct iso_symmetric *b)
{
    return a->n == b->n && a->nnz == b->nnz &&
           memcmp(a->column_start, b->column_start, ((size_t)a->n + 1) * sizeof *a->column_start) ==
               0 &&
           memcmp(a->row, b->row, (size_t)a->nnz * sizeof *a->row) == 0;
}

/* The sum as CHOLMOD sees it: lower triangle, columns packed and sorted; borrows the arrays. */
static cholmod_sparse view_of(struct iso_symmetric *a)
{
    return (cholmod_sparse){
        .nrow = (size_t)a->n,
        .ncol = (size_t)a->n,
        .nzmax = (size_t)a->nnz,
        .p = a->column_start,
        .i = a->row,
        .x = a->value,
        .stype = -1,
        .itype = CHOLMOD_INT,
        .xtype = CHOLMOD_REAL,
        .dtype = CHOLMOD_DOUBLE,
        .sorted = 1,
        .packed = 1,
    };
}

static int error_of(const struct iso_factor *f)
{
    return f->common.status == CHOLMOD_OUT_OF_MEMORY ? -ENOMEM : -EDOM;
}

/* Analyses the pattern of the sum. Nested dissection leaves fewer entries in the factor than
 * minimum degree, but the analysis takes six times as long: as much as eight factorisations with
 * their solves save. */
static int analyse_sum(struct iso_factor *f, bool dissected)
{
    drop_factor(f);
    f->common.method[0].ordering = dissected ? CHOLMOD_NESDIS : CHOLMOD_AMD;
    f->dissected = dissected;
    cholmod_sparse view = view_of(f->sum);
    f->l = cholmod_analyze(&view, &f->common);
    return f->l ? 0 : error_of(f);
}

static void copy_pattern(struct iso_symmetric *sum, const struct iso_symmetric *pattern)
{
    sum->n = pattern->n;
    sum->nnz = pattern->nnz;
    memcpy(sum->column_start, pattern->column_start,
           ((size_t)pattern->n + 1) * sizeof *pattern->column_start);
    memcpy(sum->row, pattern->row, (size_t)pattern->nnz * sizeof *pattern->row);
}

/* A pattern that comes back once is expected to come back often, except to be counted. */
static int prepare_analysis(struct iso_factor *f, const struct iso_symmetric *pattern,
                            bool to_count)
{
    if (!f->l || !same_pattern(f->sum, pattern)) {
        copy_pattern(f->sum, pattern);
        return analyse_sum(f, false);
    }
    return f->dissected || to_count ? 0 : analyse_sum(f, true);
}

static bool is_computed(const struct iso_factor *f)
{
    return f->l && f->l->xtype == CHOLMOD_REAL;
}

/* CHOLMOD's factor, which shows the pattern of L. */
static int factorise_by_cholmod(struct iso_factor *f)
{
    cholmod_sparse view = view_of(f->sum);
    return cholmod_factorize(&view, f->l, &f->common) && f->common.status == CHOLMOD_OK &&
                   f->l->minor == f->l->n
               ? 0
               : error_of(f);
}

static struct iso_ldl ldl_of(const struct iso_factor *f)
{
    return (struct iso_ldl){(int32_t)f->l->n, f->l->p, f->l->nz, f->l->i, f->l->x, f->solve_nodes};
}

/* Computes the factor by supernodes into the pattern that is known. */
static int factorise_by_supernodes(struct iso_factor *f)
{
    if (!f->nodes) {
        const struct iso_ldl l = ldl_of(f);
        const int error = iso_supernodes_new(&l, f->l->Perm, f->sum, &f->nodes);
        if (error) {
            return error;
        }
    }
    return iso_supernodes_factorise(f->nodes, f->sum, f->l->x);
}

/* The first factor after an analysis has to be CHOLMOD's. If many more are expected, it is computed
 * once more by supernodes, so that all have the same last digits. */
static int factorise_sum(struct iso_factor *f)
{
    const bool first = !is_computed(f);
    const int error = first ? factorise_by_cholmod(f) : 0;
    return error || (first && !f->dissected) ? error : factorise_by_supernodes(f);
}

/* LDL' of a * stiffness + b * mass, whatever the signs of D. */
static int factorise_matrix(struct iso_factor *f, double a, const struct iso_symmetric *stiffness,
                            double b, const struct iso_symmetric *mass, bool to_count)
{
    if (stiffness->n != mass->n || stiffness->nnz != mass->nnz) {
        return -EINVAL;
    }
    if (stiffness->n > f->sum->n_capacity || stiffness->nnz > f->sum->nnz_capacity) {
        return -ENOSPC;
    }
    const int error = prepare_analysis(f, stiffness, to_count);
    if (error) {
        return error;
    }
    bool finite = true;
    for (int32_t i = 0; i < f->sum->nnz; i++) {
        f->sum->value[i] = a * stiffness->value[i] + b * mass->value[i];
        finite = finite && isfinite(f->sum->value[i]);
    }
    /* CHOLMOD factorises NaN and indefinite matrices without an error, so that both are checked
     * here. */
    const int failed = finite ? factorise_sum(f) : -EDOM;
    if (failed) {
        drop_factor(f);
        return failed;
    }
    return 0;
}

/* The number of pivots of D that are not above 0; an LL' has none. */
static int32_t pivots_not_positive(const struct iso_factor *f)
{
    const int *p = f->l->p;
    const double *x = f->l->x;
    int32_t count = 0;
    for (size_t j = 0; !f->l->is_ll && j < f->l->n; j++) {
        count += !(x[p[j]] > 0.0);
    }
    return count;
}

int iso_factor_compute(struct iso_factor *f, double a, const struct iso_symmetric *stiffness,
                       double b, const struct iso_symmetric *mass)
{
    int error = factorise_matrix(f, a, stiffness, b, mass, false);
    if (!error && pivots_not_positive(f) > 0) { /* LDL' also exists for indefinite matrices */
        error = -EDOM;
    }
    if (!error && !f->solve_nodes && !f->l->is_super && !f->l->is_ll) {
        const struct iso_ldl l = ldl_of(f);
        error = iso_ldl_nodes_new(&l, &f->solve_nodes);
    }
    if (error) {
        drop_factor(f);
    }
    return error;
}

int iso_factor_count_below(struct iso_factor *f, const struct iso_symmetric *stiffness,
                           double limit, const struct iso_symmetric *mass, int32_t *count)
{
    const int error = factorise_matrix(f, 1.0, stiffness, -limit, mass, true);
    if (error) {
        return error;
    }
    *count = pivots_not_positive(f);
    drop_factor(f);
    return 0;
}

int iso_factor_solve(struct iso_factor *f, const double *right, int n_right, double *solution)
{
    if (!is_computed(f)) {
        return -EDOM;
    }
    size_t n = f->l->n, columns = (size_t)n_right;
    cholmod_dense b = {
        .nrow = n,
        .ncol = columns,
        .nzmax = n * columns,
        .d = n,
        .x = (void *)(uintptr_t)right, /* read only */
        .xtype = CHOLMOD_REAL,
        .dtype = CHOLMOD_DOUBLE,
    };
    if (!cholmod_solve2(CHOLMOD_A, f->l, &b, NULL, &f->x, NULL, &f->y, &f->e, &f->common)) {
        return error_of(f);
    }
    memcpy(solution, f->x->x, n * columns * sizeof *solution);
    return 0;
}

int iso_factor_ldl(const struct iso_factor *f, struct iso_ldl *ldl, const int32_t **order)
{
    if (!is_computed(f) || f->l->is_super || f->l->is_ll) {
        return -EDOM;
    }
    *ldl = ldl_of(f);
    *order = f->l->Perm;
    return 0;
}

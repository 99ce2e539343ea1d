#include "core/base/solve.h"

#include <errno.h>
#include <math.h>

#include "core/base/lanes.h"

/* Columns are eliminated in panels of PANEL columns. A panel is then subtracted from the rest of
 * the matrix, where no entry depends on another one, so a register computes several entries at
 * once. A dot product of two rows would have to wait for each sum before the next one. Each entry
 * goes through the same operations in the same order as in the plain loop, so both factors have the
 * same bits. */
enum { PANEL = 4 };

/* The sum of the squares of the first n entries of a row. It is only compared with a small share of
 * a pivot, so the order of its additions does not matter. */
static double squares_of(const double *row, int n)
{
    iso_pair left = {0}, right = {0};
    double rest = 0.0;
    int k = 0;
    for (; k + PANEL <= n; k += PANEL) {
        left += ISO_PAIR_LOAD(row + k) * ISO_PAIR_LOAD(row + k);
        right += ISO_PAIR_LOAD(row + k + 2) * ISO_PAIR_LOAD(row + k + 2);
    }
    for (; k < n; k++) {
        rest += row[k] * row[k];
    }
    left += right;
    return left[0] + left[1] + rest;
}

/* The rows before `end` of a column of the factor, from a matrix from which all panels before
 * `first` are subtracted. */
static int finish_column(double *a, int n, int first, int end, int j)
{
    double pivot = a[j * n + j];
    for (int k = first; k < j; k++) {
        pivot -= a[j * n + k] * a[j * n + k];
    }
    /* This comparison is also false for NaN. The sum is the diagonal entry of the matrix. */
    if (!(pivot > 1e-12 * fabs(pivot + squares_of(&a[j * n], j)))) {
        return -EDOM;
    }
    const double root = sqrt(pivot);
    a[j * n + j] = root;
    for (int i = j + 1; i < end; i++) {
        double sum = a[i * n + j];
        for (int k = first; k < j; k++) {
            sum -= a[i * n + k] * a[j * n + k];
        }
        a[i * n + j] = sum / root;
    }
    return 0;
}

/* Entry k of this row of the factor and of the next one. */
#define COLUMN_AT(row, n, k) ((iso_pair){(row)[k], (row)[(n) + (k)]})

/* The rows below a whole panel whose own rows are finished, two at a time. */
static void finish_rows_below(double *a, int n, int first)
{
    const double *const r0 = &a[first * n + first], *const r1 = r0 + n, *const r2 = r1 + n,
                        *const r3 = r2 + n;
    int i = first + PANEL;
    for (; i + 2 <= n; i += 2) {
        double *x = &a[i * n + first];
        const iso_pair x0 = COLUMN_AT(x, n, 0) / r0[0];
        const iso_pair x1 = (COLUMN_AT(x, n, 1) - x0 * r1[0]) / r1[1];
        const iso_pair x2 = (COLUMN_AT(x, n, 2) - x0 * r2[0] - x1 * r2[1]) / r2[2];
        const iso_pair x3 = (COLUMN_AT(x, n, 3) - x0 * r3[0] - x1 * r3[1] - x2 * r3[2]) / r3[3];
        ISO_PAIR_STORE(x, __builtin_shufflevector(x0, x1, 0, 2));
        ISO_PAIR_STORE(x + 2, __builtin_shufflevector(x2, x3, 0, 2));
        ISO_PAIR_STORE(x + n, __builtin_shufflevector(x0, x1, 1, 3));
        ISO_PAIR_STORE(x + n + 2, __builtin_shufflevector(x2, x3, 1, 3));
    }
    for (; i < n; i++) {
        double *x = &a[i * n + first];
        x[0] = x[0] / r0[0];
        x[1] = (x[1] - x[0] * r1[0]) / r1[1];
        x[2] = (x[2] - x[0] * r2[0] - x[1] * r2[1]) / r2[2];
        x[3] = (x[3] - x[0] * r3[0] - x[1] * r3[1] - x[2] * r3[2]) / r3[3];
    }
}

/* Subtracts a panel from one entry. */
static void subtract_from_entry(double *a, int n, int first, int i, int j)
{
    for (int k = first; k < first + PANEL; k++) {
        a[i * n + j] -= a[i * n + k] * a[j * n + k];
    }
}

/* Subtracts a panel from the columns j to j + PANEL - 1 of the lower triangle. The first rows end
 * within these columns: what is written behind their ends belongs to the upper triangle. */
static void subtract_panel(double *a, int n, int first, int j)
{
    /* They have names, because compilers keep an array of them in memory. */
    const double *const rows = &a[j * n + first], *const next = rows + 2 * n;
    const iso_pair k0 = COLUMN_AT(rows, n, 0), k1 = COLUMN_AT(rows, n, 1);
    const iso_pair k2 = COLUMN_AT(rows, n, 2), k3 = COLUMN_AT(rows, n, 3);
    const iso_pair m0 = COLUMN_AT(next, n, 0), m1 = COLUMN_AT(next, n, 1);
    const iso_pair m2 = COLUMN_AT(next, n, 2), m3 = COLUMN_AT(next, n, 3);
    for (int i = j; i < n; i++) {
        const double *factor = &a[i * n + first];
        double *at = &a[i * n + j];
        iso_pair left = ISO_PAIR_LOAD(at), right = ISO_PAIR_LOAD(at + 2);
        left -= factor[0] * k0;
        right -= factor[0] * m0;
        left -= factor[1] * k1;
        right -= factor[1] * m1;
        left -= factor[2] * k2;
        right -= factor[2] * m2;
        left -= factor[3] * k3;
        right -= factor[3] * m3;
        ISO_PAIR_STORE(at, left);
        ISO_PAIR_STORE(at + 2, right);
    }
}

#if defined __x86_64__
/* The same with four columns in a register. Without FMA, so that the bits are the same. */
static __attribute__((target("avx2"))) void subtract_panel_avx2(double *a, int n, int first, int j)
{
    const double *const r0 = &a[j * n + first], *const r1 = r0 + n, *const r2 = r1 + n,
                        *const r3 = r2 + n;
    const iso_doubles k0 = {r0[0], r1[0], r2[0], r3[0]}, k1 = {r0[1], r1[1], r2[1], r3[1]};
    const iso_doubles k2 = {r0[2], r1[2], r2[2], r3[2]}, k3 = {r0[3], r1[3], r2[3], r3[3]};
    for (int i = j; i < n; i++) {
        const double *factor = &a[i * n + first];
        iso_doubles entry = ISO_DOUBLES_LOAD(&a[i * n + j]);
        entry -= factor[0] * k0;
        entry -= factor[1] * k1;
        entry -= factor[2] * k2;
        entry -= factor[3] * k3;
        ISO_DOUBLES_STORE(&a[i * n + j], entry);
    }
}
#endif

typedef void subtract_function(double *a, int n, int first, int j);

static int factorise(double *a, int n, subtract_function *subtract)
{
    for (int first = 0; first < n; first += PANEL) {
        const int end = first + PANEL < n ? first + PANEL : n;
        for (int j = first; j < end; j++) {
            const int error = finish_column(a, n, first, end, j);
            if (error) {
                return error;
            }
        }
        if (end - first == PANEL) {
            finish_rows_below(a, n, first);
        }
        int j = end;
        for (; j + PANEL <= n; j += PANEL) {
            subtract(a, n, first, j);
        }
        for (; j < n; j++) {
            for (int i = j; i < n; i++) {
                subtract_from_entry(a, n, first, i, j);
            }
        }
    }
    return 0;
}

int iso__cholesky_factorise_baseline(double *a, int n)
{
    return factorise(a, n, subtract_panel);
}

int iso_cholesky_factorise(double *a, int n)
{
#if defined __x86_64__
    if (__builtin_cpu_supports("avx2")) {
        return factorise(a, n, subtract_panel_avx2);
    }
#endif
    return iso__cholesky_factorise_baseline(a, n);
}

void iso_cholesky_solve(const double *l, int n, double *b)
{
    /* Column by column, because no entry then waits for the sum of another one; each goes through
     * the same operations in the same order as row by row. */
    for (int k = 0; k < n; k++) {
        b[k] /= l[k * n + k];
        for (int i = k + 1; i < n; i++) {
            b[i] -= l[i * n + k] * b[k];
        }
    }
    for (int i = n - 1; i >= 0; i--) {
        for (int k = i + 1; k < n; k++) {
            b[i] -= l[k * n + i] * b[k];
        }
        b[i] /= l[i * n + i];
    }
}

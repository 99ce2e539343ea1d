#include "core/base/solve.h"

#include <errno.h>
#include <math.h>

#include "core/base/lanes.h"

/* Columns are eliminated in panels of PANEL columns. A panel is then subtracted from the rest of
 * the matrix, where no entry depends on another one, so a register computes several entries at
 * once. A dot product of two rows would have to wait for each sum before the next one. Each entry
 * goes through the same operations in the same order as in the plain loop, so both factors have the
 * same bits. */
enum { PANEL = ISO_DOUBLES };

/* A column of the factor, from a matrix from which all panels before `first` are subtracted. */
static int finish_column(double *a, int n, int first, int j)
{
    double pivot = a[j * n + j], diagonal = 0.0;
    for (int k = first; k < j; k++) {
        pivot -= a[j * n + k] * a[j * n + k];
    }
    for (int k = 0; k < j; k++) {
        diagonal += a[j * n + k] * a[j * n + k];
    }
    /* This comparison is also false for NaN. The sum is the diagonal entry of the matrix. */
    if (!(pivot > 1e-12 * fabs(pivot + diagonal))) {
        return -EDOM;
    }
    const double root = sqrt(pivot);
    a[j * n + j] = root;
    for (int i = j + 1; i < n; i++) {
        double sum = a[i * n + j];
        for (int k = first; k < j; k++) {
            sum -= a[i * n + k] * a[j * n + k];
        }
        a[i * n + j] = sum / root;
    }
    return 0;
}

/* Subtracts a panel from one entry. */
static void subtract_from_entry(double *a, int n, int first, int i, int j)
{
    for (int k = first; k < first + PANEL; k++) {
        a[i * n + j] -= a[i * n + k] * a[j * n + k];
    }
}

/* Entry k of this row of the factor and of the next three. */
#define COLUMN_AT(row, n, k) \
    ((iso_doubles){(row)[k], (row)[(n) + (k)], (row)[2 * (n) + (k)], (row)[3 * (n) + (k)]})

/* Subtracts a panel from the columns j to j + ISO_DOUBLES - 1 of the lower triangle. */
static void subtract_panel(double *a, int n, int first, int j)
{
    for (int i = j; i < j + ISO_DOUBLES - 1; i++) { /* the rows that end within these columns */
        for (int c = j; c <= i; c++) {
            subtract_from_entry(a, n, first, i, c);
        }
    }
    /* They have names, because compilers keep an array of them in memory. */
    const double *const rows = &a[j * n + first];
    const iso_doubles k0 = COLUMN_AT(rows, n, 0), k1 = COLUMN_AT(rows, n, 1);
    const iso_doubles k2 = COLUMN_AT(rows, n, 2), k3 = COLUMN_AT(rows, n, 3);
    for (int i = j + ISO_DOUBLES - 1; i < n; i++) {
        const double *factor = &a[i * n + first];
        iso_doubles left = ISO_DOUBLES_LOAD(&a[i * n + j]);
        left -= factor[0] * k0;
        left -= factor[1] * k1;
        left -= factor[2] * k2;
        left -= factor[3] * k3;
        ISO_DOUBLES_STORE(&a[i * n + j], left);
    }
}

int iso_cholesky_factorise(double *a, int n)
{
    for (int first = 0; first < n; first += PANEL) {
        const int end = first + PANEL < n ? first + PANEL : n;
        for (int j = first; j < end; j++) {
            const int error = finish_column(a, n, first, j);
            if (error) {
                return error;
            }
        }
        int j = end;
        for (; j + ISO_DOUBLES <= n; j += ISO_DOUBLES) {
            subtract_panel(a, n, first, j);
        }
        for (; j < n; j++) {
            for (int i = j; i < n; i++) {
                subtract_from_entry(a, n, first, i, j);
            }
        }
    }
    return 0;
}

void iso_cholesky_solve(const double *l, int n, double *b)
{
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < i; k++) {
            b[i] -= l[i * n + k] * b[k];
        }
        b[i] /= l[i * n + i];
    }
    for (int i = n - 1; i >= 0; i--) {
        for (int k = i + 1; k < n; k++) {
            b[i] -= l[k * n + i] * b[k];
        }
        b[i] /= l[i * n + i];
    }
}

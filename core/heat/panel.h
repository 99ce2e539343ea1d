/* Products of tall, thin matrices, for the basis of block Lanczos (lanczos.h). Internal to
 * core/heat.
 *
 * A panel is [n][ISO_PANEL]: value i of eight vectors, then value i + 1 of these vectors. That is
 * a block of block.h of two registers. BLAS copies such matrices into an order of its own at every
 * call, which takes longer than their products; here nothing is copied.
 *
 * The same source is compiled for the instructions that every processor of the architecture has
 * and, on x86-64, once more for AVX2 with FMA. The results differ in their last digits, as those
 * of BLAS do. */
#ifndef ISO_CORE_HEAT_PANEL_H
#define ISO_CORE_HEAT_PANEL_H

#include <stdint.h>

/* ISO_PANEL_ROWS rows of two panels fit in the first-level cache: for longer panels the caller
 * goes through the rows in pieces. */
enum { ISO_PANEL = 8, ISO_PANEL_ROWS = 256 };

struct iso_panel_ops {
    /* product[i][c] += sum over the rows of u[row][i] w[row][c]. */
    void (*dot)(int32_t rows, const double *u, const double *w, double (*product)[ISO_PANEL]);
    /* w += u weight. */
    void (*add)(int32_t rows, const double *u, const double (*weight)[ISO_PANEL], double *w);
    /* w = w weight. */
    void (*multiply)(int32_t rows, const double (*weight)[ISO_PANEL], double *w);
    const char *name;
};

/* For every processor of the architecture. */
extern const struct iso_panel_ops iso__panel_ops_baseline;
extern const struct iso_panel_ops iso__panel_ops_fma; /* x86-64 only */

/* The fastest that this machine can run. */
const struct iso_panel_ops *iso_panel_ops(void);

#endif

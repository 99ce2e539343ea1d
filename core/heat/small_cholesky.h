/* Cholesky's factor of the products of the vectors of one panel. Internal to core/heat. */
#ifndef ISO_CORE_HEAT_SMALL_CHOLESKY_H
#define ISO_CORE_HEAT_SMALL_CHOLESKY_H

#include <stdbool.h>

#include "core/heat/panel.h"

/* With the upper triangle R of R' R = gram, writes R^-1 to `inverse` and replaces r by R r; r must
 * be upper triangular. False, with r as it was, if the part of a vector that is orthogonal to those
 * before it is less than a ten-thousandth of the vector, or at most 1e-14 * scale, or not finite.
 * Then rounding errors of the sums in `gram` would matter. */
bool iso_small_cholesky(const double (*gram)[ISO_PANEL], double scale, double (*r)[ISO_PANEL],
                        double (*inverse)[ISO_PANEL]);

#endif

/* Pictures of shapes in rows and columns. */
#ifndef SIM_SHAPES_STUDY_SHEET_H
#define SIM_SHAPES_STUDY_SHEET_H

#include "sim/shapes/study/retrieve.h"

/* One shape of each class a row, up to `columns` of its shapes (at most 20 rows, as many classes).
 * -ENOMEM, -EIO, errors of sim_bank_read. */
int sim_sheet_classes(const struct sim_bank_options *how, int columns, const char *path,
                      struct iso_fault *fault) __attribute__((warn_unused_result));

/* As figure 4.5: on the left a query of each class (as `how` distorts it), then its first matches
 * by a matrix of distances, those of another class in green. */
int sim_sheet_matches(const struct sim_bank_options *how, const struct sim_features *features,
                      const double *distance, int columns, const char *path,
                      struct iso_fault *fault) __attribute__((warn_unused_result));

#endif

/* Pictures of shapes in rows and columns. */
#ifndef SIM_SHAPES_STUDY_SHEET_H
#define SIM_SHAPES_STUDY_SHEET_H

#include "sim/shapes/study/retrieve.h"

/* Draws one class in each row, with up to `columns` of its shapes. A sheet has at most 20 rows and
 * 16 columns. -ENOMEM, -EIO, errors of sim_bank_read. */
int sim_sheet_classes(const struct sim_bank_options *how, int columns, const char *path,
                      struct iso_fault *fault) __attribute__((warn_unused_result));

/* Draws a picture like figure 4.5: on the left the first query of each class (distorted as in
 * `how`), then its first matches by a matrix of distances. Matches of another class are green.
 * Limits and errors are those of sim_sheet_classes. */
int sim_sheet_matches(const struct sim_bank_options *how, const struct sim_features *features,
                      const double *distance, int columns, const char *path,
                      struct iso_fault *fault) __attribute__((warn_unused_result));

/* A picture of a file. */
struct sim_sheet_file {
    const char *path, *name; /* the name stands below it */
    bool query;              /* drawn on another ground */
};

/* Draws n files in rows of 16. -ENOMEM, -EIO, errors of sim_source_read. */
int sim_sheet_files(const struct sim_source_options *source, const struct sim_sheet_file *file,
                    int n, const char *path, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif

/* Named arrays, and their files for NumPy, for spreadsheets and for MATLAB. */
#ifndef SIM_SHAPES_DESCRIBE_ARRAY_H
#define SIM_SHAPES_DESCRIBE_ARRAY_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "core/base/fault.h"

enum sim_array_type { SIM_ARRAY_DOUBLE, SIM_ARRAY_FLOAT, SIM_ARRAY_INT };

enum { SIM_ARRAY_NAME_MAX = 32, SIM_ARRAYS_MAX = 96 };

/* An array of one or two dimensions. */
struct sim_array {
    char name[SIM_ARRAY_NAME_MAX]; /* letters, digits and underscores: a name of MATLAB, too */
    const char *meaning;           /* one line for the list of parameters */
    enum sim_array_type type;
    int32_t rows, columns; /* columns 0: a vector */
    const void *data;      /* borrowed: double, float or int32_t */
    size_t row_step;       /* items from one row to the next */
    size_t column_step;    /* items from one column to the next */
    void *owned;           /* freed by sim_arrays_done(), or NULL */
};

struct sim_arrays {
    int n;
    struct sim_array array[SIM_ARRAYS_MAX];
};

/* Appends an array that is stored row by row; `columns` is 0 for a vector. `owned` memory belongs
 * to the arrays from now on, even after a failure. -ENOMEM for more than SIM_ARRAYS_MAX arrays. */
int sim_arrays_add(struct sim_arrays *arrays, const struct sim_array *array)
    __attribute__((warn_unused_result));

/* Releases what it holds. */
void sim_arrays_done(struct sim_arrays *arrays);

/* The item of a row and a column. */
double sim_array_item(const struct sim_array *array, int32_t row, int32_t column);

enum sim_array_format {
    SIM_ARRAY_NPY,  /* NAME.npy each, version 1.0 */
    SIM_ARRAY_CSV,  /* NAME.csv each: a line for each row, no header; a vector has one column */
    SIM_ARRAY_MAT5, /* all in descriptors.mat, MATLAB 5 without compression; a vector has one
                     * column */
    SIM_ARRAY_FORMATS
};

/* "npy", "csv", "mat5"; NULL for another one. */
const char *sim_array_format_name(enum sim_array_format format);

/* The name of the file that holds an array. */
void sim_array_file_name(const struct sim_array *array, enum sim_array_format format, char *name,
                         size_t size);

/* Writes each array into a directory, in place of an earlier file of its name. -EFBIG if an array
 * has 2 GiB or more and the format is MAT5; errors of writing. The fault names the file. */
int sim_arrays_write(const struct sim_arrays *arrays, enum sim_array_format format,
                     const char *directory, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Writes the contents of a MAT5 file (MathWorks, "MAT-File Format", Level 5). The file has no time
 * in it: the same arrays make the same bytes. Each array must be smaller than 2 GiB. */
void sim_mat5_write(const struct sim_arrays *arrays, FILE *out);

#endif

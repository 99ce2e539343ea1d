#include "sim/shapes/describe/array.h"

#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>

#include "drivers/base/path.h"
#include "sim/base/result_file.h"
#include "sim/world/face/npy_writer.h"

static const char mat5_name[] = "descriptors.mat";
static const uint64_t mat5_bytes_most = INT32_MAX;

int sim_arrays_add(struct sim_arrays *arrays, const struct sim_array *array)
{
    if (arrays->n == SIM_ARRAYS_MAX) {
        free(array->owned);
        return -ENOMEM;
    }
    struct sim_array *added = &arrays->array[arrays->n++];
    *added = *array;
    if (added->row_step == 0) {
        added->row_step = array->columns ? (size_t)array->columns : 1;
        added->column_step = 1;
    }
    return 0;
}

void sim_arrays_done(struct sim_arrays *arrays)
{
    for (int i = 0; i < arrays->n; i++) {
        free(arrays->array[i].owned);
    }
    arrays->n = 0;
}

double sim_array_item(const struct sim_array *array, int32_t row, int32_t column)
{
    const size_t at = (size_t)row * array->row_step + (size_t)column * array->column_step;
    switch (array->type) {
    case SIM_ARRAY_FLOAT:
        return (double)((const float *)array->data)[at];
    case SIM_ARRAY_INT:
        return ((const int32_t *)array->data)[at];
    default:
        return ((const double *)array->data)[at];
    }
}

const char *sim_array_format_name(enum sim_array_format format)
{
    static const char *const names[SIM_ARRAY_FORMATS] = {"npy", "csv", "mat5"};
    return (unsigned)format < SIM_ARRAY_FORMATS ? names[format] : NULL;
}

void sim_array_file_name(const struct sim_array *array, enum sim_array_format format, char *name,
                         size_t size)
{
    if (format == SIM_ARRAY_MAT5) {
        (void)snprintf(name, size, "%s", mat5_name);
    } else {
        (void)snprintf(name, size, "%s.%s", array->name, sim_array_format_name(format));
    }
}

static int write_npy(const struct sim_array *array, const char *path, struct iso_fault *fault)
{
    static const enum sim_npy_type types[] = {[SIM_ARRAY_DOUBLE] = SIM_NPY_DOUBLE,
                                              [SIM_ARRAY_FLOAT] = SIM_NPY_FLOAT,
                                              [SIM_ARRAY_INT] = SIM_NPY_I32};
    const struct sim_npy_shape shape = {
        .n_dimensions = array->columns ? 2 : 1,
        .size = {(uint32_t)array->rows, (uint32_t)array->columns},
    };
    struct sim_npy_writer *writer = NULL;
    const int error = sim_npy_writer_open(path, types[array->type], &shape, &writer, fault);
    if (error) {
        return error;
    }
    for (int32_t r = 0; r < array->rows; r++) {
        for (int32_t c = 0; c < (array->columns ? array->columns : 1); c++) {
            sim_npy_writer_add(writer, sim_array_item(array, r, c));
        }
    }
    return sim_npy_writer_close(writer, true, fault);
}

static void write_csv(const void *context, FILE *out)
{
    const struct sim_array *array = context;
    const int digits = array->type == SIM_ARRAY_DOUBLE ? 17 : 9;
    for (int32_t r = 0; r < array->rows; r++) {
        for (int32_t c = 0; c < (array->columns ? array->columns : 1); c++) {
            fprintf(out, "%s%.*g", c ? "," : "", digits, sim_array_item(array, r, c));
        }
        fputc('\n', out);
    }
}

static void write_mat5(const void *context, FILE *out)
{
    sim_mat5_write(context, out);
}

static int check_mat5(const struct sim_arrays *arrays, struct iso_fault *fault)
{
    for (int i = 0; i < arrays->n; i++) {
        const struct sim_array *a = &arrays->array[i];
        const uint64_t items = (uint64_t)a->rows * (uint64_t)(a->columns ? a->columns : 1);
        if (items * sizeof(double) + 1024 > mat5_bytes_most) {
            return iso_fault_set(fault, -EFBIG,
                                 "%s: %s is too large for MAT5, which holds 2 GiB: use npy",
                                 mat5_name, a->name);
        }
    }
    return 0;
}

int sim_arrays_write(const struct sim_arrays *arrays, enum sim_array_format format,
                     const char *directory, struct iso_fault *fault)
{
    char name[SIM_ARRAY_NAME_MAX + 8], path[PATH_MAX];
    int error = 0;
    if (format == SIM_ARRAY_MAT5) {
        error = check_mat5(arrays, fault);
        return error ? error : sim_result_file(directory, mat5_name, write_mat5, arrays, fault);
    }
    for (int i = 0; i < arrays->n && !error; i++) {
        const struct sim_array *array = &arrays->array[i];
        sim_array_file_name(array, format, name, sizeof name);
        if (format == SIM_ARRAY_CSV) {
            error = sim_result_file(directory, name, write_csv, array, fault);
            continue;
        }
        error = iso_path_join(directory, name, path, fault);
        if (!error) {
            error = write_npy(array, path, fault);
        }
    }
    return error;
}

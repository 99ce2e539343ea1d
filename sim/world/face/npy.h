/* Strict reader for arrays in NumPy's .npy files: versions 1.0 and 2.0, little-endian, C order. */
#ifndef SIM_WORLD_FACE_NPY_H
#define SIM_WORLD_FACE_NPY_H

#include <stddef.h>
#include <stdint.h>

#include "core/base/fault.h"

enum { SIM_NPY_DIMENSIONS_MAX = 3 };

struct sim_npy_shape {
    int n_dimensions;
    uint32_t size[SIM_NPY_DIMENSIONS_MAX];
};

/* Reads a whole array of '<f4' or '<f2' (half precision is widened), row by row. The caller
 * frees *out with free(). Returns -ENOENT or another error of opening; -EBADMSG with *fault
 * unless the file is well formed and exactly as long as header and data; or -ENOMEM. */
int sim_npy_read_floats(const char *path, struct sim_npy_shape *shape, float **out,
                        struct iso_fault *fault) __attribute__((warn_unused_result));

/* The same for '<u4'. */
int sim_npy_read_u32(const char *path, struct sim_npy_shape *shape, uint32_t **out,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

/* The value of an IEEE 754 half-precision number. */
float sim_npy_float_of_half(uint16_t half);

#endif

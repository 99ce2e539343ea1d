/* Writes .npy files like NumPy (version 1.0, little-endian, C order): a header, then the items
 * row by row. */
#ifndef SIM_WORLD_FACE_NPY_WRITER_H
#define SIM_WORLD_FACE_NPY_WRITER_H

#include <stdint.h>

#include "core/base/fault.h"
#include "sim/world/face/npy.h"

enum sim_npy_type { SIM_NPY_FLOAT, SIM_NPY_HALF, SIM_NPY_U32, SIM_NPY_I32, SIM_NPY_DOUBLE };

struct sim_npy_writer;

/* Creates the file and writes its header. The shape determines how many items must follow.
 * Returns the errno of opening, or -ENOMEM. */
int sim_npy_writer_open(const char *path, enum sim_npy_type type, const struct sim_npy_shape *shape,
                        struct sim_npy_writer **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Adds one item, rounded to the nearest value of the type (ties to even); SIM_NPY_U32
 * and SIM_NPY_I32 drop the fraction. An error is kept, and sim_npy_writer_close returns it. */
void sim_npy_writer_add(struct sim_npy_writer *writer, double item);

/* Closes the file. The file is removed if `good` is false or if something could not be written.
 * Returns the errno of writing with a fault. NULL is allowed. */
int sim_npy_writer_close(struct sim_npy_writer *writer, int good, struct iso_fault *fault);

/* The nearest IEEE 754 half-precision number (ties to even); infinity beyond the largest one. */
uint16_t sim_npy_half_of_double(double value);

#endif

/* Writing .npy files, as NumPy writes them (version 1.0, little-endian, C order): a header, then
 * the items row by row. */
#ifndef SIM_WORLD_FACE_NPY_WRITER_H
#define SIM_WORLD_FACE_NPY_WRITER_H

#include <stdint.h>

#include "core/base/fault.h"
#include "sim/world/face/npy.h"

enum sim_npy_type { SIM_NPY_FLOAT, SIM_NPY_HALF, SIM_NPY_U32 };

struct sim_npy_writer;

/* Creates the file and writes its header; how many items follow the shape says. The errno of
 * opening, -ENOMEM. */
int sim_npy_writer_open(const char *path, enum sim_npy_type type, const struct sim_npy_shape *shape,
                        struct sim_npy_writer **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Adds one item, rounded to the nearest that the type has (ties to even). Errors are kept for the
 * end. */
void sim_npy_writer_add(struct sim_npy_writer *writer, double item);

/* Closes the file. `good`: it is wanted; else, or when something could not be written, it is
 * removed. The errno of writing with a fault; NULL is fine. */
int sim_npy_writer_close(struct sim_npy_writer *writer, int good, struct iso_fault *fault);

/* The IEEE 754 half-precision number that is nearest (ties to even); beyond the largest infinity.
 */
uint16_t sim_npy_half_of_double(double value);

#endif

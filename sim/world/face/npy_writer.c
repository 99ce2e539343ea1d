#include "sim/world/face/npy_writer.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { HEADER_BYTES = 128, MAGIC_BYTES = 10 };

struct sim_npy_writer {
    FILE *file;
    char *path;
    enum sim_npy_type type;
    int error; /* the first error, a negative errno */
};

uint16_t sim_npy_half_of_double(double value)
{
    const uint16_t sign = signbit(value) ? 0x8000 : 0;
    const double magnitude = fabs(value);
    int exponent = 0;
    if (!(magnitude < 65520.0)) { /* halfway to the next representable number */
        return (uint16_t)(sign | (isnan(value) ? 0x7e00 : 0x7c00));
    }
    (void)frexp(magnitude, &exponent);
    /* The unit of the last place: 2^-24 below the normal numbers. A mantissa that is rounded up to
     * 2048 carries into the exponent. */
    const int unit = magnitude > 0.0 && exponent - 11 > -24 ? exponent - 11 : -24;
    const int mantissa = (int)nearbyint(ldexp(magnitude, -unit));
    return (uint16_t)(sign | (((unit + 24) << 10) + mantissa));
}

static void put(struct sim_npy_writer *writer, const void *bytes, size_t size)
{
    if (!writer->error && fwrite(bytes, 1, size, writer->file) != size) {
        writer->error = errno ? -errno : -EIO;
    }
}

static void put_number(struct sim_npy_writer *writer, uint64_t number, size_t size)
{
    unsigned char bytes[8];
    for (size_t i = 0; i < size; i++) {
        bytes[i] = (unsigned char)(number >> (8 * i));
    }
    put(writer, bytes, size);
}

static void put_header(struct sim_npy_writer *writer, const struct sim_npy_shape *shape)
{
    static const char *const types[] = {"<f4", "<f2", "<u4", "<i4", "<f8"};
    char header[HEADER_BYTES + 64];
    int n = snprintf(header + MAGIC_BYTES, sizeof header - MAGIC_BYTES,
                     "{'descr': '%s', 'fortran_order': False, 'shape': (", types[writer->type]);
    for (int i = 0; i < shape->n_dimensions; i++) {
        n += snprintf(header + MAGIC_BYTES + n, sizeof header - MAGIC_BYTES - (size_t)n, "%s%u",
                      i ? ", " : "", shape->size[i]);
    }
    if (shape->n_dimensions == 1) {
        header[MAGIC_BYTES + n++] = ','; /* Python's notation of a tuple of one */
    }
    n += snprintf(header + MAGIC_BYTES + n, sizeof header - MAGIC_BYTES - (size_t)n, "), }");
    memset(header + MAGIC_BYTES + n, ' ', HEADER_BYTES - MAGIC_BYTES - (size_t)n);
    memcpy(header, "\x93NUMPY\x01\x00\x76\x00", MAGIC_BYTES);
    header[HEADER_BYTES - 1] = '\n';
    put(writer, header, HEADER_BYTES);
}

int sim_npy_writer_open(const char *path, enum sim_npy_type type, const struct sim_npy_shape *shape,
                        struct sim_npy_writer **out, struct iso_fault *fault)
{
    struct sim_npy_writer *writer = calloc(1, sizeof *writer);
    char *copy = strdup(path);
    if (!writer || !copy) {
        free(writer);
        free(copy);
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
    }
    writer->file = fopen(path, "wbe");
    if (!writer->file) {
        const int error = -errno;
        free(writer);
        free(copy);
        return iso_fault_set(fault, error, "%s: %s", path, strerror(-error));
    }
    writer->path = copy;
    writer->type = type;
    put_header(writer, shape);
    *out = writer;
    return 0;
}

void sim_npy_writer_add(struct sim_npy_writer *writer, double item)
{
    const float single = (float)item;
    uint32_t bits = 0;
    uint64_t long_bits = 0;
    switch (writer->type) {
    case SIM_NPY_FLOAT:
        memcpy(&bits, &single, sizeof bits);
        put_number(writer, bits, 4);
        break;
    case SIM_NPY_HALF:
        put_number(writer, sim_npy_half_of_double(item), 2);
        break;
    case SIM_NPY_U32:
        put_number(writer, (uint32_t)item, 4);
        break;
    case SIM_NPY_I32:
        put_number(writer, (uint32_t)(int32_t)item, 4);
        break;
    case SIM_NPY_DOUBLE:
        memcpy(&long_bits, &item, sizeof long_bits);
        put_number(writer, long_bits, 8);
        break;
    }
}

int sim_npy_writer_close(struct sim_npy_writer *writer, int good, struct iso_fault *fault)
{
    if (!writer) {
        return 0;
    }
    int error = writer->error;
    if (fclose(writer->file) != 0 && !error) {
        error = -errno;
    }
    if (error) {
        (void)iso_fault_set(fault, error, "%s: %s", writer->path, strerror(-error));
    }
    if (error || !good) {
        (void)unlink(writer->path);
    }
    free(writer->path);
    free(writer);
    return error;
}

/* MATLAB's files of level 5. Debian has libmatio, which also compresses and reads; it brings HDF5
 * along, and writing without compression is no more than the tags below. */
#include <string.h>

#include "core/base/bytes.h"
#include "sim/shapes/describe/array.h"

/* Types of data elements, and classes of arrays. */
enum { MI_INT8 = 1, MI_INT32 = 5, MI_UINT32 = 6, MI_SINGLE = 7, MI_DOUBLE = 9, MI_MATRIX = 14 };
enum { MX_DOUBLE = 6, MX_SINGLE = 7, MX_INT32 = 12 };

enum { HEADER_TEXT = 116, BLOCK = 8 };

struct kind {
    uint32_t element, class_number, bytes;
};

static const struct kind kinds[] = {
    [SIM_ARRAY_DOUBLE] = {MI_DOUBLE, MX_DOUBLE, 8},
    [SIM_ARRAY_FLOAT] = {MI_SINGLE, MX_SINGLE, 4},
    [SIM_ARRAY_INT] = {MI_INT32, MX_INT32, 4},
};

static uint32_t padded(uint32_t bytes)
{
    return (bytes + BLOCK - 1) / BLOCK * BLOCK;
}

static void put_tag(FILE *out, uint32_t type, uint32_t bytes)
{
    uint8_t tag[8];
    (void)iso_put_u32(iso_put_u32(tag, type), bytes);
    (void)fwrite(tag, 1, sizeof tag, out);
}

static void pad(FILE *out, uint32_t bytes)
{
    static const uint8_t zeros[BLOCK] = {0};
    (void)fwrite(zeros, 1, padded(bytes) - bytes, out);
}

static void put_pair(FILE *out, uint32_t type, uint32_t first, uint32_t second)
{
    uint8_t pair[8];
    put_tag(out, type, sizeof pair);
    (void)iso_put_u32(iso_put_u32(pair, first), second);
    (void)fwrite(pair, 1, sizeof pair, out);
}

static void put_item(FILE *out, enum sim_array_type type, double value)
{
    uint8_t bytes[8];
    uint64_t bits;
    switch (type) {
    case SIM_ARRAY_FLOAT:
        (void)iso_put_f32(bytes, (float)value);
        break;
    case SIM_ARRAY_INT:
        (void)iso_put_u32(bytes, (uint32_t)(int32_t)value);
        break;
    default:
        memcpy(&bits, &value, sizeof bits);
        (void)iso_put_u64(bytes, bits);
    }
    (void)fwrite(bytes, 1, kinds[type].bytes, out);
}

/* MATLAB stores arrays column by column. */
static void put_array(FILE *out, const struct sim_array *array)
{
    const struct kind *kind = &kinds[array->type];
    const uint32_t columns = array->columns ? (uint32_t)array->columns : 1;
    const uint32_t bytes = (uint32_t)array->rows * columns * kind->bytes;
    const uint32_t name_bytes = (uint32_t)strlen(array->name);
    put_tag(out, MI_MATRIX, 16 + 16 + 8 + padded(name_bytes) + 8 + padded(bytes));
    put_pair(out, MI_UINT32, kind->class_number, 0);
    put_pair(out, MI_INT32, (uint32_t)array->rows, columns);
    put_tag(out, MI_INT8, name_bytes);
    (void)fwrite(array->name, 1, name_bytes, out);
    pad(out, name_bytes);
    put_tag(out, kind->element, bytes);
    for (uint32_t c = 0; c < columns; c++) {
        for (int32_t r = 0; r < array->rows; r++) {
            put_item(out, array->type, sim_array_item(array, r, (int32_t)c));
        }
    }
    pad(out, bytes);
}

void sim_mat5_write(const struct sim_arrays *arrays, FILE *out)
{
    static const char text[] = "MATLAB 5.0 MAT-file, written by isotherm-sim";
    uint8_t header[HEADER_TEXT + 12] = {0};
    memset(header, ' ', HEADER_TEXT);
    memcpy(header, text, sizeof text - 1);
    (void)iso_put_u16(&header[HEADER_TEXT + 8], 0x0100);
    header[HEADER_TEXT + 10] = 'I';
    header[HEADER_TEXT + 11] = 'M';
    (void)fwrite(header, 1, sizeof header, out);
    for (int i = 0; i < arrays->n; i++) {
        put_array(out, &arrays->array[i]);
    }
}

#include "sim/world/face/npy.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/file/file.h"

enum { ITEMS_MAX = 1 << 28, ITEM_BYTES = 4 /* of the returned items */ };

#define FILE_BYTES_MAX (8 * (size_t)ITEMS_MAX + 65536) /* enough for all items and the header */

struct file {
    char *bytes;
    size_t n;
};

struct header {
    char type[8]; /* "<f4" */
    struct sim_npy_shape shape;
    size_t n_items, data_offset;
};

float sim_npy_float_of_half(uint16_t half)
{
    const int exponent = (half >> 10) & 31, mantissa = half & 1023;
    float magnitude;
    if (exponent == 31) {
        magnitude = mantissa ? NAN : INFINITY;
    } else if (exponent == 0) {
        magnitude = ldexpf((float)mantissa, -24);
    } else {
        magnitude = ldexpf((float)(mantissa + 1024), exponent - 25);
    }
    return half & 0x8000 ? -magnitude : magnitude;
}

static bool skip_word(const char **text, const char *word)
{
    while (**text == ' ') {
        (*text)++;
    }
    const size_t n = strlen(word);
    if (strncmp(*text, word, n) != 0) {
        return false;
    }
    *text += n;
    return true;
}

static bool parse_type(const char **text, char type[8])
{
    const char *end = skip_word(text, "'") ? strchr(*text, '\'') : NULL;
    if (!end || end - *text > 7) {
        return false;
    }
    memset(type, 0, 8);
    memcpy(type, *text, (size_t)(end - *text));
    *text = end + 1;
    return true;
}

static bool parse_shape(const char **text, struct header *header)
{
    bool comma = skip_word(text, "(");
    header->n_items = 1;
    while (!skip_word(text, ")")) {
        char *end;
        unsigned long size = **text >= '0' && **text <= '9' ? strtoul(*text, &end, 10) : 0;
        if (!comma || size == 0 || size > ITEMS_MAX / header->n_items ||
            header->shape.n_dimensions == SIM_NPY_DIMENSIONS_MAX) {
            return false;
        }
        header->shape.size[header->shape.n_dimensions++] = (uint32_t)size;
        header->n_items *= size;
        *text = end;
        comma = skip_word(text, ",");
    }
    return header->shape.n_dimensions > 0;
}

/* Parses the dictionary exactly as NumPy writes it, with sorted keys. */
static bool parse_dictionary(const char *text, struct header *header)
{
    return skip_word(&text, "{") && skip_word(&text, "'descr'") && skip_word(&text, ":") &&
           parse_type(&text, header->type) && skip_word(&text, ",") &&
           skip_word(&text, "'fortran_order'") && skip_word(&text, ":") &&
           skip_word(&text, "False") && skip_word(&text, ",") && skip_word(&text, "'shape'") &&
           skip_word(&text, ":") && parse_shape(&text, header) && (skip_word(&text, ",") || true) &&
           skip_word(&text, "}") && skip_word(&text, "\n") && *text == '\0';
}

static int parse_header(const char *path, const struct file *file, struct header *out,
                        struct iso_fault *fault)
{
    struct header header = {{0}, {0}, 0, 0};
    const unsigned char *b = (const unsigned char *)file->bytes;
    if (file->n < 12 || memcmp(b, "\x93NUMPY", 6) != 0) {
        return iso_fault_set(fault, -EBADMSG, "%s: not a .npy file", path);
    }
    if ((b[6] != 1 && b[6] != 2) || b[7] != 0) {
        return iso_fault_set(fault, -EBADMSG, "%s: unknown .npy version %d.%d", path, b[6], b[7]);
    }
    const size_t start = b[6] == 1 ? 10 : 12;
    size_t length = b[8] | (size_t)b[9] << 8;
    if (b[6] == 2) {
        length |= (size_t)b[10] << 16 | (size_t)b[11] << 24;
    }
    char text[1024];
    if (length >= sizeof text || length > file->n - start) {
        return iso_fault_set(fault, -EBADMSG, "%s: header truncated or too long", path);
    }
    memcpy(text, b + start, length);
    text[length] = '\0';
    if (!parse_dictionary(text, &header)) {
        return iso_fault_set(fault, -EBADMSG,
                             "%s: not the header of a C-ordered array of 1 to 3 dimensions", path);
    }
    header.data_offset = start + length;
    *out = header;
    return 0;
}

/* Opens and parses the file, and checks that the data are n_items of the size in the type's digit.
 */
static int load_file(const char *path, struct file *file, struct header *header,
                     struct iso_fault *fault)
{
    struct file loaded = {NULL, 0};
    struct header parsed;
    int error = iso_file_read(path, FILE_BYTES_MAX, &loaded.bytes, &loaded.n, fault);
    if (error == 0) {
        error = parse_header(path, &loaded, &parsed, fault);
    }
    if (error == 0) {
        const size_t size = parsed.type[2] == '2' ? 2 : 4;
        const size_t present = loaded.n - parsed.data_offset;
        if (present != parsed.n_items * size) {
            error = iso_fault_set(fault, -EBADMSG, "%s: %zu bytes of data, expected %zu", path,
                                  present, parsed.n_items * size);
        }
    }
    if (error != 0) {
        free(loaded.bytes);
        return error;
    }
    *file = loaded;
    *header = parsed;
    return 0;
}

/* Converts the file's item that begins at `bytes` and stores its value in memory. */
typedef void take_item(const unsigned char *bytes, void *out);

static uint32_t u32_at(const unsigned char *b)
{
    return (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

static void take_half(const unsigned char *bytes, void *out)
{
    const float value = sim_npy_float_of_half((uint16_t)(bytes[0] | bytes[1] << 8));
    memcpy(out, &value, sizeof value);
}

static void take_float(const unsigned char *bytes, void *out)
{
    const uint32_t bits = u32_at(bytes);
    float value;
    memcpy(&value, &bits, sizeof value);
    memcpy(out, &value, sizeof value);
}

static void take_u32(const unsigned char *bytes, void *out)
{
    const uint32_t value = u32_at(bytes);
    memcpy(out, &value, sizeof value);
}

/* A type that a file may have, and the conversion of its items to the caller's items of 4 bytes. */
struct item {
    const char *type;
    size_t size;
    take_item *take;
};

_Static_assert(sizeof(float) == ITEM_BYTES, "items of both readers have as many bytes");

static const struct item *find_item(const struct item *items, size_t n_items, const char *type)
{
    for (size_t i = 0; i < n_items; i++) {
        if (strcmp(items[i].type, type) == 0) {
            return &items[i];
        }
    }
    return NULL;
}

/* Reads a whole array of one of these types; `wanted` names the types in faults. */
static int read_array(const char *path, const struct item *items, size_t n_items,
                      const char *wanted, struct sim_npy_shape *shape, void **out,
                      struct iso_fault *fault)
{
    struct file file;
    struct header header;
    int error = load_file(path, &file, &header, fault);
    if (error != 0) {
        return error;
    }
    unsigned char *values = NULL;
    const struct item *item = find_item(items, n_items, header.type);
    if (!item) {
        error = iso_fault_set(fault, -EBADMSG, "%s: type is '%s', expected %s", path, header.type,
                              wanted);
        goto out;
    }
    values = malloc(header.n_items * ITEM_BYTES);
    if (!values) {
        error = iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
        goto out;
    }
    for (size_t i = 0; i < header.n_items; i++) {
        item->take((const unsigned char *)file.bytes + header.data_offset + i * item->size,
                   values + i * ITEM_BYTES);
    }
    *shape = header.shape;
    *out = values;
out:
    free(file.bytes);
    return error;
}

int sim_npy_read_floats(const char *path, struct sim_npy_shape *shape, float **out,
                        struct iso_fault *fault)
{
    static const struct item items[] = {{"<f4", 4, take_float}, {"<f2", 2, take_half}};
    void *values = NULL;
    const int error = read_array(path, items, 2, "'<f4' or '<f2'", shape, &values, fault);
    if (error == 0) {
        *out = values;
    }
    return error;
}

int sim_npy_read_u32(const char *path, struct sim_npy_shape *shape, uint32_t **out,
                     struct iso_fault *fault)
{
    static const struct item items[] = {{"<u4", 4, take_u32}};
    void *values = NULL;
    const int error = read_array(path, items, 1, "'<u4'", shape, &values, fault);
    if (error == 0) {
        *out = values;
    }
    return error;
}

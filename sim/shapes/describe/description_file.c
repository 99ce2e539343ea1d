#include "sim/shapes/describe/description_file.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/base/bytes.h"
#include "core/base/crc32.h"
#include "drivers/base/path.h"
#include "drivers/file/file.h"
#include "sim/base/result_file.h"

static const char magic[8] = "isoshp01";

enum {
    NUMBERS = 5 + ISO_SHAPE_PARTS_MAX, /* n_vertices, four sizes and those of the parts */
    HEADER = sizeof magic + 4 * NUMBERS,
    CHECK = 4,
    SIZE_MOST = 1 << 28, /* values of one description */
};

struct sizes {
    size_t local, weight, whole;
};

/* -EBADMSG for sizes that no description has. */
static int sizes_of(const struct iso_shape_description *d, struct sizes *out)
{
    if (d->n_bags < 0 || d->n_bags > ISO_SHAPE_BAGS_MAX || d->n_points < 0 || d->n_values < 0 ||
        d->n_parts < 0 || d->n_parts > ISO_SHAPE_PARTS_MAX) {
        return -EBADMSG;
    }
    const double local = (double)d->n_bags * d->n_points * d->n_values;
    double whole = 0.0;
    for (int p = 0; p < d->n_parts; p++) {
        whole += d->part_size[p] < 0 ? (double)SIZE_MOST : (double)d->part_size[p];
    }
    if (local >= SIZE_MOST || whole >= SIZE_MOST) {
        return -EBADMSG;
    }
    *out = (struct sizes){(size_t)local, d->n_bags ? (size_t)d->n_points : 0, (size_t)whole};
    return 0;
}

struct contents {
    const uint8_t *bytes;
    size_t size;
};

static void write_contents(const void *context, FILE *out)
{
    const struct contents *contents = context;
    (void)fwrite(contents->bytes, 1, contents->size, out);
}

static uint8_t *put_floats(uint8_t *at, const float *value, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        at = iso_put_f32(at, value[i]);
    }
    return at;
}

static int pack(int32_t n_vertices, const struct iso_shape_description *d, struct contents *out)
{
    struct sizes sizes;
    if (sizes_of(d, &sizes)) {
        return -EFBIG;
    }
    const size_t floats = sizes.local + sizes.weight + sizes.whole;
    const size_t size = HEADER + 4 * floats + CHECK;
    uint8_t *bytes = malloc(size);
    if (!bytes) {
        return -ENOMEM;
    }
    uint8_t *at = iso_put_bytes(bytes, magic, sizeof magic);
    const int32_t numbers[] = {n_vertices, d->n_bags, d->n_points, d->n_values, d->n_parts};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        at = iso_put_u32(at, (uint32_t)numbers[i]);
    }
    for (int p = 0; p < ISO_SHAPE_PARTS_MAX; p++) {
        at = iso_put_u32(at, (uint32_t)d->part_size[p]);
    }
    at = put_floats(at, d->local, sizes.local);
    at = put_floats(at, d->weight, sizes.weight);
    at = put_floats(at, d->whole, sizes.whole);
    (void)iso_put_u32(at, iso_crc32(0, bytes, size - CHECK));
    *out = (struct contents){bytes, size};
    return 0;
}

int sim_description_write(const char *directory, const char *name, int32_t n_vertices,
                          const struct iso_shape_description *description, struct iso_fault *fault)
{
    struct contents contents = {NULL, 0};
    char path[PATH_MAX], draft[PATH_MAX], draft_name[NAME_MAX];
    int error = pack(n_vertices, description, &contents);
    if (error) {
        return iso_fault_set(fault, error, "%s: %s", name, strerror(-error));
    }
    (void)snprintf(draft_name, sizeof draft_name, "%s.%ld-%p", name, (long)getpid(),
                   (const void *)contents.bytes);
    error = iso_path_join(directory, name, path, fault);
    if (!error) {
        error = iso_path_join(directory, draft_name, draft, fault);
    }
    if (!error) {
        error = sim_result_file(directory, draft_name, write_contents, &contents, fault);
    }
    if (!error && rename(draft, path) != 0) {
        error = iso_fault_set(fault, -errno, "%s: %s", path, strerror(errno));
        (void)unlink(draft);
    }
    free((void *)(uintptr_t)contents.bytes);
    return error;
}

static float *take_floats(const uint8_t **at, size_t n)
{
    float *value = malloc((n + 1) * sizeof *value);
    for (size_t i = 0; value && i < n; i++, *at += 4) {
        const uint32_t bits = iso_get_u32(*at);
        memcpy(&value[i], &bits, sizeof bits);
    }
    return value;
}

static int unpack(const uint8_t *bytes, size_t size, int32_t *n_vertices,
                  struct iso_shape_description *d)
{
    struct sizes sizes;
    if (size < HEADER + CHECK || memcmp(bytes, magic, sizeof magic) != 0 ||
        iso_get_u32(&bytes[size - CHECK]) != iso_crc32(0, bytes, size - CHECK)) {
        return -EBADMSG;
    }
    int32_t number[NUMBERS];
    const uint8_t *at = bytes + sizeof magic;
    for (int i = 0; i < NUMBERS; i++, at += 4) {
        number[i] = (int32_t)iso_get_u32(at);
    }
    d->n_bags = number[1];
    d->n_points = number[2];
    d->n_values = number[3];
    d->n_parts = number[4];
    memcpy(d->part_size, &number[5], sizeof d->part_size);
    if (sizes_of(d, &sizes) ||
        size != HEADER + 4 * (sizes.local + sizes.weight + sizes.whole) + CHECK) {
        return -EBADMSG;
    }
    d->local = d->n_bags ? take_floats(&at, sizes.local) : NULL;
    d->weight = d->n_bags ? take_floats(&at, sizes.weight) : NULL;
    d->whole = take_floats(&at, sizes.whole);
    if (!d->whole || (d->n_bags && (!d->local || !d->weight))) {
        return -ENOMEM;
    }
    *n_vertices = number[0];
    return 0;
}

int sim_description_read(const char *path, int32_t *n_vertices, struct iso_shape_description **out,
                         struct iso_fault *fault)
{
    char *bytes = NULL;
    size_t size = 0;
    int error = iso_file_read(path, (size_t)4 * SIZE_MOST, &bytes, &size, fault);
    if (error) {
        return error;
    }
    struct iso_shape_description *d = calloc(1, sizeof *d);
    error = d ? unpack((const uint8_t *)bytes, size, n_vertices, d) : -ENOMEM;
    free(bytes);
    if (error) {
        iso_shape_description_free(d);
        return iso_fault_set(fault, error, "%s: %s", path,
                             error == -ENOMEM ? "out of memory" : "damaged, or of another version");
    }
    *out = d;
    return 0;
}

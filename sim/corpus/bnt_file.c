#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "core/base/bytes.h"
#include "sim/corpus/scan_file.h"

enum { PLANES = 5 };

static const double coordinate_max_mm = 1e5;

/* The unread part of the file. */
struct reader {
    const uint8_t *at;
    size_t left;
};

/* The next n bytes, or NULL if fewer are left. */
static const uint8_t *take(struct reader *reader, size_t n)
{
    const uint8_t *at = reader->at;
    if (reader->left < n) {
        return NULL;
    }
    reader->at += n;
    reader->left -= n;
    return at;
}

static double real(const uint8_t *bytes)
{
    uint64_t bits = (uint64_t)iso_get_u32(bytes) | (uint64_t)iso_get_u32(bytes + 4) << 32;
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static void read_points(const uint8_t *values, double missing, struct sim_scan_grid *grid)
{
    const size_t n = (size_t)grid->rows * (size_t)grid->columns;
    for (size_t i = 0; i < n; i++) {
        struct iso_vec3 p = {real(values + 8 * i), real(values + 8 * (n + i)),
                             real(values + 8 * (2 * n + i))};
        const bool measured = p.z != missing && fabs(p.x) < coordinate_max_mm &&
                              fabs(p.y) < coordinate_max_mm && fabs(p.z) < coordinate_max_mm;
        grid->point_mm[i] = measured ? p : iso_vec3(NAN, 0.0, 0.0);
    }
}

int sim_scan_parse_bnt(const char *name, const char *bytes, size_t size, struct iso_mesh **out,
                       struct iso_fault *fault)
{
    struct reader reader = {(const uint8_t *)bytes, size};
    struct sim_scan_grid grid = {0};
    const uint8_t *head = take(&reader, 14);
    const uint8_t *picture = head ? take(&reader, iso_get_u16(head + 12)) : NULL;
    const uint8_t *count = picture ? take(&reader, 4) : NULL;
    if (!count) {
        return iso_fault_set(fault, -EBADMSG, "%s: truncated", name);
    }
    const double rows = iso_get_u16(head), columns = iso_get_u16(head + 2);
    int error = sim_scan_grid_new(name, rows, columns, &grid, fault);
    if (error) {
        return error;
    }
    const size_t n = PLANES * (size_t)grid.rows * (size_t)grid.columns;
    const uint8_t *values = iso_get_u32(count) == n ? take(&reader, 8 * n) : NULL;
    if (values && reader.left == 0) {
        read_points(values, real(head + 4), &grid);
        error = sim_scan_grid_mesh(name, &grid, out, fault);
    } else {
        error = iso_fault_set(fault, -EBADMSG, "%s: does not hold %d x %d x %d values", name,
                              grid.rows, grid.columns, PLANES);
    }
    sim_scan_grid_done(&grid);
    return error;
}

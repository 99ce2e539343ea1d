#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim/corpus/scan_file.h"

/* Larger coordinates do not belong to a face; unmeasured pixels have -999999. */
static const double coordinate_max_mm = 1e5;

/* The position of the parser. */
struct reader {
    const char *name, *at;
    struct iso_fault *fault;
};

static int read_number(struct reader *reader, const char *what, double *out)
{
    char *end;
    const double value = strtod(reader->at, &end);
    if (end == reader->at || !isfinite(value)) {
        return iso_fault_set(reader->fault, -EBADMSG, "%s: ends, or has no number, in its %s",
                             reader->name, what);
    }
    reader->at = end;
    *out = value;
    return 0;
}

/* Reads a size, for example "480 rows". */
static int read_size(struct reader *reader, const char *word, double *out)
{
    const int error = read_number(reader, word, out);
    if (error) {
        return error;
    }
    reader->at += strspn(reader->at, " \t");
    const size_t length = strlen(word);
    if (strncmp(reader->at, word, length) != 0) {
        return iso_fault_set(reader->fault, -EBADMSG, "%s: does not say how many %s", reader->name,
                             word);
    }
    reader->at += length;
    return 0;
}

/* Skips the line "pixels (flag X Y Z):", which names the planes. */
static int skip_title(struct reader *reader)
{
    reader->at += strspn(reader->at, " \t\r\n");
    const char *end = strchr(reader->at, '\n');
    if (strncmp(reader->at, "pixels", 6) != 0 || !end) {
        return iso_fault_set(reader->fault, -EBADMSG, "%s: no pixels follow its size",
                             reader->name);
    }
    reader->at = end;
    return 0;
}

static int read_planes(struct reader *reader, struct sim_scan_grid *grid)
{
    static const char *const planes[] = {"flags", "x", "y", "z"};
    const size_t n = (size_t)grid->rows * (size_t)grid->columns;
    int error = 0;
    for (int plane = 0; plane < 4; plane++) {
        for (size_t i = 0; i < n && !error; i++) {
            double value = 0.0;
            error = read_number(reader, planes[plane], &value);
            struct iso_vec3 *p = &grid->point_mm[i];
            if (plane == 0) {
                p->x = value != 0.0 ? 0.0 : NAN;
            } else if (fabs(value) > coordinate_max_mm) {
                p->x = NAN;
            } else if (plane == 1) {
                p->x += value; /* an unmeasured pixel stays NAN */
            } else {
                *(plane == 2 ? &p->y : &p->z) = value;
            }
        }
    }
    return error;
}

int sim_scan_parse_abs(const char *name, const char *bytes, size_t size, struct iso_mesh **out,
                       struct iso_fault *fault)
{
    struct reader reader = {name, bytes, fault};
    struct sim_scan_grid grid = {0};
    double rows, columns;
    (void)size; /* ends with a NUL */
    int error = read_size(&reader, "rows", &rows);
    if (!error) {
        error = read_size(&reader, "columns", &columns);
    }
    if (!error) {
        error = skip_title(&reader);
    }
    if (!error) {
        error = sim_scan_grid_new(name, rows, columns, &grid, fault);
    }
    if (!error) {
        error = read_planes(&reader, &grid);
    }
    if (!error) {
        error = sim_scan_grid_mesh(name, &grid, out, fault);
    }
    sim_scan_grid_done(&grid);
    return error;
}

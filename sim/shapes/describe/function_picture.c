#include "sim/shapes/describe/function_picture.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "sim/lab/draw/png_file.h"
#include "sim/shapes/describe/shape_view.h"

enum { CELL_PX = 240, LABEL_PX = 34, COLUMNS = 4, ROWS_MAX = 16 };

struct sheet {
    const struct iso_mesh *mesh;
    const struct sim_array *critical; /* or NULL */
    cairo_t *cr;
};

/* The range of colours. */
struct range {
    double low, high;
    bool both_signs;
};

static int compare(const void *a, const void *b)
{
    const double *p = a, *q = b;
    return (*p > *q) - (*p < *q);
}

/* value [n] is sorted on return. */
static struct range range_of(double *value, int32_t n)
{
    qsort(value, (size_t)n, sizeof *value, compare);
    const double low = value[n / 100], high = value[n - 1 - n / 100];
    if (low < 0.0 && high > 0.0) {
        const double most = fmax(-low, high);
        return (struct range){-most, most, true};
    }
    return (struct range){low, high > low ? high : low + fmax(fabs(low), 1.0), false};
}

static int colours_of(const struct sim_array *array, int32_t column, struct range *shown,
                      double ends[2], struct sim_colour **out)
{
    const int32_t n = array->rows;
    double *value = malloc((size_t)n * sizeof *value);
    struct sim_colour *colour = malloc((size_t)n * sizeof *colour);
    if (!value || !colour) {
        free(value);
        free(colour);
        return -ENOMEM;
    }
    for (int32_t v = 0; v < n; v++) {
        value[v] = sim_array_item(array, v, column);
    }
    *shown = range_of(value, n);
    ends[0] = value[0];
    ends[1] = value[n - 1];
    for (int32_t v = 0; v < n; v++) {
        const double share = (sim_array_item(array, v, column) - shown->low) /
                             (shown->high - shown->low);
        colour[v] = shown->both_signs ? sim_colour_difference(share) : sim_colour_heat(share);
    }
    free(value);
    *out = colour;
    return 0;
}

static int draw_cell(const struct sheet *sheet, const struct sim_array *array, int32_t column,
                     double x, double y)
{
    struct sim_colour *colour = NULL;
    cairo_surface_t *picture = NULL;
    struct range shown = {0};
    double ends[2];
    char name[SIM_ARRAY_NAME_MAX + 16], values[64];
    int error = colours_of(array, column, &shown, ends, &colour);
    if (!error) {
        error = sim_shape_picture(sheet->mesh, colour, sheet->critical, CELL_PX, &picture);
    }
    free(colour);
    if (error) {
        return error;
    }
    cairo_set_source_surface(sheet->cr, picture, x, y);
    cairo_paint(sheet->cr);
    cairo_surface_destroy(picture);
    if (array->columns) {
        (void)snprintf(name, sizeof name, "%s[:, %d]", array->name, column);
    } else {
        (void)snprintf(name, sizeof name, "%s", array->name);
    }
    (void)snprintf(values, sizeof values, "%.4g to %.4g", ends[0], ends[1]);
    cairo_set_source_rgb(sheet->cr, 0.1, 0.1, 0.1);
    sim_picture_text(sheet->cr, name, x + 0.5 * CELL_PX, y + CELL_PX + 14.0, 0.5);
    cairo_set_source_rgb(sheet->cr, 0.4, 0.4, 0.4);
    sim_picture_text(sheet->cr, values, x + 0.5 * CELL_PX, y + CELL_PX + 28.0, 0.5);
    return 0;
}

static bool is_function(const struct iso_shape *shape, const struct sim_array *array)
{
    const bool number = array->type != SIM_ARRAY_INT || strcmp(array->name, "segment") == 0;
    return array->rows == shape->mesh->n_vertices && number &&
           strcmp(array->name, "vertices") != 0 && strcmp(array->name, "area") != 0;
}

/* Which columns are drawn: the first ones of few; of many, and of the eigenvectors, whose first
 * one is constant, others. Returns how many. */
static int columns_of(const struct sim_array *array, int32_t column[COLUMNS])
{
    const int32_t all = array->columns ? array->columns : 1;
    const bool eigenvectors = strcmp(array->name, "phi") == 0;
    int n = 0;
    for (; n < COLUMNS && n + eigenvectors < all; n++) {
        if (eigenvectors) {
            column[n] = n + 1;
        } else {
            column[n] = all <= 2 * COLUMNS ? n : n * (all - 1) / (COLUMNS - 1);
        }
    }
    return n;
}

/* Draws the rows on a white sheet. */
static int draw_rows(struct sheet *sheet, const struct sim_array *const *row, int n,
                     cairo_surface_t *surface)
{
    int error = 0;
    sheet->cr = cairo_create(surface);
    cairo_set_source_rgb(sheet->cr, 1, 1, 1);
    cairo_paint(sheet->cr);
    cairo_select_font_face(sheet->cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                           CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(sheet->cr, 12.0);
    for (int r = 0; r < n; r++) {
        int32_t column[COLUMNS];
        const int drawn = columns_of(row[r], column);
        for (int c = 0; c < drawn && !error; c++) {
            error = draw_cell(sheet, row[r], column[c], c * CELL_PX, r * (CELL_PX + LABEL_PX));
        }
    }
    cairo_destroy(sheet->cr);
    return error;
}

int sim_function_picture(const struct iso_shape *shape, const struct sim_arrays *arrays,
                         const char *path, struct iso_fault *fault)
{
    const struct sim_array *row[ROWS_MAX];
    int n = 0, error = 0;
    struct sheet sheet = {.mesh = shape->mesh};
    struct iso_mesh *facing = NULL;
    for (int i = 0; i < arrays->n && n < ROWS_MAX; i++) {
        const struct sim_array *array = &arrays->array[i];
        if (is_function(shape, array)) {
            row[n++] = array;
        }
        sheet.critical = strcmp(array->name, "critical") == 0 ? array : sheet.critical;
    }
    if (n == 0) {
        return 0;
    }
    if (shape->is_cloud) {
        error = sim_shape_face_viewer(shape->mesh, &facing);
        sheet.mesh = facing;
    }
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, CELL_PX * COLUMNS,
                                                          (CELL_PX + LABEL_PX) * n);
    error = error ? error : draw_rows(&sheet, row, n, surface);
    iso_mesh_free(facing);
    if (error) {
        cairo_surface_destroy(surface);
        return iso_fault_set(fault, error, "%s: %s", path, strerror(-error));
    }
    return sim_png_file_write(surface, path, fault);
}

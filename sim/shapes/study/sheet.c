#include "sim/shapes/study/sheet.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim/lab/draw/png_file.h"
#include "sim/shapes/describe/shape_view.h"

enum { CELL_PX = 120, LABEL_PX = 18, ROWS_MAX = 20, COLUMNS_MAX = 16 };

static const uint32_t query_hex = 0xc8b8a0, match_hex = 0xd0a070, wrong_hex = 0x8fd694;

/* One picture of a sheet. */
struct cell {
    int32_t row;             /* row of the manifest; -1: empty */
    const char *path, *name; /* instead of a row: a file, and what stands below it; or NULL */
    bool query, wrong;
};

struct sheet {
    const struct sim_bank_options *how;
    int n_rows, n_columns;
    struct cell cell[ROWS_MAX][COLUMNS_MAX];
};

static struct sim_colour *linear_colours(const struct iso_coloured_mesh *mesh)
{
    struct sim_colour *out = calloc((size_t)mesh->mesh->n_vertices, sizeof *out);
    for (int32_t v = 0; out && v < mesh->mesh->n_vertices; v++) {
        const float *c = mesh->colour[v].channel;
        out[v] = sim_colour_hex((uint32_t)lrintf(255.0f * c[0]) << 16 |
                                (uint32_t)lrintf(255.0f * c[1]) << 8 |
                                (uint32_t)lrintf(255.0f * c[2]));
    }
    return out;
}

static int draw_mesh(const struct iso_coloured_mesh *mesh, const struct cell *cell,
                     cairo_surface_t **out)
{
    struct sim_canvas *canvas = NULL;
    struct sim_scene *scene = NULL;
    struct sim_colour *colours = mesh->colour && !cell->wrong ? linear_colours(mesh) : NULL;
    struct sim_view view = sim_shape_view(mesh->mesh);
    const uint32_t right_hex = cell->query ? query_hex : match_hex;
    const struct sim_surface_style style = {
        .base = sim_colour_hex(cell->wrong ? wrong_hex : right_hex),
        .vertex = colours,
    };
    int error = sim_canvas_new(CELL_PX, CELL_PX, sim_colour_hex(cell->query ? 0xd4dde8 : 0xf4f6f8),
                               sim_colour_hex(cell->query ? 0xa8b6c8 : 0xd8dee4), &canvas);
    if (!error) {
        error = sim_scene_new(mesh->mesh, &view, canvas, &scene);
    }
    if (!error) {
        error = sim_scene_shade(scene, &style);
    }
    if (!error) {
        *out = sim_canvas_surface(canvas);
    }
    sim_scene_free(scene);
    sim_canvas_free(canvas);
    free(colours);
    return error;
}

static int read_cell(const struct sheet *sheet, const struct cell *cell,
                     struct iso_coloured_mesh *mesh, struct iso_fault *fault)
{
    struct sim_bank_options how = *sheet->how;
    how.source.distortion = cell->query ? how.source.distortion : NULL;
    return cell->path ? sim_source_read(cell->path, cell->path, &how.source, NULL, mesh, fault)
                      : sim_bank_read(&how, cell->row, mesh, fault);
}

/* Gives a cloud triangles that can be drawn. */
static int cover_cloud(const struct sheet *sheet, struct iso_coloured_mesh *mesh)
{
    struct iso_mesh *surface = NULL;
    if (mesh->mesh->n_triangles > 0) {
        return 0;
    }
    const int error = sim_shape_cloud_surface(mesh->mesh, sheet->how->source.neighbours, &surface);
    if (!error) {
        iso_mesh_free(mesh->mesh);
        mesh->mesh = surface;
    }
    return error;
}

static int draw_cell(cairo_t *cr, const struct sheet *sheet, int row, int column,
                     struct iso_fault *fault)
{
    const struct cell *cell = &sheet->cell[row][column];
    const char *name = cell->path ? cell->name : sheet->how->manifest->rows[cell->row].class_name;
    struct iso_coloured_mesh mesh = {NULL, NULL};
    cairo_surface_t *picture = NULL;
    int error = read_cell(sheet, cell, &mesh, fault);
    if (error) {
        return error;
    }
    error = cover_cloud(sheet, &mesh);
    if (!error) {
        error = draw_mesh(&mesh, cell, &picture);
    }
    iso_coloured_mesh_done(&mesh);
    if (error) {
        return iso_fault_set(fault, error, "%s: cannot be drawn: %s", name, strerror(-error));
    }
    const double x = column * CELL_PX, y = row * (CELL_PX + LABEL_PX);
    cairo_set_source_surface(cr, picture, x, y);
    cairo_paint(cr);
    cairo_surface_destroy(picture);
    cairo_set_source_rgb(cr, 0.1, 0.1, 0.1);
    sim_picture_text(cr, name, x + 0.5 * CELL_PX, y + CELL_PX + 0.75 * LABEL_PX, 0.5);
    return 0;
}

static int draw_sheet(const struct sheet *sheet, const char *path, struct iso_fault *fault)
{
    cairo_surface_t *surface = cairo_image_surface_create(
        CAIRO_FORMAT_RGB24, CELL_PX * sheet->n_columns, (CELL_PX + LABEL_PX) * sheet->n_rows);
    cairo_t *cr = cairo_create(surface);
    cairo_set_source_rgb(cr, 1, 1, 1);
    cairo_paint(cr);
    cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cr, 11.0);
    int error = 0;
    for (int r = 0; r < sheet->n_rows; r++) {
        for (int c = 0; c < sheet->n_columns && !error; c++) {
            error = sheet->cell[r][c].row < 0 && !sheet->cell[r][c].path
                        ? 0
                        : draw_cell(cr, sheet, r, c, fault);
        }
    }
    cairo_destroy(cr);
    if (error) {
        cairo_surface_destroy(surface);
        return error;
    }
    return sim_png_file_write(surface, path, fault);
}

static void clear_sheet(struct sheet *sheet, const struct sim_bank_options *how, int n_rows,
                        int columns)
{
    memset(sheet, 0, sizeof *sheet);
    sheet->how = how;
    sheet->n_rows = n_rows < ROWS_MAX ? n_rows : ROWS_MAX;
    sheet->n_columns = columns < COLUMNS_MAX ? columns : COLUMNS_MAX;
    for (int r = 0; r < ROWS_MAX; r++) {
        for (int c = 0; c < COLUMNS_MAX; c++) {
            sheet->cell[r][c].row = -1;
        }
    }
}

int sim_sheet_classes(const struct sim_bank_options *how, int columns, const char *path,
                      struct iso_fault *fault)
{
    struct sheet sheet;
    int filled[ROWS_MAX] = {0};
    clear_sheet(&sheet, how, how->manifest->n_classes, columns);
    for (int32_t i = 0; i < how->manifest->n; i++) {
        const int32_t c = how->manifest->class_of[i];
        if (c < sheet.n_rows && filled[c] < sheet.n_columns) {
            sheet.cell[c][filled[c]++].row = i;
        }
    }
    return draw_sheet(&sheet, path, fault);
}

/* Fills a row with the items nearest to a query, nearest first. The query's own item is left out.
 */
static void fill_matches(struct sheet *sheet, int r, const struct sim_features *features,
                         int32_t query, const double *distance)
{
    double last = -INFINITY;
    int32_t last_item = -1;
    for (int c = 1; c < sheet->n_columns; c++) {
        int32_t best = -1;
        for (int32_t i = 0; i < features->items->n; i++) {
            const bool after = distance[i] > last || (distance[i] == last && i > last_item);
            if (i != features->own[query] && after && (best < 0 || distance[i] < distance[best])) {
                best = i;
            }
        }
        if (best < 0) {
            break;
        }
        last = distance[best];
        last_item = best;
        sheet->cell[r][c].row = features->items->row[best];
        sheet->cell[r][c].wrong = features->item_class[best] != features->query_class[query];
    }
}

int sim_sheet_matches(const struct sim_bank_options *how, const struct sim_features *features,
                      const double *distance, int columns, const char *path,
                      struct iso_fault *fault)
{
    struct sheet sheet;
    bool shown[ROWS_MAX] = {false};
    clear_sheet(&sheet, how, features->manifest->n_classes, columns);
    for (int32_t q = 0; q < features->queries->n; q++) {
        const int32_t c = features->query_class[q];
        if (c < sheet.n_rows && !shown[c]) {
            shown[c] = true;
            sheet.cell[c][0].row = features->queries->row[q];
            sheet.cell[c][0].query = true;
            fill_matches(&sheet, c, features, q, distance + (size_t)q * (size_t)features->items->n);
        }
    }
    return draw_sheet(&sheet, path, fault);
}

int sim_sheet_files(const struct sim_source_options *source, const struct sim_sheet_file *file,
                    int n, const char *path, struct iso_fault *fault)
{
    const struct sim_bank_options how = {.source = *source};
    struct sheet sheet;
    clear_sheet(&sheet, &how, (n + COLUMNS_MAX - 1) / COLUMNS_MAX, n);
    for (int i = 0; i < n && i < ROWS_MAX * COLUMNS_MAX; i++) {
        struct cell *cell = &sheet.cell[i / COLUMNS_MAX][i % COLUMNS_MAX];
        cell->path = file[i].path;
        cell->name = file[i].name;
        cell->query = file[i].query;
    }
    return draw_sheet(&sheet, path, fault);
}

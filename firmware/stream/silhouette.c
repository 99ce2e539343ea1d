#include "firmware/stream/silhouette.h"

#include <math.h>
#include <string.h>

#include "firmware/stream/head_outline.h"

enum {
    CELL = 4, /* silhouette points along the side of a cell */
    CELL_COLUMNS = ISO_SILHOUETTE_COLUMNS / CELL,
    CELL_ROWS = ISO_SILHOUETTE_ROWS / CELL,
    HALF = CELL * CELL / 2
};

/* ---- which cells are near ---- */

struct range {
    double from_mm, to_mm;
};

static struct range near_range(int n, double distance_mm)
{
    /* Without a face: as far as a face is looked for. With one: the body of that person. */
    return n == 0 ? (struct range){1.0, 1500.0}
                  : (struct range){distance_mm - 250.0, distance_mm + 350.0};
}

static bool is_near(const struct iso_frame *frame, const struct iso_silhouette_scale *scale,
                    const struct range *near, int column, int row)
{
    const int u = (int)floor((column + 0.5 - scale->left) * scale->px);
    const int v = (int)floor((row + 0.5 - scale->top) * scale->px);
    if (u < 0 || v < 0 || u >= frame->width_px || v >= frame->height_px) {
        return false;
    }
    const double mm = (double)iso_frame_depth_at(frame, u, v);
    return mm >= near->from_mm && mm <= near->to_mm;
}

static void sample_cells(const struct iso_frame *frame, const struct range *near,
                         bool cells[CELL_ROWS][CELL_COLUMNS])
{
    const struct iso_silhouette_scale scale = iso_silhouette_scale_of(frame);
    int counts[CELL_ROWS][CELL_COLUMNS] = {{0}};
    for (int row = 0; row < ISO_SILHOUETTE_ROWS; row++) {
        for (int column = 0; column < ISO_SILHOUETTE_COLUMNS; column++) {
            counts[row / CELL][column / CELL] += is_near(frame, &scale, near, column, row);
        }
    }
    for (int row = 0; row < CELL_ROWS; row++) {
        for (int column = 0; column < CELL_COLUMNS; column++) {
            cells[row][column] = counts[row][column] >= HALF;
        }
    }
}

/* ---- the head ---- */

struct box {
    double left, right, top, bottom; /* silhouette points */
};

static struct box box_of(int16_t outline[][2], int n)
{
    struct box box = {INFINITY, -INFINITY, INFINITY, -INFINITY};
    for (int i = 0; i < n; i++) {
        const double x = (double)outline[i][0] / ISO_OUTLINE_UNITS;
        const double y = (double)outline[i][1] / ISO_OUTLINE_UNITS;
        box = (struct box){fmin(box.left, x), fmax(box.right, x), fmin(box.top, y),
                           fmax(box.bottom, y)};
    }
    return box;
}

/* Clears the head: three times as wide as the mean head, and all above its chin. */
static void clear_head(int16_t outline[][2], int n, bool cells[CELL_ROWS][CELL_COLUMNS])
{
    const struct box head = box_of(outline, n);
    const double width = head.right - head.left;
    for (int row = 0; row < CELL_ROWS; row++) {
        for (int column = 0; column < CELL_COLUMNS; column++) {
            const double x = (column + 0.5) * CELL;
            if (row * CELL < head.bottom && x > head.left - width && x < head.right + width) {
                cells[row][column] = false;
            }
        }
    }
}

/* The part of a row inside a convex outline. Returns false if there is none. */
static bool span_of(int16_t outline[][2], int n, double y, double *from, double *to)
{
    *from = INFINITY;
    *to = -INFINITY;
    for (int i = 0; i < n; i++) {
        const int16_t *a = outline[i];
        const int16_t *b = outline[(i + 1) % n];
        const double ay = (double)a[1] / ISO_OUTLINE_UNITS;
        const double by = (double)b[1] / ISO_OUTLINE_UNITS;
        if ((ay <= y) != (by <= y)) {
            const double x = (a[0] + (b[0] - a[0]) * (y - ay) / (by - ay)) / ISO_OUTLINE_UNITS;
            *from = fmin(*from, x);
            *to = fmax(*to, x);
        }
    }
    return *from < *to;
}

/* ---- drawing ---- */

static double cell_at(bool cells[CELL_ROWS][CELL_COLUMNS], int column, int row)
{
    const int c = column < 0 ? 0 : column >= CELL_COLUMNS ? CELL_COLUMNS - 1 : column;
    const int r = row < 0 ? 0 : row >= CELL_ROWS ? CELL_ROWS - 1 : row;
    return cells[r][c];
}

/* Between the centres of the cells, their values are interpolated: this rounds the corners. */
static bool is_filled(bool cells[CELL_ROWS][CELL_COLUMNS], int column, int row)
{
    const double x = (column + 0.5) / CELL - 0.5;
    const double y = (row + 0.5) / CELL - 0.5;
    const int c = (int)floor(x);
    const int r = (int)floor(y);
    const double fx = x - c;
    const double fy = y - r;
    const double above = (1.0 - fx) * cell_at(cells, c, r) + fx * cell_at(cells, c + 1, r);
    const double below = (1.0 - fx) * cell_at(cells, c, r + 1) + fx * cell_at(cells, c + 1, r + 1);
    return (1.0 - fy) * above + fy * below > 0.5;
}

void iso_silhouette_draw(const struct iso_frame *frame, int16_t outline[][2], int n,
                         double distance_mm,
                         uint8_t bits[ISO_SILHOUETTE_ROWS][ISO_SILHOUETTE_STRIDE])
{
    bool cells[CELL_ROWS][CELL_COLUMNS];
    const struct range near = near_range(n, distance_mm);
    sample_cells(frame, &near, cells);
    if (n > 0) {
        clear_head(outline, n, cells);
    }
    memset(bits, 0, (size_t)ISO_SILHOUETTE_ROWS * ISO_SILHOUETTE_STRIDE);
    for (int row = 0; row < ISO_SILHOUETTE_ROWS; row++) {
        double from = 0.0;
        double to = 0.0;
        const bool head = span_of(outline, n, row + 0.5, &from, &to);
        for (int column = 0; column < ISO_SILHOUETTE_COLUMNS; column++) {
            const double x = column + 0.5;
            if ((head && x >= from && x < to) || is_filled(cells, column, row)) {
                bits[row][column / 8] |= (uint8_t)(0x80 >> (column % 8));
            }
        }
    }
}

void iso_relief_sample(const struct iso_frame *frame, struct iso_relief_record *out)
{
    int factor = 1;
    while (frame->width_px > factor * ISO_RELIEF_COLUMNS ||
           frame->height_px > factor * ISO_RELIEF_ROWS) {
        factor++;
    }
    out->columns = (frame->width_px + factor - 1) / factor;
    out->rows = (frame->height_px + factor - 1) / factor;
    uint16_t *to = out->depth_mm;
    for (int row = 0; row < out->rows; row++) {
        for (int column = 0; column < out->columns; column++) {
            const double mm = round(
                (double)iso_frame_depth_at(frame, column * factor, row * factor));
            *to++ = mm < 65536.0 ? (uint16_t)mm : 0;
        }
    }
}

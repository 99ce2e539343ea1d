#include "firmware/stream/silhouette.h"

#include <math.h>
#include <string.h>

#include "firmware/stream/head_outline.h"

enum {
    CELL = 4, /* silhouette points along the side of a cell */
    CELL_COLUMNS = ISO_SILHOUETTE_COLUMNS / CELL,
    CELL_ROWS = ISO_SILHOUETTE_ROWS / CELL,
    HALF = CELL * CELL / 2,
    CELLS_MIN = 4, /* fewer near cells are nobody */
};

/* ---- which cells are near ---- */

/* As far as a face is looked for. */
static const double near_mm = 1500.0;

static bool is_near(const struct iso_frame *frame, const struct iso_silhouette_scale *scale,
                    int column, int row)
{
    const int u = (int)floor((column + 0.5 - scale->left) * scale->px);
    const int v = (int)floor((row + 0.5 - scale->top) * scale->px);
    if (u < 0 || v < 0 || u >= frame->width_px || v >= frame->height_px) {
        return false;
    }
    const double mm = (double)iso_frame_depth_at(frame, u, v);
    return mm > 0.0 && mm <= near_mm;
}

static void sample_cells(const struct iso_frame *frame, bool cells[CELL_ROWS][CELL_COLUMNS])
{
    const struct iso_silhouette_scale scale = iso_silhouette_scale_of(frame);
    int counts[CELL_ROWS][CELL_COLUMNS] = {{0}};
    for (int row = 0; row < ISO_SILHOUETTE_ROWS; row++) {
        for (int column = 0; column < ISO_SILHOUETTE_COLUMNS; column++) {
            counts[row / CELL][column / CELL] += is_near(frame, &scale, column, row);
        }
    }
    for (int row = 0; row < CELL_ROWS; row++) {
        for (int column = 0; column < CELL_COLUMNS; column++) {
            cells[row][column] = counts[row][column] >= HALF;
        }
    }
}

/* ---- something is near ---- */

struct ellipse {
    double x, y, a, b; /* middle and half axes, silhouette points; a == 0: nothing */
};

/* The nearest of the sizes 1, 1.25, 1.25^2, ... */
static double step_of(double size)
{
    return pow(1.25, round(log(size) / log(1.25)));
}

/* An upright ellipse about the middle of the near cells, with about their area. */
static struct ellipse ellipse_of(bool cells[CELL_ROWS][CELL_COLUMNS])
{
    static const double aspect = 1.3;
    double n = 0.0;
    double x = 0.0;
    double y = 0.0;
    for (int row = 0; row < CELL_ROWS; row++) {
        for (int column = 0; column < CELL_COLUMNS; column++) {
            n += cells[row][column];
            x += cells[row][column] ? column + 0.5 : 0.0;
            y += cells[row][column] ? row + 0.5 : 0.0;
        }
    }
    if (n < CELLS_MIN) {
        return (struct ellipse){0};
    }
    const double a = step_of(sqrt(n * CELL * CELL / (M_PI * aspect)));
    return (struct ellipse){CELL * (floor(x / n) + 0.5), CELL * (floor(y / n) + 0.5), a,
                            aspect * a};
}

static bool is_in_ellipse(const struct ellipse *ellipse, double x, double y)
{
    const double dx = (x - ellipse->x) / ellipse->a;
    const double dy = (y - ellipse->y) / ellipse->b;
    return ellipse->a > 0.0 && dx * dx + dy * dy < 1.0;
}

/* ---- a head and shoulders ---- */

struct bust {
    int16_t (*outline)[2];
    int n;
    double x, chin, width, height; /* of the head, silhouette points */
};

static struct bust bust_of(int16_t outline[][2], int n)
{
    double least[2] = {INFINITY, INFINITY};
    double most[2] = {-INFINITY, -INFINITY};
    for (int i = 0; i < n; i++) {
        for (int axis = 0; axis < 2; axis++) {
            /* Not fmin() and fmax(): gcc 12.2 for arm64 fails on them here at -O3. */
            const double at = (double)outline[i][axis] / ISO_OUTLINE_UNITS;
            least[axis] = at < least[axis] ? at : least[axis];
            most[axis] = at > most[axis] ? at : most[axis];
        }
    }
    return (struct bust){
        outline, n, 0.5 * (least[0] + most[0]), most[1], most[0] - least[0], most[1] - least[1]};
}

/* Half the width of neck and shoulders at a row: the same for everybody. */
static double half_width_at(const struct bust *bust, double y)
{
    const double down = (y - bust->chin) / bust->height; /* from the chin, in heads */
    const double shoulder = fmin(1.0, fmax(0.0, (down - 0.12) / 0.4));
    const double round_off = sqrt(1.0 - (1.0 - shoulder) * (1.0 - shoulder));
    return down < -0.15 ? 0.0 : bust->width * (0.32 + 0.95 * round_off);
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

static void set(uint8_t bits[ISO_SILHOUETTE_ROWS][ISO_SILHOUETTE_STRIDE], int column, int row)
{
    bits[row][column / 8] |= (uint8_t)(0x80 >> (column % 8));
}

static void draw_bust(int16_t outline[][2], int n,
                      uint8_t bits[ISO_SILHOUETTE_ROWS][ISO_SILHOUETTE_STRIDE])
{
    const struct bust bust = bust_of(outline, n);
    for (int row = 0; row < ISO_SILHOUETTE_ROWS; row++) {
        double from = 0.0;
        double to = 0.0;
        const bool head = span_of(outline, n, row + 0.5, &from, &to);
        const double half = half_width_at(&bust, row + 0.5);
        for (int column = 0; column < ISO_SILHOUETTE_COLUMNS; column++) {
            const double x = column + 0.5;
            if ((head && x >= from && x < to) || fabs(x - bust.x) < half) {
                set(bits, column, row);
            }
        }
    }
}

static void draw_near(const struct iso_frame *frame,
                      uint8_t bits[ISO_SILHOUETTE_ROWS][ISO_SILHOUETTE_STRIDE])
{
    bool cells[CELL_ROWS][CELL_COLUMNS];
    sample_cells(frame, cells);
    const struct ellipse ellipse = ellipse_of(cells);
    for (int row = 0; row < ISO_SILHOUETTE_ROWS; row++) {
        for (int column = 0; column < ISO_SILHOUETTE_COLUMNS; column++) {
            if (is_in_ellipse(&ellipse, column + 0.5, row + 0.5)) {
                set(bits, column, row);
            }
        }
    }
}

void iso_silhouette_draw(const struct iso_frame *frame, int16_t outline[][2], int n,
                         uint8_t bits[ISO_SILHOUETTE_ROWS][ISO_SILHOUETTE_STRIDE])
{
    memset(bits, 0, (size_t)ISO_SILHOUETTE_ROWS * ISO_SILHOUETTE_STRIDE);
    if (n > 0) {
        draw_bust(outline, n, bits);
    } else {
        draw_near(frame, bits);
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

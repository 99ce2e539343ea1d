#include "firmware/stream/head_outline.h"

#include <math.h>
#include <stdlib.h>

/* ---- which points of the head can lie on its outline ---- */

/* Directions that are spread evenly over the sphere (the Fibonacci lattice; Gonzalez 2010). */
static struct iso_vec3 direction_of(int i)
{
    static const double golden_rad = 2.39996322972865332;
    const double y = 1.0 - 2.0 * (i + 0.5) / ISO_HEAD_OUTLINE_POINTS;
    const double r = sqrt(1.0 - y * y);
    return iso_vec3(r * cos(golden_rad * i), y, r * sin(golden_rad * i));
}

static uint32_t farthest(const struct iso_head_model *model, struct iso_vec3 direction)
{
    uint32_t best = 0;
    for (uint32_t v = 1; v < model->n_vertices; v++) {
        if (iso_dot(model->mean_mm[v], direction) > iso_dot(model->mean_mm[best], direction)) {
            best = v;
        }
    }
    return best;
}

static bool has_point(const struct iso_head_outline *outline, struct iso_vec3 point)
{
    for (int i = 0; i < outline->n; i++) {
        const struct iso_vec3 apart = iso_sub(outline->point_mm[i], point);
        if (iso_dot(apart, apart) == 0.0) {
            return true;
        }
    }
    return false;
}

void iso_head_outline_init(struct iso_head_outline *outline, const struct iso_head_model *model)
{
    outline->n = 0;
    for (int i = 0; model->n_vertices > 0 && i < ISO_HEAD_OUTLINE_POINTS; i++) {
        const struct iso_vec3 point = model->mean_mm[farthest(model, direction_of(i))];
        if (!has_point(outline, point)) {
            outline->point_mm[outline->n++] = point;
        }
    }
}

/* ---- projection ---- */

struct iso_silhouette_scale iso_silhouette_scale_of(const struct iso_frame *frame)
{
    const double px = fmax((double)frame->width_px / ISO_SILHOUETTE_COLUMNS,
                           (double)frame->height_px / ISO_SILHOUETTE_ROWS);
    return (struct iso_silhouette_scale){
        .px = px,
        .left = 0.5 * (ISO_SILHOUETTE_COLUMNS - frame->width_px / px),
        .top = 0.5 * (ISO_SILHOUETTE_ROWS - frame->height_px / px),
    };
}

struct point {
    double x, y; /* silhouette points, y down */
};

/* Returns false if the point cannot be seen. */
static bool project(const struct iso_frame *frame, const struct iso_silhouette_scale *scale,
                    struct iso_vec3 camera_mm, struct point *out)
{
    double u = 0.0;
    double v = 0.0;
    if (!iso_camera_project(&frame->camera, camera_mm, &u, &v)) {
        return false;
    }
    /* The centre of pixel 0 lies half a pixel from the corner. */
    out->x = scale->left + (u - frame->crop_x_px + 0.5) / scale->px;
    out->y = scale->top + (v - frame->crop_y_px + 0.5) / scale->px;
    return isfinite(out->x) && isfinite(out->y);
}

/* ---- the convex hull ---- */

static int by_x(const void *left, const void *right)
{
    const struct point *a = left;
    const struct point *b = right;
    if (a->x != b->x) {
        return a->x < b->x ? -1 : 1;
    }
    return (a->y > b->y) - (a->y < b->y);
}

/* Above 0 if o, a, b turn clockwise on a screen, whose y points down. */
static double turn(const struct point *o, const struct point *a, const struct point *b)
{
    return (a->x - o->x) * (b->y - o->y) - (a->y - o->y) * (b->x - o->x);
}

static int push(struct point *hull, int n, int floor, const struct point *next)
{
    while (n >= floor + 2 && turn(&hull[n - 2], &hull[n - 1], next) <= 0.0) {
        n--;
    }
    hull[n] = *next;
    return n + 1;
}

/* Andrew's monotone chain. `hull` has room for 2 n points. Returns their number. */
static int hull_of(struct point *points, int n, struct point *hull)
{
    int m = 0;
    qsort(points, (size_t)n, sizeof *points, by_x);
    for (int i = 0; i < n; i++) {
        m = push(hull, m, 0, &points[i]);
    }
    const int floor = m - 1;
    for (int i = n - 2; i >= 0; i--) {
        m = push(hull, m, floor, &points[i]);
    }
    return m - 1; /* the last point is the first one */
}

static int16_t units(double points)
{
    return (int16_t)fmax(-32767.0, fmin(32767.0, round(points * ISO_OUTLINE_UNITS)));
}

int iso_head_outline_project(const struct iso_head_outline *outline,
                             const struct iso_rigid *camera_from_face,
                             const struct iso_frame *frame, int16_t xy[ISO_OUTLINE_POINTS][2])
{
    struct point points[ISO_HEAD_OUTLINE_POINTS];
    struct point hull[2 * ISO_HEAD_OUTLINE_POINTS];
    const struct iso_silhouette_scale scale = iso_silhouette_scale_of(frame);
    for (int i = 0; i < outline->n; i++) {
        const struct iso_vec3 mm = iso_rigid_apply(camera_from_face, outline->point_mm[i]);
        if (!project(frame, &scale, mm, &points[i])) {
            return 0;
        }
    }
    const int m = outline->n >= 3 ? hull_of(points, outline->n, hull) : 0;
    if (m < 3) {
        return 0;
    }
    const int n = m < ISO_OUTLINE_POINTS ? m : ISO_OUTLINE_POINTS;
    for (int i = 0; i < n; i++) {
        const struct point *corner = &hull[i * m / n];
        xy[i][0] = units(corner->x);
        xy[i][1] = units(corner->y);
    }
    return n;
}

#include "sim/lab/outline/outline_features.h"

#include <math.h>
#include <string.h>

#include "firmware/stream/silhouette.h"

const char *sim_outline_view_name(enum sim_outline_view view)
{
    static const char *const names[SIM_OUTLINE_VIEWS] = {"stream", "no-face", "plain", "pose"};
    return view >= 0 && view < SIM_OUTLINE_VIEWS ? names[view] : NULL;
}

struct outline {
    int16_t xy[ISO_OUTLINE_POINTS][2];
    int n;
    double x, y, height; /* middle and height, silhouette points */
};

static bool find_outline(const struct iso_head_outline *head,
                         const struct iso_rigid *camera_from_face, const struct iso_frame *frame,
                         struct outline *out)
{
    double least[2] = {INFINITY, INFINITY};
    double most[2] = {-INFINITY, -INFINITY};
    out->n = iso_head_outline_project(head, camera_from_face, frame, out->xy);
    for (int i = 0; i < out->n; i++) {
        for (int axis = 0; axis < 2; axis++) {
            const double at = (double)out->xy[i][axis] / ISO_OUTLINE_UNITS;
            /* Not fmin() and fmax(): gcc 12.2 for arm64 fails on them here at -O3. */
            least[axis] = at < least[axis] ? at : least[axis];
            most[axis] = at > most[axis] ? at : most[axis];
        }
    }
    out->x = 0.5 * (least[0] + most[0]);
    out->y = 0.5 * (least[1] + most[1]);
    out->height = most[1] - least[1];
    return out->n > 0 && out->height >= 4.0;
}

/* Each point by itself: neither cells nor the mean head. */
static void draw_plain(const struct iso_frame *frame, double distance_mm,
                       uint8_t bits[ISO_SILHOUETTE_ROWS][ISO_SILHOUETTE_STRIDE])
{
    const struct iso_silhouette_scale scale = iso_silhouette_scale_of(frame);
    memset(bits, 0, (size_t)ISO_SILHOUETTE_ROWS * ISO_SILHOUETTE_STRIDE);
    for (int row = 0; row < ISO_SILHOUETTE_ROWS; row++) {
        for (int column = 0; column < ISO_SILHOUETTE_COLUMNS; column++) {
            const int u = (int)floor((column + 0.5 - scale.left) * scale.px);
            const int v = (int)floor((row + 0.5 - scale.top) * scale.px);
            const bool inside = u >= 0 && v >= 0 && u < frame->width_px && v < frame->height_px;
            const double mm = inside ? (double)iso_frame_depth_at(frame, u, v) : 0.0;
            if (mm > 0.0 && fabs(mm - distance_mm) < 300.0) {
                bits[row][column / 8] |= (uint8_t)(0x80 >> (column % 8));
            }
        }
    }
}

static void take_window(const struct outline *outline,
                        uint8_t bits[ISO_SILHOUETTE_ROWS][ISO_SILHOUETTE_STRIDE],
                        struct sim_outline_features *out)
{
    const double step = 2.0 * outline->height / SIM_OUTLINE_ROWS;
    for (int i = 0; i < SIM_OUTLINE_ROWS; i++) {
        for (int j = 0; j < SIM_OUTLINE_COLUMNS; j++) {
            const int row = (int)floor(outline->y + (i + 0.5 - 0.5 * SIM_OUTLINE_ROWS) * step);
            const int column = (int)floor(outline->x +
                                          (j + 0.5 - 0.5 * SIM_OUTLINE_COLUMNS) * step);
            const bool inside = row >= 0 && row < ISO_SILHOUETTE_ROWS && column >= 0 &&
                                column < ISO_SILHOUETTE_COLUMNS;
            out->window[i][j] = inside && iso_silhouette_is_set(bits, column, row) ? 1.0F : 0.0F;
        }
    }
}

/* The distance from the middle to the outline in a direction. */
static double radius_at(const struct outline *outline, double angle)
{
    double radius = 0.0;
    for (int i = 0; i < outline->n; i++) {
        const int16_t *a = outline->xy[i];
        const int16_t *b = outline->xy[(i + 1) % outline->n];
        const double ax = (double)a[0] / ISO_OUTLINE_UNITS - outline->x;
        const double ay = (double)a[1] / ISO_OUTLINE_UNITS - outline->y;
        const double dx = (double)(b[0] - a[0]) / ISO_OUTLINE_UNITS;
        const double dy = (double)(b[1] - a[1]) / ISO_OUTLINE_UNITS;
        const double across = cos(angle) * dy - sin(angle) * dx;
        const double along = sin(angle) * ax - cos(angle) * ay;
        if (across > 0.0 && along >= 0.0 && along <= across) {
            radius = (ax * dy - ay * dx) / across;
        }
    }
    return radius / outline->height;
}

/* The directions of the face's axes, and the distance in metres. */
static void take_pose(const struct iso_rigid *pose, struct sim_outline_features *out)
{
    for (int i = 0; i < 9; i++) {
        out->radius[i] = (float)pose->rotation.m[i / 3][i % 3];
    }
    out->radius[9] = (float)(pose->translation_mm.z / 1000.0);
}

bool sim_outline_features_of(const struct iso_head_outline *head,
                             const struct iso_rigid *camera_from_face,
                             const struct iso_frame *frame, enum sim_outline_view view,
                             struct sim_outline_features *out)
{
    static const double turn_rad = 6.28318530717958648;
    uint8_t bits[ISO_SILHOUETTE_ROWS][ISO_SILHOUETTE_STRIDE];
    struct outline outline;
    const double distance_mm = camera_from_face->translation_mm.z;
    memset(out, 0, sizeof *out);
    if (view == SIM_OUTLINE_POSE) {
        take_pose(camera_from_face, out);
        return true;
    }
    if (!find_outline(head, camera_from_face, frame, &outline)) {
        return false;
    }
    if (view == SIM_OUTLINE_PLAIN) {
        draw_plain(frame, distance_mm, bits);
    } else {
        iso_silhouette_draw(frame, outline.xy, view == SIM_OUTLINE_STREAM ? outline.n : 0, bits);
    }
    take_window(&outline, bits, out);
    for (int i = 0; view == SIM_OUTLINE_STREAM && i < SIM_OUTLINE_ANGLES; i++) {
        out->radius[i] = (float)radius_at(&outline, turn_rad * i / SIM_OUTLINE_ANGLES);
    }
    return true;
}

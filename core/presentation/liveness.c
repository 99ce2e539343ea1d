#include "core/presentation/liveness.h"

#include <stdbool.h>
#include <string.h>

#include "core/base/crc32.h"

/* A turn is counted as the movement of a point at this distance from the axis: half the length of a
 * face. */
static const double arm_mm = 80.0;
static const double sigma_max_mm = 6.0;
static const double digest_mm = 80.0;

enum { DIGEST_ROWS = 4 };

struct iso_liveness_options iso_liveness_options_default(void)
{
    return (struct iso_liveness_options){
        .still_ns = 1800000000,
        .gap_ns = 500000000,
        .frames_min = 20,
        .frozen_frames = 3,
        .moved_mm = 0.12,
        .doubt = 3.5,
    };
}

void iso_liveness_init(const struct iso_liveness_options *options, struct iso_liveness *out)
{
    memset(out, 0, sizeof *out);
    out->options = *options;
}

/* The small turn from one attitude to another, as a vector along its axis. It is exact for turns of
 * a few degrees. */
static struct iso_vec3 turn_between(const struct iso_mat3 *from, const struct iso_mat3 *to)
{
    struct iso_mat3 back = iso_mat3_transpose(from);
    const struct iso_mat3 turn = iso_mat3_mul(to, &back);
    return iso_vec3(0.5 * (turn.m[2][1] - turn.m[1][2]), 0.5 * (turn.m[0][2] - turn.m[2][0]),
                    0.5 * (turn.m[1][0] - turn.m[0][1]));
}

static void remember(struct iso_liveness *l, const struct iso_liveness_frame *frame)
{
    if (l->n == 0) {
        l->first = frame->camera_from_face;
    }
    const struct iso_vec3 shift = iso_sub(frame->camera_from_face.translation_mm,
                                          l->first.translation_mm);
    const struct iso_vec3 turn = iso_scale(
        arm_mm, turn_between(&l->first.rotation, &frame->camera_from_face.rotation));
    const double x_mm[ISO_LIVENESS_COORDINATES] = {shift.x, shift.y, shift.z,
                                                   turn.x,  turn.y,  turn.z};
    memcpy(l->x_mm[l->next], x_mm, sizeof x_mm);
    l->t_ns[l->next] = frame->t_ns;
    l->next = (l->next + 1) % ISO_LIVENESS_FRAMES;
    l->n = l->n < ISO_LIVENESS_FRAMES ? l->n + 1 : l->n;
}

/* Whether one coordinate moved over the stored frames by more than independent noise explains. */
static bool moved(const struct iso_liveness *l, int coordinate)
{
    const int from = (l->next - l->n + ISO_LIVENESS_FRAMES) % ISO_LIVENESS_FRAMES;
    double mean = 0.0, variance = 0.0, successive = 0.0, before = 0.0;
    for (int i = 0; i < l->n; i++) {
        mean += l->x_mm[(from + i) % ISO_LIVENESS_FRAMES][coordinate] / l->n;
    }
    for (int i = 0; i < l->n; i++) {
        const double x = l->x_mm[(from + i) % ISO_LIVENESS_FRAMES][coordinate] - mean;
        variance += x * x / (l->n - 1);
        successive += i > 0 ? 0.5 * (x - before) * (x - before) / (l->n - 1) : 0.0;
        before = x;
    }
    const double bound = l->options.moved_mm;
    return variance - successive > bound * bound &&
           successive < (1.0 - l->options.doubt / sqrt(l->n)) * variance;
}

static enum iso_liveness_answer judge(const struct iso_liveness *l)
{
    if (l->repeated + 1 >= l->options.frozen_frames) {
        return ISO_LIVENESS_STILL;
    }
    if (l->n < l->options.frames_min) {
        return l->answer;
    }
    for (int k = 0; k < ISO_LIVENESS_COORDINATES; k++) {
        if (moved(l, k)) {
            return ISO_LIVENESS_ALIVE;
        }
    }
    const int oldest = (l->next - l->n + ISO_LIVENESS_FRAMES) % ISO_LIVENESS_FRAMES;
    return l->last_ns - l->t_ns[oldest] >= l->options.still_ns ? ISO_LIVENESS_STILL : l->answer;
}

enum iso_liveness_answer iso_liveness_feed(struct iso_liveness *liveness,
                                           const struct iso_liveness_frame *frame)
{
    struct iso_liveness *l = liveness;
    bool begun = l->n > 0 || l->last_ns != 0;
    if (begun && (frame->t_ns <= l->last_ns || frame->t_ns - l->last_ns > l->options.gap_ns)) {
        const struct iso_liveness_options options = l->options;
        iso_liveness_init(&options, l);
        begun = false;
    }
    const bool same = begun && frame->digest == l->digest;
    l->repeated = same ? l->repeated + 1 : 0;
    l->digest = frame->digest;
    l->last_ns = frame->t_ns;
    /* The same frame twice is not two measurements; it would count as stillness. */
    if (!same && frame->sigma_mm <= sigma_max_mm) {
        remember(l, frame);
    }
    l->answer = judge(l);
    return l->answer;
}

uint32_t iso_liveness_digest(const struct iso_frame *frame, struct iso_vec3 nose_mm)
{
    double u, v;
    if (!iso_camera_project(&frame->camera, nose_mm, &u, &v)) {
        return 0;
    }
    const double reach = digest_mm / iso_camera_pixel_mm(&frame->camera, nose_mm.z);
    const double left = fmax(u - frame->crop_x_px - reach, 0.0);
    const double right = fmin(u - frame->crop_x_px + reach, frame->width_px - 1.0);
    const double top = fmax(v - frame->crop_y_px - reach, 0.0);
    const double bottom = fmin(v - frame->crop_y_px + reach, frame->height_px - 1.0);
    uint32_t digest = 0;
    for (int row = (int)top; right >= left && row <= bottom; row += DIGEST_ROWS) {
        const float *at = &frame->depth_mm[(size_t)row * (size_t)frame->width_px + (size_t)left];
        digest = iso_crc32(digest, at, ((size_t)right - (size_t)left + 1) * sizeof *at);
    }
    return digest;
}

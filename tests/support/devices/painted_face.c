#include "tests/support/devices/painted_face.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static double distance_to_segment(struct iso_vec3 p, struct iso_vec3 a, struct iso_vec3 b)
{
    struct iso_vec3 ab = iso_sub(b, a), ap = iso_sub(p, a);
    double along = fmin(fmax(iso_dot(ap, ab) / iso_dot(ab, ab), 0.0), 1.0);
    return iso_norm(iso_madd(ap, -along, ab));
}

static double distance_to_curve(struct iso_vec3 p, const struct iso_vec3 *ibug_mm, int first,
                                int last)
{
    double least = 1e9;
    for (int k = first; k < last; k++) {
        least = fmin(least, distance_to_segment(p, ibug_mm[k], ibug_mm[k + 1]));
    }
    return least;
}

/* One part of the face: a curve through landmarks, its width and its brightness. */
struct stroke {
    int first, last;
    double half_mm, albedo;
};

static double albedo_at(struct iso_vec3 p, const struct iso_vec3 *ibug_mm)
{
    static const struct stroke strokes[] = {
        {36, 41, 5.0, 0.45}, {42, 47, 5.0, 0.45}, /* lids */
        {36, 41, 3.0, 0.25}, {42, 47, 3.0, 0.25}, /* eyes */
        {32, 34, 3.0, 0.3},                       /* nostrils */
        {48, 59, 4.0, 0.45}, {60, 64, 1.5, 0.2},  /* lips, and between them */
    };
    /* Brows lie under the landmarks' curves, towards the eyes. */
    struct iso_vec3 up = iso_sub(ibug_mm[27], ibug_mm[30]);
    struct iso_vec3 above = iso_madd(p, 6.0, iso_unit(up));
    double albedo = 0.6;
    for (size_t i = 0; i < sizeof strokes / sizeof *strokes; i++) {
        const struct stroke *s = &strokes[i];
        if (distance_to_curve(p, ibug_mm, s->first, s->last) < s->half_mm) {
            albedo = s->albedo;
        }
    }
    double brow = fmin(distance_to_curve(above, ibug_mm, 17, 21),
                       distance_to_curve(above, ibug_mm, 22, 26));
    return brow < 4.5 ? 0.25 : albedo;
}

static void paint(struct iso_frame *frame, const struct iso_vec3 *ibug_mm, double level)
{
    assert_non_null(frame->intensity);
    for (int row = 0; row < frame->height_px; row++) {
        for (int column = 0; column < frame->width_px; column++) {
            size_t i = (size_t)row * (size_t)frame->width_px + (size_t)column;
            frame->intensity[i] = 0.0F;
            if (frame->depth_mm[i] > 0.0F) {
                struct iso_vec3 p = iso_frame_point_at(frame, column, row);
                double albedo = ibug_mm ? albedo_at(p, ibug_mm) : 0.6;
                double light = level * albedo / 0.6 / (1e-6 * iso_dot(p, p));
                frame->intensity[i] = (float)fmin(light, 1.0);
            }
        }
    }
}

void painted_face(struct iso_frame *frame, const struct iso_vec3 ibug_mm[ISO_LANDMARKS_IBUG],
                  double level)
{
    paint(frame, ibug_mm, level);
}

void painted_blank(struct iso_frame *frame, double level)
{
    paint(frame, NULL, level);
}

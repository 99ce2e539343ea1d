/* For every processor of the architecture (SSE2 on x86-64, NEON on aarch64), and the choice. */
#include <stddef.h>
#include <stdint.h>

enum { WIDE = 2 };
#define MEET_MANY iso__meet_many_baseline
#include "core/landmark/meet_many.inc"

void iso__meet_many_plain(const struct iso_frame *frame, const struct iso_rigid *camera_from_face,
                          const struct iso_meet_points *points, int n, double cutoff_mm,
                          struct iso_meetings *out)
{
    const struct iso_mat3 *rotation = &camera_from_face->rotation;
    for (int i = 0; i < n; i++) {
        const struct iso_vec3 arm = iso_mat3_apply(
            rotation,
            iso_vec3(points->point_mm[0][i], points->point_mm[1][i], points->point_mm[2][i]));
        const struct iso_vec3 normal = iso_mat3_apply(
            rotation, iso_vec3(points->normal[0][i], points->normal[1][i], points->normal[2][i]));
        const struct iso_vec3 turn = iso_cross(arm, normal);
        double r = 0.0;
        const enum iso_meeting meeting = iso_meet(
            frame, iso_add(arm, camera_from_face->translation_mm), normal, &r);
        out->normal[0][i] = normal.x;
        out->normal[1][i] = normal.y;
        out->normal[2][i] = normal.z;
        out->turn_mm[0][i] = turn.x;
        out->turn_mm[1][i] = turn.y;
        out->turn_mm[2][i] = turn.z;
        out->distance_mm[i] = r;
        out->weight[i] = meeting == ISO_MEETING_MEASURED ? iso_tukey(r, cutoff_mm) : 0.0;
        out->meeting[i] = meeting;
    }
}

void iso_meet_many(const struct iso_frame *frame, const struct iso_rigid *camera_from_face,
                   const struct iso_meet_points *points, int n, double cutoff_mm,
                   struct iso_meetings *out)
{
    const struct iso_camera *camera = &frame->camera;
    if (camera->projection != ISO_PINHOLE || iso_camera_is_distorted(camera) ||
        frame->width_px < 2 || frame->height_px < 2) {
        iso__meet_many_plain(frame, camera_from_face, points, n, cutoff_mm, out);
        return;
    }
#if defined __x86_64__
    if (__builtin_cpu_supports("avx2")) {
        iso__meet_many_avx2(frame, camera_from_face, points, n, cutoff_mm, out);
        return;
    }
#endif
    iso__meet_many_baseline(frame, camera_from_face, points, n, cutoff_mm, out);
}

#include "firmware/recognise/track.h"

#include <math.h>

#include "drivers/base/times.h"

void iso_track_init(struct iso_track *track, const struct iso_track_options *options)
{
    *track = (struct iso_track){.options = *options};
}

void iso_track_reset(struct iso_track *track)
{
    track->has_pose = false;
}

/* The angle between two attitudes: trace(A^T B) = 1 + 2 cos(angle). */
static double angle_between(const struct iso_mat3 *a, const struct iso_mat3 *b)
{
    double trace = 0.0;
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 3; column++) {
            trace += a->m[row][column] * b->m[row][column];
        }
    }
    return acos(fmin(fmax(0.5 * (trace - 1.0), -1.0), 1.0));
}

/* Whether a head can have moved so far in this time. */
static bool is_within_reach(const struct iso_track_options *options, double moved_mm,
                            double turned_rad, double dt_s)
{
    const double reach_mm = ISO_TRACK_SLACK_MM + options->jump_mm_s * dt_s;
    const double reach_rad = ISO_TRACK_SLACK_RAD + options->jump_rad_s * dt_s;
    return moved_mm <= fmin(reach_mm, ISO_TRACK_BREADTH_MM) && turned_rad <= reach_rad;
}

struct iso_track_motion iso_track_pose(struct iso_track *track, int64_t t_ns,
                                       const struct iso_rigid *camera_from_face)
{
    const struct iso_track_options *options = &track->options;
    const struct iso_rigid *before = &track->camera_from_face;
    const double dt_s = (double)(t_ns - track->t_ns) / (double)ISO_NS_PER_S;
    const double moved_mm = iso_norm(
        iso_sub(camera_from_face->translation_mm, before->translation_mm));
    const double turned_rad = angle_between(&camera_from_face->rotation, &before->rotation);
    const bool same = track->has_pose && t_ns - track->t_ns < options->lost_ns &&
                      is_within_reach(options, moved_mm, turned_rad, dt_s);
    struct iso_track_motion motion = {.track = track->number};
    if (!same) {
        motion.track = ++track->number;
    } else if (dt_s > 0.0) {
        motion.known = true;
        motion.mm_s = moved_mm / dt_s;
        motion.rad_s = turned_rad / dt_s;
        motion.moving = motion.mm_s > options->still_mm_s || motion.rad_s > options->still_rad_s;
    }
    track->has_pose = true;
    track->t_ns = t_ns;
    track->camera_from_face = *camera_from_face;
    return motion;
}

#include "firmware/recognise/enroll_pose.h"

#include <math.h>
#include <stddef.h>

#include "firmware/contract/contract.h"

const char *iso_enroll_pose_name(enum iso_enroll_pose pose)
{
    static const char *const names[ISO_ENROLL_POSES] = {
        [ISO_ENROLL_FRONTAL] = ISO_CONTRACT_POSE_FRONTAL,
        [ISO_ENROLL_LEFT] = ISO_CONTRACT_POSE_LEFT,
        [ISO_ENROLL_RIGHT] = ISO_CONTRACT_POSE_RIGHT,
        [ISO_ENROLL_DOWN] = ISO_CONTRACT_POSE_DOWN,
        [ISO_ENROLL_UP] = ISO_CONTRACT_POSE_UP,
    };
    return (unsigned)pose < ISO_ENROLL_POSES ? names[pose] : NULL;
}

/* The middle of a pose about one axis, and how far from it still counts. */
struct range {
    double middle_rad, within_rad;
};

static struct range yaw_range(enum iso_enroll_pose pose, const struct iso_enroll_angles *angles)
{
    switch (pose) {
    case ISO_ENROLL_LEFT:
        return (struct range){angles->yaw_rad, angles->within_rad};
    case ISO_ENROLL_RIGHT:
        return (struct range){-angles->yaw_rad, angles->within_rad};
    case ISO_ENROLL_DOWN:
    case ISO_ENROLL_UP:
        return (struct range){0.0, 2.0 * angles->within_rad};
    default:
        return (struct range){0.0, angles->yaw_max_rad};
    }
}

static struct range pitch_range(enum iso_enroll_pose pose, const struct iso_enroll_angles *angles)
{
    switch (pose) {
    case ISO_ENROLL_DOWN:
        return (struct range){-angles->pitch_rad, angles->within_rad};
    case ISO_ENROLL_UP:
        return (struct range){angles->pitch_rad, angles->within_rad};
    case ISO_ENROLL_LEFT:
    case ISO_ENROLL_RIGHT:
        return (struct range){0.0, 2.0 * angles->within_rad};
    default:
        return (struct range){0.0, angles->pitch_max_rad};
    }
}

enum iso_capture iso_enroll_pose_judge(enum iso_enroll_pose pose,
                                       const struct iso_enroll_angles *angles, double yaw_rad,
                                       double pitch_rad, double *turn_rad)
{
    const struct range yaw = yaw_range(pose, angles), pitch = pitch_range(pose, angles);
    const double yaw_off = yaw_rad - yaw.middle_rad, pitch_off = pitch_rad - pitch.middle_rad;
    const double yaw_excess = fabs(yaw_off) - yaw.within_rad;
    const double pitch_excess = fabs(pitch_off) - pitch.within_rad;
    if (yaw_excess <= 0.0 && pitch_excess <= 0.0) {
        *turn_rad = 0.0;
        return ISO_CAPTURE_OK;
    }
    if (yaw_excess >= pitch_excess) {
        *turn_rad = fabs(yaw_off);
        return yaw_off > 0.0 ? ISO_CAPTURE_TURN_RIGHT : ISO_CAPTURE_TURN_LEFT;
    }
    *turn_rad = fabs(pitch_off);
    return pitch_off > 0.0 ? ISO_CAPTURE_LOOK_DOWN : ISO_CAPTURE_LOOK_UP;
}

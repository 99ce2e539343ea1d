/* The poses of an enrolment. Visitors do not always look straight at the camera. A turned or bowed
 * head resembles a template of the same pose more than a frontal template. Therefore a person is
 * enrolled in several poses. Pure. */
#ifndef ISO_FIRMWARE_RECOGNISE_ENROLL_POSE_H
#define ISO_FIRMWARE_RECOGNISE_ENROLL_POSE_H

#include "isotherm/capture.h"

/* In the order of the steps. Left and right are the subject's. */
enum iso_enroll_pose {
    ISO_ENROLL_FRONTAL = 0,
    ISO_ENROLL_LEFT,
    ISO_ENROLL_RIGHT,
    ISO_ENROLL_DOWN, /* the chin down */
    ISO_ENROLL_UP,   /* the chin up */
    ISO_ENROLL_POSES
};

/* The word of a pose: ISO_CONTRACT_POSE_... of firmware/contract/contract.h; NULL if the number is
 * not that of a pose. */
const char *iso_enroll_pose_name(enum iso_enroll_pose pose);

/* Which attitudes of a head count as a pose. All angles are in radians and above 0. */
struct iso_enroll_angles {
    double yaw_max_rad, pitch_max_rad; /* FRONTAL: at most so far from straight ahead */
    double yaw_rad, pitch_rad; /* how far to turn, and how far to bow and to lift the chin */
    double within_rad; /* other poses: at most so far from that angle, and at most twice as far from
                        * straight ahead about the other axis */
};

/* Judges an attitude: yaw_rad above 0 is to the subject's left, pitch_rad above 0 is up
 * (isotherm/extract.h). Returns OK if it counts as the pose, else which way to turn about the axis
 * that exceeds its limit most. *turn_rad receives the angle about this axis to the middle of the
 * pose; 0 if the pose is reached. */
enum iso_capture iso_enroll_pose_judge(enum iso_enroll_pose pose,
                                       const struct iso_enroll_angles *angles, double yaw_rad,
                                       double pitch_rad, double *turn_rad);

#endif

#include "firmware/config/enroll_options.h"

#include "drivers/base/times.h"

struct iso_enroll_gate iso_enroll_gate_of(const struct iso_config_enroll *config)
{
    return (struct iso_enroll_gate){
        .pose = ISO_ENROLL_FRONTAL,
        .angles = {.yaw_max_rad = config->yaw_max_deg * ISO_RAD_PER_DEG,
                   .pitch_max_rad = config->pitch_max_deg * ISO_RAD_PER_DEG,
                   .yaw_rad = config->pose_yaw_deg * ISO_RAD_PER_DEG,
                   .pitch_rad = config->pose_pitch_deg * ISO_RAD_PER_DEG,
                   .within_rad = config->pose_within_deg * ISO_RAD_PER_DEG},
        .coverage_min = config->coverage_min,
        .pose_coverage_min = config->pose_coverage_min,
        .landmark_coverage_min = config->landmark_coverage_min,
        .expression_max = config->expression_max,
        .mouth_max_mm = config->mouth_max_mm,
    };
}

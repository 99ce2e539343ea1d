#include "sim/lab/landmarks/true_angle.h"

#include <stdio.h>

#include "core/registration/rigid.h"

static bool moves_with_expression(int landmark)
{
    return landmark == ISO_LM_LIP_UPPER || landmark == ISO_LM_MOUTH_R || landmark == ISO_LM_MOUTH_L;
}

/* NaN unless enough landmarks are known. */
static double angle_of_landmarks(const struct iso_head_model *model, const struct sim_truth *truth)
{
    enum { NEEDED = 4 };
    struct iso_vec3 mean_mm[ISO_LANDMARKS], true_mm[ISO_LANDMARKS];
    int n = 0;
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        if (truth->known[l] && !moves_with_expression(l)) {
            mean_mm[n] = iso_head_point_on(model, model->mean_mm,
                                           model->landmarks[iso_landmark_ibug[l]]);
            true_mm[n++] = truth->point_mm[l];
        }
    }
    struct iso_rigid camera_from_face;
    if (n < NEEDED || iso_rigid_fit(mean_mm, true_mm, NULL, n, &camera_from_face)) {
        return NAN;
    }
    return acos(fmin(fmax(-camera_from_face.rotation.m[2][2], -1.0), 1.0));
}

static double angle_of_word(const char *pose)
{
    int yaw, pitch, end = 0;
    if (sscanf(pose, "y%4dp%4dr%*4d%n", &yaw, &pitch, &end) != 2 || end == 0 || pose[end]) {
        return NAN;
    }
    return acos(cos(yaw * M_PI / 180.0) * cos(pitch * M_PI / 180.0));
}

double sim_true_angle(const struct iso_head_model *model, const struct sim_truth *truth,
                      const char *pose)
{
    const double angle = angle_of_landmarks(model, truth);
    return isnan(angle) ? angle_of_word(pose) : angle;
}

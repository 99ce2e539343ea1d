#include "sim/world/generate/not_faces.h"

#include "sim/world/generate/not_face_scenes.h"

static const struct sim_staged_kind kinds[] = {
    {"back", sim_not_face_back, false, false},
    {"profile", sim_not_face_profile, false, false},
    {"ear", sim_not_face_ear, false, false},
    {"hood", sim_not_face_hood, false, false},
    {"hand", sim_not_face_hand, false, false},
    {"wall", sim_not_face_wall, false, true},
    {"ball", sim_not_face_ball, false, false},
    {"chair", sim_not_face_chair, false, false},
    {"coat", sim_not_face_coat, false, false},
    {"plant", sim_not_face_plant, false, false},
    {"cushion", sim_not_face_cushion, false, false},
};

int sim_not_faces_count(int per_kind)
{
    return (int)(sizeof kinds / sizeof *kinds) * per_kind;
}

int sim_not_faces_record(struct sim_studio *studio, const struct sim_ict *ict,
                         const struct sim_sensor *sensor, uint64_t seed, int per_kind,
                         struct iso_fault *fault)
{
    struct sim_staging_plan plan = {
        .ict = ict, .sensor = sensor, .role = SIM_ROLE_PROBE, .seed = seed, .frames = 1};
    int error = 0;
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        for (int i = 0; error == 0 && i < per_kind; i++) {
            error = sim_staging_record(studio, &plan, &kinds[k], i, NULL, fault);
        }
    }
    return error;
}

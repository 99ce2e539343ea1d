/* People whose face is not visible. */
#include <stdio.h>

#include "sim/world/generate/not_face_scenes.h"
#include "sim/world/prop/hand.h"
#include "sim/world/prop/hood.h"

#define DEGREES(x) ((x)*0.017453292519943295)

/* Face frame of the mean head: the middle of the skull, and an ear canal. */
static const struct iso_vec3 skull_mm = {0.0, 35.0, -110.0};
static const double ear_x_mm = 75.0;

/* Adds a person turned by `body_yaw_rad`, so that `point_mm` of the face frame is at `place_mm`. */
static int add_turned(struct sim_staging *staging, bool hair, double body_yaw_rad,
                      struct iso_vec3 point_mm, struct iso_vec3 place_mm)
{
    struct sim_stance stance = {.body_yaw_rad = body_yaw_rad};
    stance.yaw_rad = DEGREES(sim_random_between(staging->random, -8.0, 8.0));
    stance.pitch_rad = DEGREES(sim_random_between(staging->random, -12.0, 12.0));
    stance.roll_rad = DEGREES(sim_random_between(staging->random, -6.0, 6.0));
    struct iso_rigid turned = sim_stance_camera_from_face(&stance);
    stance.nose_mm = iso_sub(place_mm, iso_rigid_apply(&turned, point_mm));
    return sim_still_add_person(staging->still, staging->ict, "turned", hair, &stance,
                                staging->random);
}

/* A random turn between two angles, in radians, to the left or to the right. */
static double turn_between(const struct sim_staging *staging, double from_degrees,
                           double to_degrees)
{
    const double turn = sim_random_between(staging->random, from_degrees, to_degrees);
    return DEGREES(sim_staging_chance(staging, 0.5) ? turn : -turn);
}

static void name_turn(struct sim_staging *staging, double body_yaw_rad)
{
    (void)snprintf(staging->variant, sizeof staging->variant, "turned%+.0f",
                   body_yaw_rad / DEGREES(1.0));
}

/* A place for the middle of the head: half the depth of a head behind the place of a face. */
static struct iso_vec3 skull_place(const struct sim_staging *staging)
{
    return iso_add(sim_staging_place(staging), iso_vec3(0.0, 0.0, 95.0));
}

int sim_not_face_back(struct sim_staging *staging)
{
    const double turn = turn_between(staging, 150.0, 180.0);
    name_turn(staging, turn);
    return add_turned(staging, true, turn, skull_mm, skull_place(staging));
}

int sim_not_face_profile(struct sim_staging *staging)
{
    const double turn = turn_between(staging, 80.0, 110.0);
    name_turn(staging, turn);
    return add_turned(staging, true, turn, skull_mm, skull_place(staging));
}

/* The ear is nearer than a face usually is, but not nearer than 0.85 of the sensor's shortest usual
 * distance. A head turned to its left shows the right ear. */
int sim_not_face_ear(struct sim_staging *staging)
{
    const double turn = turn_between(staging, 75.0, 105.0);
    struct iso_vec3 ear = {turn > 0.0 ? -ear_x_mm : ear_x_mm, 8.0, -115.0};
    struct iso_vec3 place = sim_staging_place(staging);
    place = iso_scale(sim_random_between(staging->random, 0.72, 0.95), place);
    place.z = fmax(place.z, 0.85 * staging->sensor->distance_min_mm);
    name_turn(staging, turn);
    return add_turned(staging, true, turn, ear, place);
}

int sim_not_face_hood(struct sim_staging *staging)
{
    struct sim_solid *hood = NULL;
    const double turn = turn_between(staging, 85.0, 180.0);
    name_turn(staging, turn);
    const int error = add_turned(staging, false, turn, skull_mm, skull_place(staging));
    const int made = error == 0 ? sim_hood_new(staging->random, &hood) : error;
    staging->still->things->placed = sim_stance_camera_from_face(&staging->still->stance);
    sim_group_add(staging->still->things, made, hood);
    return error;
}

/* Adds a hand whose middle (90 mm above the wrist) is at `middle_mm`. */
static void add_hand(struct sim_staging *staging, enum sim_hand_pose pose, bool left, bool back,
                     struct iso_vec3 middle_mm)
{
    struct sim_random *random = staging->random;
    const double yaw = DEGREES(sim_random_between(random, -30.0, 30.0));
    const double pitch = DEGREES(sim_random_between(random, -22.0, 22.0));
    const double roll = DEGREES(sim_random_between(random, -22.0, 22.0));
    struct iso_mat3 tilt = iso_mat3_rotation(
        iso_vec3(pitch, yaw + (back ? DEGREES(180.0) : 0.0), 0.0));
    struct iso_mat3 lean = iso_mat3_rotation(iso_vec3(0.0, 0.0, roll));
    struct iso_rigid held = {iso_mat3_mul(&tilt, &lean), {0.0, 0.0, 0.0}};
    struct iso_vec3 middle = iso_rigid_apply(&held, iso_vec3(0.0, -90.0, 0.0));
    held.translation_mm = iso_sub(middle_mm, middle);
    staging->still->things->placed = held;
    sim_hand_add(staging->still->things, pose, left, 0.0, random);
}

int sim_not_face_hand(struct sim_staging *staging)
{
    const bool fist = sim_staging_chance(staging, 0.35), back = sim_staging_chance(staging, 0.3);
    const bool two = sim_staging_chance(staging, 0.35), left = sim_staging_chance(staging, 0.5);
    const enum sim_hand_pose pose = fist ? SIM_HAND_FIST : SIM_HAND_OPEN;
    struct iso_vec3 place = sim_staging_place(staging);
    const double apart = two ? sim_random_between(staging->random, 55.0, 120.0) : 0.0;
    (void)snprintf(staging->variant, sizeof staging->variant, "%s%s%s", two ? "two-" : "",
                   fist ? "fist" : "palm", back ? "-back" : "");
    add_hand(staging, pose, left, back, iso_madd(place, -1.0, iso_vec3(apart, 0.0, 0.0)));
    if (two) {
        add_hand(staging, pose, !left, back, iso_madd(place, 1.0, iso_vec3(apart, 0.0, 0.0)));
    }
    return 0;
}

/* Walls and other objects. */
#include <stdio.h>

#include "sim/world/generate/not_face_scenes.h"
#include "sim/world/prop/furniture.h"
#include "sim/world/prop/hand.h"

#define DEGREES(x) ((x)*0.017453292519943295)

/* Places an object of the given half depth, slightly turned, with its front at the place of a face.
 */
static void put(struct sim_staging *staging, double half_depth_mm, double turn_degrees)
{
    const double yaw = DEGREES(sim_random_between(staging->random, -turn_degrees, turn_degrees));
    const double roll = DEGREES(0.2 *
                                sim_random_between(staging->random, -turn_degrees, turn_degrees));
    struct iso_mat3 turn = iso_mat3_rotation(iso_vec3(0.0, yaw, 0.0));
    struct iso_mat3 lean = iso_mat3_rotation(iso_vec3(0.0, 0.0, roll));
    struct iso_vec3 front = sim_staging_place(staging);
    staging->still->things->placed = (struct iso_rigid){
        iso_mat3_mul(&turn, &lean), iso_add(front, iso_vec3(0.0, 0.0, half_depth_mm))};
}

static void name(struct sim_staging *staging, const char *variant)
{
    (void)snprintf(staging->variant, sizeof staging->variant, "%s", variant);
}

/* ---- walls ------------------------------------------------------------------ */

static const char *const walls[] = {"plain", "slanted", "rail", "frame", "corner", "edge"};

static void add_plane(struct sim_group *things, const struct iso_rigid *camera_from_wall,
                      double turn_rad, double shift_mm)
{
    struct sim_solid *plane = NULL;
    struct iso_rigid moved = {iso_mat3_rotation(iso_vec3(0.0, turn_rad, 0.0)), {0.0, 0.0, 0.0}};
    struct iso_rigid shifted = {iso_mat3_identity(), {shift_mm, 0.0, 0.0}};
    moved = iso_rigid_mul(&moved, &shifted);
    const int made = sim_solid_rectangle(3000.0, 4000.0, 0.0, SIM_WALL, &plane);
    things->placed = iso_rigid_mul(camera_from_wall, &moved);
    sim_group_add(things, made, plane);
}

/* One batten, or four battens around a picture. */
static void add_battens(struct sim_group *things, bool frame, struct sim_random *random)
{
    const double broad = sim_random_between(random, 25.0, 80.0);
    const double thick = sim_random_between(random, 10.0, 35.0);
    const double y = sim_random_between(random, -60.0, 60.0),
                 x = sim_random_between(random, -50.0, 50.0);
    if (!frame) {
        sim_group_add_box(things, iso_vec3(2500.0, broad, 2.0 * thick), iso_vec3(0.0, y, 0.0),
                          SIM_WALL);
        return;
    }
    const double half_width = sim_random_between(random, 80.0, 160.0),
                 half_height = 1.3 * half_width;
    for (int side = -1; side <= 1; side += 2) {
        sim_group_add_box(things, iso_vec3(2.0 * half_width + broad, broad, 2.0 * thick),
                          iso_vec3(x, y + side * half_height, 0.0), SIM_WALL);
        sim_group_add_box(things, iso_vec3(broad, 2.0 * half_height, 2.0 * thick),
                          iso_vec3(x + side * half_width, y, 0.0), SIM_WALL);
    }
}

int sim_not_face_wall(struct sim_staging *staging)
{
    struct sim_random *random = staging->random;
    struct sim_group *things = staging->still->things;
    const uint32_t kind = sim_random_below(random, sizeof walls / sizeof *walls);
    const bool corner = kind >= 4;
    const double limit = kind == 1 ? 45.0 : 8.0;
    const double yaw = DEGREES(sim_random_between(random, -limit, limit));
    const double pitch = DEGREES(sim_random_between(random, -0.6 * limit, 0.6 * limit));
    const double nearest = fmax(500.0, staging->sensor->distance_min_mm);
    struct iso_rigid wall = {iso_mat3_rotation(iso_vec3(pitch, yaw, 0.0)), {0.0, 0.0, 0.0}};
    wall.translation_mm.x = corner ? sim_random_between(random, -120.0, 120.0) : 0.0;
    wall.translation_mm.z = sim_random_between(random, nearest, nearest + 700.0);
    name(staging, walls[kind]);
    if (corner) { /* two planes that meet in the line x = 0: away from the camera, or towards it */
        const double slope = DEGREES(kind == 4 ? 45.0 : -45.0);
        add_plane(things, &wall, -slope, -1500.0);
        add_plane(things, &wall, slope, 1500.0);
    } else {
        add_plane(things, &wall, 0.0, 0.0);
    }
    if (kind == 2 || kind == 3) {
        add_battens(things, kind == 3, random);
    }
    return 0;
}

/* ---- things ----------------------------------------------------------------- */

int sim_not_face_ball(struct sim_staging *staging)
{
    const double radius = sim_random_between(staging->random, 60.0, 150.0);
    const bool balloon = sim_staging_chance(staging, 0.4);
    put(staging, radius, 20.0);
    struct iso_vec3 middle = staging->still->things->placed.translation_mm;
    (void)snprintf(staging->variant, sizeof staging->variant, "%s-r%.0f",
                   balloon ? "balloon" : "ball", radius);
    sim_furniture_add_ball(staging->still->things, radius, balloon, staging->random);
    if (!balloon && sim_staging_chance(staging, 0.6)) {
        sim_staging_add_pole(staging, iso_add(middle, iso_vec3(0.0, radius, 0.0)), 14.0);
    } else if (!balloon) { /* on a fist */
        staging->still->things->placed = (struct iso_rigid){
            iso_mat3_identity(), iso_add(middle, iso_vec3(0.0, radius + 95.0, 0.0))};
        const bool left = sim_staging_chance(staging, 0.5);
        sim_hand_add(staging->still->things, SIM_HAND_FIST, left, 0.0, staging->random);
    }
    return 0;
}

int sim_not_face_chair(struct sim_staging *staging)
{
    static const char *const backs[SIM_CHAIR_BACKS] = {"slats", "ladder", "shell", "padded"};
    const uint32_t back = sim_random_below(staging->random, SIM_CHAIR_BACKS);
    put(staging, sim_random_between(staging->random, 60.0, 300.0), 35.0);
    name(staging, backs[back]);
    sim_furniture_add_chair(staging->still->things, (enum sim_chair_back)back, staging->random);
    return 0;
}

int sim_not_face_coat(struct sim_staging *staging)
{
    const bool hanger = sim_staging_chance(staging, 0.5);
    put(staging, 120.0, 35.0);
    name(staging, hanger ? "hanger" : "dummy");
    sim_furniture_add_coat(staging->still->things, hanger, staging->random);
    return 0;
}

int sim_not_face_plant(struct sim_staging *staging)
{
    put(staging, 120.0, 0.0);
    name(staging, "pot");
    sim_furniture_add_plant(staging->still->things, staging->random);
    return 0;
}

int sim_not_face_cushion(struct sim_staging *staging)
{
    put(staging, 60.0, 30.0);
    name(staging, "cushion");
    sim_furniture_add_cushion(staging->still->things, staging->random);
    return 0;
}

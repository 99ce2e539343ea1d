#include "sim/world/scene/room.h"

#include <errno.h>
#include <stdlib.h>

#include "sim/world/prop/solid.h"

enum { SOLIDS_MAX = 5, SCRATCH = 1024 };

struct sim_room {
    int n_solids;
    struct sim_solid *solids[SOLIDS_MAX]; /* camera frame */
    struct iso_vec3 scratch_mm[SCRATCH];
};

static int add_wall(struct sim_room *room, struct sim_random *random)
{
    struct sim_solid *wall;
    const int error = sim_solid_rectangle(9000.0, 7000.0, 0.0, SIM_WALL, &wall);
    if (error != 0) {
        return error;
    }
    /* One random draw in each statement, because the compiler chooses the order within an
     * expression. */
    const double yaw_rad = sim_random_between(random, -0.15, 0.15);
    const double pitch_rad = sim_random_between(random, -0.05, 0.05);
    const double z_mm = sim_random_between(random, 1300.0, 2600.0);
    struct iso_rigid placed = {iso_mat3_rotation(iso_vec3(pitch_rad, yaw_rad, 0.0)),
                               {0.0, 0.0, z_mm}};
    sim_solid_move(wall, &placed);
    room->solids[room->n_solids++] = wall;
    return 0;
}

static int add_box(struct sim_room *room, struct iso_vec3 size_mm, struct iso_vec3 at_mm,
                   double turn_rad)
{
    struct sim_solid *box;
    const int error = sim_solid_box(size_mm, SIM_WALL, &box);
    if (error != 0) {
        return error;
    }
    struct iso_rigid placed = {iso_mat3_rotation(iso_vec3(0.0, turn_rad, 0.0)), at_mm};
    sim_solid_move(box, &placed);
    room->solids[room->n_solids++] = box;
    return 0;
}

/* A chair's back and seat, and a cupboard. */
static int add_furniture(struct sim_room *room, struct sim_random *random)
{
    const double turn = sim_random_between(random, -0.6, 0.6);
    const double x_mm = sim_random_between(random, -120.0, 120.0);
    const double y_mm = sim_random_between(random, 60.0, 200.0);
    struct iso_vec3 chair = {x_mm, y_mm, sim_random_between(random, 700.0, 1000.0)};
    struct iso_vec3 seat = iso_add(chair, iso_vec3(0.0, 260.0, 80.0));
    struct iso_vec3 cupboard = {sim_random_between(random, 250.0, 450.0), 150.0, 1150.0};
    int error = add_box(room, iso_vec3(420.0, 380.0, 30.0), chair, turn);
    if (error == 0) {
        error = add_box(room, iso_vec3(430.0, 40.0, 420.0), seat, turn);
    }
    if (error == 0) {
        error = add_box(room, iso_vec3(350.0, 900.0, 300.0), cupboard, 0.5 * turn);
    }
    return error;
}

int sim_room_new(bool furniture, struct sim_random *random, struct sim_room **out)
{
    struct sim_room *room = calloc(1, sizeof *room);
    if (!room) {
        return -ENOMEM;
    }
    int error = add_wall(room, random);
    if (error == 0 && furniture) {
        error = add_furniture(room, random);
    }
    if (error != 0) {
        sim_room_free(room);
        return error;
    }
    *out = room;
    return 0;
}

void sim_room_free(struct sim_room *room)
{
    for (int i = 0; room && i < room->n_solids; i++) {
        sim_solid_free(room->solids[i]);
    }
    free(room);
}

int sim_room_draw(struct sim_room *room, struct sim_view *view)
{
    struct iso_rigid here = iso_rigid_identity();
    int error = 0;
    for (int i = 0; error == 0 && i < room->n_solids; i++) {
        error = sim_solid_draw(room->solids[i], &here, room->scratch_mm, view);
    }
    return error;
}

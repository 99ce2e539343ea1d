#include "sim/world/prop/group.h"

#include <errno.h>
#include <stdlib.h>

int sim_group_new(struct sim_group **out)
{
    struct sim_group *group = calloc(1, sizeof *group);
    if (!group) {
        return -ENOMEM;
    }
    group->placed = iso_rigid_identity();
    *out = group;
    return 0;
}

void sim_group_free(struct sim_group *group)
{
    if (!group) {
        return;
    }
    for (size_t i = 0; i < group->n_solids; i++) {
        sim_solid_free(group->solids[i]);
    }
    free(group->solids);
    free(group->scratch_mm);
    free(group);
}

static int reserve(struct sim_group *group, size_t n_vertices)
{
    if (group->n_solids == group->capacity) {
        const size_t capacity = 2 * group->capacity + 8;
        struct sim_solid **solids = realloc(group->solids, capacity * sizeof *solids);
        if (!solids) {
            return -ENOMEM;
        }
        group->solids = solids;
        group->capacity = capacity;
    }
    if (group->scratch_size < n_vertices) {
        free(group->scratch_mm);
        group->scratch_size = 0;
        group->scratch_mm = malloc(n_vertices * sizeof *group->scratch_mm);
        if (!group->scratch_mm) {
            return -ENOMEM;
        }
        group->scratch_size = n_vertices;
    }
    return 0;
}

void sim_group_add(struct sim_group *group, int made, struct sim_solid *solid)
{
    int error = group->error != 0 ? group->error : made;
    if (error == 0) {
        error = reserve(group, solid->n_vertices);
    }
    if (error == 0) {
        sim_solid_move(solid, &group->placed);
        group->solids[group->n_solids++] = solid;
    } else if (made == 0) {
        sim_solid_free(solid);
    }
    group->error = error;
}

static void add_at(struct sim_group *group, int made, struct sim_solid *solid,
                   struct iso_vec3 at_mm)
{
    if (made == 0) {
        struct iso_rigid there = {iso_mat3_identity(), at_mm};
        sim_solid_move(solid, &there);
    }
    sim_group_add(group, made, solid);
}

void sim_group_add_box(struct sim_group *group, struct iso_vec3 size_mm, struct iso_vec3 at_mm,
                       enum sim_material material)
{
    struct sim_solid *box = NULL;
    const int made = sim_solid_box(size_mm, material, &box);
    add_at(group, made, box, at_mm);
}

void sim_group_add_tube(struct sim_group *group, const struct sim_joint *joints, size_t n_joints,
                        enum sim_material material)
{
    struct sim_solid *tube = NULL;
    const int made = sim_solid_tube(joints, n_joints, material, &tube);
    sim_group_add(group, made, tube);
}

void sim_group_add_ellipsoid(struct sim_group *group, struct iso_vec3 half_mm, double roundness,
                             struct iso_vec3 at_mm, enum sim_material material)
{
    struct sim_solid *ellipsoid = NULL;
    const int made = sim_solid_superellipsoid(half_mm, roundness, material, &ellipsoid);
    add_at(group, made, ellipsoid, at_mm);
}

int sim_group_draw(struct sim_group *group, const struct iso_rigid *camera_from_group,
                   struct sim_view *view)
{
    int error = group->error;
    for (size_t i = 0; error == 0 && i < group->n_solids; i++) {
        error = sim_solid_draw(group->solids[i], camera_from_group, group->scratch_mm, view);
    }
    return error;
}

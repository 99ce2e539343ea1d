/* A solid of the simulated world: vertices and triangles of one material. */
#ifndef SIM_WORLD_PROP_SOLID_H
#define SIM_WORLD_PROP_SOLID_H

#include <stddef.h>
#include <stdint.h>

#include "isotherm/vec.h"
#include "sim/world/view/view.h"

struct sim_solid {
    uint32_t n_vertices, n_triangles;
    struct iso_vec3 *vertices_mm;
    uint32_t (*triangles)[3];
    enum sim_material material;
    float *albedo; /* [n_triangles] in the infrared; NULL: the material's own */
};

/* Room for the given counts, zeroed. -EINVAL for a count of 0, -ENOMEM. */
int sim_solid_new(uint32_t n_vertices, uint32_t n_triangles, enum sim_material material,
                  struct sim_solid **out) __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void sim_solid_free(struct sim_solid *solid);

/* A sheet of (rows x columns) vertices, row by row, joined to triangles. The caller places the
 * vertices. Both counts are 2 to 4096, otherwise -EINVAL; -ENOMEM. */
int sim_solid_sheet(uint32_t rows, uint32_t columns, enum sim_material material,
                    struct sim_solid **out) __attribute__((warn_unused_result));

/* A rectangle of width x height in the plane z = 0, its middle at the origin, x right, y down.
 * It is bent about a vertical axis to the given radius of curvature (0: flat), with its sides
 * away from the camera. -EINVAL for a size that is not positive or a negative radius, -ENOMEM. */
int sim_solid_rectangle(double width_mm, double height_mm, double bend_radius_mm,
                        enum sim_material material, struct sim_solid **out)
    __attribute__((warn_unused_result));

/* A box of the given size about the origin. -EINVAL for a size that is not positive, -ENOMEM. */
int sim_solid_box(struct iso_vec3 size_mm, enum sim_material material, struct sim_solid **out)
    __attribute__((warn_unused_result));

/* A point of a polyline, and the radius of the tube at this point. */
struct sim_joint {
    struct iso_vec3 at_mm;
    double radius_mm;
};

/* A tube along a polyline of 2 to 16 joints, of which neighbours are at different places: a finger,
 * an arm, a pole. The radius changes evenly from joint to joint; each end is half a sphere. -EINVAL
 * for another number of joints or a radius that is not positive, -ENOMEM. */
int sim_solid_tube(const struct sim_joint *joints, size_t n_joints, enum sim_material material,
                   struct sim_solid **out) __attribute__((warn_unused_result));

/* A superellipsoid about the origin with the given half axes (A. H. Barr, "Superquadrics and
 * angle-preserving transformations", 1981): both exponents are `roundness`, 1 an ellipsoid, towards
 * 0 a box. -EINVAL for a half axis that is not positive or a roundness outside (0, 1], -ENOMEM. */
int sim_solid_superellipsoid(struct iso_vec3 half_mm, double roundness, enum sim_material material,
                             struct sim_solid **out) __attribute__((warn_unused_result));

/* Adds to an open surface, counter-clockwise seen from outside, a second surface `shell_mm`
 * inside it, and walls along its borders. -ENOMEM; the solid is then unchanged. */
int sim_solid_thicken(struct sim_solid *solid, double shell_mm) __attribute__((warn_unused_result));

/* Moves the vertices. */
void sim_solid_move(struct sim_solid *solid, const struct iso_rigid *to_from);

/* Draws the solid in the camera frame. `scratch_mm` has room for n_vertices. -ENOMEM. */
int sim_solid_draw(const struct sim_solid *solid, const struct iso_rigid *camera_from_solid,
                   struct iso_vec3 *scratch_mm, struct sim_view *view)
    __attribute__((warn_unused_result));

#endif

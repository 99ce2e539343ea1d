/* Surfaces with known geometry, for the numerical tests. Free all of them with iso_mesh_free. A
 * failed allocation ends the test. Triangles are counter-clockwise seen from outside (sheets: from
 * +z). */
#ifndef TESTS_CORE_SURFACES_SHAPES_H
#define TESTS_CORE_SURFACES_SHAPES_H

#include "isotherm/mesh.h"

/* A flat sheet of columns x rows vertices about the origin in the plane z = 0, with vertex row *
 * columns + column. The direction of the diagonals changes from place to place, so that no
 * direction is preferred. */
struct iso_mesh *shape_sheet(int columns, int rows, double pitch_mm);

/* An icosahedron whose faces are split into four `splits` times. All vertices are on the sphere. */
struct iso_mesh *shape_sphere(int splits, double radius_mm);

/* A flat disc of `rings` rings about the origin; ring i has 6 i vertices. */
struct iso_mesh *shape_disc(int rings, double radius_mm);

/* An artificial face seen from +z: nose, eye sockets, cheeks and mouth on a curved ground, within
 * 100 mm of the z axis. The nose tip is near the origin. The face is not quite symmetric. */
struct iso_mesh *shape_relief(double pitch_mm);

/* Rolls a sheet about the y axis onto a cylinder, without stretching it. */
void shape_roll(struct iso_mesh *mesh, double radius_mm);

/* Returns the surface point below or above (x, y), seen along z. It ends the test if there is no
 * such point. */
struct iso_surface_point shape_locate(const struct iso_mesh *mesh, double x_mm, double y_mm);

#endif

/* Surfaces whose geometry is known, for the numerical tests. All are freed with iso_mesh_free; a
 * failure to allocate ends the test. Triangles are counter-clockwise seen from outside (sheets:
 * from +z). */
#ifndef TESTS_CORE_SURFACES_SHAPES_H
#define TESTS_CORE_SURFACES_SHAPES_H

#include "isotherm/mesh.h"

/* A flat sheet of columns x rows vertices about the origin in the plane z = 0, vertex
 * row * columns + column, diagonals turned about by place so that no direction is preferred. */
struct iso_mesh *shape_sheet(int columns, int rows, double pitch_mm);

/* An icosahedron, its faces split in four `splits` times, all vertices on the sphere. */
struct iso_mesh *shape_sphere(int splits, double radius_mm);

/* A flat disc of `rings` rings about the origin, ring i of 6 i vertices. */
struct iso_mesh *shape_disc(int rings, double radius_mm);

/* A made-up face seen from +z: nose, eye sockets, cheeks and mouth on a curved ground, within 100
 * mm of the z axis, the nose tip near the origin; not quite symmetric. */
struct iso_mesh *shape_relief(double pitch_mm);

/* Rolls a sheet about the y axis onto a cylinder, without stretching it. */
void shape_roll(struct iso_mesh *mesh, double radius_mm);

/* The surface point below or above (x, y), seen along z. Ends the test if there is none. */
struct iso_surface_point shape_locate(const struct iso_mesh *mesh, double x_mm, double y_mm);

#endif

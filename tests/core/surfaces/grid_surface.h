/* Surfaces as orthographic depth frames, for tests of code that works on grids. Each surface also
 * has the mesh that iso_triangulate makes of the frame. A failure ends the test. */
#ifndef TESTS_CORE_SURFACES_GRID_SURFACE_H
#define TESTS_CORE_SURFACES_GRID_SURFACE_H

#include "core/surface/grid.h"
#include "isotherm/triangulate.h"

struct grid_surface {
    struct iso_frame *frame;
    struct iso_grid *grid;
    struct iso_triangulator *triangulator; /* has made the mesh last, and finds places on it */
    struct iso_mesh *mesh;                 /* in the face frame */
    int32_t (*adjacent)[3];
    int32_t *plane_index; /* [n_vertices]: the index of each vertex in the planes of the grid */
};

/* Hills and hollows on 75 x 58 pixels. The surface has holes of one pixel and of many pixels,
 * single triangles, and a cliff at which the mesh is cut. With steepness 0 it is flat and has no
 * holes. */
struct grid_surface grid_surface_hills(double pitch_mm, double steepness);

/* The mean face of the shipped model within 100 mm of the nose tip. */
struct grid_surface grid_surface_mean_face(double pitch_mm);

/* Frees what the surface owns. */
void grid_surface_done(struct grid_surface *surface);

/* These functions find the same place on the grid and on the mesh. x and y are in the face frame. A
 * place without surface ends the test. */
struct iso_grid_point grid_surface_point(const struct grid_surface *surface, double x_mm,
                                         double y_mm);
struct iso_surface_point grid_surface_mesh_point(const struct grid_surface *surface, double x_mm,
                                                 double y_mm);

/* Returns the values of a field at the vertices of the mesh, [n_vertices]. Free them with free().
 */
double *grid_surface_on_mesh(const struct grid_surface *surface,
                             const struct iso_grid_field *field);

#endif

/* Surfaces as orthographic depth frames, for tests of what works on grids; each also as the mesh
 * that iso_triangulate makes of it. A failure ends the test. */
#ifndef TESTS_CORE_SURFACES_GRID_SURFACE_H
#define TESTS_CORE_SURFACES_GRID_SURFACE_H

#include "core/surface/grid.h"
#include "isotherm/triangulate.h"

struct grid_surface {
    struct iso_frame *frame;
    struct iso_grid *grid;
    struct iso_triangulator *triangulator; /* has made the mesh last */
    struct iso_mesh *mesh;                 /* in the face frame */
    int32_t (*adjacent)[3];
    int32_t *plane_index; /* [n_vertices] of the grid */
};

/* Hills and hollows on 75 x 58 pixels, with holes of one pixel and of many, single triangles, and a
 * cliff that is cut; steepness 0: flat and whole. */
struct grid_surface grid_surface_hills(double pitch_mm, double steepness);

/* The mean face of the shipped model within 100 mm of the nose tip; frame NULL if there is no
 * model. */
struct grid_surface grid_surface_mean_face(double pitch_mm);

void grid_surface_done(struct grid_surface *surface);

/* The same place on grid and mesh, by x and y in the face frame. */
struct iso_grid_point grid_surface_point(const struct grid_surface *surface, double x_mm,
                                         double y_mm);
struct iso_surface_point grid_surface_mesh_point(const struct grid_surface *surface, double x_mm,
                                                 double y_mm);

/* A field's values at the mesh's vertices: [n_vertices], to be freed. */
double *grid_surface_on_mesh(const struct grid_surface *surface,
                             const struct iso_grid_field *field);

#endif

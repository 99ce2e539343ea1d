/* The methods for the heat of twelve landmarks that the benchmark compares, and their input. */
#ifndef TESTS_BENCH_PEERS_HEAT_METHOD_H
#define TESTS_BENCH_PEERS_HEAT_METHOD_H

#include <stdbool.h>

#include "isotherm/isotherm_curve.h"
#include "isotherm/landmark.h"
#include "tests/core/surfaces/grid_surface.h"
#include "tests/core/surfaces/matrices.h"

/* The mean face as a mesh and as planes, with a heat source at each landmark. */
struct heat_case {
    struct grid_surface surface;
    struct iso_surface_point source[ISO_LANDMARKS];
    struct iso_grid_point grid_source[ISO_LANDMARKS];
    struct iso_vec3 centre_mm[ISO_LANDMARKS];
    double t_mm2, radius_mm;
    int n_points;
};

/* Makes a face with about this number of vertices; a failure ends the program. */
struct heat_case heat_case_of(double n_vertices);
/* Frees what the case holds. */
void heat_case_done(struct heat_case *c);

/* A method, its workspaces and columns. */
struct heat_method {
    const char *name;
    enum iso_mass mass; /* the mass matrix of its columns */
    bool exact;         /* its columns are heat and can be compared with the reference */
    int n_max;    /* vertices; with more the method takes too long, and bench_heat leaves it out */
    int n_before; /* calls before those that are timed: the direct solver orders a pattern in its
                     first two calls */
    /* NULL if there is no memory. */
    void *(*open)(const struct heat_case *c);
    /* The work of a frame: matrices, columns; then isotherms. 0 or a negative errno. */
    int (*heat)(void *state, const struct heat_case *c);
    int (*isotherms)(void *state, const struct heat_case *c,
                     struct iso_isotherm out[ISO_LANDMARKS]);
    void (*close)(void *state);
};

/* The first method is the grid, the second the general direct solver, the third 100 eigenpairs;
 * then follow the other libraries that were found when this was built. */
enum { HEAT_METHOD_GRID, HEAT_METHOD_DIRECT, HEAT_METHOD_EIGENPAIRS };
extern const struct heat_method heat_methods[];
extern const int n_heat_methods;

/* The work of the last heat() of the grid: pixels times steps. */
double heat_grid_pixels(const void *state);

/* Computes the isotherms of given heat columns [ISO_LANDMARKS][n_vertices] on the mesh. */
int heat_isotherms_on_mesh(struct iso_tracer *tracer, const struct heat_case *c, const double *heat,
                           struct iso_isotherm out[ISO_LANDMARKS]);

#endif

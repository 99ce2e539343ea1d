/* Other methods for heat or distances on a mesh, for comparison: in C++, with Eigen and Spectra
 * from Debian's packages. All functions return 0, or a negative errno if the library failed. */
#ifndef TESTS_BENCH_PEERS_HEAT_PEERS_H
#define TESTS_BENCH_PEERS_HEAT_PEERS_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The data of stiffness_mass.h and mesh.h in types that C and C++ share. */
struct peer_matrix {
    int32_t n, nnz;
    const int32_t *column_start, *row; /* of the lower triangle */
    const double *value;
};
struct peer_mesh {
    int32_t n_triangles;
    const double (*vertices_mm)[3];
    const int32_t (*triangles)[3];
    double area_mm2;
};

/* k eigenpairs of L phi = lambda B phi nearest to 0, by Spectra's shift-invert Lanczos over Eigen's
 * sparse LU, its default: lambda [k], phi [k][n]. */
int peer_spectra(const struct peer_matrix *stiffness, const struct peer_matrix *mass, int k,
                 double shift, double *lambda, double *phi);

/* Heat columns by `steps` steps of backward Euler with Eigen's SimplicialLDLT: loads and columns
 * are [n_columns][n]. */
int peer_backward_euler(const struct peer_matrix *stiffness, const struct peer_matrix *mass,
                        double t_mm2, int steps, const double *load, int n_columns, double *column);

/* Geodesic distances by the heat method (Crane, Weischedel and Wardetzky 2013) with Eigen's
 * SimplicialLDLT: loads and distances are [n_columns][n]. */
int peer_heat_method(const struct peer_mesh *mesh, const struct peer_matrix *stiffness,
                     const struct peer_matrix *mass, const double *load, int n_columns,
                     double *distance_mm);

#ifdef __cplusplus
}
#endif

#endif

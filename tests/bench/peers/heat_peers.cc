#include "tests/bench/peers/heat_peers.h"

#include <cerrno>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/Sparse>
#include <Spectra/SymGEigsShiftSolver.h>

using Sparse = Eigen::SparseMatrix<double>;
using Columns = Eigen::Map<Eigen::MatrixXd>;
using ConstColumns = Eigen::Map<const Eigen::MatrixXd>;
using Factor = Eigen::SimplicialLDLT<Sparse, Eigen::Lower>;

static Sparse sparse_of(const peer_matrix *a)
{
    return Eigen::Map<const Sparse>(a->n, a->n, a->nnz, a->column_start, a->row, a->value);
}

int peer_spectra(const peer_matrix *stiffness, const peer_matrix *mass, int k, double shift,
                 double *lambda, double *phi)
{
    using Op = Spectra::SymShiftInvert<double, Eigen::Sparse, Eigen::Sparse>;
    using Product = Spectra::SparseSymMatProd<double>;
    Sparse l = sparse_of(stiffness), b = sparse_of(mass);
    Op op(l, b);
    Product product(b);
    Spectra::SymGEigsShiftSolver<Op, Product, Spectra::GEigsMode::ShiftInvert> solver(
        op, product, k, 2 * k + 10, shift);
    solver.init();
    if (solver.compute(Spectra::SortRule::LargestMagn, 300, 1e-10,
                       Spectra::SortRule::SmallestMagn) < k) {
        return -ENOTRECOVERABLE;
    }
    Eigen::Map<Eigen::VectorXd>(lambda, k) = solver.eigenvalues();
    Columns(phi, stiffness->n, k) = solver.eigenvectors();
    return 0;
}

int peer_backward_euler(const peer_matrix *stiffness, const peer_matrix *mass, double t_mm2,
                        int steps, const double *load, int n_columns, double *column)
{
    Sparse l = sparse_of(stiffness), b = sparse_of(mass);
    Sparse sum = b + t_mm2 / steps * l;
    Factor factor(sum);
    if (factor.info() != Eigen::Success) {
        return -EDOM;
    }
    Columns u(column, stiffness->n, n_columns);
    u = factor.solve(ConstColumns(load, stiffness->n, n_columns));
    for (int i = 1; i < steps; i++) {
        Eigen::MatrixXd image = b.selfadjointView<Eigen::Lower>() * u;
        u = factor.solve(image);
    }
    return 0;
}

static Eigen::Vector3d vertex(const peer_mesh *mesh, int32_t index)
{
    return Eigen::Map<const Eigen::Vector3d>(mesh->vertices_mm[index]);
}

/* The divergence of the normalised negative gradient of the temperature u. */
static void add_divergence(const peer_mesh *mesh, const Eigen::Ref<const Eigen::VectorXd> &u,
                           Eigen::Ref<Eigen::VectorXd> divergence)
{
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        const int32_t *v = mesh->triangles[t];
        Eigen::Vector3d edge[3], gradient(0, 0, 0);
        for (int k = 0; k < 3; k++) {
            edge[k] = vertex(mesh, v[(k + 2) % 3]) - vertex(mesh, v[(k + 1) % 3]);
        }
        Eigen::Vector3d normal = edge[0].cross(edge[1]);
        double twice = normal.norm();
        normal /= twice;
        for (int k = 0; k < 3; k++) {
            gradient += u[v[k]] * normal.cross(edge[k]);
        }
        double length = gradient.norm();
        Eigen::Vector3d x = length > 0.0 ? Eigen::Vector3d(-gradient / length) : gradient;
        for (int k = 0; k < 3; k++) {
            const Eigen::Vector3d &a = edge[(k + 1) % 3], &b = edge[(k + 2) % 3];
            double cot_a = -a.dot(edge[k]) / twice, cot_b = -b.dot(edge[k]) / twice;
            divergence[v[k]] += 0.5 * (cot_a * b.dot(x) - cot_b * a.dot(x));
        }
    }
}

int peer_heat_method(const peer_mesh *mesh, const peer_matrix *stiffness, const peer_matrix *mass,
                     const double *load, int n_columns, double *distance_mm)
{
    Sparse l = sparse_of(stiffness), b = sparse_of(mass);
    /* The time is the square of the mean edge, as the authors advise. A tiny share of the mass
     * keeps L definite. */
    double edge = std::sqrt(mesh->area_mm2 / mesh->n_triangles * 4.0 / std::sqrt(3.0));
    Sparse first = b + edge * edge * l, second = l + 1e-9 * b;
    Factor heat(first), poisson(second);
    if (heat.info() != Eigen::Success || poisson.info() != Eigen::Success) {
        return -EDOM;
    }
    Columns distance(distance_mm, stiffness->n, n_columns);
    Eigen::MatrixXd u = heat.solve(ConstColumns(load, stiffness->n, n_columns));
    Eigen::MatrixXd divergence = Eigen::MatrixXd::Zero(stiffness->n, n_columns);
    for (int c = 0; c < n_columns; c++) {
        add_divergence(mesh, u.col(c), divergence.col(c));
    }
    distance = poisson.solve(-divergence);
    for (int c = 0; c < n_columns; c++) {
        double lowest = distance.col(c).minCoeff();
        distance.col(c).array() -= lowest;
    }
    return 0;
}

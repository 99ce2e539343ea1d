"""Finite elements: stiffness and mass matrices, eigenpairs."""
import errno
from ctypes import POINTER

import numpy as np

from ._library import Error, Owner, address, array_in, byref, check, lib, number_in, structs, view

_CONSISTENT, _LUMPED = 0, 1  # enum iso_mass


class SymmetricMatrix:
    """A symmetric sparse matrix, of which the lower triangle is stored in compressed columns, as in
    scipy.sparse.csc_matrix.

    indptr: (n + 1,) int32; indices: (nnz,) int32, the row of each entry; data: (nnz,) float64. They
    are read-only views.
    """

    def __init__(self, owner, pointer):
        """For the module itself: a matrix of the library that `owner` keeps."""
        self._owner = owner
        self._pointer = pointer
        matrix = pointer.contents
        self.n = matrix.n
        self.shape = (matrix.n, matrix.n)
        self.indptr = view(owner, matrix.column_start, (matrix.n + 1, ), np.int32)
        self.indices = view(owner, matrix.row, (matrix.nnz, ), np.int32)
        self.data = view(owner, matrix.value, (matrix.nnz, ), np.float64)

    def __matmul__(self, x):
        """The whole matrix times x: (n,) or (n, any) float64."""
        x = np.asarray(x)
        if x.ndim == 2:
            out = np.empty(x.shape, np.float64)
            for column in range(x.shape[1]):
                out[:, column] = self @ x[:, column]
            return out
        x = array_in(x, np.float64, (self.n, ), 'vector')
        out = np.empty(self.n, np.float64)
        lib.iso_symmetric_multiply(self._pointer, address(x), address(out))
        return out

    def to_scipy(self):
        """The whole matrix as a scipy.sparse.csc_matrix; needs SciPy."""
        import scipy.sparse
        lower = scipy.sparse.csc_matrix((self.data, self.indices, self.indptr), self.shape)
        return (lower + scipy.sparse.tril(lower, -1).T).tocsc()

    def __repr__(self):
        return '<isotherm.SymmetricMatrix: order %d, %d entries of its lower triangle>' % (self.n, len(self.data))


def _new_matrix(mesh):
    pointer = POINTER(structs.Symmetric)()
    n, m = mesh._struct.n_vertices, mesh._struct.n_triangles
    check(lib.iso_symmetric_new(n, n + 3 * m, byref(pointer)), 'matrix')
    return Owner(pointer, lib.iso_symmetric_free)


def finite_elements(mesh, lumped=False, density=None, robust=False):
    """Stiffness L and mass B of linear finite elements on a mesh: (L, B), two SymmetricMatrix.

    lumped: B is diagonal.
    density: (n,) float64 above 0, the density of a weighted manifold at the vertices (Abdelrahman
    2013, 5.11 to 5.13); None: 1 everywhere.
    robust: those of the intrinsic Delaunay triangulation of the mesh's tufted cover (Sharp and Crane
    2020), for bad meshes.
    L has no unit, B is in the square of the mesh's unit. Of a vertex in no triangle, the row of L is
    0 and that of B has 1 on its diagonal.
    """
    mesh._check()
    if len(mesh.triangles) == 0:
        raise Error('mesh: it has no triangles')
    stiffness, mass = _new_matrix(mesh), _new_matrix(mesh)
    kind = _LUMPED if lumped else _CONSISTENT
    if density is not None:
        density = array_in(density, np.float64, (len(mesh.vertices), ), 'density')
        if not (density > 0).all():
            raise Error('density: a number is not above 0')
    weight = None if density is None else address(density)
    if robust:
        code = lib.iso_stiffness_mass_robust(byref(mesh._struct), kind, weight, stiffness.pointer, mass.pointer)
    elif density is None:
        code = lib.iso_stiffness_mass(byref(mesh._struct), kind, stiffness.pointer, mass.pointer)
    else:
        code = lib.iso_stiffness_mass_weighted(byref(mesh._struct), kind, weight, stiffness.pointer, mass.pointer)
    check(code, 'mesh')
    return SymmetricMatrix(stiffness, stiffness.pointer), SymmetricMatrix(mass, mass.pointer)


def eigenpairs(stiffness, mass, k, tolerance=0.0):
    """The first k generalised eigenpairs L phi = lambda B phi: (eigenvalues, eigenvectors).

    k: 1..n/2, where n is at least 8. tolerance: relative, of the residual; 0: machine precision.
    eigenvalues: (k,) float64, ascending from 0, in 1 / unit^2. eigenvectors: (n, k) float64, one in
    each column, with phi' B phi = 1. Both are read-only views.
    """
    if stiffness.n != mass.n:
        raise Error('matrices: of the orders %d and %d' % (stiffness.n, mass.n))
    if not (np.array_equal(stiffness.indptr, mass.indptr) and np.array_equal(stiffness.indices, mass.indices)):
        raise Error('matrices: not from one call of finite_elements()')
    if stiffness.n < 8:
        raise Error('matrices: of the order %d, at least 8 is needed' % stiffness.n)
    k = number_in(k, 1, stiffness.n // 2, 'k')
    if not 0 <= float(tolerance) < np.inf:
        raise Error('tolerance: %r is negative or not finite' % tolerance)
    pointer = POINTER(structs.Eigenpairs)()
    check(lib.iso_eigenpairs_new(stiffness._pointer, mass._pointer, k, tolerance, byref(pointer)), 'eigenpairs',
          SPECTRUM_FAULTS)
    return pairs_views(Owner(pointer, lib.iso_eigenpairs_free), pointer.contents)


def pairs_views(owner, pairs):
    """Eigenvalues (k,) and eigenvectors (n, k) of a struct that `owner` keeps."""
    values = view(owner, pairs.lambda_, (pairs.k, ), np.float64)
    return values, view(owner, pairs.phi, (pairs.k, pairs.n), np.float64).T


SPECTRUM_FAULTS = {
    errno.EDOM: 'its matrices cannot be factorised: triangles are too thin, or their sizes differ too much',
    errno.ENOTRECOVERABLE: 'its eigenpairs do not converge, one of them is of a multiplicity above 32, or it takes '
                           'too many flips of edges to make its triangulation intrinsic Delaunay',
}

"""Distances on a shape, and corresponding points of two shapes."""
import errno
import threading
from ctypes import c_void_p

import numpy as np

from ._library import Error, Owner, address, array_in, byref, check, lib, number_in, structs


class Geodesics:
    """Distances on a shape by heat (Crane, Weischedel and Wardetzky 2013). Two matrices are
    factorised once; each source is two solves. Several threads may use it, one after the other."""

    def __init__(self, shape):
        """Raises Error if a matrix cannot be factorised."""
        geodesic = c_void_p()
        check(lib.iso_geodesic_new(shape._pointer, byref(geodesic)), 'shape',
              {errno.EDOM: 'its matrices cannot be factorised'})
        # The library borrows the shape.
        self._owner = Owner(geodesic, lib.iso_geodesic_free, shape._owner)
        self._n = shape.n
        self._lock = threading.Lock()

    def distances(self, vertex):
        """Distances of all vertices from one: (n,) float64, in the unit of the mesh."""
        vertex = number_in(vertex, 0, self._n - 1, 'vertex')
        out = np.empty(self._n, np.float64)
        with self._lock:
            check(lib.iso_geodesic_distance(self._owner.pointer, vertex, address(out)), 'distances')
        return out


def functional_map(from_shape, to_shape, from_functions, to_functions, k=20, weight=0.01):
    """The functional map that takes functions of one shape to the same functions of another one and
    commutes with the Laplacians (Ovsjanikov et al. 2012): (k, k) float64. It takes coefficients in
    the first k eigenvectors of from_shape to those of to_shape.

    from_functions, to_functions: (n, any) float64, such as signatures. weight: of the commutator,
    above 0.
    """
    own = array_in(from_functions, np.float64, (from_shape.n, None), 'from_functions')
    other = array_in(to_functions, np.float64, (to_shape.n, own.shape[1]), 'to_functions')
    if own.shape[1] < 1:
        raise Error('from_functions: there are none')
    if not 0 < float(weight) < np.inf:
        raise Error('weight: %r is not above 0 and finite' % weight)
    k = number_in(k, 1, _pairs_of_both(from_shape, to_shape), 'k')
    functions = structs.SharedFunctions(own.shape[1], address(own), address(other))
    out = np.empty((k, k), np.float64)
    check(
        lib.iso_functional_map_fit(from_shape._pointer, to_shape._pointer, k, byref(functions), weight, address(out)),
        'functional_map', {errno.EDOM: 'there is no solution'})
    return out


def points_of_map(from_shape, to_shape, c):
    """The map of points nearest to a functional map, (k, k) float64: (n,) int32, for each vertex of
    to_shape a vertex of from_shape."""
    c, k = _map_in(from_shape, to_shape, c)
    out = np.empty(to_shape.n, np.int32)
    check(lib.iso_functional_map_points(from_shape._pointer, to_shape._pointer, k, address(c), address(out)),
          'points_of_map')
    return out


def map_of_points(from_shape, to_shape, points, k):
    """The functional map of a map of points, (n of to_shape,) int32: (k, k) float64."""
    points = array_in(points, np.int32, (to_shape.n, ), 'points')
    if points.min() < 0 or points.max() >= from_shape.n:
        raise Error('points: a number is outside 0..%d' % (from_shape.n - 1))
    k = number_in(k, 1, _pairs_of_both(from_shape, to_shape), 'k')
    out = np.empty((k, k), np.float64)
    check(lib.iso_functional_map_of(from_shape._pointer, to_shape._pointer, k, address(points), address(out)),
          'map_of_points')
    return out


def zoom_out(from_shape, to_shape, c, step=5, k_last=None):
    """Refines a functional map, (k, k) float64, with `step` more eigenvectors each round, up to
    k_last (Melzi et al. 2019; None: as many as both shapes have), and returns its map of points: (n
    of to_shape,) int32."""
    c, k = _map_in(from_shape, to_shape, c)
    most = _pairs_of_both(from_shape, to_shape)
    step = number_in(step, 1, 2**31 - 1, 'step')
    k_last = most if k_last is None else number_in(k_last, k, most, 'k_last')
    out = np.empty(to_shape.n, np.int32)
    check(
        lib.iso_zoom_out(from_shape._pointer, to_shape._pointer, k, address(c), step, k_last, address(out)),
        'zoom_out')
    return out


def match(from_shape, to_shape, first_pairs=20, step=5, weight=0.01):
    """Corresponding points of two shapes, as `isotherm-sim shapes match` finds them: a functional map
    fitted to wave and heat kernel signatures, refined by ZoomOut.

    Returns (points, map): (n of to_shape,) int32, for each vertex of to_shape a vertex of from_shape,
    and the functional map of these points, (k, k) float64, where k is the smaller number of
    eigenpairs.
    """
    options = structs.MatchOptions(number_in(first_pairs, 2, 2**31 - 1, 'first_pairs'),
                                   number_in(step, 1, 2**31 - 1, 'step'), float(weight))
    if not 0 < options.weight < np.inf:
        raise Error('weight: %r is not above 0 and finite' % weight)
    k = _pairs_of_both(from_shape, to_shape)
    points, c = np.empty(to_shape.n, np.int32), np.empty((k, k), np.float64)
    check(
        lib.iso_shape_match(from_shape._pointer, to_shape._pointer, byref(options), address(points), address(c)),
        'match', {
            errno.EINVAL: 'a shape has fewer than two different eigenvalues above 0',
            errno.EDOM: 'there is no first map'
        })
    return points, c


def _pairs_of_both(from_shape, to_shape):
    return min(len(from_shape.eigenvalues), len(to_shape.eigenvalues))


def _map_in(from_shape, to_shape, c):
    c = array_in(c, np.float64, (None, None), 'map')
    if c.shape[0] != c.shape[1]:
        raise Error('map: its shape is %s, it has to be square' % (c.shape, ))
    return c, number_in(c.shape[0], 1, _pairs_of_both(from_shape, to_shape), 'map')

"""Heat on a shape, without eigenpairs."""
import errno
import threading
from ctypes import c_void_p

import numpy as np

from ._library import Error, Owner, address, array_in, byref, check, lib, structs

_TIMES_MAX = 10000
_KRYLOV = 32  # ISO_HEAT_KRYLOV_MAX: fine meshes and several times at once need more than the default


class Heat:
    """Heat from single vertices of a shape by the direct solver: one factorisation of the matrices, and
    a small Krylov space for each vertex (van den Eshof and Hochbruck 2006). Unlike a sum over eigenpairs
    it is right for short times, too. Several threads may use it, one after the other."""

    def __init__(self, shape):
        """Needs no eigenpairs: Shape(mesh, pairs=2) will do."""
        solver = c_void_p()
        options = structs.HeatDirectOptions(n_capacity=shape.n, nnz_capacity=len(shape.stiffness.data),
                                            krylov=_KRYLOV)
        check(lib.iso_heat_direct_new(byref(options), byref(solver)), 'shape')
        # The library borrows the shape's mesh and matrices.
        self._owner = Owner(solver, lib.iso_heat_direct_free, shape._owner)
        self._shape = shape
        self._lock = threading.Lock()
        # A triangle of each vertex, and the place of the vertex in it: the library takes points of triangles.
        self._triangle = np.full(shape.n, -1, np.int32)
        self._corner = np.zeros(shape.n, np.int32)
        for corner in range(3):
            self._triangle[shape.triangles[:, corner]] = np.arange(len(shape.triangles))
            self._corner[shape.triangles[:, corner]] = corner

    def columns(self, vertices, times):
        """The temperature everywhere after unit heat at a vertex has flowed for a time: columns of the heat
        kernel, (vertices, times, n) float64, in 1 / unit^2. The mass matrix times a column sums to 1.

        vertices: (any,) int32. times: (any,) float64, above 0, in unit^2, with decay exp(-lambda t); those
        below a hundredth of the longest one of a call are less exact, and better asked for by themselves.
        Raises Error if the matrices cannot be factorised.
        """
        shape = self._shape
        vertices = array_in(vertices, np.int32, (None, ), 'vertices')
        times = array_in(times, np.float64, (None, ), 'times')
        if not len(vertices) or not ((vertices >= 0) & (vertices < shape.n)).all():
            raise Error('vertices: they have to be of 0..%d, one or more' % (shape.n - 1))
        if not 0 < len(times) <= _TIMES_MAX or not ((times > 0) & (times < np.inf)).all():
            raise Error('times: they have to be above 0 and finite, 1..%d of them' % _TIMES_MAX)
        sources = (structs.SurfacePoint * len(vertices))()
        for source, vertex in zip(sources, vertices):
            source.triangle = self._triangle[vertex]
            source.weight[self._corner[vertex]] = 1.0
        out = np.empty((len(vertices), len(times), shape.n), np.float64)
        with self._lock:
            check(lib.iso_heat_direct(self._owner.pointer, shape._pointer.contents.mesh, shape.stiffness._pointer,
                                      shape.mass._pointer, sources, len(vertices), address(times), len(times),
                                      address(out)), 'heat', {errno.EDOM: 'the matrices cannot be factorised'})
        return out

"""Shapes: a connected surface with its spectrum, and functions of its vertices."""
import errno
import math
import warnings
from ctypes import POINTER, c_double

import numpy as np

from ._library import Error, Owner, address, array_in, byref, check, frees, lib, number_in, structs, view
from ._matrix import SPECTRUM_FAULTS, SymmetricMatrix, pairs_views

VERTICES_MIN = 32  # ISO_SHAPE_VERTICES_MIN
_NUMBERS_MAX = 10000
_LEFT_OUT_MOST = 0.01
_NEIGHBOURS_MIN, _NEIGHBOURS_MAX = 6, 200  # ISO_CLOUD_NEIGHBOURS_MIN, _MAX


class Shape:
    """The largest component of a mesh, with its finite elements and the lower end of its spectrum.

    Lengths are in the unit of the mesh, times of heat t in its square, with decay exp(-lambda t).
    All arrays are read-only views of the library's memory, which stays as long as one of them.

    vertices (n, 3) float64, triangles (m, 3) int32: the component, without unused vertices
    colours (n, 3) float32, or None
    areas (n,) float64: a third of the area of the triangles around each vertex
    is_cloud: made by of_points()
    total_area: their sum; area_left_out: the share of the mesh's area that is not in the shape
    near_boundary (n,) bool: on the boundary, or two edges or less from it
    stiffness, mass: SymmetricMatrix
    eigenvalues (k,) float64, ascending from 0; eigenvectors (n, k) float64, one in each column
    weighted: of a shape with colours, three pairs (eigenvalues, eigenvectors) on the manifolds whose
    densities are its channels; else empty
    """

    def __init__(self, mesh, pairs=0, colours=False, robust=False):
        """Makes the shape of a mesh.

        pairs: eigenpairs, the trivial one among them; 0: 100. A shape has at most half as many as
        vertices. colours: whether methods that need the mesh's colours will be used. robust: finite
        elements for bad meshes: those of the intrinsic Delaunay triangulation of the mesh's tufted
        cover (Sharp and Crane 2020); areas and distances stay those of the mesh.
        Raises Error if fewer than 32 vertices are left, or if its spectrum cannot be computed. Warns
        if over 1 % of the mesh's area is left out.
        """
        pairs = number_in(pairs, 0, 2**31 - 1, 'pairs')
        if colours and mesh.colours is None:
            raise Error('mesh: it has no colours', errno.ENODATA)
        mesh_area = mesh.area
        pointer = POINTER(structs.Shape)()
        given = address(mesh._arrays[2]) if colours else None
        make = lib.iso_shape_new_robust if robust else lib.iso_shape_new
        check(make(byref(mesh._struct), given, pairs, byref(pointer)), 'mesh', {
            errno.ENODATA: 'its largest part has fewer than %d vertices' % VERTICES_MIN, **SPECTRUM_FAULTS})
        self._pointer = pointer
        self._owner = Owner(pointer, lib.iso_shape_free)
        self._see(pointer.contents)
        self.area_left_out = max(0.0, 1.0 - self.total_area / mesh_area)
        if self.area_left_out > _LEFT_OUT_MOST:
            warnings.warn('%.1f %% of the area of the mesh is not in its largest part, and is left out' %
                          (100 * self.area_left_out), stacklevel=2)

    @classmethod
    def of_points(cls, points, pairs=0, colours=None, neighbours=0):
        """Makes the shape of a cloud: points of a surface, without triangles (Sharp and Crane 2020,
        5.7). Triangles of the points and their nearest neighbours stand for the surface: the shape's
        `triangles`, some of which overlap. `areas` are the sums of the rows of the mass matrix.

        points: (n, 3) float64, in any unit. pairs: as for Shape(). colours: (n, 3) float32 of 0..1, or
        None. neighbours: of each point, 6..200; 0: 30. area_left_out is the share of the points that
        are not joined to the largest part, or at the place of another one.
        Raises Error as Shape(). Warns if over 1 % of the points are left out, for each of the two
        reasons.
        """
        points = array_in(points, np.float64, (None, 3), 'points')
        pairs = number_in(pairs, 0, 2**31 - 1, 'pairs')
        if neighbours != 0:
            neighbours = number_in(neighbours, _NEIGHBOURS_MIN, _NEIGHBOURS_MAX, 'neighbours')
        if colours is not None:
            colours = array_in(colours, np.float32, (len(points), 3), 'colours')
            if not ((colours >= 0) & (colours <= 1)).all():
                raise Error('colours: a number is outside 0..1')
        if not 0 < len(points) < 2**31:
            raise Error('points: there are %d' % len(points))
        pointer = POINTER(structs.Shape)()
        check(lib.iso_shape_new_cloud(address(points), None if colours is None else address(colours), len(points),
                                      neighbours, pairs, byref(pointer)), 'points', {
            errno.ENODATA: 'their largest part has fewer than %d points' % VERTICES_MIN, **SPECTRUM_FAULTS})
        shape = cls.__new__(cls)
        shape._pointer = pointer
        shape._owner = Owner(pointer, lib.iso_shape_free)
        shape._see(pointer.contents)
        shape.area_left_out = 1.0 - shape.n / len(points)
        for share, reason in _points_left_out(points, shape.n):
            if share > _LEFT_OUT_MOST:
                warnings.warn('%.1f %% of the points are %s, and are left out' % (100 * share, reason), stacklevel=2)
        return shape

    def _see(self, shape):
        owner, mesh = self._owner, shape.mesh.contents
        n = mesh.n_vertices
        self.vertices = view(owner, mesh.vertices_mm, (n, 3), np.float64)
        self.triangles = view(owner, mesh.triangles, (mesh.n_triangles, 3), np.int32)
        self.colours = view(owner, shape.colour, (n, 3), np.float32) if shape.colour else None
        self.areas = view(owner, shape.area, (n, ), np.float64)
        self.total_area = shape.total_area
        self.is_cloud = shape.is_cloud
        self.near_boundary = view(owner, shape.near_boundary, (n, ), np.bool_)
        self.stiffness = SymmetricMatrix(owner, shape.stiffness)
        self.mass = SymmetricMatrix(owner, shape.mass)
        self.eigenvalues, self.eigenvectors = pairs_views(owner, shape.pairs.contents)
        self.weighted = [pairs_views(owner, pairs.contents) for pairs in shape.weighted if pairs]

    @property
    def n(self):
        """How many vertices there are."""
        return len(self.vertices)

    # ---- signatures

    def heat_times(self, n=100, first=None, last=None):
        """(n,) float64: times evenly spaced on a logarithmic scale. By default from 4 ln 10 over the
        last eigenvalue to 4 ln 10 over the first one that is not trivial (Sun, Ovsjanikov and Guibas
        2009)."""
        n = number_in(n, 1, _NUMBERS_MAX, 'n')
        first = 4 * math.log(10) / self.eigenvalues[-1] if first is None else float(first)
        last = 4 * math.log(10) / self.eigenvalues[1] if last is None else float(last)
        if not 0 < first <= last < np.inf:
            raise Error('times: from %g to %g' % (first, last))
        out = np.empty(n, np.float64)
        lib.iso_heat_times(first, last, n, address(out))
        return out

    def hks(self, times=None, first=0):
        """Heat kernel signature K(x, x, t), (n, times) float64, in 1 / unit^2 (Sun, Ovsjanikov and
        Guibas 2009). times: (any,) float64, not negative; None: heat_times(). first: the first
        eigenpair of the sum; 1 leaves the constant out."""
        times, out = self._times_and_room(times)
        first = number_in(first, 0, len(self.eigenvalues), 'first')
        check(lib.iso_heat_signature(self._pairs(), first, address(times), len(times), address(out)), 'hks')
        return out

    def heat_from(self, vertex, times=None, first=0):
        """The heat at every vertex after unit heat was released at one: (n, times) float64, in
        1 / unit^2. times and first as for hks()."""
        vertex = number_in(vertex, 0, self.n - 1, 'vertex')
        times, out = self._times_and_room(times)
        first = number_in(first, 0, len(self.eigenvalues), 'first')
        check(lib.iso_heat_from_vertex(self._pairs(), vertex, first, address(times), len(times), address(out)),
              'heat_from')
        return out

    def hms(self, time=None):
        """Heat mean signature: the heat that all other vertices have received from a vertex, divided
        by the number of vertices; (n,) float64, in 1 / unit^2 (Fang, Sun, Kim and Ramani 2011).
        time: None: a 64th of the area, as in the method `td`."""
        time = self.total_area / 64 if time is None else float(time)
        if not 0 <= time < np.inf:
            raise Error('time: %g is negative or not finite' % time)
        out = np.empty(self.n, np.float64)
        check(lib.iso_heat_mean_signature(self._pairs(), time, address(out)), 'hms')
        return out

    def si_hks(self):
        """Scale-invariant heat kernel signature: amplitudes of six frequencies, (n, 6) float32
        (Bronstein and Kokkinos 2010), as the method `shape-google` uses it."""
        from ._describe import describe
        return describe(self, 'shape-google').local[0]

    def wave_energies(self, n=100):
        """Energies for wks(), which are logarithms of eigenvalues, and their spread: ((n,) float64,
        float). n is at least 2."""
        n = number_in(n, 2, _NUMBERS_MAX, 'n')
        out, spread = np.empty(n, np.float64), c_double()
        check(lib.iso_wave_energies(self._pairs(), n, address(out), byref(spread)), 'wave_energies',
              {errno.EINVAL: 'the shape has fewer than two different eigenvalues above 0'})
        return out, spread.value

    def wks(self, energies=None, spread=None):
        """Wave kernel signature, (n, energies) float64, in 1 / unit^2 (Aubry, Schlickewei and Cremers
        2011). energies: (any,) float64, with their spread, a float above 0; None: wave_energies()."""
        if energies is None and spread is None:
            energies, spread = self.wave_energies()
        if energies is None or spread is None or not 0 < float(spread) < np.inf:
            raise Error('wks: energies and their spread, above 0, are needed together')
        energies = array_in(energies, np.float64, (None, ), 'energies')
        if not 0 < len(energies) <= _NUMBERS_MAX:
            raise Error('energies: %d of them, 1..%d are possible' % (len(energies), _NUMBERS_MAX))
        if len(self.eigenvalues) < 2 or not self.eigenvalues[1] > 0:
            raise Error('wks: the shape has no eigenvalue above 0')
        out = np.empty((self.n, len(energies)), np.float64)
        check(lib.iso_wave_signature(self._pairs(), address(energies), len(energies), spread, address(out)), 'wks')
        return out

    # ---- points

    def extrema(self, function):
        """Vertices where a function, (n,) float64, has an extremum over its two rings of neighbours,
        except near a boundary: (any,) int32, by falling magnitude of the function."""
        function = array_in(function, np.float64, (self.n, ), 'function')
        points = structs.CriticalPoints()
        check(lib.iso_shape_extrema(self._pointer, address(function), byref(points)), 'extrema')
        return _points(points)

    def critical_points(self):
        """The extrema of the first non-trivial eigenfunction, which lie at the tips of a shape
        (Abdelrahman 2013, 4.1): (any,) int32, at least one."""
        if len(self.eigenvalues) < 2:
            raise Error('critical_points: the shape has only the trivial eigenpair')
        points = structs.CriticalPoints()
        check(lib.iso_shape_critical_points(self._pointer, byref(points)), 'critical_points')
        return _points(points)

    # ---- within the class

    def _pairs(self):
        return self._pointer.contents.pairs

    def _times_and_room(self, times):
        times = self.heat_times() if times is None else array_in(times, np.float64, (None, ), 'times')
        if not 0 < len(times) <= _NUMBERS_MAX:
            raise Error('times: %d of them, 1..%d are possible' % (len(times), _NUMBERS_MAX))
        if not (times >= 0).all():
            raise Error('times: a number is negative')
        return times, np.empty((self.n, len(times)), np.float64)

    def __repr__(self):
        return '<isotherm.Shape: %d vertices, %d triangles, %d eigenpairs>' % (
            self.n, len(self.triangles), len(self.eigenvalues))


def _points_left_out(points, n_used):
    """Which shares of the points are not used, each with its reason."""
    if n_used == len(points):
        return []
    n_places = len(np.unique(points, axis=0))
    return [((len(points) - n_places) / len(points), 'at the place of another one'),
            ((n_places - n_used) / len(points), 'not joined to the largest part')]


def _points(points):
    owner = Owner(points, frees(lib.iso_critical_points_done))
    return view(owner, points.vertex, (points.n, ), np.int32)

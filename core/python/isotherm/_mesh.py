"""Triangle meshes: from arrays, from files."""
import errno
import os
from ctypes import POINTER, c_void_p

import numpy as np

from ._frame import Camera, Frame
from ._library import Error, Owner, address, array_in, byref, check, frees, lib, read_file, structs, view



class Mesh:
    """A triangle mesh in any unit. Triangles are counter-clockwise seen from outside.

    vertices: (n, 3) float64; triangles: (m, 3) int32, counted from 0; colours: (n, 3) float32 of
    0..1, or None. All three are read-only views. Arrays that have the right type already are shared
    with the caller and not copied: later changes of them are changes of the mesh.
    """

    def __init__(self, vertices, triangles, colours=None):
        """Makes a mesh of arrays. Raises Error for arrays of other shapes, numbers that are not
        finite, and triangles with a vertex that does not exist or with the same vertex twice."""
        vertices = array_in(vertices, np.float64, (None, 3), 'vertices')
        triangles = array_in(triangles, np.int32, (None, 3), 'triangles')
        if colours is not None:
            colours = array_in(colours, np.float32, (len(vertices), 3), 'colours')
        if len(vertices) + 3 * len(triangles) >= 2**31:
            raise Error('mesh: %d vertices and %d triangles are too many' % (len(vertices), len(triangles)), errno.EFBIG)
        struct = structs.Mesh(len(vertices), len(triangles), len(vertices), len(triangles),
                              address(vertices), address(triangles))
        self._set(struct, vertices, triangles, colours, {})
        self._check()

    def _set(self, struct, vertices, triangles, colours, mended):
        self._struct = struct
        self._arrays = (vertices, triangles, colours)
        self._mended = mended

    def _check(self):
        """Indices and coordinates are sound now. Arrays of the caller may have changed since the
        last call."""
        fault = structs.Fault()
        check(lib.iso_mesh_check(byref(self._struct), byref(fault)), 'mesh', fault=fault)
        colours = self._arrays[2]
        if colours is not None and not ((colours >= 0) & (colours <= 1)).all():
            raise Error('colours: a number is outside 0..1')

    @classmethod
    def load(cls, path, mend=True):
        """Reads a mesh from a file named .off, .obj, .ply, .stl, or .vert with its .tri beside it.
        load_points() reads clouds.

        mend: joins vertices at the same place, and removes triangles with two corners at one place,
        copies of triangles and vertices of no triangle; `mended` says how many.
        Raises OSError for a file that cannot be read, and Error, with the name of the file and the
        line, for contents that are not understood.
        """
        path = os.fsdecode(path)
        owner, coloured, mended = _parse(path, lib.iso_mesh_parse, mend)
        return cls._of_owner(owner, coloured.mesh.contents, coloured.colour, mended)

    @classmethod
    def from_depth(cls, depth, focal_length, centre=None, jump=10.0, largest_only=False):
        """The surface that a depth camera sees, in its frame: x right, y down, z forward,
        millimetres.

        depth: (rows, columns), millimetres along the optical axis; 0 where nothing was measured.
        focal_length: pixels, a number or (horizontal, vertical). centre: column and row of the
        optical axis; None: the middle. jump: an edge over which the depth changes by more
        millimetres is cut. largest_only: keep the largest connected piece only.
        Raises Error for depths that are negative or not finite, a camera that cannot exist, and a
        frame without a triangle.
        """
        depth = array_in(depth, np.float32, (None, None), 'depth')
        rows, columns = depth.shape
        fx, fy = np.broadcast_to(np.asarray(focal_length, float), (2, ))
        cx, cy = ((columns - 1) / 2, (rows - 1) / 2) if centre is None else centre
        return cls.from_frame(Frame(depth, Camera(columns, rows, cx, cy, fx, fy)), jump, largest_only)

    @classmethod
    def from_frame(cls, frame, jump=10.0, largest_only=False):
        """The same for a Frame, such as one of a Recording."""
        if not isinstance(frame, Frame):
            raise Error('frame: of the type %s, not isotherm.Frame' % type(frame).__name__)
        given, size = frame._check(), frame.depth.size
        options, triangulator = structs.TriangulateOptions(jump, largest_only), c_void_p()
        check(lib.iso_triangulator_new(size, byref(options), byref(triangulator)), 'jump',
              {errno.EINVAL: '%r is not above 0' % jump})
        work = Owner(triangulator, lib.iso_triangulator_free)
        pointer = POINTER(structs.Mesh)()
        check(lib.iso_mesh_new(size, 2 * size, byref(pointer)), 'depth')
        owner = Owner(pointer, lib.iso_mesh_free)
        check(lib.iso_triangulate(work.pointer, given, pointer), 'depth',
              {errno.ENODATA: 'it has no triangle'})
        return cls._of_owner(owner, pointer.contents, None, {})

    @classmethod
    def _of_owner(cls, owner, struct, colour, mended):
        vertices = view(owner, struct.vertices_mm, (struct.n_vertices, 3), np.float64)
        triangles = view(owner, struct.triangles, (struct.n_triangles, 3), np.int32)
        colours = view(owner, colour, (struct.n_vertices, 3), np.float32) if colour else None
        mesh = cls.__new__(cls)
        mesh._set(struct, vertices, triangles, colours, mended)
        mesh._owner = owner
        return mesh

    @property
    def vertices(self):
        """(n, 3) float64: positions."""
        return _read_only(self._arrays[0])

    @property
    def triangles(self):
        """(m, 3) int32: the vertices of each triangle, counted from 0."""
        return _read_only(self._arrays[1])

    @property
    def colours(self):
        """(n, 3) float32: red, green and blue of each vertex, 0..1; or None."""
        return None if self._arrays[2] is None else _read_only(self._arrays[2])

    @property
    def mended(self):
        """What load() mended, by name: merged, collapsed, repeated, unused. Empty for arrays."""
        return dict(self._mended)

    @property
    def area(self):
        """Area of all triangles, in the square of the mesh's unit."""
        self._check()
        return lib.iso_mesh_area(byref(self._struct))

    def __repr__(self):
        return '<isotherm.Mesh: %d vertices, %d triangles%s>' % (
            len(self._arrays[0]), len(self._arrays[1]), '' if self._arrays[2] is None else ', coloured')


def load_points(path, mend=True):
    """Reads a cloud of points from a file named .xyz, or one named .off, .obj or .ply that has no
    triangles: ((n, 3) float64, (n, 3) float32 of colours 0..1 or None), for Shape.of_points().

    mend: points at the same place become one.
    Raises OSError for a file that cannot be read, and Error, with the name of the file, for contents
    that are not understood and for a mesh.
    """
    path = os.fsdecode(path)
    owner, coloured, _ = _parse(path, lib.iso_mesh_or_cloud_parse, mend)
    mesh = coloured.mesh.contents
    if mesh.n_triangles:
        raise Error('%s: it has triangles: Mesh.load() reads it' % path)
    points = view(owner, mesh.vertices_mm, (mesh.n_vertices, 3), np.float64)
    return points, view(owner, coloured.colour, (mesh.n_vertices, 3), np.float32) if coloured.colour else None


def _parse(path, parse, mend):
    """The contents of a file by a function of the library: their owner, the struct, and what was
    mended, by name."""
    number = _format_of(path)
    data = read_file(path)
    text, tri = _terminated(data), None
    if path.lower().endswith('.vert'):
        tri = _terminated(read_file(path[:-len('vert')] + 'tri'), no_zero=path[:-len('vert')] + 'tri')
    coloured, fault = structs.ColouredMesh(), structs.Fault()
    code = parse(number, os.fsencode(path), address(text), len(data), None if tri is None else address(tri),
                 byref(coloured), byref(fault))
    check(code, path, fault=fault)
    owner = Owner(coloured, frees(lib.iso_coloured_mesh_done))
    mended = structs.MeshMended()
    if mend:
        check(lib.iso_mesh_mend(byref(coloured), byref(mended)), path, {errno.EBADMSG: 'no triangle is left of it'})
    return owner, coloured, {name: getattr(mended, name) for name, _ in mended._fields_}


def _read_only(array):
    seen = array.view()
    seen.flags.writeable = False
    return seen


def _format_of(path):
    """The number of a format, enum iso_mesh_format, by the ending of a name."""
    ending, number = os.path.splitext(path)[1].lower(), 0
    while (suffix := lib.iso_mesh_format_suffix(number)) is not None:
        if ending == '.' + suffix.decode():
            return number
        number += 1
    raise Error('%s: not named .off, .obj, .ply, .stl, .vert or .xyz' % path, errno.ENOTSUP)


def _terminated(data, no_zero=None):
    """Bytes that the library may change, with a zero byte at their end. no_zero: the name of a file
    that must not have another one."""
    if no_zero is not None and b'\0' in data:
        raise Error('%s: not a text file (it holds a NUL byte)' % no_zero, errno.EBADMSG)
    text = np.zeros(len(data) + 1, np.uint8)
    text[:-1] = np.frombuffer(data, np.uint8)
    return text

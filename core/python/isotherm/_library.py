"""libisotherm.so.0: its functions, its errors, and its memory as arrays."""
import ctypes
import errno
import os
import stat
from ctypes import (POINTER, byref, c_bool, c_char_p, c_double, c_int, c_int32, c_size_t, c_uint32, c_uint64,
                    c_void_p)

import numpy as np

from . import _structs as structs

SONAME = 'libisotherm.so.0'
_BYTES_MOST = 1 << 30


class Error(ValueError):
    """What the library refuses. The text is one line that names the thing and the fault.

    errno: the number of errno.h that the function returned, such as errno.EINVAL.
    """

    def __init__(self, text, code=errno.EINVAL):
        super().__init__(text)
        self.errno = code


def _load():
    try:
        return ctypes.CDLL(SONAME)
    except OSError as error:
        raise ImportError('%s cannot be loaded (package libisotherm0): %s' % (SONAME, error)) from None


lib = _load()


def _declare():
    """Result and arguments of every function that the module calls. Arrays are c_void_p: their type
    and size are checked where they are made."""
    mesh, matrix, pairs = POINTER(structs.Mesh), POINTER(structs.Symmetric), POINTER(structs.Eigenpairs)
    shape, description = POINTER(structs.Shape), POINTER(structs.ShapeDescription)
    method, fault = POINTER(structs.ShapeMethod), POINTER(structs.Fault)
    points, coloured = POINTER(structs.CriticalPoints), POINTER(structs.ColouredMesh)
    ops = POINTER(structs.ClassifierOps)
    head, metric, vector = POINTER(structs.HeadModel), POINTER(structs.Metric), POINTER(structs.MetricVector)
    template, extraction = POINTER(structs.Template), POINTER(structs.Extraction)
    functions = {
        'iso_frame_check': (c_int, POINTER(structs.Frame), fault),
        'iso_triangulator_new': (c_int, c_size_t, POINTER(structs.TriangulateOptions), POINTER(c_void_p)),
        'iso_triangulator_free': (None, c_void_p),
        'iso_triangulate': (c_int, c_void_p, POINTER(structs.Frame), mesh),
        'iso_landmark_name': (c_char_p, c_int),
        'iso_capture_name': (c_char_p, c_int),
        'iso_capture_is_attack': (c_bool, c_int),
        'iso_head_model_parse': (c_int, c_char_p, c_size_t, POINTER(head), fault),
        'iso_head_model_free': (None, head),
        'iso_extract_options_default': (structs.ExtractOptions, ),
        'iso_extractor_new': (c_int, head, POINTER(structs.ExtractOptions), POINTER(c_void_p)),
        'iso_extractor_free': (None, c_void_p),
        'iso_extractor_algorithm': (c_uint32, c_void_p),
        'iso_extractor_run': (c_int, c_void_p, POINTER(structs.Frame), extraction),
        'iso_extractor_locate': (c_int, c_void_p, POINTER(structs.Frame), extraction),
        'iso_extractor_forget': (None, c_void_p),
        'iso_extractor_mesh': (mesh, c_void_p),
        'iso_extractor_heat': (c_void_p, c_void_p, c_int),
        'iso_template_serialise': (c_int, template, c_char_p, c_size_t),
        'iso_template_parse': (c_int, c_char_p, c_size_t, template),
        'iso_template_wipe': (None, template),
        'iso_metric_parse': (c_int, c_char_p, c_size_t, POINTER(metric), fault),
        'iso_metric_free': (None, metric),
        'iso_metric_project': (c_int, metric, template, vector),
        'iso_metric_vector_add': (None, metric, vector, vector),
        'iso_metric_score': (c_double, metric, vector, vector),
        'iso_mesh_new': (c_int, c_int32, c_int32, POINTER(mesh)),
        'iso_mesh_free': (None, mesh),
        'iso_mesh_check': (c_int, mesh, fault),
        'iso_mesh_area': (c_double, mesh),
        'iso_mesh_format_suffix': (c_char_p, c_int),
        'iso_mesh_parse': (c_int, c_int, c_char_p, c_void_p, c_size_t, c_void_p, coloured, fault),
        'iso_mesh_or_cloud_parse': (c_int, c_int, c_char_p, c_void_p, c_size_t, c_void_p, coloured, fault),
        'iso_mesh_mend': (c_int, coloured, POINTER(structs.MeshMended)),
        'iso_coloured_mesh_done': (None, coloured),
        'iso_symmetric_new': (c_int, c_int32, c_int32, POINTER(matrix)),
        'iso_symmetric_free': (None, matrix),
        'iso_symmetric_multiply': (None, matrix, c_void_p, c_void_p),
        'iso_stiffness_mass': (c_int, mesh, c_int, matrix, matrix),
        'iso_stiffness_mass_weighted': (c_int, mesh, c_int, c_void_p, matrix, matrix),
        'iso_stiffness_mass_robust': (c_int, mesh, c_int, c_void_p, matrix, matrix),
        'iso_eigenpairs_new': (c_int, matrix, matrix, c_int32, c_double, POINTER(pairs)),
        'iso_eigenpairs_free': (None, pairs),
        'iso_shape_new': (c_int, mesh, c_void_p, c_int32, POINTER(shape)),
        'iso_shape_new_robust': (c_int, mesh, c_void_p, c_int32, POINTER(shape)),
        'iso_shape_new_cloud': (c_int, c_void_p, c_void_p, c_int32, c_int32, c_int32, POINTER(shape)),
        'iso_shape_free': (None, shape),
        'iso_heat_signature': (c_int, pairs, c_int32, c_void_p, c_int, c_void_p),
        'iso_heat_mean_signature': (c_int, pairs, c_double, c_void_p),
        'iso_heat_from_vertex': (c_int, pairs, c_int32, c_int32, c_void_p, c_int, c_void_p),
        'iso_heat_times': (None, c_double, c_double, c_int, c_void_p),
        'iso_wave_energies': (c_int, pairs, c_int, c_void_p, POINTER(c_double)),
        'iso_wave_signature': (c_int, pairs, c_void_p, c_int, c_double, c_void_p),
        'iso_shape_extrema': (c_int, shape, c_void_p, points),
        'iso_shape_critical_points': (c_int, shape, points),
        'iso_critical_points_done': (None, points),
        'iso_shape_views': (c_int, mesh, c_int, c_double, c_int, POINTER(structs.ShapeView), POINTER(c_int)),
        'iso_shape_view_of': (c_int, mesh, structs.Vec3, POINTER(structs.ShapeView)),
        'iso_heat_direct_new': (c_int, POINTER(structs.HeatDirectOptions), POINTER(c_void_p)),
        'iso_heat_direct_free': (None, c_void_p),
        'iso_heat_direct': (c_int, c_void_p, mesh, matrix, matrix, c_void_p, c_int, c_void_p, c_int, c_void_p),
        'iso_geodesic_new': (c_int, shape, POINTER(c_void_p)),
        'iso_geodesic_free': (None, c_void_p),
        'iso_geodesic_distance': (c_int, c_void_p, c_int32, c_void_p),
        'iso_functional_map_fit': (c_int, shape, shape, c_int32, POINTER(structs.SharedFunctions), c_double,
                                   c_void_p),
        'iso_functional_map_points': (c_int, shape, shape, c_int32, c_void_p, c_void_p),
        'iso_functional_map_of': (c_int, shape, shape, c_int32, c_void_p, c_void_p),
        'iso_zoom_out': (c_int, shape, shape, c_int32, c_void_p, c_int32, c_int32, c_void_p),
        'iso_shape_match': (c_int, shape, shape, POINTER(structs.MatchOptions), c_void_p, c_void_p),
        'iso_shape_method_find': (method, c_char_p),
        'iso_shape_describe': (c_int, method, shape, POINTER(description)),
        'iso_shape_description_free': (None, description),
        'iso_shape_coder_new': (c_int, method, POINTER(description), c_int32, c_int32, c_uint64,
                                POINTER(c_void_p)),
        'iso_shape_coder_free': (None, c_void_p),
        'iso_shape_coder_layout': (POINTER(structs.FeatureLayout), c_void_p),
        'iso_shape_code': (c_int, c_void_p, description, c_void_p),
        'iso_classifier_new': (c_int, ops, POINTER(structs.Labelled), POINTER(c_void_p)),
        'iso_classifier_free': (None, c_void_p),
        'iso_classifier_score': (c_int, c_void_p, c_void_p, c_void_p),
        'iso_classifier_rank': (c_int, c_void_p, c_void_p, c_int32, c_void_p),
    }
    for name, (result, *arguments) in functions.items():
        function = getattr(lib, name)
        function.restype = result
        function.argtypes = arguments


_declare()


def check(code, what, sentences=None, fault=None):
    """Raises unless `code` is 0. `what` names the thing; the fault says what is wrong with it, or
    `sentences`, by the number of errno.h, or the system's text for that number."""
    if code == 0:
        return
    number = -code
    if number == errno.ENOMEM:
        raise MemoryError('%s: out of memory' % what)
    text = fault.text.decode(errors='replace') if fault is not None else ''
    text = text or (sentences or {}).get(number) or os.strerror(number)
    raise Error(text if text.startswith('%s:' % what) else '%s: %s' % (what, text), number)


class Owner:
    """Frees an object of the library when the last array or object that uses it is gone."""

    __slots__ = ('pointer', '_free', '_needs')

    def __init__(self, pointer, free, needs=None):
        self.pointer = pointer
        self._free = free
        self._needs = needs  # what has to stay as long

    def __del__(self):
        self._free(self.pointer)


def frees(function):
    """For Owner: a function that frees what a struct holds, given the struct and not a pointer."""
    return lambda struct: function(byref(struct))


class _Memory:
    """Memory of the library for NumPy, which keeps this object, and with it the owner."""

    def __init__(self, owner, start, shape, dtype):
        self.owner = owner
        self.__array_interface__ = {
            'version': 3,
            'data': (start, True),
            'shape': shape,
            'typestr': np.dtype(dtype).str,
        }


def view(owner, start, shape, dtype):
    """Memory of the library as a read-only array, without a copy."""
    if 0 in shape:
        empty = np.empty(shape, dtype)
        empty.flags.writeable = False
        return empty
    return np.asarray(_Memory(owner, start, shape, dtype))


def array_in(value, dtype, shape, what):
    """A C-contiguous array of a type, without a copy where it is one already. `shape` has None where
    any size will do. Refuses numbers that are not finite or do not fit into the type."""
    try:
        array = np.asarray(value)
    except ValueError as error:
        raise Error('%s: %s' % (what, error)) from None
    wanted = np.dtype(dtype)
    if array.size == 0 and array.dtype.kind == 'f' and wanted.kind == 'i':
        array = array.astype(wanted)  # an empty list has the type float
    if array.dtype.kind not in ('iu' if wanted.kind == 'i' else 'fiu'):
        raise Error('%s: numbers of the type %s are needed, these are %s' % (what, wanted, array.dtype))
    if len(array.shape) != len(shape) or any(n not in (None, m) for n, m in zip(shape, array.shape)):
        needed = ', '.join('any' if n is None else str(n) for n in shape)
        raise Error('%s: its shape is %s, (%s) is needed' % (what, array.shape, needed))
    if wanted.kind == 'i' and array.size:
        limits = np.iinfo(wanted)
        if int(array.min()) < limits.min or int(array.max()) > limits.max:
            raise Error('%s: a number does not fit into %s' % (what, wanted))
    array = np.require(array, wanted, ['C', 'A'])
    if wanted.kind == 'f' and not np.isfinite(array).all():
        raise Error('%s: a number is not finite' % what)
    return array


def number_in(value, least, most, what):
    """A whole number within bounds."""
    try:
        number = int(value.__index__())
    except AttributeError:
        raise Error('%s: %r is not a whole number' % (what, value)) from None
    if not least <= number <= most:
        raise Error('%s: %d is outside %d..%d' % (what, number, least, most))
    return number


def read_file(path):
    """The contents of a regular file; a pipe or a device could keep the caller waiting."""
    if not stat.S_ISREG(os.stat(path).st_mode):
        raise Error('%s: not a regular file' % path)
    with open(path, 'rb') as file:
        if os.fstat(file.fileno()).st_size > _BYTES_MOST:
            raise Error('%s: larger than 1 GiB' % path, errno.EFBIG)
        return file.read()


def parse_file(path, parse, pointer):
    """Reads a file by a function of the library, which makes an object of its contents and lets
    `pointer` point at it. Raises OSError for a file that cannot be read, and Error, with its name, for
    contents that the function refuses."""
    data, fault = read_file(path), structs.Fault()
    check(parse(data, len(data), byref(pointer), byref(fault)), str(path), {errno.EBADMSG: 'damaged'}, fault)


def address(array):
    """Where the memory of an array begins."""
    return array.ctypes.data


__all__ = [
    'Error', 'Owner', 'address', 'array_in', 'byref', 'check', 'frees', 'lib', 'number_in', 'parse_file', 'read_file',
    'structs', 'view'
]

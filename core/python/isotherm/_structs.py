"""The structs of the library's public headers, member for member. tests/core/python/layout.c prints
where the compiler puts each member, and a test compares."""
from ctypes import (POINTER, Structure, c_bool, c_char, c_char_p, c_double, c_int, c_int32, c_int64,
                    c_uint, c_uint64, c_void_p)

PARTS_MAX = 8  # ISO_SHAPE_PARTS_MAX
CHANNELS = 3  # ISO_CHANNELS


class Fault(Structure):  # fault.h
    _fields_ = [('text', c_char * 256), ('code', c_uint)]


class Mesh(Structure):  # mesh.h; three doubles a vertex, three indices a triangle
    _fields_ = [('n_vertices', c_int32), ('n_triangles', c_int32), ('vertex_capacity', c_int32),
                ('triangle_capacity', c_int32), ('vertices_mm', c_void_p), ('triangles', c_void_p)]


class Camera(Structure):  # camera.h
    _fields_ = [('projection', c_int), ('width_px', c_int), ('height_px', c_int),
                ('fx_px', c_double), ('fy_px', c_double), ('pitch_mm', c_double),
                ('cx_px', c_double), ('cy_px', c_double), ('k1', c_double), ('k2', c_double),
                ('k3', c_double), ('p1', c_double), ('p2', c_double)]


class Frame(Structure):  # frame.h
    _fields_ = [('camera', Camera), ('width_px', c_int), ('height_px', c_int),
                ('crop_x_px', c_int), ('crop_y_px', c_int), ('t_ns', c_int64),
                ('sequence', c_uint64), ('depth_mm', c_void_p), ('intensity', c_void_p)]


class TriangulateOptions(Structure):  # triangulate.h
    _fields_ = [('jump_mm', c_double), ('largest_only', c_bool)]


class ColouredMesh(Structure):  # mesh_file.h
    _fields_ = [('mesh', POINTER(Mesh)), ('colour', c_void_p)]


class MeshMended(Structure):  # mesh_file.h
    _fields_ = [('merged', c_int32), ('collapsed', c_int32), ('repeated', c_int32),
                ('unused', c_int32)]


class Symmetric(Structure):  # stiffness_mass.h
    _fields_ = [('n', c_int32), ('nnz', c_int32), ('n_capacity', c_int32),
                ('nnz_capacity', c_int32), ('column_start', c_void_p), ('row', c_void_p),
                ('value', c_void_p)]


class Eigenpairs(Structure):  # eigenpairs.h; `lambda` is a word of Python
    _fields_ = [('n', c_int32), ('k', c_int32), ('lambda_', c_void_p), ('phi', c_void_p)]


class Shape(Structure):  # shape.h
    _fields_ = [('mesh', POINTER(Mesh)), ('colour', c_void_p), ('area', c_void_p),
                ('total_area', c_double), ('near_boundary', c_void_p),
                ('neighbour_start', c_void_p), ('neighbour', c_void_p),
                ('stiffness', POINTER(Symmetric)), ('mass', POINTER(Symmetric)),
                ('pairs', POINTER(Eigenpairs)), ('weighted', POINTER(Eigenpairs) * CHANNELS)]


class CriticalPoints(Structure):  # signature.h
    _fields_ = [('n', c_int32), ('vertex', c_void_p)]


class SharedFunctions(Structure):  # correspondence.h; `from` is a word of Python
    _fields_ = [('n', c_int), ('from_', c_void_p), ('to', c_void_p)]


class MatchOptions(Structure):  # correspondence.h
    _fields_ = [('first_pairs', c_int32), ('step', c_int32), ('weight', c_double)]


class ShapeDescription(Structure):  # shape_method.h
    _fields_ = [('n_bags', c_int32), ('n_points', c_int32), ('n_values', c_int32),
                ('local', c_void_p), ('weight', c_void_p), ('n_parts', c_int32),
                ('part_size', c_int32 * PARTS_MAX), ('whole', c_void_p)]


class ShapeMethod(Structure):  # shape_method.h
    _fields_ = [('name', c_char_p), ('title', c_char_p), ('source', c_char_p), ('colour', c_bool),
                ('coding', c_int), ('size', c_int32), ('norm', c_int), ('classifier', c_char_p),
                ('kept_parts', c_int32), ('describe', c_void_p)]


class FeatureLayout(Structure):  # shape_method.h
    _fields_ = [('size', c_int32), ('n_parts', c_int32), ('part_size', c_int32 * PARTS_MAX)]


class Labelled(Structure):  # classifier.h
    _fields_ = [('layout', POINTER(FeatureLayout)), ('n', c_int32), ('n_classes', c_int32),
                ('feature', c_void_p), ('label', c_void_p)]


class ClassifierOps(Structure):  # classifier.h; the functions are called by the library alone
    _fields_ = [('name', c_char_p), ('title', c_char_p), ('source', c_char_p),
                ('train', c_void_p), ('free', c_void_p), ('score', c_void_p), ('rank', c_void_p)]


# What the tests compare: the name in C, and the struct here.
ALL = {
    'iso_fault': Fault,
    'iso_mesh': Mesh,
    'iso_camera': Camera,
    'iso_frame': Frame,
    'iso_triangulate_options': TriangulateOptions,
    'iso_coloured_mesh': ColouredMesh,
    'iso_mesh_mended': MeshMended,
    'iso_symmetric': Symmetric,
    'iso_eigenpairs': Eigenpairs,
    'iso_shape': Shape,
    'iso_critical_points': CriticalPoints,
    'iso_shared_functions': SharedFunctions,
    'iso_match_options': MatchOptions,
    'iso_shape_description': ShapeDescription,
    'iso_shape_method': ShapeMethod,
    'iso_feature_layout': FeatureLayout,
    'iso_labelled': Labelled,
    'iso_classifier_ops': ClassifierOps,
}

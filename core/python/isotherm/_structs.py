"""The structs of the library's public headers, member for member. tests/core/python/layout.c prints
where the compiler puts each member, and a test compares."""
from ctypes import (POINTER, Structure, c_bool, c_char, c_char_p, c_double, c_int, c_int32, c_int64,
                    c_float, c_uint, c_uint8, c_uint16, c_uint32, c_uint64, c_void_p)

PARTS_MAX = 8  # ISO_SHAPE_PARTS_MAX
CHANNELS = 3  # ISO_CHANNELS
LANDMARKS = 12  # ISO_LANDMARKS
LANDMARKS_IBUG = 68  # ISO_LANDMARKS_IBUG
RADII_MAX, POINTS_MAX = 4, 32  # ISO_TEMPLATE_RADII_MAX, ISO_TEMPLATE_POINTS_MAX
SENSOR_MAX = 16  # ISO_TEMPLATE_SENSOR_MAX
UPPER_ROWS, UPPER_COLUMNS = 37, 49  # ISO_UPPER_ROWS, ISO_UPPER_COLUMNS
DIMENSIONS_MAX = 160  # ISO_METRIC_DIMENSIONS_MAX
ORIGINS_MAX, ORIGIN_MAX = 16, 64  # ISO_METRIC_ORIGINS_MAX, ISO_METRIC_ORIGIN_MAX
STAGES, FACE_PARTS = 7, 6  # ISO_STAGES, ISO_FACE_PARTS


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
                ('pairs', POINTER(Eigenpairs)), ('weighted', POINTER(Eigenpairs) * CHANNELS),
                ('is_cloud', c_bool)]


class CriticalPoints(Structure):  # signature.h
    _fields_ = [('n', c_int32), ('vertex', c_void_p)]


class ShapeView(Structure):  # signature.h
    _fields_ = [('direction', c_double * 3), ('entropy', c_double), ('divergence', c_double)]


class SharedFunctions(Structure):  # correspondence.h; `from` is a word of Python
    _fields_ = [('n', c_int), ('from_', c_void_p), ('to', c_void_p)]


class SurfacePoint(Structure):  # mesh.h
    _fields_ = [('triangle', c_int32), ('weight', c_double * 3)]


class HeatDirectOptions(Structure):  # heat_kernel.h
    _fields_ = [('n_capacity', c_int32), ('nnz_capacity', c_int32), ('krylov', c_int),
                ('gamma_over_t', c_double)]


class MatchOptions(Structure):  # correspondence.h
    _fields_ = [('first_pairs', c_int32), ('step', c_int32), ('weight', c_double)]


class ShapeDescription(Structure):  # shape_method.h
    _fields_ = [('n_bags', c_int32), ('n_points', c_int32), ('n_values', c_int32),
                ('local', c_void_p), ('weight', c_void_p), ('n_parts', c_int32),
                ('part_size', c_int32 * PARTS_MAX), ('whole', c_void_p)]


class DescribeTimes(Structure):  # shape_method.h
    _fields_ = [('n', c_int32), ('first', c_double), ('last', c_double)]


class ShapeMethod(Structure):  # shape_method.h
    _fields_ = [('name', c_char_p), ('title', c_char_p), ('source', c_char_p), ('colour', c_bool),
                ('coding', c_int), ('size', c_int32), ('norm', c_int), ('classifier', c_char_p),
                ('kept_parts', c_int32), ('times', DescribeTimes), ('describe', c_void_p)]


class FeatureLayout(Structure):  # shape_method.h
    _fields_ = [('size', c_int32), ('n_parts', c_int32), ('part_size', c_int32 * PARTS_MAX),
                ('norm', c_int)]


class Labelled(Structure):  # classifier.h
    _fields_ = [('layout', POINTER(FeatureLayout)), ('n', c_int32), ('n_classes', c_int32),
                ('feature', c_void_p), ('label', c_void_p)]


class ClassifierOps(Structure):  # classifier.h; the functions are called by the library alone
    _fields_ = [('name', c_char_p), ('title', c_char_p), ('source', c_char_p),
                ('train', c_void_p), ('free', c_void_p), ('score', c_void_p), ('rank', c_void_p)]


class Vec3(Structure):  # vec.h
    _fields_ = [('x', c_double), ('y', c_double), ('z', c_double)]


class Mat3(Structure):  # vec.h
    _fields_ = [('m', c_double * 3 * 3)]


class Rigid(Structure):  # vec.h
    _fields_ = [('rotation', Mat3), ('translation_mm', Vec3)]


class HeadPoint(Structure):  # head_model.h
    _fields_ = [('triangle', c_uint32), ('weight', c_float * 3)]


class HeadModel(Structure):  # head_model.h
    _fields_ = [('n_vertices', c_uint32), ('n_triangles', c_uint32), ('n_identity', c_uint32),
                ('n_expression', c_uint32), ('crc32', c_uint32), ('mean_mm', c_void_p),
                ('triangles', c_void_p), ('region', c_void_p), ('identity_mm', c_void_p),
                ('expression_mm', c_void_p), ('landmarks', HeadPoint * LANDMARKS_IBUG)]


class ShapeFitOptions(Structure):  # head_fit.h
    _fields_ = [('rigid_iterations', c_int), ('iterations', c_int), ('jaws', c_int),
                ('vertices', c_int), ('cutoff_first_mm', c_double), ('cutoff_last_mm', c_double),
                ('soft_weight', c_double), ('identity_stiffness_mm2', c_double),
                ('expression_stiffness_mm2', c_double)]


class Occlusion(Structure):  # head_fit.h
    _fields_ = [('covered', c_double * FACE_PARTS), ('rest_mm2', c_double)]


class ExtractOptions(Structure):  # extract.h
    _fields_ = [('t_mm2', c_double), ('n_radii', c_int), ('radius_mm', c_double * RADII_MAX),
                ('n_points', c_int), ('crop_radius_mm', c_double), ('spacing_mm', c_double),
                ('smoothing_mm', c_double), ('outlier_mm', c_double), ('fit', ShapeFitOptions),
                ('distance_min_mm', c_double), ('distance_max_mm', c_double),
                ('yaw_max_rad', c_double), ('pitch_max_rad', c_double), ('track', c_bool),
                ('heat', c_int), ('sensor', c_char * SENSOR_MAX), ('now_ns', c_void_p),
                ('now_context', c_void_p)]


class UpperFace(Structure):  # template.h
    _fields_ = [('z_mm', c_float * UPPER_COLUMNS * UPPER_ROWS),
                ('kind', c_uint8 * UPPER_COLUMNS * UPPER_ROWS)]


class Template(Structure):  # template.h
    _fields_ = [('algorithm', c_uint32), ('sensor', c_char * SENSOR_MAX), ('n_radii', c_uint16),
                ('n_points', c_uint16), ('n_frames', c_uint16), ('learned', c_bool),
                ('quality', c_float), ('radius_mm', c_float * RADII_MAX),
                ('points_mm', c_float * 3 * POINTS_MAX * LANDMARKS * RADII_MAX),
                ('weight', c_float * POINTS_MAX * LANDMARKS * RADII_MAX), ('upper', UpperFace)]


class Extraction(Structure):  # extract.h
    _fields_ = [('outcome', c_int), ('cue', c_int), ('camera_from_face', Rigid),
                ('yaw_rad', c_double), ('pitch_rad', c_double), ('roll_rad', c_double),
                ('distance_mm', c_double), ('residual_mm', c_double), ('fitted', c_bool),
                ('tracked', c_bool), ('landmark_mm', Vec3 * LANDMARKS),
                ('ibug_mm', Vec3 * LANDMARKS_IBUG), ('sigma_mm', c_double * LANDMARKS),
                ('occlusion', Occlusion), ('fit_coverage', c_double),
                ('identity_norm', c_double), ('expression_norm', c_double),
                ('coverage', c_double), ('source_mm', Vec3 * LANDMARKS), ('tmpl', Template),
                ('stage_ns', c_int64 * STAGES)]


class RerankWeights(Structure):  # metric.h
    _fields_ = [('metric', c_float), ('upper', c_float), ('bias', c_float)]


class Metric(Structure):  # metric.h
    _fields_ = [('algorithm', c_uint32), ('landmarks', c_uint32), ('n_radii', c_int),
                ('n_points', c_int), ('n_dimensions', c_int), ('weight_min', c_float),
                ('gain', c_float), ('bias', c_float), ('rerank', RerankWeights),
                ('n_origins', c_int), ('origin', c_char * ORIGIN_MAX * ORIGINS_MAX),
                ('n_nodes', c_int), ('node', c_uint16 * (UPPER_ROWS * UPPER_COLUMNS)),
                ('n_curve_values', c_int), ('n_values', c_int), ('curve_mm', c_void_p),
                ('upper_mm', c_void_p), ('between', c_void_p), ('centre', c_void_p),
                ('axis', c_void_p)]


class MetricVector(Structure):  # metric.h
    _fields_ = [('n', c_int), ('weight', c_float), ('step', c_int), ('scale', c_float),
                ('mean', c_float * DIMENSIONS_MAX)]


# What the tests compare: the name in C, and the struct here.
ALL = {
    'iso_fault': Fault,
    'iso_mesh': Mesh,
    'iso_camera': Camera,
    'iso_frame': Frame,
    'iso_triangulate_options': TriangulateOptions,
    'iso_vec3': Vec3,
    'iso_mat3': Mat3,
    'iso_rigid': Rigid,
    'iso_head_point': HeadPoint,
    'iso_head_model': HeadModel,
    'iso_shape_view': ShapeView,
    'iso_shape_fit_options': ShapeFitOptions,
    'iso_occlusion': Occlusion,
    'iso_extract_options': ExtractOptions,
    'iso_upper_face': UpperFace,
    'iso_template': Template,
    'iso_extraction': Extraction,
    'iso_rerank_weights': RerankWeights,
    'iso_metric': Metric,
    'iso_metric_vector': MetricVector,
    'iso_coloured_mesh': ColouredMesh,
    'iso_mesh_mended': MeshMended,
    'iso_symmetric': Symmetric,
    'iso_eigenpairs': Eigenpairs,
    'iso_shape': Shape,
    'iso_critical_points': CriticalPoints,
    'iso_shared_functions': SharedFunctions,
    'iso_match_options': MatchOptions,
    'iso_surface_point': SurfacePoint,
    'iso_heat_direct_options': HeatDirectOptions,
    'iso_shape_description': ShapeDescription,
    'iso_describe_times': DescribeTimes,
    'iso_shape_method': ShapeMethod,
    'iso_feature_layout': FeatureLayout,
    'iso_labelled': Labelled,
    'iso_classifier_ops': ClassifierOps,
}

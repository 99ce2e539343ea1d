"""Shapes and faces by their heat: libisotherm for NumPy.

    import isotherm
    mesh = isotherm.Mesh.load('dog.off')       # or isotherm.Mesh(vertices, triangles)
    shape = isotherm.Shape(mesh, pairs=100)    # eigenvalues, eigenvectors, stiffness, mass
    shape.hks(shape.heat_times(50))            # a row of times for each vertex
    isotherm.describe(shape, 'cp-hk').whole    # one vector for the shape

    frames = isotherm.Recording('visit')       # recorded depth frames
    face = isotherm.Extractor().extract(frames[0])   # landmarks, heat, isotherms
    isotherm.Metric().score(template, face.template)

Mesh, Shape, Geodesics, Heat, Description, Coder, Classifier and SymmetricMatrix hold memory of the library.
It is freed when the object and every array that it has handed out are gone. Arrays that a function
computes, and those of faces and templates, belong to the caller.

Lengths are in the unit of the mesh, whatever it is; areas and times of heat are in its square. Heat
flows by dU/dt = -Delta U: it decays by exp(-lambda t). (The dissertation's t is twice this one.)

The sign of an eigenvector has no meaning, and may change with the number of OpenBLAS's threads
(OPENBLAS_NUM_THREADS); with one thread, all numbers are the same to the bit from run to run.

Error is raised for what the library refuses, with one line of text; MemoryError if memory runs out.
Different objects may be used by different threads at the same time.
"""
from ._classify import Classifier, classifiers
from ._correspond import Geodesics, functional_map, map_of_points, match, points_of_map, zoom_out
from ._describe import Coder, Description, Method, describe, methods
from ._described import Described, read_described
from ._face import LANDMARKS, Extractor, Face
from ._frame import Camera, Frame
from ._heat import Heat
from ._library import Error
from ._matrix import SymmetricMatrix, eigenpairs, finite_elements
from ._mesh import Mesh, load_points
from ._recording import Recording
from ._shape import Shape
from ._template import Metric, Template
from ._views import View, best_views, view_of

__all__ = [
    'Camera', 'Classifier', 'Coder', 'Described', 'Description', 'Error', 'Extractor', 'Face', 'Frame', 'Geodesics',
    'Heat', 'LANDMARKS', 'Mesh', 'Method', 'Metric', 'Recording', 'Shape', 'SymmetricMatrix', 'Template', 'View', 'best_views',
    'classifiers', 'describe', 'eigenpairs', 'finite_elements', 'functional_map', 'load_points', 'map_of_points',
    'match', 'methods', 'points_of_map', 'read_described', 'view_of', 'zoom_out'
]

"""The library's memory stays as long as an array shows it, and no longer."""
import ctypes
import gc
import os
import sys
import unittest

import numpy as np

import isotherm
from support import COAT, DOG, TestCase, grid


def bytes_in_use():
    """What malloc() has handed out, in all arenas."""
    class Info(ctypes.Structure):
        _fields_ = [(name, ctypes.c_size_t) for name in ('arena', 'ordblks', 'smblks', 'hblks', 'hblkhd', 'usmblks',
                                                         'fsmblks', 'uordblks', 'fordblks', 'keepcost')]

    function = ctypes.CDLL(None).mallinfo2
    function.restype = Info
    gc.collect()
    info = function()
    return info.uordblks + info.hblkhd


class Memory(TestCase):
    def test_arrays_keep_what_they_show(self):
        mesh = isotherm.Mesh.load(DOG)
        shape = isotherm.Shape(mesh, pairs=20)
        description = isotherm.describe(shape, 'shape-google')
        views = [mesh.vertices, shape.eigenvectors[:, 3], shape.mass.data[5:], shape.critical_points(),
                 description.local[0], shape.triangles]
        copies = [np.array(view) for view in views]
        geodesics = isotherm.Geodesics(shape)
        distance = geodesics.distances(3)
        del mesh, shape, description
        gc.collect()
        noise = [np.full(100000, np.nan) for _ in range(20)]  # takes memory that was freed
        for view, copy in zip(views, copies):
            self.assertFalse(view.flags.writeable)
            self.same(view, copy)
        self.same(geodesics.distances(3), distance)
        del noise

    @unittest.skipIf(os.environ.get('ISOTHERM_SANITIZED'), 'the sanitizer has a malloc of its own')
    def test_memory_is_freed(self):
        coat = isotherm.Mesh.load(COAT)

        def work():
            shape = isotherm.Shape(isotherm.Mesh.load(DOG), pairs=60)
            isotherm.Shape(coat, pairs=20, colours=True)
            descriptions = [isotherm.describe(shape, name) for name in ('cp-hk', 'cp-hk')]
            coder = isotherm.Coder(descriptions)
            isotherm.Classifier('rcr', np.array([coder.code(d) for d in descriptions]), [0, 1], coder.part_sizes)
            isotherm.Geodesics(shape).distances(0)
            isotherm.match(shape, shape)
            isotherm.finite_elements(coat)
            shape.critical_points()
            for bad in (lambda: isotherm.Mesh.load(__file__), lambda: isotherm.describe(shape, 'w-hks1'),
                        lambda: isotherm.Shape(isotherm.Mesh(*grid(5, 5)))):
                self.assertRaises(isotherm.Error, bad)
            return shape.n

        size = 8 * 60 * work()  # of the eigenvectors
        for _ in range(2):
            work()  # what libraries keep once
        before = bytes_in_use()
        for _ in range(10):
            work()
        grown = bytes_in_use() - before
        kept = isotherm.Shape(isotherm.Mesh.load(DOG), pairs=60)
        held = bytes_in_use() - before - grown
        print('10 rounds: %d bytes more in use; one shape takes %d' % (grown, held), file=sys.stderr)
        self.assertGreater(held, size)  # the measure sees what the library allocates
        self.assertLess(grown, 0.1 * size)  # of ten
        del kept

"""What the tests of the Python module share: meshes, and comparisons.

The directory of the environment variable ISOTHERM_PYTHON_TEST is made by tests/core/python/python.sh.
"""
import os
import unittest

import numpy as np

import isotherm

WORK = os.environ['ISOTHERM_PYTHON_TEST']
DOG = os.path.join(WORK, 'plain', 'dog-01.off')
OTHER_DOG = os.path.join(WORK, 'plain', 'dog-02.off')
COAT = os.path.join(WORK, 'coat.ply')


def grid(columns, rows):
    """A flat sheet with unit squares."""
    x, y = np.meshgrid(np.arange(columns, dtype=float), np.arange(rows, dtype=float))
    number = np.arange(columns * rows).reshape(rows, columns)
    a, b, c, d = (number[:-1, :-1].ravel(), number[:-1, 1:].ravel(), number[1:, :-1].ravel(), number[1:, 1:].ravel())
    return (np.column_stack([x.ravel(), y.ravel(), np.zeros(columns * rows)]),
            np.concatenate([np.column_stack([a, b, d]), np.column_stack([a, d, c])]).astype(np.int32))


def shape_of(path, **options):
    return isotherm.Shape(isotherm.Mesh.load(path), **options)


class TestCase(unittest.TestCase):
    def near(self, a, b, tolerance):
        a, b = np.asarray(a, float), np.asarray(b, float)
        self.assertEqual(a.shape, b.shape)
        self.assertLessEqual(np.abs(a - b).max() / max(np.abs(b).max(), 1e-300), tolerance)

    def same(self, a, b):
        """Equal to the bit, with type and shape."""
        self.assertEqual((a.dtype, a.shape), (b.dtype, b.shape))
        self.assertTrue((a == b).all())

    def refuses(self, words, function, *arguments, error=isotherm.Error, **named):
        with self.assertRaises(error) as caught:
            function(*arguments, **named)
        self.assertIn(words, str(caught.exception))
        self.assertNotIn('\n', str(caught.exception))
        return caught.exception

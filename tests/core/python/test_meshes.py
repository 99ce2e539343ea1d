"""Structs, meshes from arrays and files, finite elements and eigenpairs."""
import ctypes
import os
import pathlib
import tempfile
import warnings

import numpy as np
import scipy.sparse.linalg

import isotherm
from isotherm import _structs
from support import COAT, DOG, OTHER_DOG, WORK, TestCase, grid, shape_of


class Layout(TestCase):
    def test_structs_are_those_of_the_compiler(self):
        seen = set()
        for line in pathlib.Path(WORK, 'layout').read_text().splitlines():
            name, member, offset, size = line.split()
            struct = _structs.ALL[name]
            if member == '-':
                self.assertEqual(ctypes.sizeof(struct), int(size), name)
                continue
            field = getattr(struct, member + '_' if member in ('lambda', 'from') else member)
            self.assertEqual((field.offset, field.size), (int(offset), int(size)), (name, member))
            seen.add((name, member.rstrip('_')))
        known = {(name, field[0].rstrip('_')) for name, struct in _structs.ALL.items() for field in struct._fields_}
        self.assertEqual(seen, known)


class Meshes(TestCase):
    def test_arrays_are_shared_and_read_only(self):
        vertices, triangles = grid(7, 6)
        mesh = isotherm.Mesh(vertices, triangles)
        self.assertTrue(np.shares_memory(mesh.vertices, vertices))
        self.assertTrue(np.shares_memory(mesh.triangles, triangles))
        for array in (mesh.vertices, mesh.triangles):
            with self.assertRaises(ValueError):
                array[0] = 0
        self.assertAlmostEqual(mesh.area, 30.0)
        vertices *= 2
        self.assertAlmostEqual(mesh.area, 120.0)
        other = isotherm.Mesh(vertices.tolist(), triangles.astype(np.int64))
        self.same(other.triangles, mesh.triangles)

    def test_bad_arrays_are_refused(self):
        vertices, triangles = grid(7, 6)
        new = isotherm.Mesh
        self.refuses('vertices: its shape is (42, 2)', new, vertices[:, :2], triangles)
        self.refuses('triangles: its shape is (180,)', new, vertices, triangles.ravel())
        self.refuses('triangles: numbers of the type int32', new, vertices, triangles.astype(float))
        self.refuses('vertices: numbers of the type float64', new, vertices.astype(complex), triangles)
        self.refuses('triangle with a vertex that does not exist', new, vertices, triangles + 1)
        self.refuses('triangle with a vertex that does not exist', new, vertices, triangles - 1)
        self.refuses('triangle with the same vertex twice', new, vertices, [[1, 1, 2]])
        self.refuses('does not fit into int32', new, vertices, triangles.astype(np.int64) + 2**32)
        self.refuses('colours: a number is outside 0..1', new, vertices, triangles, np.full((42, 3), 1.5))
        self.refuses('colours: its shape', new, vertices, triangles, np.zeros((41, 3)))
        vertices[3, 1] = np.nan
        self.refuses('vertices: a number is not finite', new, vertices, triangles)

    def test_later_changes_of_shared_arrays_are_checked(self):
        vertices, triangles = grid(7, 6)
        mesh = isotherm.Mesh(vertices, triangles)
        triangles[5, 1] = 1000000
        self.refuses('triangle with a vertex that does not exist', isotherm.Shape, mesh)
        self.refuses('triangle with a vertex that does not exist', isotherm.finite_elements, mesh)
        self.refuses('triangle with a vertex that does not exist', lambda: mesh.area)

    def test_files(self):
        mesh, words = isotherm.Mesh.load(DOG), pathlib.Path(DOG).read_text().split()
        n, m = int(words[1]), int(words[2])
        self.same(mesh.vertices, np.array(words[4:4 + 3 * n], float).reshape(n, 3))
        self.same(mesh.triangles, np.array(words[4 + 3 * n:4 + 3 * n + 4 * m], np.int32).reshape(m, 4)[:, 1:])
        self.assertIsNone(mesh.colours)
        self.assertEqual(mesh.mended, {'merged': 0, 'collapsed': 0, 'repeated': 0, 'unused': 0})
        coat = isotherm.Mesh.load(COAT)
        self.assertEqual((coat.colours.dtype, coat.colours.shape), (np.float32, coat.vertices.shape))
        self.assertGreater(coat.colours.std(), 0.01)

    def test_files_are_mended(self):
        with tempfile.TemporaryDirectory() as folder:
            # Two triangles with vertices of their own, one of them twice, and a vertex of none.
            path = os.path.join(folder, 'm.off')
            pathlib.Path(path).write_text('OFF\n7 3 0\n0 0 0\n1 0 0\n0 1 0\n1 0 0\n1 1 0\n0 1 0\n9 9 9\n'
                                  '3 0 1 2\n3 3 4 5\n3 4 5 3\n')
            mesh = isotherm.Mesh.load(path)
            self.assertEqual(mesh.mended, {'merged': 2, 'collapsed': 0, 'repeated': 1, 'unused': 1})
            self.assertEqual((len(mesh.vertices), len(mesh.triangles)), (4, 2))
            raw = isotherm.Mesh.load(path, mend=False)
            self.assertEqual((len(raw.vertices), len(raw.triangles)), (7, 3))
            pathlib.Path(os.path.join(folder, 't.vert')).write_text('0 0 0\n1 0 0\n0 1 0\n')
            pathlib.Path(os.path.join(folder, 't.tri')).write_text('1 2 3\n')
            self.same(isotherm.Mesh.load(os.path.join(folder, 't.vert')).triangles, np.array([[0, 1, 2]], np.int32))

    def test_bad_files_are_refused(self):
        load = isotherm.Mesh.load
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, 'bad.off')
            self.assertRaises(FileNotFoundError, load, path)
            for text, words in (('OFF\n3 1 0\n0 0 0\n1 zero 0\n0 1 0\n3 0 1 2\n', 'bad.off:4: bad coordinate'),
                                ('OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n', 'triangle 1 has a corner that is none'),
                                ('OFF\n3 1 0\n0 0 0\n', 'bad.off: ends within'), ('', 'bad.off'),
                                ('OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 1\n', 'no triangle is left of it'),
                                ('OFF\0', 'not a text file')):
                pathlib.Path(path).write_text(text)
                self.refuses(words, load, path)
            self.refuses('not named .off', load, os.path.join(folder, 'bad.txt'))
            os.mkdir(os.path.join(folder, 'd.off'))
            self.refuses('not a regular file', load, os.path.join(folder, 'd.off'))
            os.mkfifo(os.path.join(folder, 'p.off'))
            self.refuses('not a regular file', load, os.path.join(folder, 'p.off'))
            pathlib.Path(os.path.join(folder, 'z.vert')).write_text('0 0 0\n')
            self.assertRaises(FileNotFoundError, load, os.path.join(folder, 'z.vert'))


class Depths(TestCase):
    """A wall 1 m away, a nearer box in front of it, and a hole."""

    def setUp(self):
        self.depth = np.full((40, 60), 1000.0, np.float32)
        self.depth[10:20, 20:40] = 900.0
        self.depth[30, 50] = 0.0

    def test_a_frame_becomes_a_mesh(self):
        mesh = isotherm.Mesh.from_depth(self.depth, 500.0, centre=(10.0, 20.0))
        self.assertEqual(len(mesh.vertices), self.depth.size - 1)
        # In the order of the rows; x = (column - centre) z / f.
        rows, columns = np.nonzero(self.depth)
        z = self.depth[rows, columns].astype(float)
        self.near(mesh.vertices, np.column_stack([(columns - 10) * z / 500, (rows - 20) * z / 500, z]), 1e-12)
        # Edges over the jump of 100 mm are cut, so box and wall do not touch.
        z = mesh.vertices[mesh.triangles, 2]
        self.assertEqual(np.ptp(z, axis=1).max(), 0)
        self.near((z == 900).sum() / 3, 2 * 9 * 19, 0)
        wall = isotherm.Mesh.from_depth(self.depth, (500.0, 500.0), largest_only=True)
        self.assertEqual(wall.vertices[:, 2].min(), 1000)
        # Triangles are counter-clockwise seen from the camera, which looks along z.
        a, b, c = (wall.vertices[wall.triangles[:, k]] for k in range(3))
        self.assertTrue((np.cross(b - a, c - a)[:, 2] < 0).all())

    def test_refusals(self):
        new, depth = isotherm.Mesh.from_depth, self.depth
        self.refuses('depth: ', new, -depth, 500.0)
        self.refuses('depth: ', new, depth, 0.0)
        self.refuses('depth: ', new, np.zeros((0, 0)), 500.0)
        self.refuses('depth: its shape', new, depth[0], 500.0)
        self.refuses('depth: a number is not finite', new, depth * np.nan, 500.0)
        self.refuses('depth: it has no triangle', new, 0 * depth, 500.0)
        self.refuses('jump: 0.0 is not above 0', new, depth, 500.0, jump=0.0)


class Spectrum(TestCase):
    def test_eigenvalues_are_those_of_scipy(self):
        shape = shape_of(DOG, pairs=40)
        stiffness, mass = shape.stiffness.to_scipy(), shape.mass.to_scipy()
        self.assertEqual(shape.eigenvectors.shape, (shape.n, 40))
        expected = scipy.sparse.linalg.eigsh(stiffness, 40, mass, sigma=-1e-4, which='LM', return_eigenvectors=False)
        self.near(shape.eigenvalues, np.sort(expected), 1e-9)
        phi = shape.eigenvectors
        self.near(phi.T @ (mass @ phi), np.eye(40), 1e-10)
        self.near(stiffness @ phi, mass @ phi * shape.eigenvalues, 1e-6)
        self.near(shape.mass @ phi, mass @ phi, 1e-12)
        self.near(shape.stiffness @ phi[:, 5], stiffness @ phi[:, 5], 1e-12)
        self.near(mass.sum(), shape.total_area, 1e-12)
        self.near(shape.areas, mass.sum(axis=1).A1, 1e-12)

    def test_finite_elements_of_a_mesh(self):
        mesh = isotherm.Mesh.load(DOG)
        stiffness, mass = isotherm.finite_elements(mesh)
        shape = isotherm.Shape(mesh, pairs=20)
        self.same(stiffness.data, shape.stiffness.data)
        self.same(mass.data, shape.mass.data)
        values, vectors = isotherm.eigenpairs(stiffness, mass, 20)
        self.near(values, shape.eigenvalues, 1e-9)
        self.assertEqual(vectors.shape, (shape.n, 20))
        _, lumped = isotherm.finite_elements(mesh, lumped=True)
        self.near(lumped.to_scipy().diagonal(), shape.areas, 1e-12)
        self.assertAlmostEqual(abs(lumped.to_scipy()).sum(), shape.total_area)
        twice = isotherm.finite_elements(mesh, density=np.full(shape.n, 2.0))
        self.near(twice[0].data, 2 * stiffness.data, 1e-12)
        self.near(twice[1].data, 2 * mass.data, 1e-12)

    def test_robust_finite_elements(self):
        mesh = isotherm.Mesh.load(DOG)
        plain, robust = shape_of(DOG, pairs=20), shape_of(DOG, pairs=20, robust=True)
        below = [scipy.sparse.tril(shape.stiffness.to_scipy(), -1) for shape in (plain, robust)]
        self.assertGreater(below[0].max(), 0.01)
        self.assertLess(below[1].max(), 1e-8)
        mass = robust.mass.to_scipy()
        self.near(mass.sum(), plain.total_area, 1e-9)
        self.assertLess(abs(robust.stiffness @ np.ones(robust.n)).max(), 1e-9)
        expected = scipy.sparse.linalg.eigsh(robust.stiffness.to_scipy(), 20, mass, sigma=-1e-4, which='LM',
                                             return_eigenvectors=False)
        self.near(robust.eigenvalues, np.sort(expected), 1e-9)
        self.near(robust.eigenvalues, plain.eigenvalues, 0.05)
        stiffness, _ = isotherm.finite_elements(mesh, robust=True)
        self.same(stiffness.data, robust.stiffness.data)
        twice, heavy = isotherm.finite_elements(mesh, density=np.full(robust.n, 2.0), robust=True)
        self.near(twice.data, 2 * stiffness.data, 1e-12)
        self.near(heavy.to_scipy().sum(), 2 * plain.total_area, 1e-9)

    def test_refusals(self):
        mesh = isotherm.Mesh.load(DOG)
        stiffness, mass = isotherm.finite_elements(mesh)
        other = isotherm.finite_elements(isotherm.Mesh.load(OTHER_DOG))[1]
        n = len(mesh.vertices)
        self.refuses('k: 0 is outside', isotherm.eigenpairs, stiffness, mass, 0)
        self.refuses('k: %d is outside' % n, isotherm.eigenpairs, stiffness, mass, n)
        self.refuses('k: 2.5 is not a whole number', isotherm.eigenpairs, stiffness, mass, 2.5)
        self.refuses('tolerance', isotherm.eigenpairs, stiffness, mass, 5, tolerance=-1.0)
        self.refuses('matrices: ', isotherm.eigenpairs, stiffness, other, 5)
        self.refuses('density: a number is not above 0', isotherm.finite_elements, mesh, density=np.zeros(n))
        self.refuses('density: its shape', isotherm.finite_elements, mesh, density=np.ones(n - 1))
        self.refuses('vector: its shape', lambda: mass @ np.ones(n + 1))
        self.refuses('fewer than 32 vertices', isotherm.Shape, isotherm.Mesh(*grid(5, 5)))
        self.refuses('fewer than 32 vertices', isotherm.Shape, isotherm.Mesh(np.eye(3), np.zeros((0, 3), int)))
        self.refuses('it has no colours', isotherm.Shape, mesh, colours=True)
        self.refuses('pairs: -1 is outside', isotherm.Shape, mesh, pairs=-1)

    def test_what_is_left_out_is_told(self):
        vertices, triangles = grid(9, 9)
        both = np.concatenate([vertices, 0.5 * vertices + 100])
        mesh = isotherm.Mesh(both, np.concatenate([triangles, triangles + 81]))
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter('always')
            shape = isotherm.Shape(mesh, pairs=5)
        self.assertEqual(shape.n, 81)
        self.assertAlmostEqual(shape.area_left_out, 0.2)
        self.assertIn('20.0 % of the area', str(caught[0].message))
        self.assertEqual(shape.near_boundary.sum(), 81 - 9)

"""Functions of vertices and descriptions, against NumPy and what isotherm-sim has written."""
import os
import pathlib
import tempfile

import numpy as np

import isotherm
from support import COAT, DOG, WORK, TestCase, shape_of


class Signatures(TestCase):
    def setUp(self):
        self.shape = shape_of(DOG, pairs=40)
        self.lam, self.phi = self.shape.eigenvalues, self.shape.eigenvectors

    def test_heat(self):
        times = self.shape.heat_times(7)
        self.near(times, np.geomspace(4 * np.log(10) / self.lam[-1], 4 * np.log(10) / self.lam[1], 7), 1e-12)
        self.near(self.shape.hks(times), self.phi**2 @ np.exp(-np.outer(self.lam, times)), 1e-10)
        self.near(self.shape.hks(times, first=1), self.phi[:, 1:]**2 @ np.exp(-np.outer(self.lam[1:], times)), 1e-10)
        kernel = (self.phi * np.exp(-self.lam * 3.0)) @ self.phi.T
        self.near(self.shape.heat_from(11, [3.0])[:, 0], kernel[:, 11], 1e-10)
        kernel = (self.phi * np.exp(-self.lam * self.shape.total_area / 64)) @ self.phi.T
        self.near(self.shape.hms(), (kernel.sum(axis=1) - kernel.diagonal()) / self.shape.n, 1e-8)

    def test_waves(self):
        energies, spread = self.shape.wave_energies(30)
        weight = np.exp(-((energies - np.log(self.lam[1:, None])) / spread)**2 / 2)
        self.near(self.shape.wks(energies, spread), self.phi[:, 1:]**2 @ (weight / weight.sum(axis=0)), 1e-10)
        self.assertEqual(self.shape.wks().shape, (self.shape.n, 100))

    def test_extrema(self):
        points = self.shape.critical_points()
        self.same(points, self.shape.extrema(self.phi[:, 1]))
        heights = np.abs(self.phi[points, 1])
        self.assertTrue((np.diff(heights) <= 0).all() and len(points) >= 4)

    def test_refusals(self):
        shape = self.shape
        self.refuses('times: a number is negative', shape.hks, [-1.0])
        self.refuses('times: a number is not finite', shape.hks, [np.inf])
        self.refuses('times: 0 of them', shape.hks, [])
        self.refuses('times: from', shape.heat_times, 5, 3.0, 2.0)
        self.refuses('first: 41 is outside 0..40', shape.hks, [1.0], first=41)
        self.refuses('vertex: %d is outside' % shape.n, shape.heat_from, shape.n)
        self.refuses('vertex: -1 is outside', shape.heat_from, -1)
        self.refuses('energies and their spread', shape.wks, [1.0])
        self.refuses('time: nan', shape.hms, np.nan)
        self.refuses('function: its shape', shape.extrema, np.zeros(3))
        self.refuses('n: 1 is outside', shape.wave_energies, 1)


class Described(TestCase):
    """The library and isotherm-sim compute the same, to the bit."""

    def check(self, described, shape, times, energies):
        self.same(shape.vertices, described['vertices'])
        self.same(shape.triangles, described['triangles'])
        self.same(shape.areas, described['area'])
        self.same(shape.eigenvalues, described['lambda'])
        self.same(shape.eigenvectors, described['phi'])
        for name in ('stiffness', 'mass'):
            matrix = getattr(shape, name)
            self.same(matrix.data, described[name + '_value'])
            self.same(matrix.indices, described[name + '_row'])
        self.same(shape.heat_times(times), described['hks_time'])
        self.same(shape.hks(shape.heat_times(times)), described['hks'])
        self.same(shape.wave_energies(energies)[0], described['wks_energy'])
        self.same(shape.wks(*shape.wave_energies(energies)), described['wks'])
        self.same(shape.hms(), described['hms'])
        self.same(shape.si_hks(), described['si_hks'])
        self.same(shape.critical_points(), described['critical'])

    def check_methods(self, described, shape, colours):
        checked = 0
        for name, method in isotherm.methods().items():
            if method.colour and not colours:
                continue
            found, file = isotherm.describe(shape, name), name.replace('-', '_')
            if len(found.whole):
                self.same(found.whole, described[file])
                self.same(np.concatenate(found.parts), found.whole)
                checked += 1
            for bag, local in enumerate(found.local):
                self.same(local, described[file + ('_local_%d' % bag if len(found.local) > 1 else '_local')])
                checked += 1
            if len(found.local):
                self.assertAlmostEqual(found.weight.sum(), 1, 4)
        return checked

    def test_a_mesh(self):
        shape = shape_of(DOG, pairs=40)
        described = isotherm.read_described(os.path.join(WORK, 'npy', 'dog-01'))
        self.check(described, shape, 7, 30)
        self.assertGreaterEqual(self.check_methods(described, shape, False), 8)
        self.assertEqual(described.parameters['shape']['eigenpairs'], 40)
        self.assertEqual(set(described.meaning), set(described))

    def test_a_coloured_mesh(self):
        shape = shape_of(COAT, colours=True)
        described = isotherm.read_described(os.path.join(WORK, 'coloured', 'coat'))
        self.check(described, shape, 100, 100)
        self.assertGreaterEqual(self.check_methods(described, shape, True), 15)
        self.assertEqual(len(shape.weighted), 3)
        self.assertEqual(shape.weighted[0][1].shape, (shape.n, 64))

    def test_formats_hold_the_same(self):
        first = isotherm.read_described(os.path.join(WORK, 'npy', 'dog-01'))
        for form in ('csv', 'mat5'):
            other = isotherm.read_described(os.path.join(WORK, form, 'dog-01'))
            self.assertEqual(list(first), list(other))
            for name in first:
                self.same(first[name], other[name])

    def test_damaged_files_are_refused(self):
        source = os.path.join(WORK, 'npy', 'dog-01')
        with tempfile.TemporaryDirectory() as folder:
            self.assertRaises(FileNotFoundError, isotherm.read_described, folder)
            for name in os.listdir(source):
                os.link(os.path.join(source, name), os.path.join(folder, name))
            isotherm.read_described(folder)
            path = os.path.join(folder, 'hks.npy')
            whole = pathlib.Path(path).read_bytes()
            os.unlink(path)
            for bad in (whole[:-8], b'', b'\x93NUMPY\x01\x00', whole.replace(b"'<f8'", b"'<i8'")):
                pathlib.Path(path).write_bytes(bad)
                self.refuses('hks.npy', isotherm.read_described, folder)
            path = os.path.join(folder, 'parameters.json')
            text = pathlib.Path(path).read_text()
            os.unlink(path)
            for bad in ('', '{}', '[1]', text[:-20], text.replace('"lambda.npy"', '"../lambda.npy"')):
                pathlib.Path(path).write_text(bad)
                self.refuses('parameters.json', isotherm.read_described, folder)

    def test_methods_that_are_not_there(self):
        shape = shape_of(DOG, pairs=20)
        self.refuses("method: 'hat' is unknown; there are shape-dna, td,", isotherm.describe, shape, 'hat')
        self.refuses('w-hks1: the method needs a shape with colours', isotherm.describe, shape, 'w-hks1')

"""Features and classifiers, distances and corresponding points."""
import os
import threading

import numpy as np

import isotherm
from support import DOG, OTHER_DOG, WORK, TestCase, grid, shape_of


class Features(TestCase):
    def test_coder_and_classifiers(self):
        folder = os.path.join(WORK, 'plain')
        paths = sorted(os.path.join(folder, name) for name in os.listdir(folder) if name.endswith('.off'))
        kinds = [os.path.basename(path).rsplit('-', 1)[0] for path in paths]
        labels = np.unique(kinds, return_inverse=True)[1]
        shapes = [shape_of(path, pairs=40) for path in paths]
        for name in ('cp-hk', 'srcp-td', 'shape-google'):
            descriptions = [isotherm.describe(shape, name) for shape in shapes]
            coder = isotherm.Coder(descriptions, size=4)
            features = np.array([coder.code(d) for d in descriptions])
            self.assertEqual(features.shape, (len(paths), coder.size))
            self.assertEqual(sum(coder.part_sizes), coder.size)
            if name == 'cp-hk':
                self.same(features[0], descriptions[0].whole)
            nearest = isotherm.Classifier('nn-l2', features, labels, coder.part_sizes)
            exact = np.linalg.norm(features - features[2], axis=1)
            exact[2] = 0
            self.near(nearest.rank(features[2], left=2), exact, 1e-5)
            self.assertEqual(np.argmax(nearest.score(features[1])), labels[1])
            for classifier in isotherm.classifiers():
                model = isotherm.Classifier(classifier, features, labels, coder.part_sizes)
                self.assertEqual(model.score(features[0]).shape, (labels.max() + 1, ))

    def test_local_heat_is_compared_by_its_norm(self):
        descriptions = [isotherm.describe(shape_of(path), 'local-heat') for path in (DOG, OTHER_DOG)]
        coder = isotherm.Coder(descriptions)
        features = np.array([coder.code(d) for d in descriptions])
        model = isotherm.Classifier('nn', features, [0, 1], coder.part_sizes, isotherm.methods()['local-heat'].norm)
        own, other = model.rank(features[0])
        self.assertLess(own, 2e-3)
        self.assertGreater(other, 5e-3)
        model = isotherm.Classifier('nn', features[:, :4].copy(), [0, 1], norm='partial')
        self.refuses('only for features of local-heat', model.rank, features[0, :4].copy())
        self.refuses("norm: 'hat' is unknown", isotherm.Classifier, 'nn', features, [0, 1], norm='hat')

    def test_refusals(self):
        shape, other = shape_of(DOG, pairs=20), shape_of(OTHER_DOG, pairs=20)
        dna, td = isotherm.describe(shape, 'shape-dna'), isotherm.describe(other, 'td')
        coder = isotherm.Coder([dna])
        self.refuses('by the methods', isotherm.Coder, [dna, td])
        self.refuses('by the methods', coder.code, td)
        self.refuses('descriptions: there are none', isotherm.Coder, [])
        features = np.eye(4, dtype=np.float32)
        new = isotherm.Classifier
        self.refuses("classifier: 'hat' is unknown", new, 'hat', features, [0, 0, 1, 1])
        self.refuses('labels: they count from 0', new, 'nn-l1', features, [0, 0, 0, 0])
        self.refuses('labels: its shape', new, 'nn-l1', features, [0, 1])
        self.refuses('features: a number is not finite', new, 'nn-l1', features * np.nan, [0, 0, 1, 1])
        self.refuses('part_sizes', new, 'rcr', features, [0, 0, 1, 1], part_sizes=(1, 2))
        model = new('nn-l1', features, [0, 0, 1, 1])
        self.refuses('feature: its shape', model.score, np.zeros(5))
        self.refuses('left: 4 is outside', model.rank, np.zeros(4), left=4)
        self.refuses('it cannot rank', new('naive-bayes', features, [0, 0, 1, 1]).rank, np.zeros(4))


class HeatFromVertices(TestCase):
    """Against the exponential of the dense matrices."""

    def setUp(self):
        self.shape = isotherm.Shape(isotherm.Mesh(*grid(15, 13)), pairs=4)
        stiffness, mass = self.shape.stiffness @ np.eye(self.shape.n), self.shape.mass @ np.eye(self.shape.n)
        whitening = np.linalg.inv(np.linalg.cholesky(mass))
        self.values, vectors = np.linalg.eigh(whitening @ stiffness @ whitening.T)
        self.vectors = whitening.T @ vectors

    def test_columns_are_those_of_the_exponential(self):
        times, vertices = [0.5, 4.0, 40.0], [0, 97, 194]
        found = isotherm.Heat(self.shape).columns(vertices, times)
        self.assertEqual(found.shape, (3, 3, self.shape.n))
        for row, vertex in zip(found, vertices):
            for heat, t in zip(row, times):
                exact = self.vectors * np.exp(-self.values * t) @ self.vectors[vertex]
                self.near(heat, exact, 1e-4)
                self.near(isotherm.Heat(self.shape).columns([vertex], [t])[0, 0], exact, 1e-7)
                self.assertAlmostEqual((self.shape.mass @ heat).sum(), 1.0, 9)

    def test_refusals(self):
        columns = isotherm.Heat(self.shape).columns
        self.refuses('vertices: they have to be of 0..194', columns, [195], [1.0])
        self.refuses('vertices: they have to be of', columns, [], [1.0])
        self.refuses('times: they have to be above 0', columns, [0], [0.0])
        self.refuses('times: a number is not finite', columns, [0], [1.0, np.nan])
        self.refuses('vertices: ', columns, 3, [1.0])


class Correspondence(TestCase):
    def test_distances_on_a_sheet_are_straight(self):
        shape = isotherm.Shape(isotherm.Mesh(*grid(31, 31)), pairs=4)
        source = 15 * 31 + 15
        found = isotherm.Geodesics(shape).distances(source)
        exact = np.linalg.norm(shape.vertices - shape.vertices[source], axis=1)
        self.assertLess(np.abs(found - exact).mean(), 0.05 * exact.mean())
        self.assertEqual(found[source], 0.0)

    def test_threads_share_a_solver(self):
        shape = shape_of(DOG, pairs=4)
        geodesics, found = isotherm.Geodesics(shape), {}
        expected = [geodesics.distances(v) for v in range(16)]
        threads = [threading.Thread(target=lambda v=v: found.update({v: geodesics.distances(v)})) for v in range(16)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for v in range(16):
            self.same(found[v], expected[v])

    def test_match_is_that_of_the_simulator(self):
        one, other = shape_of(DOG, pairs=60), shape_of(OTHER_DOG, pairs=60)
        points, full_map = isotherm.match(one, other)
        self.same(points, np.load(os.path.join(WORK, 'match', 'point.npy')))
        self.same(full_map, np.load(os.path.join(WORK, 'match', 'map.npy')))
        self.same(isotherm.map_of_points(one, other, points, 60), full_map)
        self.assertEqual(isotherm.points_of_map(one, other, full_map).shape, (other.n, ))

    def test_a_shape_is_matched_with_itself(self):
        shape = shape_of(DOG, pairs=40)
        signature = shape.wks()
        c = isotherm.functional_map(shape, shape, signature, signature, k=10)
        self.near(c, np.eye(10), 0.01)
        points = isotherm.zoom_out(shape, shape, np.eye(10), step=5)
        self.same(points, np.arange(shape.n, dtype=np.int32))

    def test_refusals(self):
        shape = shape_of(DOG, pairs=10)
        hks = shape.hks()
        self.refuses('vertex: %d is outside' % shape.n, isotherm.Geodesics(shape).distances, shape.n)
        self.refuses('k: 11 is outside 1..10', isotherm.functional_map, shape, shape, hks, hks, k=11)
        self.refuses('to_functions: its shape', isotherm.functional_map, shape, shape, hks, hks[:, :3], k=5)
        self.refuses('weight', isotherm.functional_map, shape, shape, hks, hks, k=5, weight=0)
        self.refuses('has to be square', isotherm.points_of_map, shape, shape, np.ones((3, 4)))
        self.refuses('map: 11 is outside', isotherm.zoom_out, shape, shape, np.eye(11))
        self.refuses('k_last: 3 is outside', isotherm.zoom_out, shape, shape, np.eye(4), k_last=3)
        self.refuses('points: a number is outside', isotherm.map_of_points, shape, shape, np.full(shape.n, shape.n), 5)
        self.refuses('first_pairs: 1 is outside', isotherm.match, shape, shape, first_pairs=1)
        few = shape_of(DOG, pairs=2)
        self.refuses('fewer than two different eigenvalues', isotherm.match, few, few)

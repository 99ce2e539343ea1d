"""Clouds of points beside a mesh of the same points, and best views."""
import os
import tempfile
import warnings

import numpy as np
import scipy.spatial

import isotherm
from support import DOG, WORK, TestCase, grid


def ball(n, seed=3):
    points = np.random.default_rng(seed).normal(size=(n, 3))
    return points / np.linalg.norm(points, axis=1)[:, None]


class Clouds(TestCase):
    def test_the_spectrum_is_that_of_the_convex_hull(self):
        points = ball(4000)
        hull = scipy.spatial.ConvexHull(points)
        mesh = isotherm.Shape(isotherm.Mesh(points, hull.simplices), pairs=30, robust=True)
        cloud = isotherm.Shape.of_points(points, pairs=30)
        self.assertTrue(cloud.is_cloud)
        self.assertFalse(mesh.is_cloud)
        self.same(cloud.vertices, points)
        self.near(cloud.eigenvalues[1:], mesh.eigenvalues[1:], 0.01)
        self.near(cloud.total_area, mesh.total_area, 0.002)
        self.near(cloud.areas, cloud.mass.to_scipy().sum(axis=1).A1, 1e-12)
        self.assertFalse(cloud.near_boundary.any())
        self.assertEqual(cloud.area_left_out, 0)
        # Most triangles are those of the hull.
        own, other = ({tuple(sorted(t)) for t in triangles.tolist()} for triangles in (cloud.triangles, hull.simplices))
        self.assertGreater(len(own & other), 0.97 * len(other))

    def test_files(self):
        points = ball(300)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, 'ball.xyz')
            np.savetxt(path, np.vstack([points, points[:3]]), fmt='%.17g')
            read, colours = isotherm.load_points(path)
            self.same(read, points)
            self.assertIsNone(colours)
            self.assertEqual(len(isotherm.load_points(path, mend=False)[0]), 303)
            self.refuses('no triangles: a cloud of points', isotherm.Mesh.load, path)
            shape = isotherm.Shape.of_points(read, pairs=10, neighbours=12)
            isotherm.Shape.of_points(read, pairs=10, colours=np.full((300, 3), 0.5))
            self.assertEqual(shape.n, 300)
        self.refuses('it has triangles: Mesh.load() reads it', isotherm.load_points, DOG)
        self.assertRaises(FileNotFoundError, isotherm.load_points, os.path.join(WORK, 'nowhere.xyz'))

    def test_bad_points_are_refused(self):
        make, points = isotherm.Shape.of_points, ball(100)
        self.refuses('points: its shape is (100, 2)', make, points[:, :2])
        self.refuses('points: there are 0', make, np.empty((0, 3)))
        self.refuses('points: their largest part has fewer than 32 points', make, points[:20])
        self.refuses('neighbours: 5 is outside 6..200', make, points, neighbours=5)
        self.refuses('colours: its shape', make, points, colours=np.zeros((99, 3)))
        self.refuses('colours: a number is outside 0..1', make, points, colours=np.full((100, 3), 2.0))
        points[4, 1] = np.inf
        self.refuses('points: a number is not finite', make, points)

    def test_points_that_are_left_out_are_told(self):
        far, same = '20.0 % of the points are not joined to the largest part, and are left out', \
            '10.0 % of the points are at the place of another one, and are left out'
        some, apart = ball(400), 0.2 * ball(100) + 50
        some[0, 2] = -0.0
        again = some[:40].copy()
        again[0, 2] = 0.0  # the same place as -0
        for n_again, parts, said in ((0, (some, apart), [far]), (40, (some[:360], again), [same]),
                                     (40, (some[:310], again, apart[:50]), [same, far.replace('20.0', '12.5')]),
                                     (3, (some, again[:3]), []), (0, (some, ), [])):
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter('always')
                shape = isotherm.Shape.of_points(np.vstack(parts), pairs=10)
            self.assertEqual([str(warning.message) for warning in caught], said)
            self.assertEqual(shape.n, len(parts[0]))
            self.assertAlmostEqual(shape.area_left_out, 1 - len(parts[0]) / sum(map(len, parts)))


class Views(TestCase):
    def test_a_sheet_is_seen_from_above(self):
        mesh = isotherm.Mesh(*grid(9, 5))
        seen = isotherm.view_of(mesh, (0, 0, -3))
        self.near(seen.direction, (0, 0, -1), 1e-12)
        self.assertAlmostEqual(seen.entropy, np.log2(2 * 8 * 4), 2)
        self.assertAlmostEqual(seen.divergence, 0, 2)
        best = isotherm.best_views(mesh, 3, 'divergence')
        self.assertEqual(len(best), 3)
        self.assertAlmostEqual(best[0].divergence, 0, 2)
        self.assertLessEqual(best[0].direction @ best[1].direction, np.cos(np.radians(40)) + 1e-9)

    def test_they_are_those_of_the_simulator(self):
        mesh = isotherm.Mesh.load(DOG)
        described = isotherm.read_described(os.path.join(WORK, 'views', 'dog-01'))
        shape = isotherm.Shape(mesh, pairs=4)
        best = isotherm.best_views(isotherm.Mesh(shape.vertices, shape.triangles), 3)
        self.same(np.array([v.direction for v in best]), described['view'])
        self.same(np.array([v.entropy for v in best]), described['view_entropy'])
        self.same(np.array([v.divergence for v in best]), described['view_divergence'])
        again = isotherm.view_of(mesh, described['view'][0])
        self.assertAlmostEqual(again.entropy, described['view_entropy'][0], 3)

    def test_bad_arguments_are_refused(self):
        mesh = isotherm.Mesh(*grid(9, 5))
        flat = isotherm.Mesh(np.zeros((3, 3)), [[0, 1, 2]])
        self.refuses('n: 0 is outside', isotherm.best_views, mesh, 0)
        self.refuses("score: 'best' is none of entropy, divergence", isotherm.best_views, mesh, 1, 'best')
        self.refuses('apart: 4 is not between', isotherm.best_views, mesh, 1, apart=4)
        self.refuses('direction: its length is 0', isotherm.view_of, mesh, (0, 0, 0))
        self.refuses('mesh: it has no area', isotherm.best_views, flat)

#!/usr/bin/env python3
"""A cloud of points, without triangles: its spectrum, heat and distances on a sphere, where they are
known.

usage: clouds.py [PICTURE.png]
"""
import sys

import numpy as np

import isotherm
import pictures

RADIUS = 50.0  # mm

random = np.random.default_rng(1)
points = random.normal(size=(6000, 3))
points *= RADIUS / np.linalg.norm(points, axis=1)[:, None]

# Triangles of each point and its nearest neighbours stand for the surface.
shape = isotherm.Shape.of_points(points, pairs=40)
known = np.repeat([l * (l + 1) / RADIUS**2 for l in range(1, 5)], [3, 5, 7, 9])
off = np.abs(shape.eigenvalues[1:25] / known - 1).max()
area = shape.total_area / (4 * np.pi * RADIUS**2) - 1
print('%d points: 24 eigenvalues differ from l (l + 1) / R^2 by up to %.2f %%, the area by %.2f %%' %
      (shape.n, 100 * off, 100 * abs(area)))

# Distances are those of triangles, too.
exact = RADIUS * np.arccos(np.clip(points @ points[0] / RADIUS**2, -1, 1))
distance = isotherm.Geodesics(shape).distances(0)
error = np.abs(distance - exact).mean() / exact.mean()
print('distances from a point: mean error %.2f %% of the mean' % (100 * error))

if len(sys.argv) > 1:
    heat = shape.heat_from(0, [0.005 * shape.total_area, 0.02 * shape.total_area])
    pictures.draw(sys.argv[1], [('heat', shape.vertices, shape.triangles, heat[:, 0]),
                                ('heat, later', shape.vertices, shape.triangles, heat[:, 1]),
                                ('distance, mm', shape.vertices, shape.triangles, distance)])
if off > 0.02 or abs(area) > 0.005 or error > 0.03:
    sys.exit('the cloud is not like a sphere')

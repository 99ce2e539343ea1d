#!/usr/bin/env python3
"""Distances on a surface by heat, on a sphere where they are known: radius times angle.

usage: geodesics.py [PICTURE.png]
"""
import sys

import numpy as np

import isotherm
import pictures
import surfaces

RADIUS = 50.0  # mm

error = {}
for level in (3, 4, 5):
    vertices, triangles = surfaces.sphere(level, RADIUS)
    # Distances need no eigenpairs; a few are computed in any case.
    shape = isotherm.Shape(isotherm.Mesh(vertices, triangles), pairs=4)

    # Two matrices are factorised once; then each source is two solves.
    geodesics = isotherm.Geodesics(shape)
    distance = geodesics.distances(0)

    exact = RADIUS * np.arccos(np.clip(vertices @ vertices[0] / RADIUS**2, -1, 1))
    error[level] = np.abs(distance - exact).mean() / exact.mean()
    print('%5d vertices: mean error %.2f mm, %.2f %% of the mean distance; farthest %.1f mm, exact %.1f mm' %
          (shape.n, np.abs(distance - exact).mean(), 100 * error[level], distance.max(), exact.max()))

# The error shrinks with the edges.
if len(sys.argv) > 1:
    pictures.draw(sys.argv[1], [('distance, mm', vertices, triangles, distance),
                                ('error, mm', vertices, triangles, np.abs(distance - exact))])
if not error[5] < error[4] < error[3] or error[4] > 0.02:
    sys.exit('the distances are not those on a sphere')

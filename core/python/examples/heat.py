#!/usr/bin/env python3
"""Heat of one vertex of a sphere after a time, where it is known: the sum of (2l + 1) / (4 pi R^2)
exp(-l (l + 1) t / R^2) P_l(cos angle) over l.

usage: heat.py [PICTURE.png]
"""
import sys

import numpy as np

import isotherm
import pictures
import surfaces

RADIUS = 50.0  # mm
TIMES = RADIUS**2 * np.array([0.03, 0.1, 0.3])  # mm^2
VIEWER = (0.4, -0.7, 0.5)  # from where pictures.py looks


def known(cosine, t):
    degrees = np.arange(60)
    weights = (2 * degrees + 1) * np.exp(-degrees * (degrees + 1) * t / RADIUS**2)
    return np.polynomial.legendre.legval(cosine, weights) / (4 * np.pi * RADIUS**2)


error = {}
for level in (3, 4, 5):
    vertices, triangles = surfaces.sphere(level, RADIUS)
    # The direct solver needs no eigenpairs; a few are computed in any case.
    shape = isotherm.Shape(isotherm.Mesh(vertices, triangles), pairs=4)
    source = (vertices @ VIEWER).argmax()
    heat = isotherm.Heat(shape).columns([source], TIMES)[0]
    cosine = np.clip(vertices @ vertices[source] / RADIUS**2, -1, 1)
    exact = np.array([known(cosine, t) for t in TIMES])
    error[level] = (np.abs(heat - exact).max(1) / exact.max(1)).max()
    print('%5d vertices: off by at most %.2f %% of the heat at the vertex; all heat: %.12f' %
          (shape.n, 100 * error[level], (shape.mass @ heat[0]).sum()))

# The error shrinks with the edges.
if len(sys.argv) > 1:
    pictures.draw(sys.argv[1], [('after %g mm^2' % t, vertices, triangles, column) for t, column in zip(TIMES, heat)])
if not error[5] < error[4] < error[3] or error[5] > 0.01:
    sys.exit('the heat is not that of a sphere')

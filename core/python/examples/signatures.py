#!/usr/bin/env python3
"""Signatures of vertices: they are large at the tips of limbs, and stay the same when a body moves.

usage: signatures.py [PICTURE.png]
"""
import sys

import numpy as np

import isotherm
import pictures
import surfaces

# A body with five limbs of different lengths.
TIPS = [(1, 0, 0), (-0.6, 0.8, 0), (-0.5, -0.8, 0.3), (0.2, 0.3, 1), (0.3, -0.2, -1)]
vertices, triangles = surfaces.with_limbs(4, TIPS, [1.0, 0.8, 0.9, 0.7, 1.1])
shape = isotherm.Shape(isotherm.Mesh(vertices, triangles))

# The heat kernel signature: how much heat is still at a vertex after a time. There is a row of times
# for each vertex. Heat leaves a tip late, because there is little surface around it.
times = shape.heat_times(n=20, first=0.005 * shape.total_area, last=0.1 * shape.total_area)
hks = shape.hks(times)
early = hks[:, 0]
print('hks', hks.shape, 'after %.3f: %.3f in the mean, %.3f at most' % (times[0], early.mean(), early.max()))

# Among its extrema above the mean are the tips: the vertices that lie farthest out in each direction.
tips = [int(np.argmax(vertices @ np.asarray(tip) / np.linalg.norm(tip))) for tip in TIPS]
peaks = [v for v in shape.extrema(early) if early[v] > early.mean()]
away = [np.linalg.norm(vertices[peaks] - vertices[tip], axis=1).min() for tip in tips]
print('%d peaks; from each tip to the nearest one: %s' % (len(peaks), ', '.join('%.3f' % a for a in away)))

# Other functions of the vertices.
wks, hms, si_hks = shape.wks(), shape.hms(), shape.si_hks()
print('wks', wks.shape, 'hms', hms.shape, 'si_hks', si_hks.shape)
print('critical points, extrema of the first eigenfunction:', shape.critical_points())

# The body turned and moved has the same signatures.
turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
turn *= np.sign(np.linalg.det(turn))
moved = isotherm.Shape(isotherm.Mesh(vertices @ turn.T + 7, triangles))
change = np.abs(moved.hks(times) / hks - 1).max()
print('moved: the signatures change by %.1e' % change)

# The body twice as large: heat takes four times as long and is spread over four times the area.
large = isotherm.Shape(isotherm.Mesh(2 * vertices, triangles))
scale = np.abs(4 * large.hks(4 * times) / hks - 1).max()
print('twice as large: 4 K(4 t) and K(t) differ by %.1e' % scale)

if len(sys.argv) > 1:
    pictures.draw(sys.argv[1], [('heat kernel signature', vertices, triangles, np.log(early)),
                                ('wave kernel signature', vertices, triangles, np.log(wks[:, 50])),
                                ('first eigenfunction', vertices, triangles, shape.eigenvectors[:, 1])])
if max(away) > 0.1 or change > 1e-6 or scale > 1e-6:
    sys.exit('the signatures are not as they should be')

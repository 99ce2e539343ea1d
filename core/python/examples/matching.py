#!/usr/bin/env python3
"""Which points of two shapes correspond: a body and the same body bent, where the truth is known.

usage: matching.py [PICTURE.png]
"""
import sys

import numpy as np

import isotherm
import pictures
import surfaces

# A long body without symmetry, since left and right cannot be told apart by heat. Vertex i of the
# bent body is vertex i of the straight one.
straight, triangles = surfaces.with_limbs(4, [(1, 0.4, 0.1), (-1, 0.2, 0.5), (0.1, -1, 0.4), (0.2, 0.9, -0.9)],
                                          [0.9, 0.5, 0.7, 1.2])
straight = straight * (2.0, 0.6, 0.6)
curved = surfaces.bent(straight, 0.8)
one = isotherm.Shape(isotherm.Mesh(straight, triangles), pairs=80)
other = isotherm.Shape(isotherm.Mesh(curved, triangles), pairs=80)

# In one step: a functional map fitted to signatures, refined by ZoomOut. For each vertex of the
# second shape there is a vertex of the first.
points, full_map = isotherm.match(one, other)
print('points', points.shape, 'map', full_map.shape)

# The same step by step. First functions that both shapes have: wave kernel signatures at the same
# energies.
energies, spread = one.wave_energies(60)
first = isotherm.functional_map(one, other, one.wks(energies, spread), other.wks(energies, spread), k=20)
rough = isotherm.points_of_map(one, other, first)
refined = isotherm.zoom_out(one, other, first, step=5)

# The error is the distance on the first shape from the point found to the true one, over the root of
# the area. Three hundred points are enough for a mean.
geodesics = isotherm.Geodesics(one)
sample = np.random.default_rng(2).choice(one.n, 300, replace=False)
truth = {int(v): geodesics.distances(int(v)) / one.total_area**0.5 for v in sample}


def mean_error(found):
    return np.mean([distance[found[v]] for v, distance in truth.items()])


error = mean_error(points)
print('mean error: %.4f at once; step by step %.4f rough, %.4f refined; of points at random %.4f' %
      (error, mean_error(rough), mean_error(refined), mean_error(np.random.default_rng(3).permutation(one.n))))

if len(sys.argv) > 1:
    # Each point of the bent body has the colour of the point of the straight body that was found.
    pictures.draw(sys.argv[1], [('straight', straight, triangles, straight[:, 0]),
                                ('bent, in colours of its points', curved, triangles, straight[points, 0])])
if error > 0.05:
    sys.exit('the points do not correspond')

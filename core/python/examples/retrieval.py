#!/usr/bin/env python3
"""Which shapes of a corpus are of one kind: four kinds of bodies, six of each in other proportions
and bent in another way; methods of the dissertation beside each other."""
import sys

import numpy as np

import isotherm
import surfaces

KINDS = {
    'one limb': [(1, 0, 0)],
    'two limbs': [(1, 0.2, 0), (-1, 0.2, 0)],
    'three limbs': [(1, 0, 0), (-0.5, 0.9, 0), (-0.5, -0.9, 0)],
    'five limbs': [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1)],
}
EACH = 6

# The corpus: labels count from 0.
random = np.random.default_rng(5)
shapes, labels = [], []
for label, directions in enumerate(KINDS.values()):
    for _ in range(EACH):
        turned = np.asarray(directions, float) + random.normal(scale=0.1, size=(len(directions), 3))
        vertices, triangles = surfaces.with_limbs(3, turned, random.uniform(1.0, 1.4, len(directions)))
        vertices = surfaces.bent(vertices, random.uniform(0.1, 0.5))
        shapes.append(isotherm.Shape(isotherm.Mesh(vertices, triangles), pairs=60))
        labels.append(label)
labels = np.array(labels)

share = {}
for name in ('shape-dna', 'td', 'cp-hk', 'shape-google'):
    method = isotherm.methods()[name]

    # A description for each shape. The coder turns it into a feature; for some methods it learns
    # from the corpus first, without labels.
    descriptions = [isotherm.describe(shape, name) for shape in shapes]
    coder = isotherm.Coder(descriptions, size=0 if method.coding == 'plain' else 16)
    features = np.array([coder.code(d) for d in descriptions])

    # The nearest neighbour of each shape, without itself, by the norm that suits the method.
    nearest = isotherm.Classifier('nn-' + method.norm, features, labels)
    hits = 0
    for i, feature in enumerate(features):
        distance = nearest.rank(feature, left=i)
        distance[i] = np.inf  # the shape itself
        hits += labels[np.argmin(distance)] == labels[i]
    share[name] = hits / len(shapes)
    print('%-12s %4d values  nearest neighbour of the same kind: %2d of %d  (%s)' %
          (name, coder.size, hits, len(shapes), method.source))

if max(share.values()) < 0.9 or min(share.values()) < 0.4:
    sys.exit('the methods do not find shapes of the same kind')

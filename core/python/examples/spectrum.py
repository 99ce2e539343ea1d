#!/usr/bin/env python3
"""The spectrum of a sphere, which is known: l (l + 1) / r^2, each 2 l + 1 times."""
import sys

import numpy as np

import isotherm
import surfaces

RADIUS = 50.0  # mm; any unit will do
LEVELS = 7  # l = 0..6

# A mesh of two arrays: positions, and three vertices for each triangle.
mesh = isotherm.Mesh(*surfaces.sphere(level=4, radius=RADIUS))
print(mesh)

# A shape is a mesh with its finite elements and its first eigenpairs.
shape = isotherm.Shape(mesh, pairs=LEVELS**2)
print(shape, '%.0f mm2, a sphere has %.0f' % (shape.total_area, 4 * np.pi * RADIUS**2))

# All eigenvalues of one l are the same on a sphere. On a mesh they differ a little, and are larger
# by a share that grows with the square of frequency times edge length.
worst = 0.0
print(' l  times       exact        mean   error      spread')
for l in range(LEVELS):
    found = shape.eigenvalues[l**2:(l + 1)**2]
    exact = l * (l + 1) / RADIUS**2
    error = found.mean() / exact - 1 if l else 0.0
    worst = max(worst, abs(error))
    print('%2d  %5d  %10.6f  %10.6f  %5.2f %%  %.1e' % (l, len(found), exact, found.mean(), 100 * error, np.ptp(found)))

# The eigenvectors are orthonormal by the mass matrix: phi' B phi = 1.
phi = shape.eigenvectors
residual = np.abs(phi.T @ (shape.mass @ phi) - np.eye(phi.shape[1])).max()
print("phi' B phi differs from 1 by %.1e" % residual)

# The same from the matrices alone, with a lumped mass. Its eigenvalues are smaller.
stiffness, mass = isotherm.finite_elements(mesh, lumped=True)
values, _ = isotherm.eigenpairs(stiffness, mass, LEVELS**2)
print('l = 6 with a lumped mass: %.6f, with a consistent one: %.6f' %
      (values[-13:].mean(), shape.eigenvalues[-13:].mean()))

if worst > 0.02 or residual > 1e-8 or not values[-1] < shape.eigenvalues[-1]:
    sys.exit('the spectrum is not that of a sphere')

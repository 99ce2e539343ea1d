#!/usr/bin/env python3
"""The Python module beside SciPy: 100 eigenpairs of a surface and a signature of its vertices.

usage: python_peers.py [VERTICES...]        needs SciPy, and one thread: OPENBLAS_NUM_THREADS=1

Both get the same matrices. SciPy's way is that of most programs in Python: ARPACK (Lehoucq, Sorensen
and Yang 1998) in shift-invert mode with SuperLU. The times are medians of five runs, by turns.
"""
import statistics
import sys
import time

import numpy as np
import scipy.sparse.linalg

import isotherm

PAIRS, RUNS = 100, 5
SHIFT = -1e-8  # next to the lowest eigenvalue, which is 0


def bumpy_sphere(n):
    """A closed surface with about n vertices, radius about 1, without symmetry."""
    rows = max(6, round((n / 2)**0.5))
    angle, height = np.meshgrid(np.arange(2 * rows) * np.pi / rows, (np.arange(rows) + 0.5) / rows * np.pi)
    angle, height = angle.ravel(), height.ravel()
    at = np.column_stack([np.cos(angle) * np.sin(height), np.sin(angle) * np.sin(height), np.cos(height)])
    at = np.vstack([at, [[0, 0, 1], [0, 0, -1]]])
    number = np.arange(2 * rows * rows).reshape(rows, 2 * rows)
    a, b = number[:-1], np.roll(number, -1, axis=1)[:-1]
    c, d = number[1:], np.roll(number, -1, axis=1)[1:]
    top, bottom = number[0], number[-1]
    triangles = [(a, c, d), (a, d, b), (np.full_like(top, len(at) - 2), top, np.roll(top, -1)),
                 (np.full_like(bottom, len(at) - 1), np.roll(bottom, -1), bottom)]
    bumps = 1 + 0.2 * np.sin(3 * at[:, :1] + 1) * np.cos(4 * at[:, 1:2]) + 0.1 * at[:, 2:]
    return at * bumps, np.vstack([np.column_stack([x.ravel() for x in t]) for t in triangles]).astype(np.int32)


def timed(function, times):
    begin = time.perf_counter()
    result = function()
    times.append(1e3 * (time.perf_counter() - begin))
    return result


def main():
    sizes = [int(word) for word in sys.argv[1:]] or [2000, 8000, 32000]
    print('%d eigenpairs of a surface, and the heat kernel signature at 100 times; ms, medians of %d' % (PAIRS, RUNS))
    print('vertices   isotherm   SciPy   ratio   eigenvalues differ   signature: isotherm   NumPy   ratio')
    for size in sizes:
        mesh = isotherm.Mesh(*bumpy_sphere(size))
        stiffness, mass = isotherm.finite_elements(mesh)
        theirs, times = (stiffness.to_scipy().tocsc(), mass.to_scipy().tocsc()), ([], [], [], [])
        for _ in range(RUNS):
            ours, _ = timed(lambda: isotherm.eigenpairs(stiffness, mass, PAIRS), times[0])
            peer, _ = timed(lambda: scipy.sparse.linalg.eigsh(theirs[0], PAIRS, theirs[1], sigma=SHIFT), times[1])
            shape = isotherm.Shape(mesh, pairs=PAIRS)
            at = shape.heat_times(100)
            signature = timed(lambda: shape.hks(at), times[2])
            other = timed(lambda: shape.eigenvectors**2 @ np.exp(-np.outer(shape.eigenvalues, at)), times[3])
        a, b, c, d = (statistics.median(t) for t in times)
        off = np.abs(np.sort(peer) - ours)[1:] / ours[1:]
        print('%8d %10.1f %7.1f %7.2f %20.0e %21.2f %7.2f %7.2f' %
              (len(mesh.vertices), a, b, a / b, off.max(), c, d, c / d))
        if not np.allclose(signature, other, rtol=1e-9):
            sys.exit('the signatures differ')


main()

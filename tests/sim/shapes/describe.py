"""Reads what `shapes describe` has written and computes the same from the mesh alone.

usage: describe.py MESH.off DIRECTORY COLOURED ROBUST
DIRECTORY has npy/NAME, csv/NAME and mat5/NAME of the same mesh; COLOURED has one of a
coloured mesh, ROBUST one of MESH.off with --laplacian robust.
"""
import glob
import json
import os
import sys

import numpy as np
import scipy.io
import scipy.sparse as sparse
import scipy.sparse.csgraph
import scipy.sparse.linalg


def near(what, a, b, tolerance):
    a, b = np.asarray(a, float), np.asarray(b, float)
    assert a.shape == b.shape, (what, a.shape, b.shape)
    error = np.abs(a - b).max() / max(np.abs(b).max(), 1e-300)
    assert error <= tolerance, (what, error)


def read_off(path):
    words = open(path).read().split()
    n, m = int(words[1]), int(words[2])
    vertices = np.array(words[4:4 + 3 * n], float).reshape(n, 3)
    faces = np.array(words[4 + 3 * n:4 + 3 * n + 4 * m], int).reshape(m, 4)
    return vertices, faces[:, 1:]


def finite_elements(v, f):
    """Linear elements from the gradients of the hat functions; no cotangents."""
    rows, columns, stiff, heavy = [], [], [], []
    for t in f:
        p = v[t]
        edge = np.array([p[2] - p[1], p[0] - p[2], p[1] - p[0]])
        area = 0.5 * np.linalg.norm(np.cross(edge[1], edge[2]))
        for i in range(3):
            for j in range(3):
                rows.append(t[i])
                columns.append(t[j])
                stiff.append(edge[i] @ edge[j] / (4 * area))
                heavy.append(area / (6 if i == j else 12))
    n = len(v)
    return (sparse.csc_matrix((stiff, (rows, columns)), (n, n)), sparse.csc_matrix((heavy, (rows, columns)), (n, n)))


def read_all(directory):
    described = json.load(open(os.path.join(directory, 'npy', 'dog-01', 'parameters.json')))
    mat = scipy.io.loadmat(os.path.join(directory, 'mat5', 'dog-01', 'descriptors.mat'))
    arrays = {}
    for entry in described['arrays']:
        name = entry['name']
        array = np.load(os.path.join(directory, 'npy', 'dog-01', entry['file']))
        assert array.dtype == np.dtype(entry['type']) and list(array.shape) == entry['shape'], entry
        assert len(entry['meaning']) > 5
        table = np.loadtxt(os.path.join(directory, 'csv', 'dog-01', name + '.csv'), delimiter=',', ndmin=2)
        column = array.reshape(array.shape[0], -1)
        assert mat[name].dtype == array.dtype and (mat[name] == column).all(), name
        assert (table.astype(array.dtype) == column).all(), name
        arrays[name] = array
    assert len(arrays) == sum(not key.startswith('_') for key in mat)
    return described, arrays


def symmetric(arrays, name, n):
    entry = (arrays[name + '_value'], (arrays[name + '_row'], arrays[name + '_column']))
    lower = sparse.coo_matrix(entry, (n, n)).tocsc()
    assert (arrays[name + '_row'] >= arrays[name + '_column']).all()
    return lower + sparse.tril(lower, -1).T


def check_spectrum(arrays, stiffness, mass):
    lam, phi = arrays['lambda'], arrays['phi']
    n, k = phi.shape
    assert k == 40
    near('stiffness', symmetric(arrays, 'stiffness', n).toarray(), stiffness.toarray(), 1e-12)
    near('mass', symmetric(arrays, 'mass', n).toarray(), mass.toarray(), 1e-12)
    near('orthonormal', phi.T @ (mass @ phi), np.eye(k), 1e-10)
    expected = scipy.sparse.linalg.eigsh(stiffness, k, mass, sigma=-1e-4, which='LM', return_eigenvectors=False)
    near('eigenvalues', lam, np.sort(expected), 1e-9)
    near('eigenvectors', stiffness @ phi, mass @ phi * lam, 1e-6)
    return lam, phi


def check_signatures(arrays, described, lam, phi):
    t, e = arrays['hks_time'], arrays['wks_energy']
    told = described['shape']['hks_times']
    near('told times', [told['number'], told['first'], told['last']], [7, t[0], t[-1]], 1e-6)
    near('times', t, np.geomspace(4 * np.log(10) / lam[-1], 4 * np.log(10) / lam[1], 7), 1e-9)
    near('hks', arrays['hks'], phi**2 @ np.exp(-np.outer(lam, t)), 1e-10)
    near('energies', np.diff(e), np.full(29, e[1] - e[0]), 1e-9)
    spread = 7 * (e[1] - e[0])
    near('ends', [e[0] - 2 * spread, e[-1] + 2 * spread], [np.log(lam[1]), np.log(lam[-1])], 1e-9)
    weight = np.exp(-((e - np.log(lam[1:, None])) / spread)**2 / 2)
    near('wks', arrays['wks'], phi[:, 1:]**2 @ (weight / weight.sum(axis=0)), 1e-10)
    kernel = (phi * np.exp(-lam * arrays['area'].sum() / 64)) @ phi.T
    near('hms', arrays['hms'], (kernel.sum(axis=1) - kernel.diagonal()) / len(phi), 1e-8)


def check_segments(arrays, lam, phi):
    """Segments belong to the peaks of the heat kernel signature that persist, and are connected."""
    heat = phi**2 @ np.exp(-lam * arrays['area'].sum() / 64)
    f, segment, peak, persistence = (arrays[name] for name in ('triangles', 'segment', 'peak', 'peak_persistence'))
    n = len(heat)
    edges = np.concatenate([f[:, [0, 1]], f[:, [1, 2]], f[:, [2, 0]]])
    edges = np.concatenate([edges, edges[:, ::-1]])
    highest = np.full(n, -np.inf)
    np.maximum.at(highest, edges[:, 0], heat[edges[:, 1]])
    assert sorted(peak) == list(np.flatnonzero(heat > highest))
    assert (np.diff(persistence) <= 0).all() and peak[0] == heat.argmax()
    many = int((persistence >= 0.1 * np.ptp(heat)).sum())
    assert many >= 4 and set(segment) == set(range(many)) and (segment[peak[:many]] == range(many)).all()
    inner = edges[segment[edges[:, 0]] == segment[edges[:, 1]]]
    graph = sparse.coo_matrix((np.ones(len(inner)), (inner[:, 0], inner[:, 1])), (n, n))
    assert sparse.csgraph.connected_components(graph)[0] == many
    # The second peak ends where its island meets the first one's: above that level they are apart.
    for level, together in ((1e-9, False), (-1e-9, True)):
        height = heat[peak[1]] - persistence[1] + level * np.ptp(heat)
        above = edges[(heat[edges] >= height).all(axis=1)]
        graph = sparse.coo_matrix((np.ones(len(above)), (above[:, 0], above[:, 1])), (n, n))
        label = sparse.csgraph.connected_components(graph)[1]
        assert (label[peak[0]] == label[peak[1]]) == together


def check_shape(arrays, lam, phi):
    ratio = lam[1:16] / lam[1]
    near('shape_dna', arrays['shape_dna'], ratio, 1e-6)
    assert abs(arrays['td'].sum() - 1) < 1e-5 and arrays['td'].shape == (100, )
    assert arrays['cp_hk'].shape == (700, ) and (arrays['cp_hk'][:601] == arrays['cp_hk_plain']).all()
    near('number of points', arrays['cp_hk'][600:601], [0.1 * len(arrays['critical'])], 1e-6)
    assert (arrays['si_hks'] == arrays['shape_google_local']).all()
    n = len(phi)
    f = arrays['triangles']
    near_by = sparse.coo_matrix((np.ones(6 * len(f)), (f[:, [0, 1, 2, 1, 2, 0]].ravel(), f[:, [1, 2, 0, 0, 1, 2]].ravel())), (n, n)).tocsr()
    near_by = near_by + near_by @ near_by
    for point in arrays['critical']:
        ring = near_by[point].indices
        others = phi[ring[ring != point], 1]
        assert (others < phi[point, 1]).all() or (others > phi[point, 1]).all(), point
    heights = np.abs(phi[arrays['critical'], 1])
    assert (np.diff(heights) <= 0).all() and len(heights) >= 4


def check_robust(directory, plain, mass):
    """Finite elements for bad meshes: no conductance is negative, while the plain ones have such."""
    names = ('lambda', 'phi') + tuple(m + s for m in ('stiffness', 'mass') for s in ('_row', '_column', '_value'))
    arrays = {name: np.load(os.path.join(directory, name + '.npy')) for name in names}
    lam, phi = arrays['lambda'], arrays['phi']
    n, k = phi.shape
    robust, heavy = symmetric(arrays, 'stiffness', n), symmetric(arrays, 'mass', n)
    assert sparse.tril(plain, -1).max() > 0.01 and sparse.tril(robust, -1).max() < 1e-8
    assert abs(robust.sum(axis=1)).max() < 1e-9
    near('area', heavy.sum(), mass.sum(), 1e-9)
    expected = scipy.sparse.linalg.eigsh(robust, k, heavy, sigma=-1e-4, which='LM', return_eigenvectors=False)
    near('robust eigenvalues', lam, np.sort(expected), 1e-9)
    assert json.load(open(os.path.join(directory, 'parameters.json')))['shape']['laplacian'] == 'robust'


def check_coloured(directory):
    path = glob.glob(os.path.join(directory, '*'))[0]
    for channel in range(3):
        local = np.load(os.path.join(path, 'w_hks2_local_%d.npy' % channel))
        assert local.shape[1] == 20 and np.isfinite(local).all() and local.std() > 0
    histogram = np.load(os.path.join(path, 'w_hks2.npy'))
    assert histogram.shape == (64, ) and abs(histogram.sum() - 1) < 1e-5
    assert json.load(open(os.path.join(path, 'parameters.json')))['source']['colours']


def main():
    described, arrays = read_all(sys.argv[2])
    vertices, triangles = read_off(sys.argv[1])
    near('vertices', arrays['vertices'], vertices, 0)
    near('triangles', arrays['triangles'], triangles, 0)
    stiffness, mass = finite_elements(vertices, triangles)
    near('area', arrays['area'], mass.sum(axis=1).A1, 1e-12)
    lam, phi = check_spectrum(arrays, stiffness, mass)
    check_signatures(arrays, described, lam, phi)
    check_segments(arrays, lam, phi)
    check_shape(arrays, lam, phi)
    check_coloured(sys.argv[3])
    assert described['shape']['laplacian'] == 'plain'
    check_robust(os.path.join(sys.argv[4], 'dog-01'), stiffness, mass)


main()

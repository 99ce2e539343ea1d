"""Small meshes for the examples: spheres, and bodies with limbs. Each is (vertices, triangles)."""
import numpy as np


def sphere(level=4, radius=1.0):
    """A sphere: an icosahedron of which each triangle is cut into four, `level` times. It has
    10 4^level + 2 vertices."""
    golden = (1 + 5**0.5) / 2
    vertices = np.array([(-1, golden, 0), (1, golden, 0), (-1, -golden, 0), (1, -golden, 0), (0, -1, golden),
                         (0, 1, golden), (0, -1, -golden), (0, 1, -golden), (golden, 0, -1), (golden, 0, 1),
                         (-golden, 0, -1), (-golden, 0, 1)])
    triangles = np.array([(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4),
                          (11, 10, 2), (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9),
                          (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)])
    for _ in range(level):
        vertices, triangles = _cut(vertices, triangles)
    return radius * vertices / np.linalg.norm(vertices, axis=1)[:, None], triangles


def _cut(vertices, triangles):
    """Cuts each triangle into four at the middles of its edges."""
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges, number = np.unique(edges, axis=0, return_inverse=True)
    ab, bc, ca = (len(vertices) + number.reshape(-1, 3)).T
    a, b, c = triangles.T
    quarters = np.concatenate([np.column_stack(t) for t in ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))])
    return np.concatenate([vertices, vertices[edges].mean(axis=1)]), quarters


def with_limbs(level, directions, lengths, width=0.35):
    """A sphere with limbs: (number, 3) directions, and the length of each."""
    directions = np.asarray(directions, float)
    directions = directions / np.linalg.norm(directions, axis=1)[:, None]
    unit, triangles = sphere(level)
    angle = np.arccos(np.clip(unit @ directions.T, -1, 1))
    return unit * (1 + np.exp(-(angle / width)**2) @ np.asarray(lengths, float))[:, None], triangles


def bent(vertices, angle):
    """The same body, its x axis bent to an arc of `angle` radians."""
    x, y, z = vertices.T
    radius = (x.max() - x.min()) / angle
    return np.column_stack([(radius - y) * np.sin(x / radius), radius - (radius - y) * np.cos(x / radius), z])

"""The directions from which a mesh is seen best."""
import errno
import math
from ctypes import c_int
from typing import NamedTuple

import numpy as np

from ._library import Error, array_in, byref, check, lib, number_in, structs

_SCORES = ('entropy', 'divergence')  # enum iso_view_score
_VIEWS_MAX = 1000
_FAULTS = {errno.EINVAL: 'it has no area', errno.EDOM: 'its axes cannot be computed'}


class View(NamedTuple):
    """A direction, and what is seen from it in parallel projection."""
    direction: np.ndarray  # (3,) float64, of unit length, from the mesh to the viewer
    entropy: float  # bits: large if many triangles are seen, all of the same size (Vazquez et al. 2001)
    divergence: float  # bits: small if all parts are seen by their area (Sbert et al. 2005)


def best_views(mesh, n=4, score='entropy', apart=math.radians(40)):
    """The best views of a mesh, in the order in which they are found: a list of View, of at most n.

    score: 'entropy', which depends on how the surface is divided into triangles, or 'divergence',
    which depends on it much less. apart: the least angle between two views, radians. Raises Error for a mesh without
    area.
    """
    n = number_in(n, 1, _VIEWS_MAX, 'n')
    if score not in _SCORES:
        raise Error('score: %r is none of %s' % (score, ', '.join(_SCORES)))
    if not 0 < float(apart) < math.pi:
        raise Error('apart: %r is not between 0 and pi' % apart)
    mesh._check()
    views, found = (structs.ShapeView * n)(), c_int()
    check(lib.iso_shape_views(byref(mesh._struct), _SCORES.index(score), apart, n, views, byref(found)), 'mesh', _FAULTS)
    return [_view(seen) for seen in views[:found.value]]


def view_of(mesh, direction):
    """The scores of one direction, (3,) numbers: a View. Raises Error for a mesh without area and a
    direction of length 0."""
    direction = array_in(direction, np.float64, (3, ), 'direction')
    if not direction.any():
        raise Error('direction: its length is 0')
    mesh._check()
    seen = structs.ShapeView()
    check(lib.iso_shape_view_of(byref(mesh._struct), structs.Vec3(*direction), byref(seen)), 'mesh', _FAULTS)
    return _view(seen)


def _view(seen):
    return View(np.array(seen.direction), seen.entropy, seen.divergence)

"""Descriptions of whole shapes by the methods of the library, and the features made of them."""
import errno
from ctypes import POINTER, c_void_p
from typing import NamedTuple

import numpy as np

from ._library import Error, Owner, address, byref, check, lib, number_in, structs, view

_CODINGS = ('plain', 'reduced', 'bags')  # enum iso_shape_coding
NORMS = ('l1', 'l2', 'partial')  # enum iso_norm


class Method(NamedTuple):
    """A method of describing shapes (isotherm/shape_method.h)."""
    name: str  # as on a command line: 'cp-hk'
    title: str  # as in a table: 'CP-HK'
    source: str  # author, year, section
    colour: bool  # it needs a shape with colours
    coding: str  # how a description becomes a feature: 'plain', 'reduced' or 'bags'
    size: int  # default: principal components, or words of each vocabulary; or 0
    norm: str  # by which nearest neighbours are best looked for: 'l1', 'l2' or 'partial'
    classifier: str  # what the dissertation classifies it by


def methods():
    """All methods by their names, in the order of the library's table."""
    table = (POINTER(structs.ShapeMethod) * 1000).in_dll(lib, 'iso_shape_methods')
    found = {}
    for pointer in table:
        if not pointer:  # the end of the table
            break
        m = pointer.contents
        found[m.name.decode()] = Method(m.name.decode(), m.title.decode(), m.source.decode(), m.colour,
                                        _CODINGS[m.coding], m.size, NORMS[m.norm], m.classifier.decode())
    return found


def _find(name):
    method = lib.iso_shape_method_find(str(name).encode())
    if not method:
        raise Error('method: %r is unknown; there are %s' % (name, ', '.join(methods())), errno.ENOENT)
    return method


class Description:
    """The description of a shape by a method. All arrays are read-only views.

    whole (any,) float32: the description of the shape as a whole; parts: the same, cut into its
    parts
    local (bags, n, values) float32: of methods with bags, values of each vertex; else (0, 0, 0)
    weight (n,) float32: of methods with bags, the share of the area; else empty
    """

    def __init__(self, owner, method):
        """For the module itself; describe() makes descriptions."""
        self._owner = owner
        self.method = method
        d = owner.pointer.contents
        sizes = list(d.part_size[:d.n_parts])
        local = (d.n_bags, d.n_points, d.n_values) if d.n_bags else (0, 0, 0)
        self.whole = view(owner, d.whole, (sum(sizes), ), np.float32)
        self.parts = np.split(self.whole, np.cumsum(sizes)[:-1]) if sizes else []
        self.local = view(owner, d.local, local, np.float32)
        self.weight = view(owner, d.weight, (d.n_points if d.n_bags else 0, ), np.float32)

    def __repr__(self):
        return '<isotherm.Description by %s: %d values, %d bags>' % (self.method, len(self.whole), len(self.local))


def describe(shape, method):
    """Describes a shape by the name of a method, such as 'cp-hk'. Raises Error for an unknown name,
    and for a method with colours if the shape was made without them."""
    found = _find(method)
    if len(shape.eigenvalues) < 2:
        raise Error('describe: the shape has only the trivial eigenpair')
    pointer = POINTER(structs.ShapeDescription)()
    check(lib.iso_shape_describe(found, shape._pointer, byref(pointer)), str(method),
          {errno.ENODATA: 'the method needs a shape with colours'})
    return Description(Owner(pointer, lib.iso_shape_description_free), str(method))


class Coder:
    """Turns descriptions of one method into features of one size, with what it has learned of a
    corpus: principal components, or words of vocabularies. It needs no labels.

    size: values of a feature; part_sizes: values of each of its parts.
    """

    def __init__(self, descriptions, size=0, seed=1):
        """Learns from descriptions of one method. size: principal components, or words of each
        vocabulary; 0: the method's default. seed: starts the vocabularies."""
        descriptions = list(descriptions)
        if not descriptions:
            raise Error('descriptions: there are none')
        self.method = descriptions[0].method
        for d in descriptions:
            self._accept(d)
        size = number_in(size, 0, 2**31 - 1, 'size')
        seed = number_in(seed, 0, 2**64 - 1, 'seed')
        pointers = (POINTER(structs.ShapeDescription) * len(descriptions))(*[d._owner.pointer for d in descriptions])
        coder = c_void_p()
        check(lib.iso_shape_coder_new(_find(self.method), pointers, len(descriptions), size, seed, byref(coder)),
              'descriptions', {errno.EINVAL: 'they are of different sizes',
                               errno.EDOM: 'principal components cannot be found'})
        self._owner = Owner(coder, lib.iso_shape_coder_free)
        self._layout = lib.iso_shape_coder_layout(coder).contents
        self.size = self._layout.size
        self.part_sizes = tuple(self._layout.part_size[:self._layout.n_parts])

    def _accept(self, description):
        if description.method != self.method:
            raise Error('descriptions: by the methods %s and %s' % (self.method, description.method))

    def code(self, description):
        """The feature of one description: (size,) float32."""
        self._accept(description)
        out = np.empty(self.size, np.float32)
        check(lib.iso_shape_code(self._owner.pointer, description._owner.pointer, address(out)), 'description',
              {errno.EINVAL: 'of other sizes than those that the coder has learned from'})
        return out

    def __repr__(self):
        return '<isotherm.Coder of %s: %d values>' % (self.method, self.size)

"""Classifiers of features."""
import errno
from ctypes import POINTER, c_void_p

import numpy as np

from ._describe import NORMS
from ._library import Error, Owner, address, array_in, byref, check, lib, number_in, structs

_FAULTS = {
    errno.EINVAL: 'there is too little to learn from',
    errno.EDOM: 'its system of equations is singular',
    errno.ENOSYS: 'it cannot rank',
}
_COMPARE_FAULTS = {**_FAULTS, errno.EINVAL: 'the norm partial is only for features of local-heat'}


def _table():
    """The library's classifiers by their names."""
    table = (POINTER(structs.ClassifierOps) * 1000).in_dll(lib, 'iso_classifiers')
    found = {}
    for pointer in table:
        if not pointer:  # the end of the table
            break
        found[pointer.contents.name.decode()] = pointer
    return found


def classifiers():
    """The names of the classifiers: nn-l1, nn-l2, crc-rls, rcr, naive-bayes, nn."""
    return tuple(_table())


class Classifier:
    """A classifier that has learned from labelled features (isotherm/classifier.h)."""

    def __init__(self, name, features, labels, part_sizes=None, norm='l1'):
        """name: one of classifiers(). features: (n, size) float32. labels: (n,) int32, from 0.
        part_sizes: as Coder.part_sizes, what `rcr` codes apart; None: one part.
        norm: what `nn` compares by, the norm of the method: 'l1', 'l2' or 'partial'."""
        ops = _table().get(name)
        if ops is None:
            raise Error('classifier: %r is unknown; there are %s' % (name, ', '.join(classifiers())), errno.ENOENT)
        features = array_in(features, np.float32, (None, None), 'features')
        self.n, self.size = features.shape
        labels = array_in(labels, np.int32, (self.n, ), 'labels')
        if self.n < 1 or self.size < 1:
            raise Error('features: there are none')
        if labels.min() < 0 or labels.max() < 1:
            raise Error('labels: they count from 0, and two classes are needed')
        self.n_classes = int(labels.max()) + 1
        self.name = name
        if norm not in NORMS:
            raise Error('norm: %r is unknown; there are %s' % (norm, ', '.join(NORMS)))
        layout = _layout(part_sizes or (self.size, ), self.size)
        layout.norm = NORMS.index(norm)
        training = structs.Labelled(POINTER(structs.FeatureLayout)(layout), self.n, self.n_classes, address(features),
                                    address(labels))
        model = c_void_p()
        check(lib.iso_classifier_new(ops, byref(training), byref(model)), name, _FAULTS)
        self._owner = Owner(model, lib.iso_classifier_free, (layout, features, labels))

    def score(self, feature):
        """How likely a feature, (size,) float32, is of each class: (n_classes,) float64, higher is
        more likely; -inf for a class that nothing was learned of."""
        feature = array_in(feature, np.float32, (self.size, ), 'feature')
        out = np.empty(self.n_classes, np.float64)
        check(lib.iso_classifier_score(self._owner.pointer, address(feature), address(out)), self.name,
              _COMPARE_FAULTS)
        return out

    def rank(self, feature, left=-1):
        """How far a feature, (size,) float32, is from each that was learned from: (n,) float64. left:
        the number of one that is left out, as if it had never been learned from, whose distance is
        0; -1: none."""
        feature = array_in(feature, np.float32, (self.size, ), 'feature')
        left = number_in(left, -1, self.n - 1, 'left')
        out = np.empty(self.n, np.float64)
        check(lib.iso_classifier_rank(self._owner.pointer, address(feature), left, address(out)), self.name,
              _COMPARE_FAULTS)
        return out


def _layout(part_sizes, size):
    sizes = [number_in(part, 1, 2**31 - 1, 'part_sizes') for part in part_sizes]
    if sum(sizes) != size or len(sizes) > structs.PARTS_MAX:
        raise Error('part_sizes: at most %d, whose sum is %d, are needed' % (structs.PARTS_MAX, size))
    layout = structs.FeatureLayout(size, len(sizes))
    layout.part_size[:len(sizes)] = sizes
    return layout

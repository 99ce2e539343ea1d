"""Templates of faces, and the metric that compares them."""
import ctypes
import errno
from ctypes import POINTER

import numpy as np

from ._library import Error, Owner, byref, check, lib, parse_file, structs

METRIC = '/usr/share/isotherm/face.metric'  # of the package isotherm-data
_BYTES_MOST = 64 + 4 * 12 * 32 * 7 + (49 * 37 + 3) // 4 + 2 * 49 * 37  # ISO_TEMPLATE_BYTES_MAX
_FAULTS = {
    errno.EINVAL: 'it was made by another algorithm',
    errno.ENODATA: 'too few of its points were measured',
    errno.EBADMSG: 'truncated or damaged',
    errno.EPROTONOSUPPORT: 'of another version',
}


class Template:
    """The isotherms and the upper face of a person, in the face frame: x to the subject's left, y
    up, z out of the face, millimetres; the tip of the mean nose is the origin.

    Biometric data: keep it as such.

    algorithm: int; templates of different algorithms cannot be compared. quality: the share of
    measured points, 0..1. radii (r,) float32: of the isotherms, mm. All arrays are copies.
    """

    def __init__(self, data):
        """Reads a template from the bytes that bytes(template) gives. Raises Error."""
        data = bytes(data)
        self._struct = structs.Template()
        check(lib.iso_template_parse(data, len(data), byref(self._struct)), 'template', _FAULTS)

    @classmethod
    def _of_struct(cls, struct):
        template = cls.__new__(cls)
        template._struct = structs.Template.from_buffer_copy(struct)
        return template

    def __bytes__(self):
        """The serialised template, some 8 kB. Coordinates are rounded to 1/64 mm."""
        room = ctypes.create_string_buffer(_BYTES_MOST)
        size = lib.iso_template_serialise(byref(self._struct), room, len(room))
        check(min(size, 0), 'template')
        return room.raw[:size]

    def __copy__(self):
        return Template._of_struct(self._struct)  # the memory of each template is wiped at its end

    def __del__(self):
        if hasattr(self, '_struct'):
            lib.iso_template_wipe(byref(self._struct))

    algorithm = property(lambda self: self._struct.algorithm)
    sensor = property(lambda self: self._struct.sensor.decode())
    quality = property(lambda self: self._struct.quality)

    @property
    def radii(self):
        return np.array(self._struct.radius_mm[:self._struct.n_radii], np.float32)

    @property
    def points(self):
        """(radii, 12, points, 3) float32: the points of the isotherms, by radius and landmark
        (isotherm.LANDMARKS), millimetres."""
        return self._part(self._struct.points_mm)

    @property
    def weights(self):
        """(radii, 12, points) float32, 0..1: 0 where the isotherm is open or the surface was filled
        in."""
        return self._part(self._struct.weight)

    def _part(self, member):
        return np.ctypeslib.as_array(member)[:self._struct.n_radii, :, :self._struct.n_points].copy()

    @property
    def upper(self):
        """(37, 49) float32: the heights of the upper face over a grid of 3 mm, from y = 87 mm down;
        NaN where there is no surface."""
        upper = self._struct.upper
        heights = np.ctypeslib.as_array(upper.z_mm).copy()
        heights[np.ctypeslib.as_array(upper.kind) == 0] = np.nan
        return heights

    def __repr__(self):
        return '<isotherm.Template: %d x 12 isotherms, quality %.2f>' % (self._struct.n_radii, self.quality)


class Metric:
    """How likely two templates are of one person (isotherm/metric.h: a two-covariance model).

    A score s is calibrated so that strangers reach it with probability 10^-s at most, on rendered
    people. dimensions: numbers of a vector. algorithm: of the templates that it compares.
    """

    def __init__(self, path=METRIC):
        """Reads a metric. Raises OSError and Error."""
        pointer = POINTER(structs.Metric)()
        parse_file(path, lib.iso_metric_parse, pointer)
        self._owner = Owner(pointer, lib.iso_metric_free)
        self.dimensions, self.algorithm = pointer.contents.n_dimensions, pointer.contents.algorithm

    def vector(self, *templates):
        """(dimensions,) float64: the templates of one person as the metric sees them, their mean.
        Within a person the numbers are independent and have about the variance 1."""
        return np.array(self._vector(list(templates)).mean[:self.dimensions], np.float64)

    def score(self, person, probe):
        """How much more likely a probe is of a person than of anybody: a number, larger for the same
        person. person: a Template, or a list of templates of one person; probe: a Template."""
        person = [person] if isinstance(person, Template) else person
        vectors = self._vector(person), self._vector([probe])
        return lib.iso_metric_score(self._owner.pointer, byref(vectors[0]), byref(vectors[1]))

    def _vector(self, templates):
        if not templates:
            raise Error('templates: there are none')
        whole = structs.MetricVector()
        for template in templates:
            one = structs.MetricVector()
            check(lib.iso_metric_project(self._owner.pointer, byref(template._struct), byref(one)), 'template', _FAULTS)
            lib.iso_metric_vector_add(self._owner.pointer, byref(one), byref(whole))
        return whole

    def __repr__(self):
        return '<isotherm.Metric: %d dimensions>' % self.dimensions

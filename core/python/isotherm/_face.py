"""From a depth frame to a face: landmarks, heat, isotherms."""
import errno
from ctypes import POINTER, c_double, c_int32, c_void_p

import numpy as np

from ._frame import Frame
from ._library import Error, Owner, byref, check, lib, parse_file, structs
from ._mesh import Mesh
from ._template import Template

MODEL = '/usr/share/isotherm/head.model'  # of the package isotherm-data
_HEAT = ('grid', 'direct', 'spectral')  # enum iso_heat_method
_OK = 1  # ISO_CAPTURE_OK


def _landmarks():
    names = []
    while (name := lib.iso_landmark_name(len(names))) is not None:
        names.append(name.decode())
    return tuple(names)


LANDMARKS = _landmarks()


class Face:
    """What was found in one frame. Coordinates are in the frame of the camera, millimetres.

    outcome: 'ok', or why there is no template, such as 'too-far' or 'covered-eyes'. is_attack: the
    outcome is a cue of a presentation attack (ISO/IEC 30107-1). yaw, pitch, roll: radians. distance:
    of the nose tip along the optical axis. fitted: whether the head model was fitted; if not, the
    next four are None.
    landmarks (12, 3) float64: in the order of isotherm.LANDMARKS. sigma (12,) float64: their standard
    deviations. ibug (68, 3) float64: the points of the scheme iBUG 300-W. residual: of the fit, root
    mean square.
    template: Template; mesh: Mesh of the face patch, in the face frame; heat (n, 12) float64: the
    heat of each landmark on its vertices, 1/mm^2. None unless the outcome is 'ok'.
    """

    def __init__(self, found, extractor=None):
        """For the module itself; Extractor makes faces."""
        self.outcome = lib.iso_capture_name(found.outcome).decode()
        self.is_attack = lib.iso_capture_is_attack(found.outcome)
        self.yaw, self.pitch, self.roll = found.yaw_rad, found.pitch_rad, found.roll_rad
        self.distance, self.fitted = found.distance_mm, found.fitted
        self.landmarks = self.sigma = self.ibug = self.residual = None
        self.template = self.mesh = self.heat = None
        if self.fitted:
            self.landmarks, self.ibug = _points(found.landmark_mm), _points(found.ibug_mm)
            self.sigma, self.residual = np.array(found.sigma_mm), found.residual_mm
        if found.outcome == _OK and extractor is not None:
            self.template = Template._of_struct(found.tmpl)
            self.mesh = _mesh(lib.iso_extractor_mesh(extractor).contents)
            self.heat = np.column_stack([_copy(lib.iso_extractor_heat(extractor, landmark), len(self.mesh.vertices))
                                         for landmark in range(len(LANDMARKS))])

    def __repr__(self):
        return '<isotherm.Face: %s, %.0f mm away>' % (self.outcome, self.distance)


class Extractor:
    """Makes templates of depth frames: all steps from the frame to the isotherms (isotherm/extract.h;
    Abdelrahman 2013, chapter 6). One thread at a time."""

    def __init__(self, model=MODEL, heat='grid', track=False, sensor='', time=None, radii=None, points=None):
        """model: the file of the head model. heat: how the heat equation is solved: 'grid' as in the
        appliance, 'direct', or 'spectral' by 100 eigenpairs as in the dissertation. track: start from
        the face of the frame before. sensor: a word that is written into templates. time: of the
        heat, mm^2; radii: of the isotherms, mm; points: of an isotherm. Other values than the default
        ones give templates that the trained metric refuses.
        Raises OSError for a model that cannot be read, and Error."""
        pointer = POINTER(structs.HeadModel)()
        parse_file(model, lib.iso_head_model_parse, pointer)
        head = Owner(pointer, lib.iso_head_model_free)
        options = lib.iso_extract_options_default()
        if heat not in _HEAT:
            raise Error('heat: %r is none of %s' % (heat, ', '.join(_HEAT)))
        options.heat, options.track = _HEAT.index(heat), track
        if len(sensor.encode()) > 15:
            raise Error('sensor: %r has more than 15 bytes' % sensor)
        options.sensor = sensor.encode()
        options.t_mm2 = options.t_mm2 if time is None else time
        options.n_points = options.n_points if points is None else points
        if radii is not None:
            if not 1 <= len(radii) <= len(options.radius_mm):
                raise Error('radii: %d of them, 1..%d are possible' % (len(radii), len(options.radius_mm)))
            options.n_radii = len(radii)
            options.radius_mm[:len(radii)] = list(radii)
        extractor = c_void_p()
        check(lib.iso_extractor_new(pointer, byref(options), byref(extractor)), 'extractor',
              {errno.EINVAL: 'time, radii or points are out of range'})
        self._owner = Owner(extractor, lib.iso_extractor_free, head)

    @property
    def algorithm(self):
        """int: identifies all that shapes a template; templates carry it."""
        return lib.iso_extractor_algorithm(self._owner.pointer)

    def extract(self, frame):
        """The Face of a Frame, with its template if the frame is usable."""
        return self._find(lib.iso_extractor_run, frame, self._owner.pointer)

    def locate(self, frame):
        """The Face of a Frame without template and heat: where the landmarks are, and whether the
        frame is usable."""
        return self._find(lib.iso_extractor_locate, frame, None)

    def _find(self, function, frame, extractor):
        if not isinstance(frame, Frame):
            raise Error('frame: of the type %s, not isotherm.Frame' % type(frame).__name__)
        found = structs.Extraction()
        try:
            check(function(self._owner.pointer, frame._check(), byref(found)), 'frame',
                  {errno.EINVAL: 'larger than 1920 x 1200', errno.EDOM: 'the heat equation has no solution'})
            return Face(found, extractor)
        finally:
            lib.iso_template_wipe(byref(found.tmpl))

    def forget(self):
        """Ends the tracking of a face: the next frame is searched as a whole."""
        lib.iso_extractor_forget(self._owner.pointer)


def _points(array):
    return np.array([(point.x, point.y, point.z) for point in array])


def _copy(pointer, n):
    return np.ctypeslib.as_array((c_double * n).from_address(pointer)).copy()


def _mesh(struct):
    """A copy, because the next run of the extractor changes its mesh."""
    vertices = _copy(struct.vertices_mm, 3 * struct.n_vertices).reshape(-1, 3)
    triangles = np.ctypeslib.as_array((c_int32 * (3 * struct.n_triangles)).from_address(struct.triangles))
    return Mesh(vertices, triangles.reshape(-1, 3).copy())

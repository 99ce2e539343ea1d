"""Cameras and depth frames."""
import dataclasses

import numpy as np

from ._library import Error, address, array_in, byref, check, lib, structs

_PROJECTIONS = ('none', 'pinhole', 'orthographic')  # enum iso_projection


@dataclasses.dataclass(frozen=True)
class Camera:
    """The intrinsic parameters of a camera, in pixels (isotherm/camera.h).

    A pinhole camera has focal lengths fx and fy, the principal point (cx, cy), and the distortion of
    Brown (1971). An orthographic one has a pitch, the millimetres that a pixel spans.
    """

    width: int
    height: int
    cx: float
    cy: float
    fx: float = 0.0
    fy: float = 0.0
    pitch: float = 0.0
    projection: str = 'pinhole'
    k1: float = 0.0
    k2: float = 0.0
    k3: float = 0.0
    p1: float = 0.0
    p2: float = 0.0

    def _struct(self):
        if self.projection not in _PROJECTIONS[1:]:
            raise Error('camera: the projection %r is neither pinhole nor orthographic' % (self.projection, ))
        try:
            return structs.Camera(_PROJECTIONS.index(self.projection), self.width, self.height, self.fx, self.fy,
                                  self.pitch, self.cx, self.cy, self.k1, self.k2, self.k3, self.p1, self.p2)
        except TypeError as error:
            raise Error('camera: %s' % error) from None


class Frame:
    """A depth frame: what one camera measured at one time.

    depth: (rows, columns) float32, millimetres along the optical axis, 0 where nothing was measured.
    intensity: the same shape, 0..1, or None. camera: Camera. time: nanoseconds of a monotonic clock.
    sequence: the number of the frame. The arrays are shared with the caller if they have the right
    type already. A frame keeps its arrays and its camera; make another one for others.
    """

    def __init__(self, depth, camera, intensity=None, time=0, sequence=0):
        """Raises Error for depths that are negative or not finite, a camera that cannot exist, and a
        camera or an intensity of another size."""
        self._depth = array_in(depth, np.float32, (None, None), 'depth')
        self._intensity = None
        if intensity is not None:
            self._intensity = array_in(intensity, np.float32, self._depth.shape, 'intensity')
        self._camera = camera
        rows, columns = self._depth.shape
        self._struct = structs.Frame(camera._struct(), columns, rows, 0, 0, int(time), int(sequence),
                                     address(self._depth),
                                     None if self._intensity is None else address(self._intensity))
        self._check()

    depth = property(lambda self: self._depth)
    intensity = property(lambda self: self._intensity)
    camera = property(lambda self: self._camera)
    time = property(lambda self: self._struct.t_ns)
    sequence = property(lambda self: self._struct.sequence)

    def _check(self):
        """The frame as the library takes it. Arrays of the caller may have changed since."""
        fault = structs.Fault()
        check(lib.iso_frame_check(byref(self._struct), byref(fault)), 'depth', fault=fault)
        return byref(self._struct)

    def __repr__(self):
        rows, columns = self.depth.shape
        return '<isotherm.Frame: %d x %d, %.0f %% measured>' % (columns, rows, 100 * (self.depth > 0).mean())

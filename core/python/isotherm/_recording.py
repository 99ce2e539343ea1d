"""Recordings of depth cameras, format 1."""
import configparser
import csv
import errno
import os
import re

import numpy as np

from ._frame import Camera, Frame
from ._library import Error

_SIZES = ('width_px', 'height_px')
_ALWAYS = _SIZES + ('cx_px', 'cy_px', 'unit_mm')
_BY_PROJECTION = {'pinhole': ('fx_px', 'fy_px'), 'orthographic': ('pitch_mm', )}
_OPTIONAL = ('k1', 'k2', 'k3', 'p1', 'p2')


class Recording:
    """A directory with the depth frames of one camera; a sequence of Frame.

    camera: Camera. sensor: the name of the kind of camera. unit: millimetres per count. nominal:
    whether the intrinsics are the manufacturer's, not measured on this camera. times: (n,) int64,
    nanoseconds, rising. Frames are read when they are asked for: recording[i].

    Infrared and colour pictures of a recording are not read; the method does not use them.
    """

    def __init__(self, directory):
        """Reads recording.ini and depth.txt. Raises OSError for a file that cannot be read, and
        Error, with its name, for contents that are not understood."""
        self.directory = os.fsdecode(directory)
        self._read_description(os.path.join(self.directory, 'recording.ini'))
        self._read_list(os.path.join(self.directory, 'depth.txt'))

    def _read_description(self, path):
        parser = configparser.ConfigParser(strict=True, interpolation=None, empty_lines_in_values=False)
        with open(path, encoding='utf-8') as file:
            try:
                parser.read_file(file)
            except (configparser.Error, UnicodeDecodeError) as error:
                raise _bad(path, str(error).replace('\n', ' ')) from None
        if sorted(parser.sections()) != ['depth', 'recording']:
            raise _bad(path, 'its sections are not [recording] and [depth]')
        recording, depth = dict(parser['recording']), dict(parser['depth'])
        if sorted(recording) != ['format', 'sensor'] or recording['format'] != '1':
            raise _bad(path, '[recording] is not format = 1 and a sensor')
        self.sensor = recording['sensor']
        projection = depth.pop('projection', None)
        if projection not in _BY_PROJECTION:
            raise _bad(path, 'projection is neither pinhole nor orthographic')
        nominal = depth.pop('nominal', 'no') if projection == 'pinhole' else 'no'
        if nominal not in ('yes', 'no'):
            raise _bad(path, 'nominal is neither yes nor no')
        self.nominal = nominal == 'yes'
        numbers = _numbers(path, projection, depth)
        self.unit = numbers.pop('unit_mm')
        if not 0.001 <= self.unit <= 100:
            raise _bad(path, 'unit_mm must be 0.001..100')
        self.camera = Camera(projection=projection,
                             **{key.removesuffix('_px').removesuffix('_mm'): n for key, n in numbers.items()})

    def _read_list(self, path):
        times, self._names = [], []
        with open(path, encoding='utf-8', errors='surrogateescape') as file:
            for number, line in enumerate(file, 1):
                if line.startswith('#') or not line.strip('\r\n'):
                    continue
                words = line.split()
                if len(words) != 2 or words[1].startswith('/') or '..' in words[1].split('/'):
                    raise _bad('%s:%d' % (path, number), 'not a time and the name of a file in the recording')
                times.append(_nanoseconds('%s:%d' % (path, number), words[0]))
                self._names.append(words[1])
        self.times = np.array(times, np.int64)
        if not times or (np.diff(self.times) <= 0).any():
            raise _bad(path, 'there is no frame, or the times do not rise')

    def __len__(self):
        return len(self._names)

    def __getitem__(self, index):
        """Reads one frame. Needs Pillow (Debian: python3-pil). A failure concerns this frame alone."""
        index = range(len(self))[index]
        return Frame(self._depth(os.path.join(self.directory, self._names[index])), self.camera,
                     time=self.times[index], sequence=index)

    def _depth(self, path):
        from PIL import Image, UnidentifiedImageError
        with open(path, 'rb') as file:
            try:
                with Image.open(file, formats=('PNG', )) as image:
                    mode, counts = image.mode, np.asarray(image)
            except (UnidentifiedImageError, Image.DecompressionBombError, OSError, SyntaxError, ValueError) as error:
                raise _bad(path, 'truncated or damaged: %s' % str(error).replace('\n', ' ')) from None
        if mode not in ('I', 'I;16', 'I;16B'):
            raise _bad(path, 'not a grey picture of 16 bits')
        if counts.shape != (self.camera.height, self.camera.width):
            raise _bad(path, 'its size is %d x %d, not %d x %d' %
                       (*counts.shape[::-1], self.camera.width, self.camera.height))
        return (counts * self.unit).astype(np.float32)

    def landmarks(self):
        """The ground truth of landmarks.csv: for each frame that has any, by its index, a dict of
        points, (3,) float64, in the frame of the camera, millimetres. Empty without that file."""
        path, found = os.path.join(self.directory, 'landmarks.csv'), {}
        if not os.path.exists(path):
            return found
        with open(path, encoding='utf-8', errors='surrogateescape', newline='') as file:
            rows = csv.reader(file)
            try:
                if next(rows, None) != ['frame', 'name', 'x_mm', 'y_mm', 'z_mm']:
                    raise _bad(path, 'its header is not frame,name,x_mm,y_mm,z_mm')
                for row in rows:
                    self._add_landmark('%s:%d' % (path, rows.line_num), row, found)
            except csv.Error as error:
                raise _bad('%s:%d' % (path, rows.line_num), str(error)) from None
        return found

    def _add_landmark(self, where, row, found):
        try:
            frame, name, point = int(row[0]), row[1], np.array(row[2:], float)
        except (ValueError, IndexError):
            frame, name, point = -1, '', np.empty(0)
        points = found.setdefault(frame, {})
        if not 0 <= frame < len(self) or point.shape != (3, ) or name in points:
            raise _bad(where, 'not one landmark of a frame')
        points[name] = point

    def __repr__(self):
        return '<isotherm.Recording: %s, %d frames of %s>' % (self.directory, len(self), self.sensor)


def _bad(what, text):
    return Error('%s: %s' % (what, text), errno.EBADMSG)


def _numbers(path, projection, depth):
    """The numbers of the section [depth], every one that is needed and none that is unknown."""
    needed = _ALWAYS + _BY_PROJECTION[projection]
    known = needed + (_OPTIONAL if projection == 'pinhole' else ())
    for key in needed:
        if key not in depth:
            raise _bad(path, '%s is missing from [depth]' % key)
    numbers = {}
    for key, text in depth.items():
        if key not in known:
            raise _bad(path, '%s is unknown or does not belong to this projection' % key)
        try:
            numbers[key] = int(text) if key in _SIZES else float(text)
        except ValueError:
            raise _bad(path, '%s = %s is not a number' % (key, text)) from None
    return numbers


def _nanoseconds(where, text):
    """Seconds as text, to the nanosecond; a float would round them. More digits are dropped."""
    match = re.fullmatch('([0-9]{1,10})(?:[.]([0-9]*))?', text)
    if not match or int(match[1]) >= 2**63 // 10**9:
        raise _bad(where, '%s is not a time in seconds' % text)
    return int(match[1]) * 10**9 + int((match[2] or '')[:9].ljust(9, '0'))

"""Recordings, faces and templates, against what isotherm-sim writes of the same frames."""
import copy
import csv
import gc
import os
import pathlib
import shutil
import tempfile

import numpy as np

import isotherm
from support import WORK, TestCase

CORPUS = os.path.join(WORK, 'corpus')
DATA = os.environ['ISOTHERM_PYTHON_DATA']
MODEL, METRIC = os.path.join(DATA, 'head.model'), os.path.join(DATA, 'face.metric')


def rows(*path):
    with open(os.path.join(WORK, *path), newline='') as file:
        return list(csv.DictReader(file))


class Recordings(TestCase):
    def test_frames(self):
        recording = isotherm.Recording(os.path.join(CORPUS, 'p01-enrol'))
        self.assertEqual((len(recording), recording.sensor, recording.unit), (5, 'astra', 1.0))
        self.assertEqual(recording.times[:3].tolist(), [0, 33333333, 66666666])
        frame = recording[-1]
        self.assertEqual((frame.depth.dtype, frame.depth.shape, frame.sequence), (np.float32, (480, 640), 4))
        self.assertEqual(frame.time, recording.times[4])
        seen = frame.depth[frame.depth > 0]
        self.assertTrue((seen == np.round(seen)).all() and 400 < np.median(seen) < 4000)
        self.assertEqual(len([frame for frame in recording]), 5)
        with self.assertRaises(IndexError):
            recording[5]
        self.assertTrue(0.95 < len(isotherm.Mesh.from_frame(frame).vertices) / len(seen) < 1)  # some pixels stand alone

    def changed(self, name, old, new):
        """A copy of a recording in which a text was replaced."""
        work = tempfile.TemporaryDirectory()
        self.addCleanup(work.cleanup)
        copy = os.path.join(work.name, 'copy')
        shutil.copytree(os.path.join(CORPUS, 'p01-v1'), copy)
        path = pathlib.Path(copy, name)
        text = path.read_bytes()
        self.assertIn(old, text)
        path.write_bytes(text.replace(old, new, 1))
        return copy

    def test_bad_descriptions_are_refused(self):
        for old, new, words in (
            (b'format = 1', b'format = 2', '[recording] is not format = 1'),
            (b'unit_mm = 1', b'', 'unit_mm is missing'),
            (b'unit_mm = 1', b'unit_mm = 1000', 'unit_mm must be'),
            (b'fx_px = ', b'fx_px = x', 'is not a number'),
            (b'cx_px', b'pitch_mm = 2\ncx_px', 'pitch_mm is unknown or does not belong'),
            (b'cx_px', b'fx_px = 3\ncx_px', 'fx_px'),
            (b'pinhole', b'fisheye', 'neither pinhole nor orthographic'),
            (b'[depth]', b'[color]', 'its sections'),
        ):
            error = self.refuses(words, isotherm.Recording, self.changed('recording.ini', old, new))
            self.assertIn('recording.ini', str(error))

    def test_bad_lists_are_refused(self):
        first = b'0.000000000 depth/000000.png'
        for new in (b'-1 depth/000000.png', b'9 depth/000000.png', b'0 /etc/passwd', b'0 depth/../../x.png', b'0',
                    b'0 a b', b'nan depth/000000.png', b'\xff depth/000000.png', b'9999999999 depth/000000.png'):
            self.refuses('depth.txt', isotherm.Recording, self.changed('depth.txt', first, new))
        later = isotherm.Recording(self.changed('depth.txt', b'0.066666666 ', b'1234567890.0000000019 '))
        self.assertEqual(later.times[2], 1234567890 * 10**9 + 1)  # a float would round it

    def test_a_bad_frame_concerns_itself_alone(self):
        recording = isotherm.Recording(self.changed('depth/000001.png', b'IDAT', b'IDOT'))
        self.refuses('000001.png', recording.__getitem__, 1)
        self.assertEqual(recording[0].depth.shape, (480, 640))
        name = os.path.join(recording.directory, 'depth/000002.png')
        os.remove(name)
        with self.assertRaises(FileNotFoundError):
            recording[2]
        os.mkdir(name)
        with self.assertRaises(IsADirectoryError):
            recording[2]

    def test_truth(self):
        truth = isotherm.Recording(os.path.join(CORPUS, 'p01-enrol')).landmarks()
        self.assertEqual(set(truth[0]), set(isotherm.LANDMARKS))
        for new in (b'0,nasion,1,2', b'7,nasion,1,2,3', b'0,nasion,1,2,x', b'x', b'\xff', b'x' * 200000):
            bad = self.changed('landmarks.csv', b'0,nasion', new + b'\n0,nasion')
            self.refuses('landmarks.csv:2', isotherm.Recording(bad).landmarks)


class Faces(TestCase):
    @classmethod
    def setUpClass(cls):
        cls.extractor, cls.metric = isotherm.Extractor(MODEL), isotherm.Metric(METRIC)

    def face(self, name, frame=0):
        return self.extractor.extract(isotherm.Recording(os.path.join(CORPUS, name))[frame])

    def test_scores_are_those_of_the_evaluation(self):
        compared = rows('scores', 'scores.csv')
        self.assertEqual(len(compared), 4)
        for row in compared:
            person = self.face(row['gallery_subject'] + '-enrol').template
            probe = self.face(row['probe_recording']).template
            self.assertAlmostEqual(self.metric.score(person, probe), float(row['score']), delta=1e-5)

    def test_landmarks_are_those_of_the_evaluation(self):
        found, faces = rows('faces', 'landmarks.csv'), {}
        self.assertEqual(len(found), 12 * len(rows('faces', 'frames.csv')))
        for row in found:
            key = row['recording'], int(row['frame'])
            if key not in faces:
                faces[key] = self.face(*key)
            point = faces[key].landmarks[isotherm.LANDMARKS.index(row['name'])]
            np.testing.assert_allclose(point, [float(row[axis + '_mm']) for axis in 'xyz'], atol=6e-4)
        for row in rows('faces', 'frames.csv'):
            face = faces[row['recording'], int(row['frame'])]
            self.assertEqual((face.outcome, face.is_attack), (row['outcome'], False))
            self.assertAlmostEqual(np.degrees(face.yaw), float(row['yaw_deg']), delta=6e-4)

    def test_heat_and_isotherms(self):
        """Each isotherm lies on the surface near its landmark, and heat decays with the distance."""
        face, tip = self.face('p01-enrol'), isotherm.LANDMARKS.index('nose_tip')
        heat, vertices = face.heat[:, tip], face.mesh.vertices
        self.assertEqual(heat.shape, (len(vertices), ))
        distance = np.linalg.norm(vertices - vertices[heat.argmax()], axis=1)
        means = [heat[(distance >= a) & (distance < a + 8)].mean() for a in (0, 8, 16, 24, 32)]
        self.assertTrue((np.diff(means) < 0).all(), means)
        points, weights = face.template.points, face.template.weights
        self.assertEqual(points.shape, weights.shape + (3, ))
        for radius, ring, weight in zip(face.template.radii, points[:, tip], weights[:, tip]):
            away = np.linalg.norm(ring[weight > 0] - vertices[heat.argmax()], axis=1)
            self.assertTrue((away < 1.3 * radius).all() and (away > 0.5 * radius).all(), (radius, away))

    def test_templates_survive_their_bytes(self):
        template = self.face('p01-enrol').template
        again = isotherm.Template(bytes(template))
        self.assertEqual(bytes(again), bytes(template))
        self.assertLessEqual(np.abs(again.points - template.points).max(), 1 / 128 + 1e-6)
        self.assertEqual((again.algorithm, again.algorithm), (self.extractor.algorithm, self.metric.algorithm))
        self.assertTrue((np.isnan(again.upper) == np.isnan(template.upper)).all())
        data = bytearray(bytes(template))
        data[100] ^= 1
        self.refuses('template: truncated or damaged', isotherm.Template, data)
        self.refuses('template:', isotherm.Template, b'')
        self.refuses('template:', isotherm.Template, np.zeros((1000, 0), np.uint8))

    def test_a_template_outlives_its_face(self):
        template = self.face('p01-enrol').template
        points, again = template.points, copy.copy(template)
        del template
        gc.collect()
        self.same(again.points, points)
        self.assertGreater(np.abs(points).max(), 10)
        self.same(self.face('p01-enrol').template.points, points)

    def test_a_person_of_several_templates(self):
        person = [self.face('p01-enrol', i).template for i in range(3)]
        probe, other = self.face('p01-v1').template, self.face('p02-v1').template
        self.assertGreater(self.metric.score(person, probe), 3)
        self.assertLess(self.metric.score(person, other), 0)
        mean = np.mean([self.metric.vector(template) for template in person], axis=0)
        self.assertLess(np.abs(self.metric.vector(*person) - mean).max(), np.abs(mean).max() / 2)

    def test_frames_without_a_usable_face(self):
        camera = isotherm.Camera(640, 480, 319.5, 239.5, 570, 570)
        nobody = self.extractor.extract(isotherm.Frame(np.zeros((480, 640), np.float32), camera))
        self.assertNotEqual(nobody.outcome, 'ok')
        self.assertEqual((nobody.template, nobody.landmarks, nobody.fitted), (None, None, False))
        located = self.extractor.locate(isotherm.Recording(os.path.join(CORPUS, 'p01-v1'))[0])
        self.assertEqual((located.outcome, located.template), ('ok', None))

    def test_refusals(self):
        camera, depth = isotherm.Camera(4, 3, 1.5, 1, 100, 100), np.ones((3, 4), np.float32)
        self.refuses('depth:', isotherm.Frame, -depth, camera)
        self.refuses('depth:', isotherm.Frame, np.ones((4, 4)), camera)
        self.refuses('intensity: its shape', isotherm.Frame, depth, camera, intensity=np.ones((2, 2)))
        self.refuses('projection', isotherm.Frame, depth, isotherm.Camera(4, 3, 1.5, 1, projection='fisheye'))
        frame = isotherm.Frame(depth, camera)
        with self.assertRaises(AttributeError):
            frame.depth = depth
        for thing in (isotherm.Mesh.from_frame(frame), depth, None):
            self.refuses('not isotherm.Frame', self.extractor.extract, thing)
            self.refuses('not isotherm.Frame', isotherm.Mesh.from_frame, thing)
        self.refuses('heat:', isotherm.Extractor, MODEL, heat='fast')
        self.refuses('radii: 5 of them', isotherm.Extractor, MODEL, radii=[1, 2, 3, 4, 5])
        self.refuses('out of range', isotherm.Extractor, MODEL, points=1000)
        self.refuses('face.metric:', isotherm.Extractor, METRIC)
        self.refuses('templates: there are none', self.metric.score, [], None)
        other = isotherm.Extractor(MODEL, radii=[15]).extract(isotherm.Recording(os.path.join(CORPUS, 'p01-v1'))[0])
        self.refuses('another algorithm', self.metric.vector, other.template)
        with self.assertRaises(FileNotFoundError):
            isotherm.Metric('/nowhere')

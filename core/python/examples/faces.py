#!/usr/bin/env python3
"""Who is it: a person of one recording, beside the people of others.

usage: faces.py [--data DIRECTORY] [--picture FILE.png] ENROLMENT VISIT...

Each is a directory with recorded depth frames, as `isotherm-sim record` and `isotherm-sim generate`
write them. DIRECTORY has head.model and face.metric; by default it is that of the package
isotherm-data.
"""
import argparse
import os
import sys

import numpy as np

import isotherm
import pictures

parser = argparse.ArgumentParser(description='Compares the person of one recording with those of others.')
parser.add_argument('--data', default='/usr/share/isotherm')
parser.add_argument('--picture')
parser.add_argument('enrolment')
parser.add_argument('visits', nargs='+')
arguments = parser.parse_args()

extractor = isotherm.Extractor(os.path.join(arguments.data, 'head.model'))
metric = isotherm.Metric(os.path.join(arguments.data, 'face.metric'))


def faces_of(directory):
    """The usable faces of a recording."""
    faces = [extractor.extract(frame) for frame in isotherm.Recording(directory)]
    good = [face for face in faces if face.template]
    if not good:
        sys.exit('%s: no usable face; the frames are: %s' % (directory, ', '.join(face.outcome for face in faces)))
    return good


person = faces_of(arguments.enrolment)
print('%s: %d usable faces' % (arguments.enrolment, len(person)))
for visit in arguments.visits:
    face = faces_of(visit)[0]
    # A score s says that among rendered strangers one in 10^s is as much alike.
    score = metric.score([face.template for face in person], face.template)
    print('%s: score %6.1f, %s' % (visit, score, 'the same person' if score > 5 else 'somebody else'))

if arguments.picture:
    face, tip = person[0], isotherm.LANDMARKS.index('nose_tip')
    heat = np.log10(np.maximum(face.heat[:, tip], 1e-8))
    pictures.draw(arguments.picture, [('heat of the nose tip, lg of 1/mm^2', face.mesh.vertices, face.mesh.triangles, heat)])

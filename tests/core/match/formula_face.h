/* Upper faces that are given by a formula, for the tests of registration and reranking. */
#ifndef TESTS_CORE_MATCH_FORMULA_FACE_H
#define TESTS_CORE_MATCH_FORMULA_FACE_H

#include "core/match/upper_face.h"
#include "isotherm/vec.h"

/* Returns the height of a person's surface above the point (x, y), all in mm. */
double formula_face_height_mm(int who, double x, double y);

/* Returns the upper face of a person; each number gives another face. */
struct iso_upper_face formula_face(int who);

/* Returns the upper face of a person after a motion. */
struct iso_upper_face formula_face_moved(int who, const struct iso_rigid *motion);

/* Returns the motion that turns by the vector (rx, ry, rz), radians, and then moves by (x, y, z),
 * mm. */
struct iso_rigid formula_face_motion(double rx, double ry, double rz, double x, double y, double z);

#endif
